// SPDX-License-Identifier: Apache-2.0
#include "sdk/core/pipeline.hpp"

#include <algorithm>
#include <string>

namespace odograph {

void Pipeline::process(const odo_header& message) {
  events_.begin();
  watch_.see(message);
  switch (message.type) {
    case ODO_TYPE_IMU: joiner_.push(as<odo_imu>(message), [this](const odo_imu& whole) { on_imu(whole); }); break;
    case ODO_TYPE_IMU_NOISE:
      remember(message);
      estimator_->on_imu_noise(as<odo_imu_noise>(message));
      ask(attitude_, message);
      ask(vo_, message);
      break;
    case ODO_TYPE_MAGNETOMETER:
      ask(attitude_, message);
      ask(vo_, message);
      break;
    case ODO_TYPE_FRAME:
      ++counters_.frames;
      if (vo_) estimator_->update(FrameTime{message.t_ns});
      publish_estimates();
      ask(vo_, message);
      ask_fixers(message);
      break;
    case ODO_TYPE_CALIBRATION:
      remember(message);
      estimator_->on_calibration(as<odo_calibration>(message));
      ask(vo_, message);
      ask_fixers(message);
      break;
    case ODO_TYPE_BAROMETER:
      estimator_->update(&as<odo_barometer>(message));
      ask(step_, message);
      ask_fixers(message);
      break;
    default: ask_fixers(message);  // GNSS, waypoints
  }
  handle_events();
  watch_silence();
}

/// The attitude first: it is a prior of what the others make of the same sample.
void Pipeline::on_imu(const odo_imu& imu) {
  events_.begin();
  estimator_->propagate(imu);
  publish_estimates();
  ask(attitude_, imu.header);
  ask(vo_, imu.header);
  ask(step_, imu.header);
}

/// Hands a message to a plugin, and handles all that comes of it.
void Pipeline::ask(const std::unique_ptr<PluginInstance>& plugin, const odo_header& message) {
  if (!plugin) return;
  take(*plugin, message);
  handle_events();
}

void Pipeline::ask_fixers(const odo_header& message) {
  for (const auto& fixer : fixers_) ask(fixer, message);
}

/// Hands a message to a plugin and copies what it answers into the queue.
void Pipeline::take(PluginInstance& plugin, const odo_header& message) {
  for (const AnyMessage& event : plugin.process(message)) enqueue(event.header());
  if (plugin.take_reset()) describe_sensors_to(plugin);
}

/// After a reset a plugin knows of no camera any more.
void Pipeline::describe_sensors_to(PluginInstance& plugin) {
  for (const AnyMessage& description : descriptions_)
    for (const AnyMessage& event : plugin.process(description.header())) enqueue(event.header());
  plugin.take_reset();
}

void Pipeline::remember(const odo_header& description) {
  const auto same = [&](const AnyMessage& known) {
    if (known.header().type != description.type) return false;
    return description.type == ODO_TYPE_CALIBRATION
               ? as<odo_calibration>(known.header()).id == as<odo_calibration>(description).id
               : known.header().source == description.source;
  };
  const auto found = std::find_if(descriptions_.begin(), descriptions_.end(), same);
  (found != descriptions_.end() ? *found : descriptions_.emplace_back()).assign(description);
}

void Pipeline::enqueue(const odo_header& event) {
  if (events_.push(event)) return;
  ++counters_.events_dropped;
  host_.report(event.source, ODO_SEVERITY_WARNING, "event_limit",
               std::string("a ") + message_info(event.type)->name + " was dropped: one sample has given " +
                   std::to_string(events_.limit()) + " events already; plugins that answer each other without end?");
}

void Pipeline::handle_events() {
  while (!events_.empty()) {
    AnyMessage event;
    event.assign(events_.front().header());
    events_.pop();
    handle(event);
    // Fixes of one call count as one: the corrected pose comes after the last of them.
    const bool more_fixes = !events_.empty() && events_.front().header().type == ODO_TYPE_FIX;
    if (event.header().type != ODO_TYPE_FIX || !more_fixes) publish_estimates();
  }
}

void Pipeline::handle(AnyMessage& event) {
  const odo_header& header = event.header();
  switch (header.type) {
    case ODO_TYPE_VO_MOTION: return on_vo_motion(reinterpret_cast<odo_vo_motion&>(event.header()));
    case ODO_TYPE_FIX: return on_fix(reinterpret_cast<odo_fix&>(event.header()));
    case ODO_TYPE_POSE:  // a prior for the fixers; it has been published
      for (const auto& fixer : fixers_) take(*fixer, header);
      return;
    default: publish_(header);
  }
  switch (header.type) {
    case ODO_TYPE_ATTITUDE:
      poses_.predictor().add_attitude(as<odo_attitude>(header));
      if (!camera_knows_bias_)
        poses_.predictor().set_biases(Eigen::Vector3d(as<odo_attitude>(header).gyro_bias_b), Eigen::Vector3d::Zero());
      estimator_->update(&as<odo_attitude>(header));
      publish_estimates();
      if (vo_) take(*vo_, header);
      if (step_) take(*step_, header);
      break;
    case ODO_TYPE_STEP:
      if (scale_) take(*scale_, header);
      ++counters_.steps;
      estimator_->update(&as<odo_step>(header));
      break;
    case ODO_TYPE_MOTION_MODE:
      if (scale_) take(*scale_, header);
      estimator_->update(&as<odo_motion_mode>(header));
      break;
    case ODO_TYPE_SCALE:
      scale_to_come_ = as<odo_scale>(header);
      estimator_->update(&as<odo_scale>(header));
      break;
    default: break;
  }
}

/// The scale that holds for a motion: what the source answers to it, or what it has said before; null where there is
/// none. The answer is taken at once, because the motion needs it.
const odo_scale* Pipeline::scale_for(const odo_vo_motion& motion) {
  if (!scale_) return nullptr;
  const odo_scale* found = nullptr;
  const auto consider = [&](const odo_scale& scale) {
    const bool in_time = scale.valid_from_ns < motion.header.t_ns && motion.header.t_ns <= scale.valid_to_ns;
    if (!in_time || scale.scale_group != motion.scale_group) return;
    scale_in_use_ = scale;
    found = &scale_in_use_;
  };
  if (scale_to_come_) consider(*scale_to_come_);
  for (const AnyMessage& event : scale_->process(motion.header)) {
    publish_(event.header());
    consider(as<odo_scale>(event.header()));
  }
  scale_->take_reset();  // a scale source is told of no sensors
  return found;
}

void Pipeline::on_vo_motion(odo_vo_motion& motion) {
  estimator_->prepare(motion);
  publish_(motion.header);
  inertial_motion_.reset();
  if ((motion.header.flags & ODO_VO_INERTIAL) && (motion.header.flags & ODO_VO_METRIC)) inertial_motion_ = motion;
  estimator_->update(RelativeMotion{&motion, scale_for(motion)});
  publish_estimates();
  odo_fix reference;
  while (estimator_->take_step_reference(reference))
    if (step_) take(*step_, reference.header);
}

void Pipeline::on_fix(odo_fix& fix) {
  resolve_geodetic(fix, geodesy_);  // what is published is metric, and says what became of it
  fix.header.flags &= ~ODO_FIX_ACCEPTED;
  const bool used = estimator_->update(&fix).accepted;
  ++(used ? counters_.fixes_accepted : counters_.fixes_rejected);
  if (used) fix.header.flags |= ODO_FIX_ACCEPTED;
  publish_(fix.header);
  if (used && scale_) take(*scale_, fix.header);
  if (used && step_) take(*step_, fix.header);
}

void Pipeline::reset() {
  events_.begin();
  for (PluginInstance* instance : instances()) {
    const auto learnt = instance->save();  // the clock was set back, the walker is the same
    instance->reset();
    if (!learnt.empty()) instance->load(learnt);
    if (instance->take_reset()) describe_sensors_to(*instance);
  }
  estimator_->reset();
  for (const AnyMessage& description : descriptions_) {
    if (description.header().type == ODO_TYPE_CALIBRATION)
      estimator_->on_calibration(as<odo_calibration>(description.header()));
    else
      estimator_->on_imu_noise(as<odo_imu_noise>(description.header()));
  }
  joiner_.reset();
  watch_.reset();
  poses_.clear();
  scale_to_come_.reset();
  inertial_motion_.reset();
  camera_knows_bias_ = false;
  if (last_pose_ns_ != INT64_MIN) before_restart_ = last_pose_;
  last_pose_ns_ = INT64_MIN;
  state_ = 0;
  handle_events();
}

Pipeline::Pipeline(const PipelineConfig& config, const Surroundings& surroundings, Publish publish)
    : estimator_(make_estimator(config.coupling, config.start,
                                {config.vo_frontend.has_value(), config.scale_source.has_value()})),
      host_(surroundings.host),
      geodesy_(surroundings.geodesy),
      poses_(surroundings.poses),
      events_(Parameters{}.events_per_sample),
      watch_(config.ordering.max_gap_s),
      publish_(std::move(publish)) {
  if (config.origin) geodesy_.set_origin(*config.origin);
}

Result<std::unique_ptr<Pipeline>> Pipeline::make(const PipelineConfig& config, const Surroundings& surroundings,
                                                 Publish publish) {
  std::unique_ptr<Pipeline> pipeline(new Pipeline(config, surroundings, std::move(publish)));
  uint32_t number = 0;
  const auto start = [&](const PluginChoice& choice, std::unique_ptr<PluginInstance>& slot) -> Result<bool> {
    auto made = PluginInstance::make(choice, config.verify_hash, ++number, surroundings.host);
    if (!made) return made.failure();
    slot = std::move(*made);
    return true;
  };
  const std::pair<const std::optional<PluginChoice>*, std::unique_ptr<PluginInstance>*> slots[] = {
      {&config.attitude, &pipeline->attitude_},
      {&config.step_estimator, &pipeline->step_},
      {&config.vo_frontend, &pipeline->vo_},
      {&config.scale_source, &pipeline->scale_}};
  for (const auto& [choice, slot] : slots)
    if (choice->has_value())
      if (const auto started = start(**choice, *slot); !started) return started.failure();
  for (const PluginChoice& choice : config.fixers)
    if (const auto started = start(choice, pipeline->fixers_.emplace_back()); !started) return started.failure();
  return pipeline;
}

}  // namespace odograph
