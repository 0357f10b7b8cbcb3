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

/// Products coefficient by coefficient: at these sizes Eigen's blocked ones are no faster, and cost seconds to compile.
UpdateResult Localizer::update(const Innovation& innovation, double max_nis, StateSet considered) {
  using Gain = Eigen::Matrix<double, kStates, Eigen::Dynamic, 0, kStates, Innovation::kMaxRows>;
  using PoseGain = Eigen::Matrix<double, 4, Eigen::Dynamic, 0, 4, Innovation::kMaxRows>;
  using Square = Innovation::Square;
  const auto& H = innovation.H;
  const int rows = static_cast<int>(H.rows());
  Gain PHt = P_.lazyProduct(H.transpose());
  // Process noise since the measurement is not correlated with it; limited to half the current variance.
  for (int i = 0; i < kStates; ++i) PHt.row(i) -= std::min(innovation.since[i], 0.5 * P_(i, i)) * H.col(i).transpose();
  Square S = H.lazyProduct(PHt);
  S += innovation.noise;
  S = (0.5 * (S + S.transpose())).eval();
  const Eigen::LLT<Square> llt(S);
  if (llt.info() != Eigen::Success) return {false, 0.0, rows};
  const Square inverse = llt.solve(Square::Identity(rows, rows));
  const double nis = innovation.residual.dot(inverse.lazyProduct(innovation.residual));
  if (!(nis >= 0) || !std::isfinite(nis) || (max_nis > 0 && nis > max_nis)) return {false, nis, rows};

  Gain K = PHt.lazyProduct(inverse);
  for (int i = 0; i < kStates; ++i)
    if (considered[static_cast<size_t>(i)]) K.row(i).setZero();
  const Gain KS = K.lazyProduct(S);
  const Gain half = PHt - 0.5 * KS;
  for (DelayedPose& pose : delayed_poses_) {
    const PoseGain CHt = pose.cross.lazyProduct(H.transpose());
    PoseGain K_pose = CHt.lazyProduct(inverse);
    for (int i = 0; i < 4; ++i)  // what is considered of the current pose is considered of the retained one
      if (considered[static_cast<size_t>(kPose[i])]) K_pose.row(i).setZero();
    const Eigen::Vector4d moved = K_pose.lazyProduct(innovation.residual);
    pose.q_n_b = (about_down(moved[0]) * pose.q_n_b).normalized();
    pose.p_n += along_arc(moved.tail<3>(), moved[0]);
    pose.cross += K_pose.lazyProduct((KS - PHt).transpose()) - CHt.lazyProduct(K.transpose());
    const PoseGain half_pose = CHt - 0.5 * K_pose.lazyProduct(S);
    pose.own -= K_pose.lazyProduct(half_pose.transpose()) + half_pose.lazyProduct(K_pose.transpose());
  }
  StateVector moved = K.lazyProduct(innovation.residual);
  moved.head<3>() = along_arc(moved.head<3>(), moved[kHeading]);
  x_ += moved;
  P_ -= K.lazyProduct(half.transpose()) + half.lazyProduct(K.transpose());
  return {true, nis, rows};
}

}  // namespace odograph
