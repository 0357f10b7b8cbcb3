// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "sdk/tools/simulation/motion.hpp"
#include "sdk/tools/simulation/scenario.hpp"

namespace odograph {

/// A phone's lens that moves: its stabiliser shifts the principal point against the hand's shake, its autofocus changes
/// the focal length. Thread: immutable after construction.
///
/// The stabiliser integrates the gyroscope to an angle with a leak, which is a high-pass; the leak grows with the
/// square of the travel that is used up, from `high_pass_hz` to `end_pass_hz`, so that slow and large rotation is
/// followed and only the shake compensated (driver of an IMX214 module: 0.5 to 0.9 Hz, rising to 13 Hz). The lens
/// follows gain * angle with a lag and a random residual.
class SimLens {
 public:
  struct State {
    Eigen::Vector2d shift_px{0, 0};   ///< of the principal point, x right and y down
    Eigen::Vector2d rate_px_s{0, 0};  ///< of that shift
    double focal = 1;                 ///< focal length over the nominal one
  };

  SimLens() = default;  ///< stands still
  /// `in_body`: from the camera to the body.
  SimLens(const Scenario::Camera& camera, const Eigen::Quaterniond& in_body, const Motion& phone, uint64_t seed);

  bool moves() const { return !shift_.empty() || !focus_.empty(); }
  State at(double t_s) const;  ///< held before the start and after the end
  /// No pixel is ever further than this from where the still lens would show it.
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
