// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "plugins/step/odograph/step_finder.hpp"
#include "plugins/step/odograph/walk_signal.hpp"

namespace odograph::steps {

/// Finds the steps of purposeful walkers and of people who walk while looking through the phone, each step once. Two
/// finders process the same samples: one the acceleration smoothed by 60 ms, which detects a vivid walk quickly; the
/// other a smoother signal for slow, gentle steps, whose second harmonic is as strong as the first. A vivid walk takes
/// precedence. Does not allocate.
class GaitFinder {
 public:
  void add(const WalkSample& sample);
  /// Steps found by the last add(), in chronological order.
  std::span<const FoundStep> found() const { return {found_.data(), found_count_}; }
  bool walking() const { return vivid_.walking() || gentle_.walking(); }
  /// Start of the present walk, or end of the last one.
  int64_t since_ns() const;
  const WalkSignal& signal() const { return signal_; }
  void reset() { *this = GaitFinder(); }

 private:
  /// Within this time after a vivid step, gentle steps count as shorter vivid ones; set on the walks listed in the
  /// README.
  static constexpr int64_t kSlowingDown_ns = 10'000'000'000;
  /// Interval between two steps after which the walker has stood: longer than one missed step.
  static constexpr int64_t kStood_ns = 800'000'000;

  void take(const FoundStep& step);

  WalkSignal signal_, smoother_{0.11, 18, true};
  StepFinder vivid_, gentle_{StepFinder::Parameters::of_gentle_steps()};
  int64_t last_end_ns_ = INT64_MIN / 2;    ///< of the newest step used
  int since_stood_ = 0;                    ///< steps since then
  int64_t last_vivid_ns_ = INT64_MIN / 2;  ///< the same for vivid steps
  std::array<FoundStep, 8> waiting_{};     ///< gentle steps found during a vivid walk, newest last
  size_t waiting_count_ = 0;
  std::array<FoundStep, 40> found_{};
  size_t found_count_ = 0;
};

}  // namespace odograph::steps
