// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "sdk/host/localizer/front_end.hpp"
#include "sdk/host/localizer/step_update.hpp"
#include "sdk/host/localizer/tracker.hpp"
#include "sdk/math/ring.hpp"

namespace odograph {

/// A walker's steps: compared with the front-end where it moved meanwhile; otherwise they move the track. Each waits
/// until the front-end has covered its time or has gone silent.
class Walker {
 public:
  Walker(Tracker& tracker, FrontEnd& front_end) : tracker_(tracker), front_end_(front_end) {}
  void reset();
  /// At the start of a track.
  void start() { update_.reset(tracker_.localizer); }

  void add(const odo_step& step);
  /// Processes the steps whose time is settled by now. Returns their displacement of the body in n, m.
  Eigen::Vector3d settle(int64_t now_ns);
  /// Paper mode: a whole step moves the track while the front-end does not. Returns its displacement in n, m.
  Eigen::Vector3d apply_paper_step(const odo_step& step);

  bool any() const { return update_.any(); }
  /// Whether steps have moved the track since the last call.
  bool take_moved() { return std::exchange(moved_, false); }
  int64_t moved_ns() const { return moved_ns_; }
  /// A change of the verdict on the front-end's metric scale.
  Notice take_notice() { return std::exchange(notice_, {}); }

 private:
  Eigen::Vector3d apply_step(const odo_step& step, double share);
  void pop();
  void estimate_scale();
  void compare(const odo_step& step);

  Tracker& tracker_;
  FrontEnd& front_end_;
  StepUpdate update_;
  Ring<odo_step, 16> waiting_;
  size_t count_ = 0;     // of waiting steps
  size_t compared_ = 0;  // of these, the oldest, already compared with an unscaled front-end
  int64_t moved_ns_ = INT64_MIN;
  bool moved_ = false;
  Notice notice_;
};

}  // namespace odograph
