// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/fusion/trajectory.hpp"

#include "sdk/host/base/saturating.hpp"
#include "sdk/host/fusion/outputs.hpp"
#include "sdk/math/gravity.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr Trajectory::Parameters kParameters;

}  // namespace

std::optional<TrackPoint> Trajectory::stored(int64_t t_ns) const {
  const size_t later = track_.later_than(t_ns);
  if (later == track_.size()) return std::nullopt;
  if (later == 0) return newest();
  const TrackPoint &a = track_.back(later), &b = track_.back(later - 1);
  const double w = weight_between(a, b, t_ns);
  TrackPoint out = w < 0.5 ? a : b;
  out.t_ns = t_ns;
  out.q_o_b = a.q_o_b.slerp(w, b.q_o_b);
  out.p_o_b = a.p_o_b + w * (b.p_o_b - a.p_o_b);
  out.path_m = a.path_m + w * (b.path_m - a.path_m);
  out.drift_m2 = a.drift_m2 + w * (b.drift_m2 - a.drift_m2);
  out.heading_drift_rad2 = a.heading_drift_rad2 + w * (b.heading_drift_rad2 - a.heading_drift_rad2);
  return out;
}

std::optional<TrackPoint> Trajectory::at(int64_t t_ns, bool by_attitude_first) const {
  auto point = stored(t_ns);
  if (!point || t_ns <= point->t_ns) return point;
  const double ahead_s = std::min(seconds(t_ns - point->t_ns), seconds(kMaxExtrapolation_ns));
  const auto then = inertial_point(point->t_ns), now = inertia.at(t_ns, seconds(kMaxExtrapolation_ns));
  const bool by_gyroscope = then && now;
  if (const auto q = by_attitude(t_ns); q && (by_attitude_first || !by_gyroscope))
    point->q_o_b = *q;
  else if (by_gyroscope)
    point->q_o_b = point->q_o_b * then->q_e_b.conjugate() * now->q_e_b;
  if (velocity_ == Velocity::steps)
    point->p_o_b.head<2>() += walked_s(t_ns) * v_o_.head<2>();
  else
    point->p_o_b += ahead_s * v_o_;
  point->t_ns = t_ns;
  return point;
}

double Trajectory::walked_s(int64_t t_ns) const {
  if (velocity_ != Velocity::steps) return 0;
  return walked_on_s(seconds(t_ns, newest().t_ns), seconds(velocity_until_ns_, newest().t_ns));
}

void Trajectory::push(int64_t t_ns, const Quaterniond& q_o_b, const Vector3d& d_o, const Vector3d& drift_m2,
                      double heading_drift_rad2) {
  TrackPoint point = empty() ? TrackPoint{} : newest();
  point.t_ns = std::max(t_ns, point.t_ns);
  point.q_o_b = q_o_b.normalized();
  point.p_o_b += d_o;
  point.path_m += d_o.norm();
  point.drift_m2 += drift_m2;
  point.heading_drift_rad2 += heading_drift_rad2;
  track_.push(point);
  if (const auto q_a_b = attitude(point.t_ns)) q_o_a_ = point.q_o_b * q_a_b->conjugate();
}

void Trajectory::add_attitude(const odo_attitude& attitude) {
  attitudes_.push({attitude.header.t_ns, quaternion(attitude.q_n_b)});
}

std::optional<Quaterniond> Trajectory::attitude(int64_t t_ns) const {
  if (attitudes_.empty()) return std::nullopt;
  const Attitude& then = attitudes_.back(std::min(attitudes_.later_than(t_ns), attitudes_.size() - 1));
  return t_ns - then.t_ns > nanoseconds(kParameters.attitude_gap_s) ? std::nullopt : std::optional(then.q_a_b);
}

std::optional<Quaterniond> Trajectory::by_attitude(int64_t t_ns) const {
  const auto q_a_b = attitude(t_ns);
  return q_a_b ? std::optional<Quaterniond>(q_o_a_ * *q_a_b) : std::nullopt;
}

std::optional<InertialTrack::Point> Trajectory::inertial_point(int64_t t_ns) const {
  const auto point = inertia.at(t_ns, kParameters.gyro_gap_s);
  return point && point->t_ns == t_ns ? point : std::nullopt;
}

std::optional<Quaterniond> Trajectory::gyro_rotation(int64_t from_ns, int64_t to_ns) const {
  const auto from = inertial_point(from_ns), to = inertial_point(to_ns);
  if (!from || !to) return std::nullopt;
  return from->q_e_b.conjugate() * to->q_e_b;
}

std::optional<Vector3d> Trajectory::inertial_displacement(int64_t from_ns, int64_t to_ns, const Quaterniond& q_o_b,
                                                          const Vector3d& v_o, const Vector3d& accel_bias_b) const {
  const auto from = inertial_point(from_ns), to = inertial_point(to_ns);
  if (!from || !to || to_ns <= from_ns) return std::nullopt;
  const double T = seconds(to_ns - from_ns);
  const Vector3d constant_o = Vector3d(0, 0, kStandardGravity_mps2) - q_o_b * accel_bias_b;
  const Vector3d by_samples_o = q_o_b * (to->q_e_b.conjugate() * (to->p_e - from->p_e - T * to->v_e));
  return Vector3d(T * v_o + by_samples_o - 0.5 * T * T * constant_o);
}

}  // namespace odograph
