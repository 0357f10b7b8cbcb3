// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "sdk/math/ring.hpp"

namespace odograph::step_scale {

struct Displacement {
  double metres;
  double relative_sigma;
};

/// D_step of Antigny et al. 2019, eq. (6): the metric displacement between two images, interpolated linearly in time
/// from step lengths. During step k+1 the speed is that of step k, step_k / dt_step_k; over an interval that touches
/// several steps the parts add up. Does not allocate.
class StepInterpolation {
 public:
  /// Without another step the walker is assumed to stand `hold` step durations after the end of a step.
  explicit StepInterpolation(double hold) : hold_(hold) {}

  void add_step(int64_t t_start_ns, int64_t t_end_ns, double length_m, double sigma_m);
  /// The walker stands from here on, until the next step.
  void stand(int64_t t_ns) { standing_since_ns_ = t_ns; }

  /// Displacement from t0 to t1; nothing before the first step.
  std::optional<Displacement> between(int64_t t0_ns, int64_t t1_ns) const;

 private:
  struct Step {
    int64_t t_end_ns;
    double duration_s;
    double speed_mps;
    double relative_sigma;
  };

  double hold_;
  Ring<Step, 16> steps_;
  int64_t standing_since_ns_ = INT64_MAX;
};

}  // namespace odograph::step_scale
