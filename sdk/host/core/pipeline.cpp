// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/pipeline.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <odograph/step_estimator.h>
#include <odograph/vo_frontend.h>

#include "sdk/host/base/rotation.hpp"

namespace odograph {
namespace {

constexpr Pipeline::Parameters kParameters;

}  // namespace

void Pipeline::process(const odo_header& message) {
  wake();
  events_.begin();
  watch_.see(message);
  switch (message.type) {
    case ODO_TYPE_IMU: joiner_.push(as<odo_imu>(message), [this](const odo_imu& whole) { on_imu(whole); }); break;
    case ODO_TYPE_IMU_NOISE:
      remember(message);
      estimator_->on_imu_noise(as<odo_imu_noise>(message));
      ask(message);
      break;
    case ODO_TYPE_FRAME:
      ++counters_.frames;
      if (is_main_camera(message) && has_vo_) estimator_->update(FrameTime{message.t_ns});
      publish_estimates();
      ask(message);
      break;
    case ODO_TYPE_CALIBRATION:
      remember(message);
      if (is_main_camera(message)) on_calibration(as<odo_calibration>(message));
      ask(message);
      break;
    case ODO_TYPE_EARTH_FIELD:
      if (message.flags & ODO_EARTH_FIELD_DECLINATION) declination_rad_ = as<odo_earth_field>(message).declination_rad;
      ask(message);
      break;
    case ODO_TYPE_BAROMETER:
      estimator_->update(&as<odo_barometer>(message));
      ask(message);
      break;
    default: ask(message);  // magnetometer, GNSS, waypoints, and what only a plugin knows
  }
  handle_events();
  watch_silence();
}

void Pipeline::on_imu(const odo_imu& imu) {
  events_.begin();
  if ((imu.header.flags & ODO_IMU_ACCEL) == 0) {  // front-ends alone: all others need gravity
    for (PluginInstance* plugin : asked_)
      if (plugin->interface_id() == ODO_INTERFACE_VO_FRONTEND && plugin->wants(ODO_TYPE_IMU)) take(*plugin, imu.header);
    return handle_events();
  }
  estimator_->propagate(imu);
  publish_estimates();
  ask(imu.header);
}

/// The camera of the front-end: the first that has a calibration or a frame.
bool Pipeline::is_main_camera(const odo_header& message) {
  int64_t none = kNoCamera;
  camera_.compare_exchange_strong(none, message.source);
  return camera_ == message.source;
}

void Pipeline::on_calibration(const odo_calibration& calibration) {
  if (calibration.header.flags & ODO_CALIBRATION_EXTRINSICS) p_b_c_ = Eigen::Vector3d(calibration.p_b_c);
  estimator_->on_calibration(calibration);
}

bool Pipeline::is_for(const PluginInstance& plugin, const odo_header& message) const {
  if (!plugin.wants(message.type)) return false;
  const bool of_camera = message.type == ODO_TYPE_FRAME || message.type == ODO_TYPE_CALIBRATION;
  return !of_camera || camera_ == message.source || plugin.takes_several_cameras() ||
         plugin.interface_id() != ODO_INTERFACE_VO_FRONTEND;
}

/// Hands a sample to the plugins that want it, the attitude first: it is a prior of what the others make of the same
/// sample. All that comes of it is handled before the next one is asked.
void Pipeline::ask(const odo_header& message) {
  bool wanted = message_info(message.type) != nullptr;
  for (PluginInstance* plugin : asked_) {
    if (!is_for(*plugin, message)) {
      if (message.type == ODO_TYPE_FRAME && plugin->wants(message.type)) report_other_camera(message.source);
      continue;
    }
    wanted = true;
    take(*plugin, message);
    handle_events();
  }
  if (!wanted) ++counters_.unknown;
}

/// Hands an event to the plugins that want it, but not to the one that it came from.
void Pipeline::tell(const odo_header& event) {
  for (PluginInstance* plugin : asked_)
    if (plugin->number() != event.source && plugin->wants(event.type)) take(*plugin, event);
}

/// Hands a message to a plugin and copies what it answers into the queue.
void Pipeline::take(PluginInstance& plugin, const odo_header& message) {
  for (const AnyMessage& event : plugin.process(message)) enqueue(event);
  if (plugin.take_reset()) describe_sensors_to(plugin);
}

/// After a reset a plugin knows of no camera any more.
void Pipeline::describe_sensors_to(PluginInstance& plugin) {
  for (const AnyMessage& description : descriptions_) {
    if (!is_for(plugin, description.header())) continue;
    for (const AnyMessage& event : plugin.process(description.header())) enqueue(event);
  }
  plugin.take_reset();
}

void Pipeline::remember(const odo_header& description) {
  const auto same = [&](const AnyMessage& known) {
    return known.header().type == description.type && known.header().source == description.source;
  };
  const auto found = std::find_if(descriptions_.begin(), descriptions_.end(), same);
  (found != descriptions_.end() ? *found : descriptions_.emplace_back()).assign(description);
}

void Pipeline::enqueue(const AnyMessage& event) {
  if (events_.push(event)) return;
  ++counters_.events_dropped;
  host_.report(event.header().source, ODO_SEVERITY_WARNING, "event_limit",
               "a " + message_name(event.header().type) + " was dropped: one sample has given " +
                   std::to_string(events_.limit()) + " events already; plugins that answer each other without end?");
}

void Pipeline::handle_events() {
  while (!events_.empty()) {
    AnyMessage event = events_.front();
    events_.pop();
    handle(event);
    // Fixes of one call count as one: the corrected pose comes after the last of them.
    const bool more_fixes = !events_.empty() && events_.front().header().type == ODO_TYPE_FIX;
    if (event.header().type != ODO_TYPE_FIX || !more_fixes) publish_estimates();
  }
}

/// Whether an event is of the plugin whose events of this type are used: the first that is alive.
bool Pipeline::in_use(const odo_header& event) const {
  for (const auto& plugin : plugins_)
    if (plugin->alive() && plugin->gives(event.type)) return plugin->number() == event.source;
  return false;
}

void Pipeline::handle(AnyMessage& event) {
  const odo_header& header = event.header();
  switch (header.type) {
    case ODO_TYPE_FIX: return on_fix(reinterpret_cast<odo_fix&>(event.header()));
    case ODO_TYPE_POSE:  // a prior for the fixers; they have been published
    case ODO_TYPE_CORRECTION: return tell(header);
    case ODO_TYPE_VO_MOTION:
      if (in_use(header) && is_of_main_camera(as<odo_vo_motion>(header)))
        return on_vo_motion(reinterpret_cast<odo_vo_motion&>(event.header()));
      break;
    case ODO_TYPE_SCALE: return on_scale(reinterpret_cast<odo_scale&>(event.header()));
    case ODO_TYPE_ATTITUDE: complete(reinterpret_cast<odo_attitude&>(event.header())); break;
    default: break;
  }
  publish_(header);
  switch (header.type) {
    case ODO_TYPE_ATTITUDE:
      if (in_use(header)) on_attitude(as<odo_attitude>(header));
      break;
    case ODO_TYPE_STEP:
      if (!in_use(header)) break;
      tell(header);
      ++counters_.steps;
      if (steps_alone_need_heading_ && (header.flags & ODO_STEP_HEADING) == 0)
        host_.report(header.source, ODO_SEVERITY_WARNING, "no_heading",
                     "a step without heading_rad (ODO_STEP_HEADING) and no camera: this coupling does not move by it; "
                     "`coupling: {type: inertial}` goes by the phone's direction");
      estimator_->update(&as<odo_step>(header));
      tell_notice();
      break;
    case ODO_TYPE_MOTION_MODE:
      if (!in_use(header)) break;
      tell(header);
      estimator_->update(&as<odo_motion_mode>(header));
      break;
    case ODO_TYPE_VO_MOTION: break;
    default: tell(header);  // for plugins that declare it
  }
}

void Pipeline::on_attitude(const odo_attitude& attitude) {
  poses_.predictor().add_attitude(attitude);
  if (attitude.header.flags & ODO_ATTITUDE_TRUE_NORTH) north_is_true_ = true;
  if (!camera_knows_bias_ && (attitude.header.flags & ODO_ATTITUDE_GYRO_BIAS))
    poses_.predictor().set_biases(Eigen::Vector3d(attitude.gyro_bias_b), Eigen::Vector3d::Zero());
  estimator_->update(&attitude);
  publish_estimates();
  tell(attitude.header);
}

/// A scale that was said outside of a motion.
void Pipeline::on_scale(odo_scale& scale) {
  bool accepted = estimator_->update(&scale).accepted;
  for (size_t i = 0; i < scales_.size(); ++i)
    if (scales_[i]->number() == scale.header.source) accepted |= scale_join_.note(i, scale);
  publish_scale(scale, accepted);
}

void Pipeline::publish_scale(odo_scale& scale, bool accepted) {
  if (accepted)
    scale.header.flags |= ODO_FLAG_ACCEPTED;
  else
    host_.report(scale.header.source, ODO_SEVERITY_WARNING, "late_scale",
                 "a scale changes nothing: it holds until valid_to_ns = " + std::to_string(scale.valid_to_ns) +
                     " in scale_group " + std::to_string(scale.scale_group) + "; the newest motion ended at " +
                     std::to_string(scale_join_.motion_ns()) + " in group " + std::to_string(scale_join_.group()));
  publish_(scale.header);
}

/// The scale that holds for a motion: what the sources answer to it, or what they have said before; null where there is
/// none. The answers are taken at once, because the motion needs them.
const odo_scale* Pipeline::scale_for(const odo_vo_motion& motion) {
  scale_join_.begin(motion);
  for (size_t i = 0; i < scales_.size(); ++i) {
    for (AnyMessage& event : scales_[i]->process(motion.header)) {
      if (event.header().type != ODO_TYPE_SCALE) {
        enqueue(event);
        continue;
      }
      auto& scale = reinterpret_cast<odo_scale&>(event.header());
      publish_scale(scale, scale_join_.answer(i, scale));
    }
    if (scales_[i]->take_reset()) describe_sensors_to(*scales_[i]);
  }
  return scale_join_.joined();
}

void Pipeline::on_vo_motion(odo_vo_motion& motion) {
  if (motion.state > ODO_LOST) motion.state = ODO_LOST;  // of a newer list (docs/abi.md)
  estimator_->prepare(motion);
  publish_(motion.header);
  inertial_motion_.reset();
  if ((motion.header.flags & ODO_VO_INERTIAL) && (motion.header.flags & ODO_VO_METRIC))
    inertial_motion_ = copy_as<odo_vo_motion>(motion.header);
  odo_vo_motion judged = motion;
  for (double& c : judged.covariance) c *= odometry_covariance_;
  judged.scale_sigma *= std::sqrt(odometry_covariance_);
  estimator_->update(RelativeMotion{&judged, scale_for(motion)});
  publish_estimates();
  for (PluginInstance* plugin : asked_) {  // the scale sources have had it
    const bool is_scale = std::find(scales_.begin(), scales_.end(), plugin) != scales_.end();
    if (!is_scale && plugin->number() != motion.header.source && plugin->wants(ODO_TYPE_VO_MOTION))
      take(*plugin, motion.header);
  }
  odo_fix reference;
  while (estimator_->take_step_reference(reference))
    for (PluginInstance* plugin : asked_)
      if (plugin->interface_id() == ODO_INTERFACE_STEP_ESTIMATOR) take(*plugin, reference.header);
}

void Pipeline::tell_notice() {
  if (const Notice notice = estimator_->take_notice(); notice.key)
    host_.report(0, ODO_SEVERITY_WARNING, notice.key, notice.text);
}

void Pipeline::on_fix(odo_fix& fix) {
  resolve_geodetic(fix, geodesy_);  // what is published is metric, and has the verdict
  const odo_fix moved = at_track(fix);
  const UpdateResult result = is_beyond_frame(fix) ? UpdateResult{} : estimator_->update(&moved);
  const bool used = result.accepted;
  tell_notice();
  if (!used && result.dof > 0)
    host_.report(fix.header.source, ODO_SEVERITY_INFO, "rejected_fix",
                 "a fix was rejected by the gate: " + std::to_string(std::sqrt(result.nis)) +
                     " sigma from the track in " + std::to_string(result.dof) + " components");
  ++(used ? counters_.fixes_accepted : counters_.fixes_rejected);
  if (used) fix.header.flags |= ODO_FLAG_ACCEPTED;
  if (used && (fix.header.flags & (ODO_FIX_YAW | ODO_FIX_ORIENTATION))) north_is_true_ = true;
  publish_(fix.header);
  if (used) tell(fix.header);
}

void Pipeline::reset() {
  events_.begin();
  for (const auto& instance : plugins_) {
    const auto learnt = instance->save();  // the clock was set back, the walker is the same
    instance->reset();
    if (!learnt.empty()) instance->load(learnt);
    if (instance->take_reset()) describe_sensors_to(*instance);
  }
  estimator_->reset();
  anchors_.lose_holds();
  for (const AnyMessage& description : descriptions_) {
    if (description.header().type == ODO_TYPE_IMU_NOISE)
      estimator_->on_imu_noise(as<odo_imu_noise>(description.header()));
    else if (camera_ == description.header().source)
      estimator_->on_calibration(as<odo_calibration>(description.header()));
  }
  joiner_.reset();
  watch_.reset();
  poses_.clear();
  scale_join_.reset();
  inertial_motion_.reset();
  camera_knows_bias_ = false;
  north_is_true_ = start_has_heading_;
  if (last_pose_ns_ != INT64_MIN) before_restart_ = last_pose_;
  last_pose_ns_ = INT64_MIN;
  state_ = 0;
  handle_events();
}

Pipeline::Pipeline(const PipelineConfig& config, const Surroundings& surroundings, Publish publish)
    : estimator_(
          make_estimator(config.coupling, config.start, {!config.vo_frontends.empty(), !config.scale_sources.empty()})),
      host_(surroundings.host),
      geodesy_(surroundings.geodesy),
      poses_(surroundings.poses),
      anchors_(surroundings.anchors),
      world_mutex_(surroundings.world_mutex),
      events_(kParameters.events_per_sample),
      watch_(config.ordering.max_gap_s),
      publish_(std::move(publish)),
      scale_join_(config.scale_sources.size()),
      odometry_covariance_(config.coupling.odometry_covariance),
      steps_alone_need_heading_(config.coupling.type == CouplingType::paper && config.vo_frontends.empty()),
      start_has_heading_(config.start.heading_given),
      north_is_true_(start_has_heading_),
      declination_rad_(config.declination_rad) {
  if (config.origin) geodesy_.set_origin(*config.origin);
  anchors_.set_ground(
      [this](double north_m, double east_m, double near_down_m) { return ground_at(north_m, east_m, near_down_m); });
}

Result<std::unique_ptr<Pipeline>> Pipeline::make(const PipelineConfig& config, const Surroundings& surroundings,
                                                 Publish publish) {
  std::unique_ptr<Pipeline> pipeline(new Pipeline(config, surroundings, std::move(publish)));
  auto& plugins = pipeline->plugins_;
  std::vector<PluginInstance*> attitudes, steps, odometries, fixers;
  const std::pair<const std::vector<PluginChoice>*, std::vector<PluginInstance*>*> kinds[] = {
      {&config.attitudes, &attitudes},
      {&config.step_estimators, &steps},
      {&config.vo_frontends, &odometries},
      {&config.scale_sources, &pipeline->scales_},
      {&config.fixers, &fixers}};
  for (const auto& [choices, kind] : kinds)
    for (const PluginChoice& choice : *choices) {
      const auto number = static_cast<uint32_t>(plugins.size() + 1);
      auto made = PluginInstance::make(choice, config.library_check, number, surroundings.host);
      if (!made) return made.failure();
      kind->push_back(plugins.emplace_back(std::move(*made)).get());
    }
  for (const auto* kind : {&attitudes, &odometries, &pipeline->scales_, &steps, &fixers})
    pipeline->asked_.insert(pipeline->asked_.end(), kind->begin(), kind->end());
  pipeline->has_attitude_ = !attitudes.empty();
  pipeline->has_vo_ = !odometries.empty();
  const auto anyone_wants = [&](uint32_t type) {
    return std::any_of(plugins.begin(), plugins.end(), [type](const auto& plugin) { return plugin->wants(type); });
  };
  pipeline->gives_poses_to_ = anyone_wants(ODO_TYPE_POSE);
  pipeline->gives_corrections_to_ = anyone_wants(ODO_TYPE_CORRECTION);
  return pipeline;
}

}  // namespace odograph
