// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "sdk/math/rotation.hpp"
#include "sdk/math/sample_intervals.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

/// Rotates the body by a rotation vector in body axes, rad. Returns the orientation at mid-interval, which rotates the
/// specific force measured over the interval (midpoint rule).
inline Eigen::Matrix3d rotate_body(Eigen::Quaterniond& q, const Eigen::Vector3d& rotation_b) {
  const Eigen::Matrix3d R_middle = (q * exp_rotation(0.5 * rotation_b)).toRotationMatrix();
  q = (q * exp_rotation(rotation_b)).normalized();
  return R_middle;
}

/// Rotation integrated from a gyroscope, and its derivative by the gyroscope bias (Forster et al., "On-manifold
/// preintegration", 2017, eq. (33) and (44)).
struct RotationIntegral {
  Eigen::Quaterniond q_b0_b1 = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d by_bias = Eigen::Matrix3d::Zero();  ///< derivative of the right perturbation by the bias, s

  /// Adds one interval. `rate_b`: rad/s, bias subtracted.
  void add(const Eigen::Vector3d& rate_b, double dt_s) {
    const Eigen::Quaterniond step = exp_rotation(rate_b * dt_s);
    q_b0_b1 = q_b0_b1 * step;
    by_bias = step.conjugate().toRotationMatrix() * by_bias - dt_s * Eigen::Matrix3d::Identity();
  }
};

/// Integrates over the samples between two times, with the gap rule of for_each_interval. `rate_between` returns the
/// bias-corrected rate, rad/s, from two neighbouring samples. Nothing where samples are missing.
template <class Samples, class RateBetween>
std::optional<RotationIntegral> integrate_rotation(const Samples& samples, int64_t from_ns, int64_t to_ns,
                                                   int64_t longest_gap_ns, RateBetween rate_between) {
  RotationIntegral out;
  const bool whole = for_each_interval(samples, from_ns, to_ns, longest_gap_ns,
                                       [&](const auto& before, const auto& after, int64_t t0_ns, int64_t t1_ns) {
                                         out.add(rate_between(before, after), seconds(t1_ns - t0_ns));
                                       });
  return whole ? std::optional(out) : std::nullopt;
}

}  // namespace odograph
