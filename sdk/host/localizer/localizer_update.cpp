// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "sdk/host/localizer/localizer.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph {

using Eigen::Vector3d;

namespace {

/// Change of a heading-dependent displacement under a finite rotation: the chord of the arc, not its tangent.
Vector3d along_arc(const Vector3d& tangent, double turned_rad) {
  return left_jacobian(turned_rad * Vector3d::UnitZ()) * tangent;
}

}  // namespace

template <int D>
UpdateResult Localizer::update(const Innovation<D>& innovation, double max_nis, StateSet considered) {
  const auto& H = innovation.H;
  Eigen::Matrix<double, kStates, D> PHt = P_ * H.transpose();
  // Process noise since the measurement is not correlated with it; limited to half the current variance.
  for (int i = 0; i < kStates; ++i) PHt.row(i) -= std::min(innovation.since[i], 0.5 * P_(i, i)) * H.col(i).transpose();
  Eigen::Matrix<double, D, D> S = H * PHt + innovation.noise;
  S = (0.5 * (S + S.transpose())).eval();
  const Eigen::LLT<Eigen::Matrix<double, D, D>> llt(S);
  if (llt.info() != Eigen::Success) return {false, 0.0, D};
  const double nis = innovation.residual.dot(llt.solve(innovation.residual));
  if (!(nis >= 0) || !std::isfinite(nis) || (max_nis > 0 && nis > max_nis)) return {false, nis, D};

  const Eigen::Matrix<double, D, D> inverse = llt.solve(Eigen::Matrix<double, D, D>::Identity().eval());
  Eigen::Matrix<double, kStates, D> K = PHt * inverse;
  for (int i = 0; i < kStates; ++i)
    if (considered[static_cast<size_t>(i)]) K.row(i).setZero();
  for (DelayedPose& pose : delayed_poses_) {
    const Eigen::Matrix<double, 4, D> CHt = pose.cross * H.transpose();
    Eigen::Matrix<double, 4, D> K_pose = CHt * inverse;
    for (int i = 0; i < 4; ++i)  // what is considered of the current pose is considered of the retained one
      if (considered[static_cast<size_t>(kPose[i])]) K_pose.row(i).setZero();
    const Eigen::Matrix<double, 4, 1> moved = K_pose * innovation.residual;
    pose.q_n_b = (about_down(moved[0]) * pose.q_n_b).normalized();
    pose.p_n += along_arc(moved.tail<3>(), moved[0]);
    pose.cross += K_pose * (S * K.transpose() - PHt.transpose()) - CHt * K.transpose();
    const Eigen::Matrix<double, 4, D> half = CHt - 0.5 * K_pose * S;
    pose.own -= K_pose * half.transpose() + half * K_pose.transpose();
  }
  StateVector moved = K * innovation.residual;
  moved.head<3>() = along_arc(moved.head<3>(), moved[kHeading]);
  x_ += moved;
  const Eigen::Matrix<double, kStates, D> half = PHt - 0.5 * K * S;
  P_ -= K * half.transpose() + half * K.transpose();
  return {true, nis, D};
}

template UpdateResult Localizer::update<1>(const Innovation<1>&, double, StateSet);
template UpdateResult Localizer::update<2>(const Innovation<2>&, double, StateSet);
template UpdateResult Localizer::update<4>(const Innovation<4>&, double, StateSet);

}  // namespace odograph
