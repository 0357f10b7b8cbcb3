// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "sdk/math/time.hpp"

namespace odograph {

struct GyroSample {
  int64_t t_ns = 0;
  Eigen::Vector3d rate_b = Eigen::Vector3d::Zero();  ///< rad/s
};

/// Orientation of the body from its gyroscope as a function of time: the rate is linear between samples, and each
/// interval's rotation is the exponential of its integral (the second Magnus term, below 1e-5 rad at 50 Hz and hand
/// rates, is neglected). Times are seconds after the first sample.
class GyroOrientation {
 public:
  /// The rate is scale (measured - bias), rad/s. At least two samples in strictly ascending time order.
  GyroOrientation(const std::vector<GyroSample>& samples, const Eigen::Vector3d& bias_b,
                  const Eigen::Matrix3d& scale = Eigen::Matrix3d::Identity());

  double seconds(int64_t t_ns) const { return odograph::seconds(t_ns - first_ns_); }
  /// Whether samples cover the interval without a gap longer than `gap_s`.
  bool covers(double from_s, double to_s, double gap_s) const;
  /// From the body at `t_s` to the body at the first sample; extrapolated beyond the samples with the nearest
  /// interval's rate.
  Eigen::Quaterniond at(double t_s) const;
  Eigen::Vector3d rate(double t_s) const;

 private:
  struct Knot {
    double t_s;
    Eigen::Quaterniond q;
    Eigen::Vector3d rate, acceleration;
  };
  size_t interval(double t_s) const;
  int64_t first_ns_;
  std::vector<Knot> knots_;
};

}  // namespace odograph
