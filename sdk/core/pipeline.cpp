// SPDX-License-Identifier: Apache-2.0
#include "sdk/core/pipeline.hpp"

namespace odograph {

void Pipeline::process(const odo_header& message) {
  watch_.see(message);
  switch (message.type) {
    case ODO_TYPE_IMU: joiner_.push(as<odo_imu>(message), [this](const odo_imu& whole) { on_imu(whole); }); break;
    case ODO_TYPE_MAGNETOMETER:
    case ODO_TYPE_IMU_NOISE:
      if (message.type == ODO_TYPE_IMU_NOISE) estimator_->on_imu_noise(as<odo_imu_noise>(message));
      if (attitude_) attitude_->process(message);
      if (vo_) on_vo_events(vo_->process(message));
      break;
    case ODO_TYPE_FRAME: on_frame(as<odo_frame>(message)); break;
    case ODO_TYPE_CALIBRATION:
      estimator_->on_calibration(as<odo_calibration>(message));
      if (vo_) on_vo_events(vo_->process(message));
      offer_to_fixers(message);
      break;
    case ODO_TYPE_BAROMETER:
      estimator_->update(&as<odo_barometer>(message));
      if (step_) on_steps(step_->process(message));
      offer_to_fixers(message);
      break;
    default: offer_to_fixers(message);  // GNSS, waypoints
  }
  if (watch_.imu_silent() && attitude_) set_state(watch_.now_ns(), ODO_LOST, ODO_REASON_SENSOR_SILENT);
  if (watch_.camera_silent() && vo_) set_state(watch_.now_ns(), ODO_LOST, ODO_REASON_SENSOR_SILENT);
}

void Pipeline::on_imu(const odo_imu& imu) {
  estimator_->propagate(imu);
  if (attitude_) {
    for (AnyMessage& event : attitude_->process(imu.header)) {
      estimator_->update(&as<odo_attitude>(event.header()));
      publish_(event.header());
      publish_pose();
      if (vo_) on_vo_events(vo_->process(event.header()));
      if (step_) on_steps(step_->process(event.header()));
    }
  }
  if (vo_) on_vo_events(vo_->process(imu.header));
  if (step_) on_steps(step_->process(imu.header));
}

void Pipeline::on_steps(std::span<AnyMessage> events) {
  for (AnyMessage& event : events) {
    publish_(event.header());
    if (scale_) scale_->process(event.header());
    if (event.header().type == ODO_TYPE_MOTION_MODE) estimator_->update(&as<odo_motion_mode>(event.header()));
    if (event.header().type != ODO_TYPE_STEP) continue;
    ++counters_.steps;
    estimator_->update(&as<odo_step>(event.header()));
    publish_pose();
  }
}

void Pipeline::on_frame(const odo_frame& frame) {
  ++counters_.frames;
  if (!vo_) return offer_to_fixers(frame.header);
  estimator_->update(FrameTime{frame.header.t_ns});
  publish_pose();
  on_vo_events(vo_->process(frame.header));
  offer_to_fixers(frame.header);
}

void Pipeline::on_vo_events(std::span<AnyMessage> events) {
  for (AnyMessage& event : events) {
    if (event.header().type == ODO_TYPE_VO_MOTION)
      on_vo_motion(reinterpret_cast<odo_vo_motion&>(event.header()));
    else
      publish_(event.header());
  }
}

void Pipeline::on_vo_motion(odo_vo_motion& motion) {
  estimator_->prepare(motion);
  publish_(motion.header);
  const odo_scale* scale = nullptr;
  if (scale_) {
    for (AnyMessage& event : scale_->process(motion.header)) {
      publish_(event.header());
      const auto& candidate = as<odo_scale>(event.header());
      const bool in_time = candidate.valid_from_ns < motion.header.t_ns && motion.header.t_ns <= candidate.valid_to_ns;
      if (in_time && candidate.scale_group == motion.scale_group) scale = &candidate;
    }
  }
  estimator_->update(RelativeMotion{&motion, scale});
  publish_pose();
  publish_correction();
  teach_steps();
}

void Pipeline::offer_to_fixers(const odo_header& message) {
  for (auto& fixer : fixers_) on_fixes(fixer->process(message));
}

void Pipeline::on_fixes(std::span<AnyMessage> events) {
  for (AnyMessage& event : events) {
    auto& fix = reinterpret_cast<odo_fix&>(event.header());
    resolve_geodetic(fix, geodesy_);  // what is published is metric, and says what became of it
    const bool used = estimator_->update(&fix).accepted;
    ++(used ? counters_.fixes_accepted : counters_.fixes_rejected);
    fix.header.quality = used ? 1.0f : 0.0f;
    publish_(fix.header);
    if (used && scale_) scale_->process(fix.header);
    if (used && step_) on_steps(step_->process(fix.header));
  }
  publish_correction();
}

void Pipeline::publish_pose() {
  odo_pose pose;
  if (!estimator_->take_pose(pose)) return;
  if (any_dead() && pose.state == ODO_TRACKING) pose.state = ODO_DEGRADED, pose.reason = ODO_REASON_PLUGIN_FAILED;
  set_state(pose.header.t_ns, pose.state, pose.reason);
  publish_(pose.header);
  for (auto& fixer : fixers_) on_fixes(fixer->process(pose.header));
}

void Pipeline::publish_correction() {
  Correction correction;
  odo_pose pose;
  if (estimator_->take_correction(correction, pose)) publish_(pose.header);
}

void Pipeline::teach_steps() {
  odo_fix reference;
  if (estimator_->take_step_reference(reference) && step_) on_steps(step_->process(reference.header));
}

int32_t Pipeline::pose_at(int64_t t_ns, odo_pose& out) const {
  Estimate estimate;
  const int32_t status = estimator_->at(t_ns, estimate);
  if (status == ODO_OK) out = estimate.pose;
  return status;
}

void Pipeline::set_state(int64_t t_ns, uint32_t state, uint32_t reason) {
  if (state_ != 0 && t_ns > state_since_ns_) {
    counters_.state_s[state_] += static_cast<double>(t_ns - state_since_ns_) * kNanoseconds;
    state_since_ns_ = t_ns;
  }
  if (state == state_ && reason == reason_) return;
  if (state_ == 0) state_since_ns_ = t_ns;
  state_ = state;
  reason_ = reason;
  auto event = make_message<odo_state>(ODO_TYPE_STATE, t_ns);
  event.state = state;
  event.reason = reason;
  publish_(event.header);
}

bool Pipeline::any_dead() const {
  const auto dead = [](const auto& instance) { return instance && !instance->alive(); };
  return dead(attitude_) || dead(step_) || dead(vo_) || dead(scale_);
}

uint64_t Pipeline::plugin_faults() const {
  uint64_t faults = 0;
  for (const PluginInstance* instance : instances()) faults += instance->faults();
  return faults;
}

void Pipeline::reset() {
  for (PluginInstance* instance : instances()) {
    const auto learnt = instance->save();  // the clock was set back, the walker is the same
    instance->reset();
    if (!learnt.empty()) instance->load(learnt);
  }
  estimator_->reset();
  joiner_.reset();
  watch_.reset();
  state_ = 0;
}

Pipeline::Pipeline(const PipelineConfig& config, Geodesy& geodesy, Publish publish)
    : estimator_(make_estimator(config.coupling, config.start,
                                {config.vo_frontend.has_value(), config.scale_source.has_value()})),
      geodesy_(geodesy),
      watch_(config.ordering.max_gap_s),
      publish_(std::move(publish)) {
  if (config.origin) geodesy.set_origin(*config.origin);
}

Result<std::unique_ptr<Pipeline>> Pipeline::make(const PipelineConfig& config, HostServices& host, Geodesy& geodesy,
                                                 Publish publish) {
  std::unique_ptr<Pipeline> pipeline(new Pipeline(config, geodesy, std::move(publish)));
  uint32_t number = 0;
  const auto start = [&](const PluginChoice& choice, std::unique_ptr<PluginInstance>& slot) -> Result<bool> {
    auto made = PluginInstance::make(choice, config.verify_hash, ++number, host);
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
