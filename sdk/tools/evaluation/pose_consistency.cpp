// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/evaluation/pose_consistency.hpp"

#include <algorithm>

#include <Eigen/Dense>

#include "sdk/host/messages/messages.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/evaluation/start_alignment.hpp"

namespace odograph {
namespace {

using Eigen::Matrix2d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kThreeSigma1 = 9.0, kThreeSigma2 = 11.83;  // 99.73 % of chi-square, one and two degrees of freedom
constexpr double kMinSigma_m = 0.01, kMinSigma_rad = 1e-3;  // lower clamp of the covariance

/// Longest continuous time beyond three sigma.
struct Beyond {
  double longest_s = 0, now_s = 0;
  void see(bool is, double dt_s) {
    now_s = is ? now_s + dt_s : 0;
    longest_s = std::max(longest_s, now_s);
  }
};

}  // namespace

PoseConsistency pose_consistency(const std::vector<odo_pose>& poses, const StampedPoses& truth) {
  double position = 0, heading = 0;
  YawAlignment aligned;
  size_t n = 0;
  Beyond position_beyond, heading_beyond;
  StampedPoses estimate, reference;
  for (const odo_pose& pose : poses) {
    const auto there = pose_at(truth, pose.header.t_ns, kLargestTruthGap_s);
    if (!there) continue;
    const Quaterniond q = raw_quaternion(pose.q_n);
    if (estimate.empty()) aligned = yaw_alignment({pose.header.t_ns, q, Vector3d(pose.p_n)}, *there);
    const double dt_s = estimate.empty() ? 0 : seconds(pose.header.t_ns - estimate.back().t_ns);
    estimate.push_back({pose.header.t_ns, q, Vector3d(pose.p_n)});
    reference.push_back(*there);
    const Eigen::Vector2d error = (aligned.on_truth(Vector3d(pose.p_n)) - there->p).head<2>();
    const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> P(pose.covariance);
    const Eigen::AngleAxisd rotation(aligned.yaw_rad, Vector3d::UnitZ());
    const Eigen::Matrix3d turned =
        rotation * Eigen::Matrix3d(P.block<3, 3>(3, 3)) * rotation.inverse().toRotationMatrix();
    const Matrix2d S = Matrix2d(turned.topLeftCorner<2, 2>()) + kMinSigma_m * kMinSigma_m * Matrix2d::Identity();
    const double position_2 = error.dot(S.inverse() * error), off = aligned.yaw_error(q, there->q),
                 heading_2 = off * off / (P(2, 2) + kMinSigma_rad * kMinSigma_rad);
    position += position_2 / 2, heading += heading_2, ++n;
    position_beyond.see(position_2 > kThreeSigma2, dt_s);
    heading_beyond.see(heading_2 > kThreeSigma1, dt_s);
  }
  PoseConsistency figures{.poses = n};
  if (n < 3) return figures;
  const Pairs pairs{reference, estimate};
  double scale = 1;
  figures.path_m = path_length(reference);
  figures.ape_m = statistics_of(absolute_errors(reference, align(pairs, Alignment::yaw, nullptr)).translation_m).rmse;
  align(pairs, Alignment::sim3, &scale);
  figures.scale_error = 1 / scale - 1;
  figures.position_nees = position / static_cast<double>(n), figures.heading_nees = heading / static_cast<double>(n);
  figures.position_beyond_s = position_beyond.longest_s, figures.heading_beyond_s = heading_beyond.longest_s;
  return figures;
}

double horizontal_nees(const Vector3d& error_n, const double covariance_n[9]) {
  Matrix2d P;
  P << covariance_n[0], covariance_n[1], covariance_n[3], covariance_n[4];
  return error_n.head<2>().dot(P.ldlt().solve(error_n.head<2>()));
}

}  // namespace odograph
