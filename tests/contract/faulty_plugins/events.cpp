// SPDX-License-Identifier: Apache-2.0
//
// Faulty plugins: the events and their meaning.
#include <chrono>

#include "tests/contract/faulty_plugins/reference_plugin.hpp"

using namespace faulty;

// ---- events --------------------------------------------------------------------------------------------------------
#if defined(FAULTY_events_some__none)
INPUT(attitude) { return ODO_E_DISCARD; }
#elif defined(FAULTY_events_type__pose)
EVENT(scale) { e.header.type = ODO_TYPE_POSE; }
#elif defined(FAULTY_events_size__zero)
EVENT(scale) { e.header.struct_size = 0; }
#elif defined(FAULTY_events_size__header_only)
EVENT(scale) { e.header.struct_size = 32; }
#elif defined(FAULTY_events_numbers__nan)
EVENT(scale) { e.scale.scale = std::nan(""); }
#elif defined(FAULTY_events_numbers__no_quaternion)
EVENT(attitude) { e.attitude.q_n_b[1] = 0; }
#elif defined(FAULTY_events_count__400)
INPUT(attitude) {
  if (m.type == ODO_TYPE_IMU)
    for (int i = 0; i < 400; ++i) answer_imu(s, m);
  return ODO_OK;
}
#elif defined(FAULTY_events_numbers__percent)
EVENT(scale) { e.header.flags |= ODO_FLAG_QUALITY, e.header.quality = 80; }
#elif defined(FAULTY_events_reserved__used)
EVENT(scale) { e.header.reserved = 7; }
#elif defined(FAULTY_events_flags__host_s_own)
EVENT(fixer) { e.header.flags |= ODO_FLAG_ACCEPTED; }
#elif defined(FAULTY_events_flags__unknown)
EVENT(scale) { e.header.flags = 1u << 20; }
#elif defined(FAULTY_events_time_order__back_and_forth)
EVENT(attitude) { e.header.t_ns -= s.inputs % 2 ? 30'000'000 : 0; }
#elif defined(FAULTY_events_time_known__wall_clock)
EVENT(scale) { e.header.t_ns = std::chrono::system_clock::now().time_since_epoch().count(); }
#elif defined(FAULTY_events_time_known__seconds)
EVENT(scale) { e.header.t_ns = -5'000'000'000 + e.header.t_ns / 1'000'000'000; }
#elif defined(FAULTY_events_numbers__not_symmetric)
EVENT(odometry) { e.motion.covariance[1] = 1e-5; }
#elif defined(FAULTY_events_uncertainty__sure)
EVENT(odometry) {
  for (int i = 0; i < 18; ++i) e.motion.covariance[i] = e.motion.covariance[6 * (i % 6) + i / 6] = 0;
}
#elif defined(FAULTY_events_lists__mode_42)
EVENT(steps) {
  if (e.header.type == ODO_TYPE_STEP) e.step.mode = 42;
}

// ---- what they mean ------------------------------------------------------------------------------------------------
#elif defined(FAULTY_attitude_each_sample__every_second)
INPUT(attitude) { return s.inputs % 2 ? ODO_OK : ODO_E_DISCARD; }
#elif defined(FAULTY_attitude_up__down)
EVENT(attitude) { e.attitude.q_n_b[1] = 0, e.attitude.q_n_b[0] = 1; }
#elif defined(FAULTY_step_length__millimetres)
EVENT(steps) {
  if (e.header.type == ODO_TYPE_STEP) e.step.length_m *= 1000;
}
#elif defined(FAULTY_step_frequency__a_minute)
EVENT(steps) {
  if (e.header.type == ODO_TYPE_STEP) e.step.frequency_hz *= 60;
}
#elif defined(FAULTY_step_order__overlap)
EVENT(steps) {
  if (e.header.type == ODO_TYPE_STEP) e.step.t_start_ns -= 100'000'000;
}
#elif defined(FAULTY_step_times__to_come)
EVENT(steps) {
  if (e.header.type == ODO_TYPE_STEP) e.step.t_end_ns += 100'000'000;
}
#elif defined(FAULTY_step_late__two_seconds)
EVENT(steps) {
  if (e.header.type == ODO_TYPE_STEP) e.step.t_start_ns -= 2'000'000'000, e.step.t_end_ns -= 2'000'000'000;
}
#elif defined(FAULTY_step_late__three_at_once)
INPUT(steps) {  // delays two steps of a walk until the third
  static int64_t held_ns[2];
  static int held = 0;
  if (m.type != ODO_TYPE_IMU || s.last_step_ns == 0 || m.t_ns - s.last_step_ns < 500'000'000) return ODO_OK;
  if (held < 2) {
    held_ns[held++] = s.last_step_ns = m.t_ns;
    return ODO_OK;
  }
  s.last_step_ns = held_ns[0] - 500'000'000;
  for (held = 0; held < 2; ++held) {
    odo_header then = m;
    then.t_ns = held_ns[held];
    answer_walk(s, then);
  }
  held = 0;
  return ODO_OK;
}
#elif defined(FAULTY_step_index__from_1)
EVENT(steps) {
  if (e.header.type == ODO_TYPE_STEP) ++e.step.index;
}
#elif defined(FAULTY_mode_changes__always)
INPUT(steps) {
  s.mode_said = false;
  return ODO_OK;
}
#elif defined(FAULTY_motion_each_frame__every_second)
INPUT(odometry) { return m.type == ODO_TYPE_FRAME && m.t_ns / 100'000'000 % 2 ? ODO_E_DISCARD : ODO_OK; }
#elif defined(FAULTY_motion_reason__none)
EVENT(odometry) { e.motion.state = ODO_LOST; }
#elif defined(FAULTY_motion_speed__millimetres)
EVENT(odometry) { e.motion.header.flags |= ODO_VO_METRIC, e.motion.p_c0_c1[0] = 140; }
#elif defined(FAULTY_motion_camera__other)
EVENT(odometry) { e.motion.camera = 5; }
#elif defined(FAULTY_scale_unit__millimetres)
EVENT(scale) { e.scale.scale *= 1000; }
#elif defined(FAULTY_scale_group__foreign)
EVENT(scale) { e.scale.scale_group = 77; }
#elif defined(FAULTY_scale_interval__turned)
EVENT(scale) { std::swap(e.scale.valid_from_ns, e.scale.valid_to_ns); }
#elif defined(FAULTY_scale_interval__past)
EVENT(scale) { e.scale.valid_from_ns -= 2'000'000'000, e.scale.valid_to_ns -= 1'000'000'000; }
#elif defined(FAULTY_scale_sigma__huge)
EVENT(scale) { e.scale.sigma = 1e6; }
#elif defined(FAULTY_fix_says_something__nothing)
EVENT(fixer) { e.header.flags = 0; }
#elif defined(FAULTY_fix_place__abroad)
EVENT(fixer) { e.fix.p_n[0] = 4e6; }
#elif defined(FAULTY_fix_no_echo__poses)
INPUT(fixer) {
  if (m.type == ODO_TYPE_POSE) answer_waypoint(s, m);
  return ODO_OK;
}
#else
#error "no plugin of this name"
#endif
