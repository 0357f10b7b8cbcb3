// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/localizer/tracker.hpp"

#include <algorithm>
#include <utility>

#include "sdk/host/base/saturating.hpp"
#include "sdk/math/gravity.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

void Tracker::reset() {
  *this = Tracker(config_, start_);
  heading.reset(start_.heading_rad);
}

void Tracker::start(int64_t t_ns, const Quaterniond& q_o_b) {
  t_ns_ = t_ns;
  localizer.set_position(Vector3d(start_.position_m.data()));
  heading.start(localizer);
  if (config_.orientation == Orientation::gyroscope)
    localizer.set(kHeadingRate, 0, squared(gyroscope_.bias_sigma_radps));
  coverage.begin(t_ns);
  push(t_ns, q_o_b, Vector3d::Zero());
}

void Tracker::start_without_attitude(int64_t t_ns, const Quaterniond& q_b_c) {
  constexpr double kLongestAgo_s = 1;  // maximum age of the sample whose force is taken for gravity
  if (const auto point = inertia.at(t_ns, kLongestAgo_s); point && inertia.has_force())
    return start(t_ns, Quaterniond::FromTwoVectors(point->force_b, -Vector3d::UnitZ()));
  Matrix3d level;  // columns: the camera's x, y, z in o, optical axis horizontal along the first axis of o
  level << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  start(t_ns, Quaterniond(level) * q_b_c.conjugate());
}

bool Tracker::add_attitude(const odo_attitude& attitude) {
  const bool first = !heading.has_attitude();
  attitudes.push(attitude);
  heading.on_attitude(localizer, attitude);
  tilt_variance_ = std::max(attitude.covariance_n[0], attitude.covariance_n[4]);
  return first;
}

void Tracker::start_camera_at(int64_t t_ns, const Quaterniond& q_o_b, const Vector3d& lever_b) {
  coverage.begin(t_ns);
  localizer.set_position(Vector3d(start_.position_m.data()) - localizer.q_n_o() * (q_o_b * lever_b));
}

void Tracker::propagate(int64_t t_ns) {
  if (t_ns <= t_ns_) return;
  const double dt_s = seconds(saturating_difference(t_ns, t_ns_));
  t_ns_ = t_ns;
  TrackPoint drifted = track_.newest();
  drifted.heading_drift_rad2 += heading.propagate(localizer, dt_s, rotates_with_attitude_);
  track_.push(drifted);
  height.propagate(localizer, dt_s);
  if (config_.orientation != Orientation::gyroscope) return;
  localizer.add_multiple(kHeading, kHeadingRate, dt_s);
  localizer.add_variance(kHeadingRate, squared(gyroscope_.bias_walk) * dt_s);
}

void Tracker::push(int64_t t_ns, const Quaterniond& q_o_b, const Vector3d& d_o, const Vector3d& drift_m2,
                   double heading_drift_rad2) {
  TrackPoint point = track_.empty() ? TrackPoint{} : track_.newest();
  point.t_ns = std::max(t_ns, point.t_ns);
  point.q_o_b = q_o_b.normalized();
  point.p_o_b += d_o;
  point.path_m += d_o.norm();
  point.drift_m2 += drift_m2;
  point.heading_drift_rad2 += heading_drift_rad2;
  track_.push(point);
  if (const auto q_a_b = attitudes.at(point.t_ns)) q_o_a_ = point.q_o_b * q_a_b->conjugate();
}

double Tracker::unobserved_m(int64_t t_ns) const {
  const double unobserved_s = seconds(saturating_difference(t_ns, std::max(coverage.until_ns(), gap_ns_)));
  return rotates_with_attitude_ || unobserved_s < p_.unobserved_s ? 0.0 : unobserved_m_in(unobserved_s);
}

double Tracker::unobserved_m_in(double unobserved_s) const {
  return std::min(unobserved_s * config_.fastest_mps, p_.farthest_m);
}

void Tracker::add_gap(int64_t until_ns) {
  const double unobserved_m = this->unobserved_m(until_ns);
  if (unobserved_m == 0) return;
  for (const StateIndex i : {kNorth, kEast}) localizer.add_variance(i, squared(unobserved_m));
  gap_ns_ = until_ns;
}

void Tracker::pause(int64_t until_ns, bool placed) {
  set_velocity(Vector3d::Zero(), Velocity::none);
  const int64_t seen_ns = rotates_with_attitude_ ? now_ns() : std::max(coverage.until_ns(), gap_ns_);
  gap_ns_ = until_ns;  // immediately, so that any later motion source can ignore the pause
  if (!placed) return;
  const double unobserved_m = unobserved_m_in(seconds(saturating_difference(until_ns, seen_ns)));
  for (const StateIndex i : {kNorth, kEast}) localizer.add_variance(i, squared(unobserved_m));
}

void Tracker::rotate_with_attitude() {
  if (!std::exchange(rotates_with_attitude_, true) && heading.has_attitude()) heading.join(localizer, q_o_a_);
}

std::optional<InertialTrack::Point> Tracker::inertial_point(int64_t t_ns) const {
  const auto point = inertia.at(t_ns, gyroscope_.longest_gap_s);
  return point && point->t_ns == t_ns ? point : std::nullopt;
}

std::optional<Vector3d> Tracker::inertial_displacement(int64_t from_ns, int64_t to_ns, const Quaterniond& q_o_b,
                                                       const Vector3d& v_o, const Vector3d& accel_bias_b) const {
  const auto from = inertial_point(from_ns), to = inertial_point(to_ns);
  if (!from || !to || to_ns <= from_ns) return std::nullopt;
  const double T = seconds(to_ns - from_ns);
  const Vector3d constant_o = Vector3d(0, 0, kStandardGravity_mps2) - q_o_b * accel_bias_b;
  const Vector3d by_samples_o = q_o_b * (to->q_e_b.conjugate() * (to->p_e - from->p_e - T * to->v_e));
  return Vector3d(T * v_o + by_samples_o - 0.5 * T * T * constant_o);
}

std::optional<Quaterniond> Tracker::gyro_rotation(int64_t from_ns, int64_t to_ns) const {
  const auto from = inertial_point(from_ns), to = inertial_point(to_ns);
  if (!from || !to) return std::nullopt;
  return from->q_e_b.conjugate() * to->q_e_b;
}

std::optional<Quaterniond> Tracker::by_attitude(int64_t t_ns) const {
  const auto reach_ns = nanoseconds(heading.parameters().gap_s);
  if (!attitudes.covers(t_ns, reach_ns)) return std::nullopt;
  return q_o_a_ * *attitudes.at(t_ns);
}

std::optional<TrackPoint> Tracker::at(int64_t t_ns) const {
  auto point = track_.at(t_ns);
  if (!point || t_ns <= point->t_ns) return point;
  const double ahead_s = std::min(seconds(t_ns - point->t_ns), seconds(kMaxExtrapolation_ns));
  const auto then = inertial_point(point->t_ns), now = inertia.at(t_ns, seconds(kMaxExtrapolation_ns));
  const bool by_gyroscope = then && now;
  if (const auto q = by_attitude(t_ns); q && (rotates_with_attitude_ || !by_gyroscope))
    point->q_o_b = *q;
  else if (by_gyroscope)
    point->q_o_b = point->q_o_b * then->q_e_b.conjugate() * now->q_e_b;
  point->p_o_b += ahead_s * v_o_;
  point->t_ns = t_ns;
  return point;
}

}  // namespace odograph
