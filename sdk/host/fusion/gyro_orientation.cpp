// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/fusion/gyro_orientation.hpp"

#include <utility>

#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

void GyroOrientation::start(const Quaterniond& q_b_c) {
  if (!is_enabled()) return;
  q_b_c_ = q_b_c;
  filter_.reset(state_.track.newest().q_o_b * q_b_c_, tilt_covariance());
  if (!state_.heading.north() && !state_.start_pose.heading_given) state_.filter.inflate_heading(kUnknownHeading_rad);
}

Matrix3d GyroOrientation::tilt_covariance() const {
  return Vector3d(state_.tilt_variance(), state_.tilt_variance(), 0).asDiagonal();
}

std::optional<Quaterniond> GyroOrientation::rotate(const odo_vo_motion& m, double rotation_sigma_rad) {
  const double dt_s = seconds(m.header.t_ns - m.t_from_ns);
  const auto from = state_.track.inertial_point(m.t_from_ns), to = state_.track.inertial_point(m.header.t_ns);
  if (!is_enabled()) return std::nullopt;
  if (!from || !to || dt_s <= 0) return gap_ = true, std::nullopt;
  if (std::exchange(gap_, false)) {
    const TrackPoint point = state_.track.stored(m.t_from_ns).value_or(state_.track.newest());
    filter_.realign(point.q_o_b * q_b_c_, tilt_covariance());
  }
  const Quaterniond q_c0_c1 = q_b_c_.conjugate() * from->q_e_b.conjugate() * to->q_e_b * q_b_c_;
  filter_.propagate(q_c0_c1, dt_s);
  // With parallax, rotation and translation are too correlated in a frame of a camera alone for the bias to be
  // observable; a front-end with inertia separates them over many frames.
  const bool pure = m.reason == ODO_REASON_NO_PARALLAX && (m.header.flags & ODO_VO_ROTATION) != 0;
  constexpr uint32_t inertial = ODO_VO_ROTATION | ODO_VO_INERTIAL;
  if (pure || (m.header.flags & inertial) == inertial)
    filter_.update_relative_rotation(q_c0_c1, quaternion(m.q_c0_c1), rotation_sigma_rad, dt_s);
  filter_.update_gravity(q_b_c_.conjugate() * (to->q_e_b.conjugate() * ((to->v_e - from->v_e) / dt_s)), pure);
  return Quaterniond(filter_.q_n_c() * q_b_c_.conjugate());
}

void GyroOrientation::update_inclination(const odo_fix& fix, const TrackPoint& then) {
  if (!is_enabled() || (fix.header.flags & ODO_FIX_ORIENTATION) == 0) return;
  const Quaterniond q_o_n = state_.filter.q_n_o().conjugate();
  const Matrix3d R_o_n = q_o_n.toRotationMatrix();
  const auto stated = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(fix.orientation_cov_n);
  constexpr double kUninformedVariance = 1e6;  // rad^2: heading belongs to T_n_o
  Vector3d off_o = log_rotation(q_o_n * quaternion(fix.q_n_b) * then.q_o_b.conjugate());
  off_o.z() = 0;
  Matrix3d R = R_o_n * stated * R_o_n.transpose();
  R.row(2).setZero(), R.col(2).setZero(), R(2, 2) = kUninformedVariance;
  filter_.correct(off_o, R, state_.config.fix_gate_sigma);
}

}  // namespace odograph
