// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Geometry>

namespace odograph {

/// Motion of a rigid body as one smooth function of time, so that poses, IMU samples and rolling-shutter rows are
/// consistent: a uniform quintic B-spline for the position (acceleration twice differentiable) and a cumulative cubic
/// B-spline on SO(3) (Kim, Kim & Shin 1995; derivatives after Sommer et al., CVPR 2020). Thread: immutable after
/// construction.
class Motion {
 public:
  struct State {
    Eigen::Isometry3d T_n_b;
    Eigen::Vector3d velocity_n;          ///< m/s
    Eigen::Vector3d acceleration_n;      ///< m/s^2
    Eigen::Vector3d angular_velocity_b;  ///< rad/s
    /// Output of an ideal accelerometer, m/s^2.
    Eigen::Vector3d specific_force_b() const;
  };

  Motion() = default;
  /// Control points at t = i / rate_hz. Both lists have the same length, at least one.
  Motion(double rate_hz, std::vector<Eigen::Vector3d> p_n, std::vector<Eigen::Quaterniond> q_n_b);

  /// Even beyond the start and the end for a few control points, constant further out.
  State at(double t_s) const;
  Eigen::Isometry3d pose(double t_s) const { return at(t_s).T_n_b; }
  double duration_s() const;

 private:
  static constexpr long kBeyond = 3;  // control points added at each end

  size_t index(long i) const;

  double rate_hz_ = 1.0;
  size_t count_ = 0;
  std::vector<Eigen::Vector3d> p_;
  std::vector<Eigen::Quaterniond> q_;
};

}  // namespace odograph
