// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "sdk/tools/simulation/motion.hpp"
#include "sdk/tools/simulation/scenario.hpp"

namespace odograph {

/// A moving phone lens: optical stabilisation shifts the principal point against hand shake, autofocus changes the
/// focal length. Thread: immutable after construction.
///
/// The stabiliser integrates the gyroscope with a leak, which acts as a high-pass; the leak grows with the square of
/// the used travel, from `high_pass_hz` to `end_pass_hz`, so that slow and large rotations pass and only shake is
/// compensated (driver of an IMX214 module: 0.5 to 0.9 Hz, rising to 13 Hz). The lens follows gain * angle with a lag
/// and a random residual.
class SimLens {
 public:
  struct State {
    Eigen::Vector2d shift_px{0, 0};   ///< of the principal point, x right and y down
    Eigen::Vector2d rate_px_s{0, 0};  ///< of that shift
    double focal = 1;                 ///< ratio to the nominal focal length
  };

  SimLens() = default;  ///< at rest
  /// `in_body`: from the camera to the body.
  SimLens(const Scenario::Camera& camera, const Eigen::Quaterniond& in_body, const Motion& phone, uint64_t seed);

  bool moves() const { return !shift_.empty() || !focus_.empty(); }
  State at(double t_s) const;  ///< constant before the start and after the end
  /// Maximum displacement of any pixel relative to the lens at rest.
  double reach_px() const { return reach_px_; }

 private:
  struct FocusMove {
    double t_start_s, from, to;
  };
  void stabilise(const Scenario::Camera& camera, const Eigen::Quaterniond& in_body, const Motion& phone, uint64_t seed);
  void focus(const Scenario::Camera& camera, double duration_s, uint64_t seed);

  std::vector<Eigen::Vector2d> shift_;  // at kRate_hz
  std::vector<FocusMove> focus_;
  double move_s_ = 0;
  double reach_px_ = 0;
};

}  // namespace odograph
