// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "plugins/step/odograph/length_model.hpp"
#include "plugins/step/odograph/walk_signal.hpp"

namespace odograph::steps {

/// How a walker carries the phone, told from each step's rotation rate, from how the phone hangs and from how much of
/// the acceleration is vertical: a swinging arm and a leg rotate it at the stride's rate much more than a hand that
/// holds it for its owner to see; in a pocket it stands on end; in a bag, on the body or on a leg it is thrown to and
/// fro as much as up and down. Two steps must agree.
class CarryModeClassifier {
 public:
  /// Set on the walks and simulated walkers that the README names.
  struct Parameters {
    double running_swing_mps2 = 14.0, running_hz = 2.25;  ///< above both: running
    double loose_radps = 0.92, held_radps = 0.85;         ///< mean rate of a step, to become loose and to be held again
    double on_end = 0.75, top_down = -0.5;                ///< part of up that is the phone's long axis
    double thigh_radps = 1.4;                             ///< mean rate: more than a hand that holds an upright phone
    double thigh_ends_radps = 1.1;                        ///< less, and it is no thigh any more
    double worn_part = 0.56, worn_radps = 0.45;  ///< vertical part below, rate above: a bag or the body, as a pocket
    double learn_rate = 0.15;                    ///< weight of the newest step in the rate of the last ones
    int steps_to_believe = 2;                    ///< that agree
  };
  CarryModeClassifier() : CarryModeClassifier(Parameters{}) {}
  explicit CarryModeClassifier(const Parameters& parameters) : p_(parameters) {}

  /// `up_b`: where up is in the phone's own axes.
  Carry classify(const FoundStep& step, const Eigen::Vector3d& up_b);
  /// When the present way of carrying began.
  int64_t since_ns() const { return since_ns_; }
  /// In a pocket that swings with a leg.
  bool on_leg() const { return now_ == Carry::pocket && swings_; }
  void reset() { *this = CarryModeClassifier(p_); }

 private:
  Parameters p_;
  double rate_radps_ = 0;  ///< of the last steps
  bool swings_ = false;    ///< as a thigh does
  Carry now_ = Carry::texting, next_ = Carry::texting;
  int agreed_ = 0;
  int64_t since_ns_ = 0, next_since_ns_ = 0;
};

/// Whether the hand of somebody who does not walk is still. Somebody who looks around or types pauses between: movement
/// counts for a while.
class StillnessDetector {
 public:
  /// Set on the walks and simulated walkers that the README names.
  struct Parameters {
    double moves_mps2 = 0.6, moves_radps = 0.2;  ///< standard deviation of the vertical, mean rate: one is enough
    double window_s = 0.5;                       ///< over which
    int64_t pause_ns = 4'000'000'000;            ///< for so long movement counts
  };
  StillnessDetector() : StillnessDetector(Parameters{}) {}
  explicit StillnessDetector(const Parameters& parameters) : p_(parameters) {}

  bool is_still(const WalkSignal& signal, int64_t now_ns);
  /// When the stillness or the movement began.
  int64_t since_ns() const { return since_ns_; }

 private:
  Parameters p_;
  bool still_ = true;
  int64_t last_moved_ns_ = INT64_MIN / 2, since_ns_ = 0;
};

}  // namespace odograph::steps
