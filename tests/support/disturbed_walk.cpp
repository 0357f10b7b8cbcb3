// SPDX-License-Identifier: Apache-2.0
#include "tests/support/disturbed_walk.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "sdk/math/rotation.hpp"
#include "sdk/tools/simulation/simulate.hpp"
#include "tests/support/plugin_run.hpp"

using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

struct Span {
  double from_s, to_s;
  bool has(double t) const { return t >= from_s && t < to_s; }
};

Recording walk() {
  Scenario s;
  s.walker.stand_s = 8;
  s.route = {{0, 0, 0}, {45, 0, 0}, {45, 30, 0}, {65, 30, 11}, {90, 30, 11}};
  s.events = {{.at_m = 20, .what = "stand", .for_s = 6}, {.at_m = 108, .what = "speed", .for_s = 10, .speed_mps = 0.5}};
  s.imu.rate_hz = 100;
  auto recording = required(simulated(s, 21));
  return std::move(*recording);
}

template <class M>
M& of(AnyMessage& message) {
  return reinterpret_cast<M&>(message.header());
}

/// Disturbs a gyroscope and an accelerometer sample; false: the sample is lost.
bool disturb(odo_imu& imu, double t, size_t number) {
  for (const Span silent : {Span{30, 30.15}, {33, 33.4}, {62, 65}, {99, 99.3}})
    if (silent.has(t)) return false;
  if (number < 3) std::fill_n(imu.accel_b, 3, 0.1);                            // free fall
  if (Span{36, 38}.has(t) && number % 20 == 0) imu.header.t_ns -= 10'000'000;  // the time of the previous one
  if (Span{40, 40.3}.has(t)) imu.gyro_b[0] += 35, imu.gyro_b[1] -= 3, imu.accel_b[2] += 45;
  if (number == 4200) imu.gyro_b[1] = std::numeric_limits<double>::quiet_NaN();
  if (number == 4250) imu.accel_b[0] = 1e3;
  if (number == 4300) imu.gyro_b[2] = -80;
  return true;
}

bool disturb(odo_magnetometer& sample, double t, size_t number) {
  if (Span{45, 60}.has(t)) sample.field_b[0] = 1.5 * sample.field_b[0] + 2e-5, sample.field_b[2] *= 1.3;
  if (Span{60, 62}.has(t)) std::fill_n(sample.field_b, 3, 0.0);
  if (Span{90, 96}.has(t)) sample.field_b[1] += number % 2 ? 3e-5 : -3e-5;
  if (number == 4000) sample.field_b[1] = 0.02;
  return !Span{62, 80}.has(t) && t > 0.4;
}

bool disturb(odo_barometer& reading, double t, size_t number) {
  if (number % 97 == 96) reading.pressure_pa = number % 2 ? 1000 : 2e5;
  return !Span{12, 44}.has(t) && !Span{50, 53}.has(t) && !Span{84, 95.5}.has(t);
}

bool disturb(odo_gnss& sample, double t, size_t number) {
  if (Span{50, 70}.has(t)) sample.longitude_rad += 40 / 6378137.0 / std::cos(sample.latitude_rad);
  if (Span{88, 95}.has(t)) sample.header.flags &= ~ODO_GNSS_COVARIANCE;
  if (number % 5 == 4) sample.header.flags &= ~ODO_GNSS_HEIGHT;
  if (number == 30) sample.latitude_rad = 3;
  if (number == 31) sample.header.flags &= ~ODO_GNSS_POSITION;
  sample.satellites = static_cast<uint32_t>(number % 7);
  sample.header.flags |= ODO_GNSS_VELOCITY;
  return !Span{75, 87}.has(t);
}

/// Adds the samples that are not lost, as delivered to a pipeline.
void add_samples(const Recording& recording, int64_t start_ns, std::vector<AnyMessage>& out) {
  size_t numbers[16] = {};
  for (const RecordedMessage& recorded : recording.messages) {
    AnyMessage m(recorded.message.header());
    const double t = static_cast<double>(m.header().t_ns - start_ns) * 1e-9;
    bool kept = true;
    const auto with = [&](auto& sample, size_t kind) {
      const size_t number = numbers[kind]++;
      kept = disturb(sample, t, number);
    };
    switch (m.header().type) {
      case ODO_TYPE_IMU: with(of<odo_imu>(m), 0); break;
      case ODO_TYPE_MAGNETOMETER: with(of<odo_magnetometer>(m), 1); break;
      case ODO_TYPE_BAROMETER: with(of<odo_barometer>(m), 2); break;
      case ODO_TYPE_GNSS: with(of<odo_gnss>(m), 3); break;
      default: kept = false;
    }
    if (kept) out.push_back(m);
  }
}

odo_attitude attitude_at(const TrueState& state, double t) {
  auto a = make_message<odo_attitude>(ODO_TYPE_ATTITUDE, state.t_ns);
  const double off = 2.9 + 0.002 * t;
  put_quaternion(Quaterniond(Eigen::AngleAxisd(off, Vector3d::UnitZ())) * state.q, a.q_n_b);
  for (int k = 0; k < 3; ++k) a.covariance_n[4 * k] = 1e-3, a.gyro_bias_b[k] = state.gyro_bias[k];
  return a;
}

odo_pose pose_at(const TrueState& state, double t) {
  auto p = make_message<odo_pose>(ODO_TYPE_POSE, state.t_ns);
  p.header.flags = ODO_POSE_ORIENTATION | ODO_POSE_POSITION | ODO_POSE_METRIC;
  put_quaternion(state.q, p.q_n);
  const Vector3d jump = t > 66 ? Vector3d(8, -6, 0) : Vector3d::Zero();
  Vector3d::Map(p.p_n) = state.p + jump;
  for (int k = 0; k < 6; ++k) p.covariance[7 * k] = k < 3 ? 0.01 : 1;
  if (Span{100, 102}.has(t)) p.covariance[14] = 16;
  if (Span{97, 98}.has(t)) p.header.flags |= ODO_POSE_EXTRAPOLATED;
  if (Span{103, 104}.has(t)) p.header.flags &= ~ODO_POSE_METRIC;
  p.state = ODO_TRACKING;
  return p;
}

odo_vo_motion motion_between(const TrueState& from, const TrueState& to, double t) {
  auto m = make_message<odo_vo_motion>(ODO_TYPE_VO_MOTION, to.t_ns);
  m.header.flags = ODO_VO_ROTATION | ODO_VO_TRANSLATION | ODO_FLAG_NAVIGATION;
  m.t_from_ns = from.t_ns;
  m.scale_group = t < 40 ? 1 : t < 95 ? 2 : 7;
  const double scale = m.scale_group == 1 ? 2.5 : m.scale_group == 2 ? 4 : 1.7;
  put_quaternion(from.q, m.q_n_c0), put_quaternion(from.q.conjugate() * to.q, m.q_c0_c1);
  Vector3d::Map(m.p_c0_c1) = from.q.conjugate() * (to.p - from.p) / scale;
  if (Span{25, 26}.has(t)) m.header.flags &= ~ODO_FLAG_NAVIGATION;
  if (Span{34, 34.5}.has(t)) std::fill_n(m.p_c0_c1, 3, 0.0);
  if (Span{47, 47.1}.has(t)) Vector3d::Map(m.p_c0_c1) *= 50;
  m.state = ODO_TRACKING;
  return m;
}

/// A fix at a known point, for some seconds at a similar, wrong one.
odo_fix fix_at(const TrueState& state, double t) {
  auto f = make_message<odo_fix>(ODO_TYPE_FIX, state.t_ns);
  f.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE | ODO_FIX_SLANT | ODO_FLAG_ACCEPTED;
  if (static_cast<int>(std::lround(t)) % 30 == 5)
    f.header.flags |= ODO_FIX_DOWN | ODO_FIX_COVARIANCE;  // rarely: a barometer uses it
  const Vector3d landmark(100, 60, -25), noise(0.3 * std::sin(3 * t), 0.3 * std::cos(5 * t), 0.1 * std::sin(7 * t));
  const bool wrong = Span{55, 56.5}.has(t), alike = t > 104;
  const Vector3d place =
      (alike ? Vector3d(2.4 * state.p) : Vector3d(state.p)) + noise + (wrong ? Vector3d(15, 5, 0) : Vector3d::Zero());
  Vector3d::Map(f.p_n) = place;
  Vector3d::Map(f.landmark_n) = landmark;
  f.slant_distance_m = (landmark - place).norm();
  for (int k = 0; k < 3; ++k) f.covariance_n[4 * k] = static_cast<int>(t) % 4 == 0 ? 1 : 0.25;
  if (Span{70, 72}.has(t)) f.header.flags &= ~(ODO_FLAG_ACCEPTED | ODO_FIX_EAST);
  return f;
}

}  // namespace

DisturbedWalk::DisturbedWalk() {
  const Recording recording = walk();
  const auto& states = recording.true_states;
  const int64_t start_ns = states.front().t_ns;
  const TrueState* frame = nullptr;
  add_samples(recording, start_ns, messages);
  auto camera = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, messages.front().header().t_ns);
  camera.header.flags = ODO_CALIBRATION_EXTRINSICS;  // the motions are in the body frame
  camera.q_b_c[0] = 1;
  messages.emplace_back(camera.header);
  for (size_t i = 0; i < states.size(); ++i) {
    const double t = static_cast<double>(states[i].t_ns - start_ns) * 1e-9;
    messages.emplace_back(attitude_at(states[i], t).header);
    if (i % 10 != 0) continue;
    if (frame) messages.emplace_back(motion_between(*frame, states[i], t).header);
    frame = &states[i];
    messages.emplace_back(pose_at(states[i], t).header);
    if (i % 100 == 0) messages.emplace_back(fix_at(states[i], t).header);
    if (i % 2000 != 0) continue;
    auto waypoint = make_message<odo_waypoint>(ODO_TYPE_WAYPOINT, states[i].t_ns);
    Vector3d::Map(waypoint.p_n) = states[i].p;
    waypoint.sigma_m = i % 4000 ? 0.05 : 0.6;
    if (i % 4000) waypoint.header.flags |= ODO_WAYPOINT_VERTICAL;
    messages.emplace_back(waypoint.header);
  }
  const auto in_order = [](const AnyMessage& a, const AnyMessage& b) { return a.header().t_ns < b.header().t_ns; };
  std::stable_sort(messages.begin(), messages.end(), in_order);
  auto steps = PluginRun("step_odograph")(messages);
  messages.insert(messages.end(), steps.begin(), steps.end());
  std::stable_sort(messages.begin(), messages.end(), in_order);
}
