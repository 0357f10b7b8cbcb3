// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/fusion/inertial_track.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/rotation.hpp"
#include "sdk/host/base/saturating.hpp"

namespace odograph {
namespace {

using Eigen::Vector3d;

constexpr size_t kMaxReintegrated = 64;  // points between two accelerometer samples

}  // namespace

/// Rotation rate and force are linear between two points.
void InertialTrack::integrate(const Point& from, Point& to) {
  const double dt = seconds(to.t_ns, from.t_ns);
  to.q_e_b = (from.q_e_b * exp_rotation(0.5 * dt * (from.rate_b + to.rate_b))).normalized();
  const Vector3d a0 = from.q_e_b * from.force_b, a1 = to.q_e_b * to.force_b;
  to.v_e = from.v_e + 0.5 * dt * (a0 + a1);
  to.p_e = from.p_e + dt * from.v_e + dt * dt / 6 * (2 * a0 + a1);
}

Vector3d InertialTrack::force_at(int64_t t_ns) const {
  if (before_.t_ns == INT64_MIN || t_ns >= newest_force_.t_ns) return newest_force_.force_b;
  const double span = seconds(newest_force_.t_ns, before_.t_ns);
  const double w = span > 0 ? std::clamp(seconds(t_ns, before_.t_ns) / span, 0.0, 1.0) : 1.0;
  return before_.force_b + w * (newest_force_.force_b - before_.force_b);
}

void InertialTrack::add(const odo_imu& imu) {
  const int64_t t_ns = imu.header.t_ns;
  if (imu.header.flags & ODO_IMU_ACCEL) add_force(t_ns, Vector3d(imu.accel_b) - accel_bias_b_);
  if ((imu.header.flags & ODO_IMU_GYRO) == 0 || (!points_.empty() && t_ns <= newest_ns())) return;
  Point point;
  point.t_ns = t_ns;
  point.rate_b = Vector3d(imu.gyro_b) - gyro_bias_b_;
  point.force_b = force_at(t_ns);
  const bool goes_on = !points_.empty() && seconds(t_ns, newest_ns()) <= kLongestGap_s;
  if (goes_on) integrate(points_.back(0), point);
  since_gap_ = goes_on ? since_gap_ + 1 : 1;
  points_.push(point);
}

/// Re-integrates the points since the previous accelerometer sample, for which its force was held constant.
void InertialTrack::add_force(int64_t t_ns, const Vector3d& force_b) {
  if (t_ns <= newest_force_.t_ns) return;
  const bool goes_on = newest_force_.t_ns != INT64_MIN && seconds(t_ns, newest_force_.t_ns) <= kLongestGap_s;
  before_ = goes_on ? newest_force_ : Force{};
  newest_force_ = {t_ns, force_b};
  size_t back = 0;
  const size_t most = std::min({since_gap_, points_.size(), kMaxReintegrated});
  while (back < most && points_.back(back).t_ns > before_.t_ns) ++back;
  if (!goes_on || back == most) return;  // too far back, or nothing to interpolate from
  for (; back-- > 0;) {
    Point& point = points_.back(back);
    point.force_b = force_at(point.t_ns);
    integrate(points_.back(back + 1), point);
  }
}

bool InertialTrack::has_force() const {
  return !points_.empty() && newest_force_.t_ns != INT64_MIN &&
         seconds(newest_ns(), newest_force_.t_ns) <= kLongestGap_s;
}

std::optional<InertialTrack::Point> InertialTrack::at(int64_t t_ns, double ahead_s) const {
  const size_t usable = std::min(since_gap_, points_.size());
  if (usable == 0 || t_ns < points_.back(usable - 1).t_ns) return {};
  if (t_ns >= newest_ns()) {
    const Point& last = points_.back(0);
    const double dt = std::min(seconds(t_ns, last.t_ns), ahead_s);
    Point out = last;
    out.t_ns = last.t_ns + std::llround(dt * 1e9);
    out.q_e_b = last.q_e_b * exp_rotation(dt * last.rate_b);
    const Vector3d a0 = last.q_e_b * last.force_b, a1 = out.q_e_b * last.force_b;
    out.v_e += 0.5 * dt * (a0 + a1);
    out.p_e += dt * last.v_e + dt * dt / 6 * (2 * a0 + a1);
    return out;
  }
  const size_t later = points_.later_than(t_ns);
  const Point &a = points_.back(later), &b = points_.back(later - 1);
  if (t_ns == a.t_ns) return a;
  const double w = seconds(t_ns, a.t_ns) / seconds(b.t_ns, a.t_ns);
  Point out;
  out.t_ns = t_ns;
  out.rate_b = a.rate_b + w * (b.rate_b - a.rate_b);
  out.force_b = a.force_b + w * (b.force_b - a.force_b);
  integrate(a, out);
  return out;
}

void InertialTrack::clear() {
  points_.clear();
  since_gap_ = 0;
  before_ = newest_force_ = {};
}

}  // namespace odograph
