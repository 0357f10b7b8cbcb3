// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "plugins/step/odograph/length_model.hpp"
#include "plugins/step/odograph/walk_signal.hpp"

namespace odograph::steps {

/// Carrying mode of the phone, from each step's angular rate, the phone's inclination and the vertical part of the
/// acceleration. A swinging arm and a leg rotate the phone at the stride rate much more than a hand holding it for
/// viewing; in a pocket it stands on end; in a bag, on the body or on a leg the horizontal acceleration is as large as
/// the vertical one. Two consecutive steps must agree.
class CarryModeClassifier {
 public:
  /// Set on the walks and simulated walkers listed in the README.
  struct Parameters {
    double running_swing_mps2 = 14.0, running_hz = 2.25;  ///< above both: running
    double loose_radps = 0.92, held_radps = 0.85;         ///< mean rate of a step: enter and leave the loose mode
    double on_end = 0.75, top_down = -0.5;                ///< component of up along the phone's long axis
    double thigh_radps = 1.4;                             ///< mean rate above that of a hand holding the phone upright
    double thigh_ends_radps = 1.1;                        ///< below it the phone is no longer on a thigh
    double worn_part = 0.56, worn_radps = 0.45;  ///< vertical part below and rate above: bag or body, treated as pocket
    double learn_rate = 0.15;                    ///< weight of the newest step in the mean rate
    int min_agreeing_steps = 2;                  ///< consecutive agreeing steps
  };
  CarryModeClassifier() : CarryModeClassifier(Parameters{}) {}
  explicit CarryModeClassifier(const Parameters& parameters) : p_(parameters) {}

  /// `up_b`: direction of up in b.
  CarryMode classify(const FoundStep& step, const Eigen::Vector3d& up_b);
  /// Start of the present carrying mode.
  int64_t since_ns() const { return since_ns_; }
  /// In a pocket that swings with a leg.
  bool on_leg() const { return now_ == CarryMode::pocket && swings_; }
  void reset() { *this = CarryModeClassifier(p_); }

 private:
  Parameters p_;
  double rate_radps_ = 0;  ///< of the last steps
  bool swings_ = false;    ///< swings like a thigh
  CarryMode now_ = CarryMode::texting, next_ = CarryMode::texting;
  int agreed_ = 0;
  int64_t since_ns_ = 0, next_since_ns_ = 0;
};

/// Detects whether the hand of a standing person is still. A person who looks around or types pauses between movements,
/// so that movement counts for a while.
class StillnessDetector {
 public:
  /// Set on the walks and simulated walkers listed in the README.
  struct Parameters {
    double moves_mps2 = 0.6, moves_radps = 0.2;  ///< standard deviation of the vertical, mean rate: either is enough
    double window_s = 0.5;                       ///< over which
    int64_t pause_ns = 4'000'000'000;            ///< time for which movement counts
  };
  StillnessDetector() : StillnessDetector(Parameters{}) {}
  explicit StillnessDetector(const Parameters& parameters) : p_(parameters) {}

  bool is_still(const WalkSignal& signal, int64_t now_ns);
  /// Start of the present stillness or movement.
  int64_t since_ns() const { return since_ns_; }

 private:
  Parameters p_;
  bool still_ = true;
  int64_t last_moved_ns_ = INT64_MIN / 2, since_ns_ = 0;
};

}  // namespace odograph::steps
