// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "plugins/step/odograph/step_finder.hpp"
#include "plugins/step/odograph/walk_signal.hpp"

namespace odograph::steps {

/// Steps of walkers who want to get somewhere and of those who look at the world through their phone, each step once.
/// Two finders look at the same samples: one at the acceleration smoothed by 60 ms, which knows a vivid walk at once,
/// the other at a smoother one for slow, gentle steps, whose second harmonic is as strong as the first. While there is
/// a vivid walk it is the one that counts. No allocation.
class GaitFinder {
 public:
  void add(const WalkSample& sample);
  /// What the last add() found, in order of time.
  std::span<const FoundStep> found() const { return {found_.data(), found_count_}; }
  bool walking() const { return vivid_.walking() || gentle_.walking(); }
  /// When the walk that goes on began, or the last one ended.
  int64_t since_ns() const;
  const WalkSignal& signal() const { return signal_; }
  void reset() { *this = GaitFinder(); }

 private:
  /// After a vivid step a gentle one is a shorter one of the same manner; set on the walks that the README names.
  static constexpr int64_t kSlowingDown_ns = 10'000'000'000;
  /// Between two steps, after which he has stood: more than a step that was missed.
  static constexpr int64_t kStood_ns = 800'000'000;

  void take(const FoundStep& step);

  WalkSignal signal_, smoother_{0.11, 18, true};
  StepFinder vivid_, gentle_{StepFinder::Parameters::of_gentle_steps()};
  int64_t last_end_ns_ = INT64_MIN / 2;    ///< of the newest step that counted
  int since_stood_ = 0;                    ///< steps since then
  int64_t last_vivid_ns_ = INT64_MIN / 2;  ///< the same of the vivid ones
  std::array<FoundStep, 8> waiting_{};     ///< gentle ones found while a vivid walk went on, the newest last
  size_t waiting_count_ = 0;
  std::array<FoundStep, 40> found_{};
  size_t found_count_ = 0;
};

}  // namespace odograph::steps
