// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/evaluation/vo_consistency.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "sdk/math/rotation.hpp"

namespace odograph {
namespace {

using Eigen::Vector3d;

constexpr double kMinDisplacement_m = 0.03;  // minimum for a meaningful direction
constexpr double kLargestGap_s = 0.25;

}  // namespace

MotionConsistency motion_consistency(const StampedPoses& truth, const std::vector<odo_vo_motion>& motions) {
  MotionConsistency result;
  for (const odo_vo_motion& m : motions) {
    if ((m.header.flags & ODO_VO_COVARIANCE) == 0) continue;
    const auto from = pose_at(truth, m.t_from_ns, kLargestGap_s), to = pose_at(truth, m.header.t_ns, kLargestGap_s);
    if (!from || !to) continue;
    const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> covariance(m.covariance);
    const Vector3d error = log_rotation(raw_quaternion(m.q_c0_c1) * (from->q.conjugate() * to->q).conjugate());
    result.rotation.push_back(error.dot(covariance.topLeftCorner<3, 3>().inverse() * error) / 3);
    const Vector3d displacement = from->q.conjugate() * (to->p - from->p), own(m.p_c0_c1);
    if (displacement.norm() < kMinDisplacement_m) continue;
    const Vector3d across = own - own.norm() / displacement.norm() * displacement;
    result.direction.push_back(across.dot(covariance.bottomRightCorner<3, 3>().inverse() * across) / 2);
  }
  return result;
}

VoShape vo_shape(const StampedPoses& truth, const std::vector<odo_vo_motion>& motions, const Pairs& pairs) {
  const double none = std::nan("");
  VoShape shape;
  const double one = 1 / static_cast<double>(std::max<size_t>(1, motions.size()));
  for (const odo_vo_motion& m : motions) {
    if (m.state == ODO_TRACKING) shape.tracking_share += one;
    if (m.state == ODO_LOST) shape.lost_share += one;
  }
  if (pairs.reference.size() < 10)
    return {none, none, none, none, {}, {}, none, none, shape.tracking_share, shape.lost_share};
  constexpr double kWindow_m = 10;
  const auto end_with = [&](double window_m) {
    return absolute_errors(pairs.reference, with_true_lengths(pairs, window_m).track).translation_m.back();
  };
  const auto mean = [&](const std::vector<double>& x) { return x.empty() ? none : statistics_of(x).mean; };
  const StampedPoses aligned = align(pairs, Alignment::sim3, nullptr);
  shape.path_m = path_length(pairs.reference);
  shape.ape_m = statistics_of(absolute_errors(pairs.reference, aligned).translation_m).rmse;
  shape.end_per_frame_m = end_with(0), shape.end_per_window_m = end_with(kWindow_m);
  for (const double change : scale_changes(pairs, kWindow_m)) shape.scale_change.push_back(std::abs(change));
  shape.rotation_rad = relative_errors(pairs.reference, aligned, 1, false).rotation_rad;
  const MotionConsistency nees = motion_consistency(truth, motions);
  shape.rotation_nees = mean(nees.rotation), shape.direction_nees = mean(nees.direction);
  return shape;
}

}  // namespace odograph
