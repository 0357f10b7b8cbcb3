// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "plugins/step/odograph/length_model.hpp"
#include "plugins/step/odograph/walk_signal.hpp"

namespace odograph::steps {

/// How a walker carries the phone, told from each step's rotation rate and from how the phone hangs: a swinging arm and
/// a pocket turn it at the stride's rate much more than a hand that holds it for its owner to see; in a pocket it
/// stands on end. Two steps must agree.
class CarryJudge {
 public:
  /// `up_b`: where up is in the phone's own axes.
  Carry judge(const FoundStep& step, const Eigen::Vector3d& up_b);
  /// When the present way of carrying began.
  int64_t since_ns() const { return since_ns_; }
  void reset() { *this = CarryJudge(); }

 private:
  Carry now_ = Carry::texting, next_ = Carry::texting;
  int agreed_ = 0;
  int64_t since_ns_ = 0, next_since_ns_ = 0;
};

/// Whether the hand of somebody who does not walk is still. Somebody who looks around or types pauses between: movement
/// counts for a while.
class HandJudge {
 public:
  bool is_still(const WalkSignal& signal, int64_t now_ns);
  /// When the stillness or the movement began.
  int64_t since_ns() const { return since_ns_; }

 private:
  bool still_ = true;
  int64_t last_moved_ns_ = INT64_MIN / 2, since_ns_ = 0;
};

}  // namespace odograph::steps
