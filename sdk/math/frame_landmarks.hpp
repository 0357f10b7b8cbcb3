// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <odograph/messages.h>

#include "sdk/math/voxel_map.hpp"

namespace odograph {

/// Landmarks of one frame, which wait for its pose and are then placed in metres. Not thread-safe; allocates once.
class FrameLandmarks {
 public:
  struct Parameters {
    uint32_t min_age = 3;           ///< frames; two rays fit any wrong match
    double max_sigma = 0.05;        ///< of a landmark's distance, relative
    double max_scale_sigma = 0.10;  ///< relative: better than by steps alone
  };

  FrameLandmarks() : waiting_(ODO_MOST_POINTS) {}

  void hold(const odo_points& points) {
    count_ = 0, t_ns_ = points.header.t_ns;
    for (uint32_t i = 0; i < points.count && count_ < waiting_.size(); ++i) {
      const odo_point* point = ODO_POINTS_AT(&points, i);
      if (!point) return;
      if ((point->flags & ODO_POINT_UNCERTAIN) == 0 && point->age >= p_.min_age) waiting_[count_++] = *point;
    }
  }
  void forget() { count_ = 0; }

  /// Relative standard deviation of a pose's scale; 1 if it is unknown.
  static double scale_sigma(const odo_pose& pose) {
    return pose.scale > 0 && pose.scale_sigma > 0 ? pose.scale_sigma / pose.scale : 1;  // 0: unknown
  }

  /// Calls each(point) with the landmarks of the pose's frame, in a frame m in which the camera is at q, p. Whether the
  /// pose is of that frame and knows its scale.
  template <class Each>
  bool place(const odo_pose& pose, const Eigen::Quaterniond& q_m_c, const Eigen::Vector3d& p_m_c, Each&& each) {
    constexpr uint32_t needed = ODO_POSE_POSITION | ODO_POSE_ORIENTATION | ODO_POSE_METRIC | ODO_POSE_CAMERA;
    if (pose.header.t_ns != t_ns_ || (pose.header.flags & needed) != needed) return false;
    const size_t count = std::exchange(count_, 0);
    if (scale_sigma(pose) > p_.max_scale_sigma) return false;
    const Eigen::Matrix3f R_m_c = q_m_c.toRotationMatrix().cast<float>();
    const auto scale = static_cast<float>(pose.scale), sigma = static_cast<float>(scale_sigma(pose));
    for (size_t i = 0; i < count; ++i) {
      const Eigen::Vector3f p_c = scale * Eigen::Vector3f(waiting_[i].p_c);
      const float* c = waiting_[i].covariance;
      Eigen::Matrix3f covariance;
      covariance << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
      covariance *= scale * scale;
      if (!(static_cast<double>(covariance.trace()) < std::pow(p_.max_sigma * static_cast<double>(p_c.norm()), 2)))
        continue;
      each(MapPoint{p_m_c + q_m_c * p_c.cast<double>(), R_m_c * covariance * R_m_c.transpose(), sigma,
                    p_m_c.cast<float>(), t_ns_});
    }
    return true;
  }

 private:
  Parameters p_;
  std::vector<odo_point> waiting_;
  size_t count_ = 0;
  int64_t t_ns_ = 0;
};

}  // namespace odograph
