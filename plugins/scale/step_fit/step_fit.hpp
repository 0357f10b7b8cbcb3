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

/// Scale of a scale group from all its steps, for odometries whose scale drifts slowly: a Kalman filter of the
/// log-scale with one measurement per step (the step's length over the odometry's horizontal displacement between its
/// two contacts). Antigny et al. 2019 scale each frame separately; here the odometry's own lengths are kept, and the
/// independent errors of the steps average out. Does not allocate.
class StepFit {
 public:
  /// "Empirical": chosen, not tuned.
  struct Parameters {
    double timing = 0.12;   ///< relative: contacts are timed to 70 ms in a step of half a second, shared by neighbours
    double huber = 1.5;     ///< standard deviations beyond which the loss is linear; empirical
    double alike = 2;       ///< max ratio of three displacements of a walk; empirical
    double straight = 0.8;  ///< min net displacement of the three over their sum; empirical
    int64_t pause_ns = 1'000'000'000;  ///< max interval between two steps of one walk; empirical
  };

  /// `drift`: of the scale, relative, from step to step. `common`: relative error common to all steps.
  StepFit(double drift, double common) : drift_(drift), common_(common) {}

  /// A motion's horizontal displacement in n, up to scale. Another group restarts the filter.
  void add_motion(int64_t from_ns, int64_t to_ns, const Eigen::Vector2d& d_n, uint32_t group);
  /// False if the odometry does not cover the step, or does not show a walk.
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
  bool is_walk() const;
  bool take(const Step& step);

  Parameters p_;
  double drift_, common_;
  Ring<Point, 1024> path_;
  std::optional<uint32_t> group_;
  std::array<Step, 3> recent_{};
  size_t recent_count_ = 0;
  int64_t last_end_ns_ = 0;
  double log_scale_ = 0, variance_ = -1;  // negative: unknown
};

}  // namespace odograph::step_fit
