// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include <Eigen/Geometry>

#include "plugins/vo/odograph/visual/parameters.hpp"
#include "sdk/math/ring.hpp"

namespace odograph::vo {

/// Rotation of a gyroscope between two times (see RotationIntegral).
struct GyroRotation {
  Eigen::Quaterniond q_c0_c1;
  Eigen::Matrix3d by_bias;  ///< derivative of the right perturbation by the bias, s
  double sigma_rad;         ///< noise, and scale and misalignment errors in proportion to the angle
};

/// Ring buffer of the latest gyroscope samples, in the camera's axes. Does not allocate.
class Gyroscope {
 public:
  explicit Gyroscope(const GyroscopeParameters& parameters = {}) : p_(parameters) {}

  void add(int64_t t_ns, const Eigen::Vector3d& rate_c);
  /// Nothing if samples are missing. Beyond the newest sample its rate is extrapolated for a short time.
  std::optional<GyroRotation> between(int64_t from_ns, int64_t to_ns, const Eigen::Vector3d& bias_c) const;
  /// Rate of the nearest sample, rad/s.
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
