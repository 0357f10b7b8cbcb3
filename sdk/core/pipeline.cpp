// SPDX-License-Identifier: Apache-2.0
#include "sdk/core/pipeline.hpp"

namespace odograph {

void Pipeline::process(const odo_header& message) {
  watch_.see(message);
  switch (message.type) {
    case ODO_TYPE_IMU: joiner_.push(as<odo_imu>(message), [this](const odo_imu& whole) { on_imu(whole); }); break;
    case ODO_TYPE_MAGNETOMETER:
    case ODO_TYPE_IMU_NOISE:
      if (attitude_) attitude_->process(message);
      if (vo_) on_vo_events(vo_->process(message));
      break;
    case ODO_TYPE_FRAME: on_frame(as<odo_frame>(message)); break;
    case ODO_TYPE_CALIBRATION:
      coupling_.on_calibration(as<odo_calibration>(message));
      if (vo_) on_vo_events(vo_->process(message));
      offer_to_fixers(message);
      break;
    case ODO_TYPE_BAROMETER:
      if (step_) on_steps(step_->process(message));
      offer_to_fixers(message);
      break;
    default: offer_to_fixers(message);  // GNSS, waypoints
  }
  if (watch_.imu_silent() && attitude_) set_state(watch_.now_ns(), ODO_LOST, ODO_REASON_SENSOR_SILENT);
  if (watch_.camera_silent() && vo_) set_state(watch_.now_ns(), ODO_LOST, ODO_REASON_SENSOR_SILENT);
}

void Pipeline::on_imu(const odo_imu& imu) {
  coupling_.on_imu(imu);
  if (attitude_) {
    for (AnyMessage& event : attitude_->process(imu.header)) {
      coupling_.on_attitude(as<odo_attitude>(event.header()));
      publish_(event.header());
      if (const auto first = coupling_.start_without_camera()) publish_pose(*first);
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
    if (event.header().type != ODO_TYPE_STEP) continue;
    ++counters_.steps;
    if (const auto pose = coupling_.on_step(as<odo_step>(event.header()))) publish_pose(*pose);
  }
}

void Pipeline::on_frame(const odo_frame& frame) {
  ++counters_.frames;
  if (!vo_) return offer_to_fixers(frame.header);
  if (!camera_started_) {
    camera_started_ = true;
    publish_pose(coupling_.on_first_frame(frame.header.t_ns));
  }
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
  coupling_.prepare(motion);
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
  const odo_pose pose = coupling_.on_vo_motion(motion, scale);
  publish_pose(pose);
  if (!step_) return;
  const bool own = scale_ ? scale && (scale->header.flags & ODO_SCALE_NOT_BY_STEPS) != 0
                          : (motion.header.flags & ODO_VO_METRIC) != 0;
  if (const auto fix = teacher_.see(pose, own)) on_steps(step_->process(fix->header));
}

void Pipeline::offer_to_fixers(const odo_header& message) {
  for (auto& fixer : fixers_) on_fixes(fixer->process(message));
}

void Pipeline::on_fixes(std::span<AnyMessage> events) {
  for (AnyMessage& event : events) {
    auto& fix = reinterpret_cast<odo_fix&>(event.header());
    std::array<double, 3> p_n;
    const bool used = coupling_.on_fix(fix, p_n);
    ++(used ? counters_.fixes_accepted : counters_.fixes_rejected);
    for (int i = 0; i < 3; ++i)
      fix.p_n[i] = p_n[static_cast<size_t>(i)];  // what is published is metric, and says what became of it
    fix.header.quality = used ? 1.0f : 0.0f;
    publish_(fix.header);
    if (used && scale_) scale_->process(fix.header);
    if (used && step_) on_steps(step_->process(fix.header));
    if (used) teacher_.fixed(fix.header.t_ns);
  }
  if (const auto corrected = coupling_.take_correction()) publish_(corrected->header);
}

void Pipeline::publish_pose(odo_pose pose) {
  if (any_dead() && pose.state == ODO_TRACKING) pose.state = ODO_DEGRADED, pose.reason = ODO_REASON_PLUGIN_FAILED;
  set_state(pose.header.t_ns, pose.state, pose.reason);
  publish_(pose.header);
  for (auto& fixer : fixers_) on_fixes(fixer->process(pose.header));
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
  coupling_.reset();
  joiner_.reset();
  watch_.reset();
  teacher_.reset();
  camera_started_ = false;
  state_ = 0;
}

Pipeline::Pipeline(const PipelineConfig& config, Geodesy& geodesy, Publish publish)
    : coupling_(config.coupling, config.start, {config.vo_frontend.has_value(), config.scale_source.has_value()},
                geodesy),
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
