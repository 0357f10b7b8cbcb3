// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/smooth_pose.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/rotation.hpp"
#include "sdk/host/base/saturating.hpp"

namespace odograph {
namespace {

using Eigen::AngleAxisd;
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

void CorrectionBlend::reset() {
  corrections_.clear();
  corrections_.push({INT64_MIN, {}, SmoothPose(parameters_)});
}

void CorrectionBlend::correct(int64_t t_ns, const Rigid& correction, const SmoothPose::Pose& before) {
  Correction now = corrections_.back(0);
  t_ns = std::max(t_ns, now.since_ns);
  now.smooth.jumped(t_ns, before, {(correction.q * before.q_n).normalized(), correction.q * before.p_n + correction.p});
  if (t_ns == now.since_ns) {  // one correction with the previous one: nothing was smooth between them
    now.T_new_old = correction * now.T_new_old;
    corrections_.back(0) = now;
  } else {
    corrections_.push({t_ns, correction, now.smooth});
  }
}

SmoothPose::Pose CorrectionBlend::at(int64_t t_ns, SmoothPose::Pose pose) const {
  size_t i = 0;
  for (; i + 1 < corrections_.size() && t_ns < corrections_.back(i).since_ns; ++i) {
    const Rigid T_old_new = corrections_.back(i).T_new_old.inverse();
    pose = {(T_old_new.q * pose.q_n).normalized(), T_old_new.q * pose.p_n + T_old_new.p};
  }
  return corrections_.back(i).smooth.at(t_ns, pose);
}

}  // namespace odograph
