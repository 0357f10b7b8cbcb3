// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/pipeline.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <odograph/step_estimator.h>
#include <odograph/vo_frontend.h>

#include "sdk/host/core/event_verdicts.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph {
namespace {

constexpr Pipeline::Parameters kParameters;

}  // namespace

void Pipeline::process(const odo_header& message) {
  wake();
  events_.begin();
  if (watch_.on_message(message)) on_pause();
  checks_.on_sample(message);
  if (is_description(message)) roster_.store_description(message);
  sources_.came(message);
  switch (message.type) {
    case ODO_TYPE_IMU: joiner_.push(as<odo_imu>(message), [this](const odo_imu& whole) { on_imu(whole); }); break;
    case ODO_TYPE_FRAME:
      ++counters_.frames;
      if (roster_.is_main_camera(message) && roster_.has_front_end()) fusion_->on_frame(message.t_ns, outputs_);
      publish();
      dispatch(message);
      break;
    case ODO_TYPE_CALIBRATION:
      if (roster_.is_main_camera(message)) fusion_->on_calibration(as<odo_calibration>(message));
      dispatch(message);
      break;
    case ODO_TYPE_EARTH_FIELD:
      north_.add(as<odo_earth_field>(message));
      dispatch(message);
      break;
    case ODO_TYPE_BAROMETER:
      fusion_->on_barometer(as<odo_barometer>(message), outputs_);
      publish();
      dispatch(message);
      break;
    default: dispatch(message);  // magnetometer, GNSS, waypoints, and types that only a plugin knows
  }
  handle_events();
  if (std::exchange(places_moved_, false)) {  // after the correction
    fusion_->publish_moved_key_frames([this](const odo_key_frame& frame) {
      publish_and_forward(frame.header);
      roster_.return_event(frame.header);
    });
    handle_events();
  }
  sources_.judge();
  publisher_.check_input();
  if (!std::exchange(broken_, false)) return;
  host_.report(0, ODO_SEVERITY_ERROR, "broken_pose",
               "the fusion's pose is not finite: it is not published, and the pipeline restarts", ODO_E_ERROR);
  reset();
}

/// All sensors were silent. This counts as one event of any length; nothing integrates over it.
void Pipeline::on_pause() {
  joiner_.reset();
  fusion_->on_pause(watch_.pause().to_ns);
  publisher_.pause();
}

void Pipeline::on_imu(const odo_imu& imu) {
  events_.begin();
  checks_.on_imu(imu);
  if ((imu.header.flags & ODO_IMU_ACCEL) == 0) {  // for front-ends only: all others need gravity
    roster_.forward_to_kind(ODO_INTERFACE_VO_FRONTEND, imu.header);
    return handle_events();
  }
  fusion_->on_imu(imu);
  dispatch(imu.header);
}

void Pipeline::wake() {
  if (!host_.has_woken()) return;
  events_.begin();
  roster_.wake([this] { handle_events(); });
}

/// Passes a sample to each plugin in turn and handles all resulting events before the next plugin.
void Pipeline::dispatch(const odo_header& message) {
  if (roster_.dispatch(message, [this] { handle_events(); })) return;
  if (!message_info(message.type)) ++counters_.unknown;
  const bool used = message.type == ODO_TYPE_BAROMETER && coupling_.type == CouplingType::localizer;
  if (used || is_description(message) || !unused_.insert(message.type).second) return;
  host_.report(0, ODO_SEVERITY_INFO, "unused_" + message_name(message.type),
               "no plugin of this config uses " + message_name(message.type) + ": these samples have no effect");
}

void Pipeline::enqueue(const AnyMessage& event) {
  if (events_.push(event)) return;
  ++counters_.events_dropped;
  host_.report(event.header().source, ODO_SEVERITY_WARNING, "event_limit",
               "a " + message_name(event.header().type) + " was dropped: one sample has given " +
                   std::to_string(events_.limit()) + " events already; do plugins answer each other in a loop?");
}

void Pipeline::handle_events() {
  while (!events_.empty()) {
    handle(events_.front());
    const uint32_t type = events_.front().header().type;
    events_.pop();
    // Fixes from one call count as one: the corrected pose follows the last of them.
    const bool more_fixes = !events_.empty() && events_.front().header().type == ODO_TYPE_FIX;
    if (type != ODO_TYPE_FIX || !more_fixes) publish();
  }
}

void Pipeline::handle(AnyMessage& event) {
  odo_header& header = event.header();
  sources_.came(header);
  const bool used = roster_.in_use(header);
  switch (header.type) {
    case ODO_TYPE_ATTITUDE: return on_attitude(reinterpret_cast<odo_attitude&>(header), used);
    case ODO_TYPE_STEP: return on_step(as<odo_step>(header), used);
    case ODO_TYPE_VO_MOTION:
      if (!used || !is_of_main_camera(as<odo_vo_motion>(header))) return publish_(header);
      return on_vo_motion(reinterpret_cast<odo_vo_motion&>(header));
    case ODO_TYPE_SCALE: return on_scale(reinterpret_cast<odo_scale&>(header));
    case ODO_TYPE_FIX: return on_fix(reinterpret_cast<odo_fix&>(header));
    case ODO_TYPE_KEY_FRAME:
      fusion_->on_key_frame(reinterpret_cast<odo_key_frame&>(header));
      return publish_and_forward(header);
    case ODO_TYPE_RELATIVE_POSE: return on_place(reinterpret_cast<odo_relative_pose&>(header));
    case ODO_TYPE_MAP_POSE: return on_place(reinterpret_cast<odo_map_pose&>(header));
    case ODO_TYPE_POSE:  // a prior for fix plugins; already published
    case ODO_TYPE_CORRECTION: return roster_.forward_event(header);
    case ODO_TYPE_POINTS: return on_points(reinterpret_cast<odo_points&>(header), used);
    case ODO_TYPE_SURFACE: return on_surface(reinterpret_cast<odo_surface&>(header), used);
    case ODO_TYPE_MOTION_MODE: publish_(header); return used ? roster_.forward_event(header) : void();
    default: publish_and_forward(header);  // for plugins that declare them
  }
}

void Pipeline::publish_and_forward(const odo_header& event) {
  publish_(event);
  roster_.forward_event(event);
}

/// A place was recognised: in this session's track, or in the map of an earlier one.
void Pipeline::on_place(auto& place) {
  places_moved_ = take_verdict(place.header, fusion_->on_place(place, outputs_), host_) || places_moved_;
  publish_and_forward(place.header);
}

void Pipeline::on_attitude(odo_attitude& attitude, bool used) {
  north_.complete(attitude);
  publish_(attitude.header);
  if (!used) return;
  poses_.add_attitude(attitude);
  north_.observe(attitude);
  fusion_->on_attitude(attitude, outputs_);
  publish();
  roster_.forward_event(attitude.header);
}

void Pipeline::on_step(const odo_step& step, bool used) {
  publish_(step.header);
  if (!used) return;
  roster_.forward_event(step.header);
  if (watch_.pause().is_within(step.t_start_ns, step.t_end_ns)) return;
  ++counters_.steps;
  if (coupling_.type == CouplingType::paper && !inputs_.vo && (step.header.flags & ODO_STEP_HEADING) == 0)
    host_.report(step.header.source, ODO_SEVERITY_WARNING, "no_heading",
                 "a step without heading_rad (ODO_STEP_HEADING) and no camera: this coupling does not use it; "
                 "`coupling: {type: localizer}` uses the phone's direction");
  fusion_->on_step(step, outputs_);
}

/// A scale published outside of a motion callback.
void Pipeline::on_scale(odo_scale& scale) {
  ScaleUse use = fusion_->on_scale(scale, outputs_).accepted ? ScaleUse::used : ScaleUse::late;
  const PluginRoster::Plugins& sources = roster_.scale_sources();
  for (size_t i = 0; i < sources.size(); ++i) {
    if (sources[i]->number() != scale.header.source) continue;
    const ScaleUse noted = scale_join_.note(i, scale);
    if (use != ScaleUse::used) use = noted;
  }
  publish_scale(scale, use);
}

void Pipeline::publish_scale(odo_scale& scale, ScaleUse use) {
  if (use == ScaleUse::used) scale.header.flags |= ODO_FLAG_ACCEPTED;
  if (use == ScaleUse::pointless) sources_.on_pointless_scale(scale.header.source);
  if (use == ScaleUse::late)
    host_.report(scale.header.source, ODO_SEVERITY_WARNING, "late_scale",
                 "a scale has no effect: it is valid until valid_to_ns = " + std::to_string(scale.valid_to_ns) +
                     " in scale_group " + std::to_string(scale.scale_group) + "; the newest motion ended at " +
                     std::to_string(scale_join_.motion_ns()) + " in group " + std::to_string(scale_join_.group()));
  publish_(scale.header);
}

/// The scale valid for a motion, from the sources' answers to it or their earlier statements; null if there is none.
/// The answers are processed immediately because the motion needs them.
const odo_scale* Pipeline::scale_for(const odo_vo_motion& motion) {
  scale_join_.begin(motion, fusion_->is_in_metres(motion));
  const PluginRoster::Plugins& sources = roster_.scale_sources();
  for (size_t i = 0; i < sources.size(); ++i) {
    for (AnyMessage& event : sources[i]->process(motion.header)) {
      if (event.header().type != ODO_TYPE_SCALE) {
        enqueue(event);
        continue;
      }
      sources_.came(event.header());
      auto& scale = reinterpret_cast<odo_scale&>(event.header());
      publish_scale(scale, scale_join_.answer(i, scale));
    }
    if (sources[i]->take_reset()) roster_.send_descriptions(*sources[i]);
  }
  return scale_join_.joined();
}

void Pipeline::on_points(odo_points& points, bool used) {
  if (used) points.scale_group = group_of(points.header, points.scale_group), scene_.hold(points);
  publish_(points.header);
  if (used) roster_.forward_event(points.header);
}

/// Surfaces of the first finder are kept: they get ids of the session, and anchors follow them.
void Pipeline::on_surface(odo_surface& surface, bool used) {
  const uint32_t resets = roster_.resets(surface.header.source);
  if (used && !surfaces_.take(surface, resets, publish_)) return;
  publish_(surface.header);
  if (used) roster_.forward_event(surface.header);
}

/// A scale group's number in this pipeline, which has several front-ends and resets.
uint32_t Pipeline::group_of(const odo_header& event, uint32_t group) {
  return groups_.number(event.source, roster_.resets(event.source), group);
}

void Pipeline::on_vo_motion(odo_vo_motion& motion) {
  if (motion.state > ODO_LOST) motion.state = ODO_LOST;  // an unknown state, from a newer ABI (docs/abi.md)
  motion.scale_group = group_of(motion.header, motion.scale_group);
  fusion_->prepare(motion);
  publish_(motion.header);
  odo_vo_motion weighted = motion;
  for (double& c : weighted.covariance) c *= coupling_.odometry_covariance;
  weighted.scale_sigma *= std::sqrt(coupling_.odometry_covariance);
  const odo_scale* scale = scale_for(motion);
  // A front-end may relocalise after a pause with its own metric scale; a scale assumed over a pause is invalid.
  if (watch_.pause().is_within(motion.t_from_ns, motion.header.t_ns)) {
    scale = nullptr;
    if ((motion.header.flags & ODO_VO_METRIC) == 0) {
      weighted.header.flags &= ~ODO_VO_TRANSLATION;
      weighted.state = std::max(weighted.state, ODO_DEGRADED), weighted.reason = ODO_REASON_SENSOR_SILENT;
    }
  }
  fusion_->on_motion(weighted, scale, outputs_);
  const auto reference = outputs_.step_reference;
  publish();
  roster_.forward_event(motion.header, false);  // the scale sources have received it already
  if (reference) roster_.forward_to_kind(ODO_INTERFACE_STEP_ESTIMATOR, reference->header);
}

/// Publishes what the fusion has given since the last call.
void Pipeline::publish() {
  for (const Notice& notice : outputs_.notices) host_.report(0, notice.severity, notice.key, notice.text);
  if (!broken_) broken_ = !publisher_.publish(*fusion_, outputs_);
  outputs_.clear();
}

void Pipeline::on_fix(odo_fix& fix) {
  geodesy_.resolve(fix);  // the published fix has metric coordinates and the verdict
  const UpdateResult result = is_beyond_frame(fix, host_) ? UpdateResult{} : fusion_->on_fix(fix, outputs_);
  const bool used = result.accepted;
  if (!used && result.dof > 0)
    host_.report(fix.header.source, ODO_SEVERITY_INFO, "rejected_fix",
                 "a fix was rejected by the gate: " + std::to_string(std::sqrt(result.nis)) +
                     " sigma from the track in " + std::to_string(result.dof) + " components");
  ++(used ? counters_.fixes_accepted : counters_.fixes_rejected);
  if (used) fix.header.flags |= ODO_FLAG_ACCEPTED;
  if (used) north_.observe(fix);
  publish_(fix.header);
  if (used) roster_.forward_event(fix.header);
}

bool Pipeline::is_of_main_camera(const odo_vo_motion& motion) {
  return !roster_.has_camera() || camera() == motion.camera || report_other_camera(motion, camera(), host_);
}

void Pipeline::reset() {
  events_.begin();
  roster_.reset();
  fusion_ = make_fusion(coupling_, start_, inputs_);
  outputs_.clear();
  anchors_.drop_kept_poses();
  scene_.forget_pending();
  for (const AnyMessage& description : roster_.descriptions()) {
    if (description.header().type == ODO_TYPE_CALIBRATION && roster_.is_main_camera(description.header()))
      fusion_->on_calibration(as<odo_calibration>(description.header()));
  }
  joiner_.reset();
  checks_.reset();
  watch_.reset();
  poses_.clear();
  scale_join_.reset();
  publisher_.reset();
  north_.reset();
  handle_events();
}

Pipeline::Pipeline(const PipelineConfig& config, const Surroundings& surroundings, Publish publish)
    : roster_(surroundings.host, [this](const AnyMessage& event) { enqueue(event); }),
      coupling_(config.coupling),
      start_(config.start),
      inputs_{!config.vo_frontends.empty(), !config.scale_sources.empty()},
      fusion_(make_fusion(coupling_, start_, inputs_)),
      host_(surroundings.host),
      checks_(surroundings.checks),
      geodesy_(surroundings.geodesy),
      poses_(surroundings.poses),
      anchors_(surroundings.anchors),
      scene_(surroundings.scene),
      surfaces_(scene_, anchors_, surroundings.world_mutex),
      events_(kParameters.events_per_sample),
      watch_(config.ordering.max_gap_s),
      publish_(std::move(publish)),
      sources_(roster_, surroundings.host),
      scale_join_(config.scale_sources.size()),
      north_(config.declination_rad, config.start.heading_given),
      publisher_({roster_, watch_, checks_, north_, poses_, anchors_, scene_, surroundings.world_mutex}, publish_,
                 [this](const odo_header& event) {
                   places_moved_ |= event.type == ODO_TYPE_CORRECTION;
                   if (event.type == ODO_TYPE_POSE ? wants_poses_ : wants_corrections_) enqueue(AnyMessage(event));
                 }) {
  if (config.origin) geodesy_.set_origin(*config.origin);
  anchors_.set_ground([this](double north_m, double east_m, double near_down_m) {
    return roster_.ground_at(north_m, east_m, near_down_m);
  });
}

Result<std::unique_ptr<Pipeline>> Pipeline::make(const PipelineConfig& config, const Surroundings& surroundings,
                                                 Publish publish) {
  std::unique_ptr<Pipeline> pipeline(new Pipeline(config, surroundings, std::move(publish)));
  if (const auto started = pipeline->roster_.start(config); !started) return started.failure();
  pipeline->wants_poses_ = pipeline->roster_.wants(ODO_TYPE_POSE);
  pipeline->wants_corrections_ = pipeline->roster_.wants(ODO_TYPE_CORRECTION);
  return pipeline;
}

}  // namespace odograph
