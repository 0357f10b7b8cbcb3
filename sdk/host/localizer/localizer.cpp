// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/localizer/localizer.hpp"

#include <algorithm>
#include <cmath>

namespace odograph {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

/// Expands a covariance of (heading, position) to (rotation, position).
Eigen::Matrix<double, 6, 6> spread(const Eigen::Matrix4d& of_pose, double tilt_variance) {
  Eigen::Matrix<double, 6, 6> out = Eigen::Matrix<double, 6, 6>::Zero();
  out.bottomRightCorner<4, 4>() = of_pose;
  out(0, 0) = out(1, 1) = tilt_variance;
  return out;
}

/// Share of a position shift that a retained pose takes: 0 up to the last fixed position, 1 now, linear in path length
/// between, for an error that grew along the path. Without a fixed position n itself was wrong, and every pose takes
/// the whole shift.
double share_of_shift(double path_m, double fixed_m, double now_m) {
  if (fixed_m < 0 || path_m >= now_m) return 1.0;
  return path_m <= fixed_m ? 0.0 : (path_m - fixed_m) / (now_m - fixed_m);
}

}  // namespace

void Localizer::move(const Vector3d& d_n, std::initializer_list<std::pair<StateIndex, Vector3d>> by,
                     const Matrix3d& noise) {
  x_.head<3>() += d_n;
  Eigen::Matrix<double, 3, kStates> F = Eigen::Matrix<double, 3, kStates>::Zero();
  F.leftCols<3>().setIdentity();
  for (const auto& [state, derivative] : by) F.col(state) += derivative;
  const Eigen::Matrix<double, 3, kStates> FP = F.lazyProduct(P_);
  const Matrix3d FPF = FP.lazyProduct(F.transpose());
  P_.topRows<3>() = FP;
  P_.leftCols<3>() = FP.transpose();
  P_.topLeftCorner<3, 3>() = 0.5 * (FPF + FPF.transpose());
  P_.topLeftCorner<3, 3>() += noise;
  for (DelayedPose& pose : delayed_poses_) pose.cross.leftCols<3>() = pose.cross.lazyProduct(F.transpose()).eval();
}

void Localizer::add_multiple(StateIndex to, StateIndex from, double factor) {
  x_[to] += factor * x_[from];
  P_.row(to) += factor * P_.row(from);
  P_.col(to) += factor * P_.col(from);
  for (DelayedPose& pose : delayed_poses_) pose.cross.col(to) += factor * pose.cross.col(from);
}

void Localizer::decay(StateIndex i, double mean, double keep, double variance) {
  x_[i] = mean + keep * (x_[i] - mean);
  P_.row(i) *= keep;
  P_.col(i) *= keep;
  P_(i, i) += variance;
  for (DelayedPose& pose : delayed_poses_) pose.cross.col(i) *= keep;
}

void Localizer::set(StateIndex i, double value, double variance) {
  x_[i] = value;
  decay(i, value, 0, variance);
}

void Localizer::set_variance(StateIndex i, double variance) {
  if (P_(i, i) <= 0) return set(i, x_[i], variance);
  decay(i, x_[i], std::sqrt(variance / P_(i, i)), 0);
}

void Localizer::copy_error(StateIndex to, StateIndex from) {
  P_.row(to) = P_.row(from);
  P_.col(to) = P_.col(from);
  P_(to, to) = P_(from, from);
  for (DelayedPose& pose : delayed_poses_) pose.cross.col(to) = pose.cross.col(from);
}

void Localizer::shift(const Vector3d& by_n, const Matrix3d& covariance, double fixed_m, double now_m) {
  x_.head<3>() += by_n;
  P_.topLeftCorner<3, 3>() += covariance;
  for (DelayedPose& pose : delayed_poses_) {
    const double share = share_of_shift(pose.path_m, fixed_m, now_m);
    pose.p_n += share * by_n;
    pose.own.bottomRightCorner<3, 3>() += share * share * covariance;
    pose.cross.bottomLeftCorner<3, 3>() += share * covariance;
  }
}

void Localizer::rotate(double by_rad, const Vector3d& about_n) {
  const Quaterniond q = about_down(by_rad);
  const Matrix3d R = q.toRotationMatrix();
  x_.head<3>() = about_n + R * (p_n() - about_n);
  x_[kHeading] += by_rad, x_[kAttitudeHeading] += by_rad;
  P_.topRows<3>() = (R * P_.topRows<3>()).eval();
  P_.leftCols<3>() = (P_.leftCols<3>() * R.transpose()).eval();
  for (DelayedPose& pose : delayed_poses_) {
    pose.q_n_b = (q * pose.q_n_b).normalized();
    pose.p_n = about_n + R * (pose.p_n - about_n);
    pose.cross.bottomRows<3>() = (R * pose.cross.bottomRows<3>()).eval();
    pose.cross.leftCols<3>() = (pose.cross.leftCols<3>() * R.transpose()).eval();
    pose.own.bottomRows<3>() = (R * pose.own.bottomRows<3>()).eval();
    pose.own.rightCols<3>() = (pose.own.rightCols<3>() * R.transpose()).eval();
  }
}

void Localizer::inflate_heading(double sigma_rad) {
  const double variance = sigma_rad * sigma_rad;
  for (const int i : {kHeading, kAttitudeHeading})
    for (const int j : {kHeading, kAttitudeHeading}) P_(i, j) += variance;
  for (DelayedPose& pose : delayed_poses_) {  // rotated with the rest, about the body's position
    Eigen::Vector4d by;
    by << 1, across(pose.p_n - p_n());
    pose.own += variance * by * by.transpose();
    for (const int i : {kHeading, kAttitudeHeading}) pose.cross.col(i) += variance * by;
  }
}

uint64_t Localizer::retain_pose(const TrackPoint& then, const TrackPoint& now) {
  const Vector3d since_n = q_n_o() * (now.p_o_b - then.p_o_b);
  Eigen::Matrix<double, 4, kStates> H = Eigen::Matrix<double, 4, kStates>::Zero();
  for (int i = 0; i < 4; ++i) H(i, kPose[i]) = 1;
  H.block<3, 1>(1, kHeading) = -across(since_n);
  H.block<3, 1>(1, kLogScale) = -since_n;
  StateVector since = StateVector::Zero();
  since.head<3>() = now.drift_m2 - then.drift_m2;
  since[kHeading] = now.heading_drift_rad2 - then.heading_drift_rad2;
  since = since.cwiseMin(0.5 * P_.diagonal());
  DelayedPose pose{++last_pose_id_, then.path_m,       q_n_o() * then.q_o_b,
                   p_n() - since_n, H.lazyProduct(P_), Eigen::Matrix4d::Zero()};
  pose.cross -= H * since.asDiagonal();
  pose.own = pose.cross.lazyProduct(H.transpose());
  pose.own = (0.5 * (pose.own + pose.own.transpose())).eval();
  delayed_poses_.push_back(pose);
  return last_pose_id_;
}

void Localizer::release_pose(uint64_t id) {
  std::erase_if(delayed_poses_, [id](const DelayedPose& pose) { return pose.id == id; });
}

Eigen::Matrix<double, 6, 6> Localizer::pose_covariance(double tilt_variance) const {
  Eigen::Matrix4d of_pose;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) of_pose(i, j) = P_(kPose[i], kPose[j]);
  return spread(of_pose, tilt_variance);
}

bool Localizer::retained_pose(uint64_t id, double tilt_variance, RetainedPose& out) const {
  const auto found = std::find_if(delayed_poses_.begin(), delayed_poses_.end(),
                                  [id](const DelayedPose& pose) { return pose.id == id; });
  if (found == delayed_poses_.end()) return false;
  Eigen::Matrix4d cross;
  for (int j = 0; j < 4; ++j) cross.col(j) = found->cross.col(kPose[j]);
  out = {found->q_n_b, found->p_n, spread(found->own, tilt_variance), pose_covariance(tilt_variance), spread(cross, 0)};
  return true;
}

}  // namespace odograph
