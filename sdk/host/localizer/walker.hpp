// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "sdk/host/localizer/front_end.hpp"
#include "sdk/host/localizer/step_update.hpp"
#include "sdk/host/localizer/tracker.hpp"
#include "sdk/math/ring.hpp"

namespace odograph {

/// A walker's steps: compared with the front-end where it moved meanwhile, the motion itself where it did not. They
/// wait until it has answered for their time, or will not.
class Walker {
 public:
  Walker(Tracker& tracker, FrontEnd& front_end) : tracker_(tracker), front_end_(front_end) {}
  void reset();
  /// At the start of a track.
  void start() { update_.reset(tracker_.localizer); }

  void add(const odo_step& step);
  /// Steps of a time that is decided by now. What they moved the body by, in n, m.
  Eigen::Vector3d settle(int64_t now_ns);
  /// The papers' rule: a step moves the track, whole, while the front-end does not. The same.
  Eigen::Vector3d carry_as_in_papers(const odo_step& step);

  bool any() const { return update_.any(); }
  /// Whether steps have moved the track since the last call, and up to when.
  bool take_carried() { return std::exchange(carried_, false); }
  int64_t carried_ns() const { return carried_ns_; }
  /// The front-end's metric scale has come into doubt, or out of it.
  Notice take_notice() { return std::exchange(notice_, {}); }

 private:
  Eigen::Vector3d carry(const odo_step& step, double share);
  void pop();
  void learn_scale();
  void compare(const odo_step& step);

  Tracker& tracker_;
  FrontEnd& front_end_;
  StepUpdate update_;
  Ring<odo_step, 16> waiting_;
  size_t count_ = 0;     // of those that wait
  size_t compared_ = 0;  // of these, the oldest, with an unscaled front-end
  int64_t carried_ns_ = INT64_MIN;
  bool carried_ = false;
  Notice notice_;
};

}  // namespace odograph
