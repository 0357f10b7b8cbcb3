// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

namespace odograph::gait {

/// A detected step: from one peak of the gait signal to the next.
struct DetectedStep {
  int64_t t_start_ns;
  int64_t t_end_ns;
  double swing_mps2;     ///< maximum minus minimum of the signal within the step
  double mean_abs_mps2;  ///< mean of its absolute value
  double mean_mps2;      ///< mean
  double peak_mps2;      ///< maximum
};

/// Peaks of the gait signal above an adaptive threshold, with a refractory time and a maximum step duration. A parabola
/// through three samples refines the time of a peak, which is shortly after the foot's contact. Does not allocate.
class StepDetector {
 public:
  struct Parameters {
    double min_peak_mps2 = 0.35;     ///< smaller peaks are not steps
    double relative_peak = 0.35;     ///< nor are peaks below this fraction of the recent ones
    double min_interval_s = 0.30;    ///< 3.3 steps per second
    double max_interval_s = 1.1;     ///< after a longer pause a new step starts
    double start_interval_s = 0.55;  ///< assumed duration of the first step after a pause
    double confirm_s = 0.12;         ///< time for which a peak must stay the highest
  };

  explicit StepDetector(const Parameters& parameters) : p_(parameters) {}

  /// Adds the next value of the signal; returns a step when one is confirmed. `active` is false while standing.
  std::optional<DetectedStep> update(int64_t t_ns, double value, bool active);
  /// Time from a step to the detection of the next one, at most.
  int64_t longest_ns() const { return static_cast<int64_t>((p_.max_interval_s + p_.confirm_s) * 1e9); }

 private:
  std::optional<DetectedStep> confirm();

  Parameters p_;
  bool started_ = false;
  int64_t last_ns_ = 0;
  double last_value_ = 0.0, previous_value_ = 0.0;
  int64_t previous_ns_ = 0;
  double typical_peak_ = 0.0;
  // Candidate peak, and extremes since the last step.
  bool candidate_ = false;
  int64_t candidate_ns_ = 0;
  double candidate_value_ = 0.0;
  double lowest_ = 0.0, lowest_before_candidate_ = 0.0;
  double absolute_sum_ = 0.0, sum_ = 0.0;
  int count_ = 0;
  int64_t last_step_ns_ = INT64_MIN / 2;
};

}  // namespace odograph::gait
