// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "sdk/math/ring.hpp"

namespace odograph::step_fit {

struct Scale {
  double scale, relative_sigma;
};

/// The scale of a scale group from all steps in it: a Kalman filter of its logarithm, one measurement a
/// step (the step's length over the odometry's horizontal displacement between its two contacts), for odometries whose
/// scale drifts slowly. Where Antigny et al. 2019 scale each frame on its own, the odometry's own lengths are kept
/// here, and what steps err by one by one averages out. No allocation.
class StepFit {
 public:
  /// "by hand": chosen so, not tuned.
  struct Parameters {
    double timing = 0.12;   ///< relative: contacts are timed to 70 ms of a step of half a second, neighbours share them
    double huber = 1.5;     ///< standard deviations, from where on an innovation counts linearly; by hand
    double alike = 2;       ///< longest to shortest of three displacements of a walk; by hand
    double straight = 0.8;  ///< of their sum, that the three lead somewhere; by hand
    int64_t pause_ns = 1'000'000'000;  ///< between two steps: longer ones are not of one walk; by hand
  };

  /// `drift`: of the scale, relative, from step to step. `common`: what all steps err by together, relative.
  StepFit(double drift, double common) : drift_(drift), common_(common) {}

  /// A motion's horizontal displacement in n, up to scale. Another group begins anew.
  void add_motion(int64_t from_ns, int64_t to_ns, const Eigen::Vector2d& d_n, uint32_t group);
  /// False when the odometry does not cover the step, or does not see a walk in it.
  bool add_step(int64_t start_ns, int64_t end_ns, double length_m, double sigma_m);
  std::optional<Scale> scale() const;

 private:
  struct Point {
    int64_t t_ns;
    Eigen::Vector2d p;
  };
  struct Step {
    Eigen::Vector2d d = Eigen::Vector2d::Zero();  // up to scale
    double length_m = 0, relative_sigma = 0;
  };
  std::optional<Eigen::Vector2d> at(int64_t t_ns) const;
  bool walks() const;
  bool take(const Step& step);

  Parameters p_;
  double drift_, common_;
  Ring<Point, 1024> path_;
  std::optional<uint32_t> group_;
  std::array<Step, 3> recent_{};
  size_t recent_count_ = 0;
  int64_t last_end_ns_ = 0;
  double log_scale_ = 0, variance_ = -1;  // below 0: not known
};

}  // namespace odograph::step_fit
