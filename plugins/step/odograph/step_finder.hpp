// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "plugins/step/odograph/walk_signal.hpp"

namespace odograph::steps {

/// A step with what a length model wants to know of it.
struct FoundStep {
  int64_t t_start_ns, t_end_ns;  ///< one foot's contact to the other's
  double swing_mps2;             ///< largest less smallest smoothed vertical acceleration
  double rise_m;                 ///< of the trunk within the step: highest less lowest
  double gyro_radps;             ///< mean rotation rate
  double frequency_hz;           ///< of the steps around it
};

/// Finds the contacts of feet as peaks of the smoothed vertical acceleration: the trunk is lowest there and is pushed
/// up. A walk begins with four peaks that are alike, whose signal repeats itself and is mostly vertical; they are
/// reported together. It goes on while such steps keep coming. So waving, typing and turning on the spot, which are as
/// strong but neither regular nor vertical, are no steps. No allocation.
class StepFinder {
 public:
  /// Looks at the newest smoothed value of the signal.
  void update(const WalkSignal& signal);
  /// What the last update() found, oldest first.
  std::span<const FoundStep> found() const { return {found_.data(), found_count_}; }
  bool walking() const { return walking_; }
  /// When the walk that goes on began, or the last one ended.
  int64_t since_ns() const { return since_ns_; }
  void reset() { *this = StepFinder(); }

 private:
  struct Peak {
    size_t index;
    double t_ns;  // between samples
    double value, low;
    double upright;  // the vertical part of the power around it
  };
  void confirm(const WalkSignal& signal);
  void begin(const WalkSignal& signal);
  void go_on(const WalkSignal& signal);
  double repetition(const WalkSignal& signal, double interval_s, size_t intervals) const;
  void emit(const WalkSignal& signal, const Peak& from, const Peak& to);
  double interval_s(size_t newer) const;

  bool walking_ = false;
  int64_t since_ns_ = 0;
  bool candidate_ = false;
  Peak best_{};
  double low_ = 1e9;
  std::array<Peak, 8> peaks_{};  // the last ones, newest last
  size_t peak_count_ = 0;
  int stray_ = 0;
  double typical_swing_ = 0, typical_s_ = 0.55;
  std::array<FoundStep, 8> found_{};
  size_t found_count_ = 0;
};

}  // namespace odograph::steps
