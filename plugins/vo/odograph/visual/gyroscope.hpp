// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include <Eigen/Geometry>

#include "plugins/vo/odograph/visual/parameters.hpp"
#include "sdk/math/ring.hpp"

namespace odograph::vo {

/// A gyroscope's rotation between two times, as RotationIntegral has it.
struct GyroRotation {
  Eigen::Quaterniond q_c0_c1;
  Eigen::Matrix3d by_bias;  ///< derivative of the right-hand small rotation by the bias, s
  double sigma_rad;         ///< noise, and scale and misalignment by the angle
};

/// The latest gyroscope samples, in the camera's axes. No allocation.
class Gyroscope {
 public:
  explicit Gyroscope(const GyroscopeParameters& parameters = {}) : p_(parameters) {}

  void add(int64_t t_ns, const Eigen::Vector3d& rate_c);
  /// Nothing where samples lack; after the newest sample its rate goes on for a moment.
  std::optional<GyroRotation> between(int64_t from_ns, int64_t to_ns, const Eigen::Vector3d& bias_c) const;
  /// rad/s at a time, the nearest sample's.
  std::optional<Eigen::Vector3d> rate(int64_t t_ns) const;
  void clear() { samples_.clear(); }

 private:
  struct Sample {
    int64_t t_ns;
    Eigen::Vector3d rate_c;
  };

  GyroscopeParameters p_;
  Ring<Sample, 4096> samples_;
};

}  // namespace odograph::vo
