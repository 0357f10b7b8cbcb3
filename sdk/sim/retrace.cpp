// SPDX-License-Identifier: Apache-2.0
#include "sdk/sim/retrace.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/sim/signal.hpp"

namespace odograph {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kRate_hz = 200.0, kGravity = 9.80665, kHold_m = 1.25;
constexpr double kSlow_s = 0.6;  // of the Gaussian that parts steps from the way: 3 % of it are left at 0.7 Hz

Quaterniond attitude_at(const std::vector<StampedPose>& attitudes, int64_t t) {
  const auto after = std::lower_bound(attitudes.begin(), attitudes.end(), t,
                                      [](const StampedPose& x, int64_t time) { return x.t_ns < time; });
  if (after == attitudes.begin()) return attitudes.front().q;
  if (after == attitudes.end()) return attitudes.back().q;
  const StampedPose &a = *(after - 1), &b = *after;
  return a.q.slerp(static_cast<double>(t - a.t_ns) / static_cast<double>(b.t_ns - a.t_ns), b.q);
}

/// The way's place at a time: straight between waypoints.
Vector3d way_at(const std::vector<Waypoint>& marks, int64_t t) {
  size_t i = 1;
  while (i + 1 < marks.size() && marks[i].t_ns < t) ++i;
  const Waypoint &a = marks[i - 1], &b = marks[i];
  const double x = static_cast<double>(t - a.t_ns) / std::max(1.0, static_cast<double>(b.t_ns - a.t_ns));
  return a.p_n + std::clamp(x, 0.0, 1.0) * (b.p_n - a.p_n);
}

/// Where the walker's phone points, level: its top when it lies flat, its back when it stands.
Vector3d ahead(const Quaterniond& q) {
  const Vector3d v = q * Vector3d(0, 1, -1);
  return {v.x(), v.y(), 0};
}

/// Integrates and takes away what is slow.
void integrate_fast_part(Signal& s) {
  double sum = 0;
  for (double& x : s) x = sum += x / kRate_hz;
  Signal slow = s;
  smooth(slow, kSlow_s, kRate_hz);
  for (size_t i = 0; i < s.size(); ++i) s[i] -= slow[i];
}

}  // namespace

Result<Retraced> retrace(const Recording& recording) {
  const std::string name = recording.path.string();
  auto marks = recording.waypoints();
  if (marks.size() < 2) return Failure{ODO_E_DATA, name + ": retracing a walk needs at least two waypoints"};
  if (recording.phone_attitudes.size() < 2)
    return Failure{ODO_E_DATA, name + ": retracing a walk needs the phone's own rotation vector"};
  std::vector<std::pair<int64_t, Vector3d>> forces;
  for (const auto& m : recording.messages)
    if (m.message.header().type == ODO_TYPE_IMU && (m.message.header().flags & ODO_IMU_ACCEL))
      forces.emplace_back(m.message.header().t_ns, Vector3d::Map(as<odo_imu>(m.message.header()).accel_b));
  if (forces.size() < 10) return Failure{ODO_E_DATA, name + ": retracing a walk needs its accelerometer"};
  Retraced out;
  out.start_ns = std::min(forces.front().first, marks.front().t_ns);
  const int64_t end = std::max(forces.back().first, marks.back().t_ns);
  const auto n = static_cast<size_t>(std::ceil(static_cast<double>(end - out.start_ns) * 1e-9 * kRate_hz)) + 1;
  const auto time = [&](size_t i) { return out.start_ns + std::llround(static_cast<double>(i) / kRate_hz * 1e9); };

  // The map's turn: summed over the walk, so that long legs count more.
  double sine = 0, cosine = 0;
  for (size_t k = 1; k < marks.size(); ++k) {
    const Vector3d leg = marks[k].p_n - marks[k - 1].p_n;
    for (int64_t t = marks[k - 1].t_ns; t < marks[k].t_ns; t += 100'000'000) {
      const Vector3d f = ahead(attitude_at(recording.phone_attitudes, t)).normalized();
      cosine += leg.x() * f.x() + leg.y() * f.y(), sine += leg.x() * f.y() - leg.y() * f.x();
    }
  }
  out.turn_rad = std::atan2(sine, cosine);
  const Eigen::AngleAxisd turn(out.turn_rad, Vector3d::UnitZ());
  for (Waypoint& mark : marks) {
    mark.p_n = turn * mark.p_n;
    out.route.emplace_back(mark.p_n.x(), mark.p_n.y(), -mark.p_n.z());
    out.journey.waypoints.push_back({static_cast<double>(mark.t_ns - out.start_ns) * 1e-9, mark.p_n});
  }

  std::vector<Quaterniond> q(n);
  std::vector<Vector3d> p(n);
  Signal fast[3], way[3];
  for (int axis = 0; axis < 3; ++axis) fast[axis] = Signal(n), way[axis] = Signal(n);
  size_t next = 0;
  for (size_t i = 0; i < n; ++i) {
    const int64_t t = time(i);
    q[i] = attitude_at(recording.phone_attitudes, t);
    if (i > 0 && q[i].dot(q[i - 1]) < 0) q[i].coeffs() *= -1;
    while (next + 2 < forces.size() && forces[next + 1].first < t) ++next;
    const auto& [t0, f0] = forces[next];
    const auto& [t1, f1] = forces[next + 1];
    const double x = static_cast<double>(t - t0) / std::max(1.0, static_cast<double>(t1 - t0));
    const Vector3d a = q[i] * (f0 + std::clamp(x, 0.0, 1.0) * (f1 - f0)) + Vector3d(0, 0, kGravity);
    const Vector3d at = way_at(marks, t);
    for (int axis = 0; axis < 3; ++axis) fast[axis][i] = a[axis], way[axis][i] = at[axis];
  }
  for (int axis = 0; axis < 3; ++axis) {
    Signal slow = fast[axis];
    smooth(slow, kSlow_s, kRate_hz);
    for (size_t i = 0; i < n; ++i) fast[axis][i] -= slow[i];
    integrate_fast_part(fast[axis]), integrate_fast_part(fast[axis]);
    smooth(way[axis], 0.5, kRate_hz);
  }
  for (size_t i = 0; i < n; ++i)
    p[i] = Vector3d(way[0][i] + fast[0][i], way[1][i] + fast[1][i], way[2][i] + fast[2][i] - kHold_m);
  out.journey.phone = Motion(kRate_hz, std::move(p), std::move(q));
  out.journey.modes = {{0.0, ODO_MODE_UNKNOWN}};
  return out;
}

}  // namespace odograph
