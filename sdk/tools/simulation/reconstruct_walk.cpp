// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/reconstruct_walk.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/time.hpp"
#include "sdk/tools/simulation/signal.hpp"
#include "sdk/tools/simulation/walk_smoother.hpp"

namespace odograph {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kReconstructed_hz = 200.0, kHold_m = 1.25;
constexpr double kMark_m = 0.7;         // of a waypoint: position and time of the walker's tap; 0.8 rms on the 80 walks
constexpr double kHeight_m = 0.1;       // of the hand above the floor
constexpr double kAnywhere_m = 5.0;     // between waypoints
constexpr double kUsual_mps = 0.7;      // deviation of the walker's speed from the mean between waypoints
constexpr double kStanding_mps = 0.03;  // speed of the hands at standstill
constexpr double kQuiet_mps2 = 0.25, kQuiet_radps = 0.35;  // rms over a second at standstill (a step: above 1)

Quaterniond attitude_at(const std::vector<StampedPose>& attitudes, int64_t t) {
  const auto after = std::lower_bound(attitudes.begin(), attitudes.end(), t,
                                      [](const StampedPose& x, int64_t time) { return x.t_ns < time; });
  if (after == attitudes.begin()) return attitudes.front().q;
  if (after == attitudes.end()) return attitudes.back().q;
  const StampedPose &a = *(after - 1), &b = *after;
  return a.q.slerp(static_cast<double>(t - a.t_ns) / static_cast<double>(b.t_ns - a.t_ns), b.q);
}

/// Position on the path, linear between waypoints.
Vector3d path_at(const std::vector<Waypoint>& marks, int64_t t) {
  size_t i = 1;
  while (i + 1 < marks.size() && marks[i].t_ns < t) ++i;
  const Waypoint &a = marks[i - 1], &b = marks[i];
  const double x = static_cast<double>(t - a.t_ns) / std::max(1.0, static_cast<double>(b.t_ns - a.t_ns));
  return a.p_n + std::clamp(x, 0.0, 1.0) * (b.p_n - a.p_n);
}

/// Horizontal pointing direction of the phone: its top when it lies flat, its back when it is upright.
Vector3d ahead(const Quaterniond& q) {
  const Vector3d v = q * Vector3d(0, 1, -1);
  return {v.x(), v.y(), 0};
}

using Samples = std::vector<std::pair<int64_t, Vector3d>>;

/// Linear interpolation between samples; `next` advances.
Vector3d value_at(const Samples& samples, int64_t t, size_t& next) {
  while (next + 2 < samples.size() && samples[next + 1].first < t) ++next;
  const auto& [t0, v0] = samples[next];
  const auto& [t1, v1] = samples[next + 1];
  const double x = static_cast<double>(t - t0) / std::max(1.0, static_cast<double>(t1 - t0));
  return v0 + std::clamp(x, 0.0, 1.0) * (v1 - v0);
}

/// Accelerometer and gyroscope at the accelerometer's times, s from `start_ns`; empty if one is missing.
std::vector<InertialSample> inertial_samples(const Recording& recording, int64_t start_ns) {
  Samples forces, rates;
  for (const auto& m : recording.messages) {
    if (m.message.header().type != ODO_TYPE_IMU) continue;
    const auto& imu = as<odo_imu>(m.message.header());
    const auto add = [&](Samples& to, uint32_t flag, const double* v) {
      if ((imu.header.flags & flag) && (to.empty() || imu.header.t_ns > to.back().first))
        to.emplace_back(imu.header.t_ns, Vector3d::Map(v));
    };
    add(forces, ODO_IMU_ACCEL, imu.accel_b);
    add(rates, ODO_IMU_GYRO, imu.gyro_b);
  }
  std::vector<InertialSample> out;
  if (forces.size() < 10 || rates.size() < 10) return out;
  size_t next = 0;
  for (const auto& [t, force] : forces) out.push_back({seconds(t - start_ns), value_at(rates, t, next), force});
  return out;
}

/// Quiet for half a second before and after.
bool is_at_rest(const std::vector<InertialSample>& samples, size_t i) {
  double sum = 0, squares = 0, turning = 0;
  int n = 0;
  for (const int direction : {-1, 1})
    for (auto k = static_cast<long>(i) + std::max(direction, 0);; k += direction, ++n) {
      if (k < 0 || k >= static_cast<long>(samples.size())) break;
      const InertialSample& s = samples[static_cast<size_t>(k)];
      if (std::abs(s.t_s - samples[i].t_s) > 0.5) break;
      const double force = s.accel_b.norm();
      sum += force, squares += force * force, turning += s.gyro_b.squaredNorm();
    }
  const double mean = sum / n;
  return squares / n - mean * mean < kQuiet_mps2 * kQuiet_mps2 && turning / n < kQuiet_radps * kQuiet_radps;
}

PseudoMeasurement::Vector known(const Vector3d& value_n, double horizontal_sigma, double vertical_sigma) {
  return {value_n, {horizontal_sigma, horizontal_sigma, vertical_sigma}};
}

/// Pseudo-measurements from waypoints, floor and standstill, once a second and at each waypoint.
std::vector<PseudoMeasurement> pseudo_measurements(const std::vector<InertialSample>& samples,
                                                   const std::vector<WalkState>& guess,
                                                   const std::vector<Journey::Mark>& marks) {
  std::vector<PseudoMeasurement> out;
  size_t next_mark = 0;
  double next_s = 0;
  for (size_t i = 0; i < samples.size(); ++i) {
    for (; next_mark < marks.size() && marks[next_mark].t_s <= samples[i].t_s; ++next_mark)
      out.push_back({i, known(marks[next_mark].p_n - Vector3d(0, 0, kHold_m), kMark_m, kHeight_m), {}});
    if (samples[i].t_s < next_s) continue;
    next_s = samples[i].t_s + 1;
    out.push_back({i, known(guess[i].p_n, kAnywhere_m, kHeight_m),
                   is_at_rest(samples, i) ? known(Vector3d::Zero(), kStanding_mps, kStanding_mps)
                                          : known(guess[i].v_n, kUsual_mps, kUsual_mps)});
  }
  return out;
}

/// Cubic Hermite interpolation of position and velocity between samples.
Eigen::Isometry3d pose_between(const InertialSample& sa, const WalkState& a, const InertialSample& sb,
                               const WalkState& b, double t_s) {
  const double h = sb.t_s - sa.t_s, u = std::clamp((t_s - sa.t_s) / h, 0.0, 1.0);
  const Vector3d chord = b.p_n - a.p_n;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = a.p_n + u * chord + u * (1 - u) * ((1 - u) * (h * a.v_n - chord) - u * (h * b.v_n - chord));
  T.linear() = a.q_n_b.slerp(u, b.q_n_b).toRotationMatrix();
  return T;
}

/// From the waypoints' map to the phone's north, summed over the walk, so that long legs have more weight.
double yaw_of_map(const Recording& recording, const std::vector<Waypoint>& marks) {
  double sine = 0, cosine = 0;
  for (size_t k = 1; k < marks.size(); ++k) {
    const Vector3d leg = marks[k].p_n - marks[k - 1].p_n;
    for (int64_t t = marks[k - 1].t_ns; t < marks[k].t_ns; t += 100'000'000) {
      const Vector3d f = ahead(attitude_at(recording.phone_attitudes, t)).normalized();
      cosine += leg.x() * f.x() + leg.y() * f.y(), sine += leg.x() * f.y() - leg.y() * f.x();
    }
  }
  return std::atan2(sine, cosine);
}

/// Initial guess: the path between waypoints, smooth in time, and the phone's own orientation.
std::vector<WalkState> first_guess(const Recording& recording, const std::vector<InertialSample>& samples,
                                   const std::vector<Waypoint>& marks, int64_t start_ns) {
  Signal path[3];
  for (const InertialSample& s : samples) {
    const Vector3d at = path_at(marks, start_ns + nanoseconds(s.t_s));
    for (int axis = 0; axis < 3; ++axis) path[axis].push_back(at[axis]);
  }
  const double rate_hz = static_cast<double>(samples.size() - 1) / (samples.back().t_s - samples.front().t_s);
  for (Signal& axis : path) smooth(axis, 0.5, rate_hz);
  std::vector<WalkState> walk;
  for (size_t i = 0; i < samples.size(); ++i) {
    const int64_t t = start_ns + nanoseconds(samples[i].t_s);
    const Vector3d p_n(path[0][i], path[1][i], path[2][i] - kHold_m);
    const Vector3d v_n =
        i > 0 ? Vector3d((p_n - walk[i - 1].p_n) / (samples[i].t_s - samples[i - 1].t_s)) : Vector3d(Vector3d::Zero());
    walk.push_back({attitude_at(recording.phone_attitudes, t), p_n, v_n, Vector3d::Zero(), Vector3d::Zero()});
  }
  return walk;
}

Motion motion(const std::vector<InertialSample>& samples, const std::vector<WalkState>& walk, double end_s) {
  std::vector<Quaterniond> q;
  std::vector<Vector3d> p;
  size_t next = 0;
  for (size_t i = 0; i <= static_cast<size_t>(std::ceil(end_s * kReconstructed_hz)); ++i) {
    const double t_s = static_cast<double>(i) / kReconstructed_hz;
    while (next + 2 < samples.size() && samples[next + 1].t_s < t_s) ++next;
    const auto T = pose_between(samples[next], walk[next], samples[next + 1], walk[next + 1], t_s);
    p.push_back(T.translation());
    q.emplace_back(T.linear());
    if (i > 0 && q[i].dot(q[i - 1]) < 0) q[i].coeffs() *= -1;
  }
  return Motion(kReconstructed_hz, std::move(p), std::move(q));
}

}  // namespace

Result<ReconstructedWalk> reconstruct_walk(const Recording& recording) {
  const std::string name = recording.path.string();
  auto marks = recording.waypoints();
  if (marks.size() < 2) return Failure{ODO_E_DATA, name + ": retracing a walk needs at least two waypoints"};
  if (recording.phone_attitudes.size() < 2)
    return Failure{ODO_E_DATA, name + ": retracing a walk needs the phone's own rotation vector"};
  const auto imu_at = [](const auto& m) { return m.message.header().type == ODO_TYPE_IMU; };
  const auto first = std::find_if(recording.messages.begin(), recording.messages.end(), imu_at);
  ReconstructedWalk out;
  out.start_ns = marks.front().t_ns;
  if (first != recording.messages.end()) out.start_ns = std::min(out.start_ns, first->message.header().t_ns);
  const auto samples = inertial_samples(recording, out.start_ns);
  if (samples.empty()) return Failure{ODO_E_DATA, name + ": retracing a walk needs its accelerometer and gyroscope"};

  out.yaw_rad = yaw_of_map(recording, marks);
  const Eigen::AngleAxisd rotation(out.yaw_rad, Vector3d::UnitZ());
  for (Waypoint& mark : marks) {
    mark.p_n = rotation * mark.p_n;
    out.journey.waypoints.push_back({seconds(mark.t_ns - out.start_ns), mark.p_n});
  }

  auto walk = first_guess(recording, samples, marks, out.start_ns);
  const auto known = pseudo_measurements(samples, walk, out.journey.waypoints);
  walk = smooth_walk(samples, known, std::move(walk));

  const double end_s = std::max(samples.back().t_s, out.journey.waypoints.back().t_s);
  out.journey.phone = motion(samples, walk, end_s);
  for (Journey::Mark& mark : out.journey.waypoints) {  // true positions on the rendered walk
    mark.p_n.head<2>() = out.journey.phone.pose(mark.t_s).translation().head<2>();
    out.route.emplace_back(mark.p_n.x(), mark.p_n.y(), -mark.p_n.z());
  }
  out.journey.modes = {{0.0, ODO_MODE_UNKNOWN}};
  return out;
}

}  // namespace odograph
