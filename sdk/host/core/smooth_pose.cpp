// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/smooth_pose.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/rotation.hpp"
#include "sdk/host/base/saturating.hpp"

namespace odograph {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

/// Remaining length after dt for dx/dt = -max(min(x / tau, limit), x / far): exponential down to limit * far, linear,
/// and exponential again below limit * tau.
double left_of(double length, double dt, double tau, double limit, double far) {
  if (length > limit * far) {
    const double far_s = far * std::log(length / (limit * far));
    if (dt <= far_s) return length * std::exp(-dt / far);
    dt -= far_s;
    length = limit * far;
  }
  const double knee = limit * tau;
  if (length > knee) {
    const double straight_s = (length - knee) / limit;
    if (dt <= straight_s) return length - limit * dt;
    dt -= straight_s;
    length = knee;
  }
  return length * std::exp(-dt / tau);
}

Vector3d left_of(const Vector3d& x, double dt, double tau, double limit, double far) {
  const double length = x.norm();
  return length > 0 ? Vector3d(x * (left_of(length, dt, tau, limit, far) / length)) : Vector3d::Zero();
}

}  // namespace

SmoothPose::Pose SmoothPose::at(int64_t t_ns, const Pose& pose) const {
  const double dt = std::max(0.0, static_cast<double>(saturating_difference(t_ns, since_ns_)) * 1e-9);
  const double tau = parameters_.time_constant_s, far = parameters_.far_time_constant_s;
  const Vector3d theta_n = left_of(rotation_n_, dt, tau, parameters_.max_rate_radps, far);
  const Vector3d shift = left_of(shift_n_, dt, tau, parameters_.max_speed_mps, far);
  return {(exp_rotation(theta_n) * pose.q_n).normalized(), pose.p_n + shift};
}

void SmoothPose::jumped(int64_t t_ns, const Pose& before, const Pose& after) {
  t_ns = std::max(t_ns, since_ns_);
  const Pose smooth = at(t_ns, before);
  const AngleAxisd difference((smooth.q_n * after.q_n.conjugate()).normalized());
  rotation_n_ = std::remainder(difference.angle(), 2 * EIGEN_PI) * difference.axis();
  shift_n_ = smooth.p_n - after.p_n;
  since_ns_ = t_ns;
}

}  // namespace odograph
