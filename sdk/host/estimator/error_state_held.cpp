// SPDX-License-Identifier: Apache-2.0
//
// Poses of the past that are held: how they begin, and how an update moves them. What time and bookkeeping do to their
// covariance with the filter's errors stands beside what it does to the filter's own, in error_state.cpp.
#include <algorithm>

#include "sdk/host/base/rotation.hpp"
#include "sdk/host/estimator/error_state.hpp"

namespace odograph::inertial {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

uint64_t ErrorState::hold(const PastPose& at, int64_t t_ns, double path_m) {
  HeldPoses<kSize>::Held held{.id = ++last_held_, .t_ns = t_ns, .path_m = path_m, .q_n_b = at.q_n_b, .p_n = at.p_n};
  held.cross = (1 - at.w) * P.middleRows<6>(at.before) + at.w * P.middleRows<6>(at.after);
  held.own = (1 - at.w) * held.cross.middleCols<6>(at.before) + at.w * held.cross.middleCols<6>(at.after);
  held.own = (0.5 * (held.own + held.own.transpose())).eval();
  return held_.add(std::move(held)).id;
}

bool ErrorState::held(uint64_t id, HeldPose& out) const {
  const auto* held = held_.find(id);
  if (!held) return false;
  out = {held->q_n_b, held->p_n, held->own, P.block<6, 6>(kTheta, kTheta), held->cross.middleCols<6>(kTheta)};
  return true;
}

void ErrorState::shift_held(const Vector3d& by_n, const Matrix3d& covariance, double fixed_m, double now_m) {
  for (auto& held : held_) {
    const double share = share_of_correction(held.path_m, fixed_m, now_m);
    held.p_n += share * by_n;
    held.own.bottomRightCorner<3, 3>() += share * share * covariance;
    const auto also = [&](int at) { held.cross.block<3, 3>(3, at) += share * covariance; };
    also(kPosition), also(kVoPosition);
    for (size_t i = 0; i < clone_count_; ++i) also(column_back(i) + 3);
  }
}

/// K and N of a held pose are made as those of the filter's own errors are. Where it does not move it is a considered
/// parameter itself (Schmidt 1966): P_zx <- P_zx (I - K H)'.
template <int D>
void ErrorState::update_held(const Innovation<D>& innovation, const Gain<D>& gain, bool moves) {
  for (auto& held : held_) {
    if (!moves) {
      held.cross -= (held.by(innovation) * gain.K.transpose()).eval();
      continue;
    }
    const Eigen::Matrix<double, 6, D> by_held =
        held.cross.middleCols(gain.first, gain.count) * gain.known.topRows(gain.count);
    const Eigen::Matrix<double, 6, D> K = (held.by(innovation) - by_held) * gain.inverse;
    const Eigen::Matrix<double, 6, D> N = K * gain.half + by_held;
    held.cross -= K * gain.N.transpose() + N * gain.K.transpose();
    held.own -= K * N.transpose() + N * K.transpose();
    const Eigen::Matrix<double, 6, 1> error = K * innovation.residual;
    held.q_n_b = (exp_rotation(error.head<3>()) * held.q_n_b).normalized();
    held.p_n += turning_ ? Vector3d(left_jacobian(error.head<3>()) * error.tail<3>()) : Vector3d(error.tail<3>());
  }
}

template void ErrorState::update_held<1>(const Innovation<1>&, const Gain<1>&, bool);
template void ErrorState::update_held<2>(const Innovation<2>&, const Gain<2>&, bool);
template void ErrorState::update_held<3>(const Innovation<3>&, const Gain<3>&, bool);
template void ErrorState::update_held<6>(const Innovation<6>&, const Gain<6>&, bool);

}  // namespace odograph::inertial
