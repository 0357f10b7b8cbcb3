// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sdk/host/fusion/pose_filter.hpp"

namespace odograph {

/// Updates from position and heading fixes, with any subset of components, at the time of the fix.
class Fixes {
 public:
  static constexpr uint32_t kHorizontal = ODO_FIX_NORTH | ODO_FIX_EAST, kAllAxes = kHorizontal | ODO_FIX_DOWN;

  struct Parameters {
    double start_heading_rad = 0.2;   ///< rad against north without a compass; applied at the first fix
    double max_integrity_risk = 0.5;  ///< a fix that is more likely wrong than right is ignored
    double arc_rad = 0.05;            ///< rad: a larger heading error is corrected before the position
    int max_rejected = 5;             ///< consecutive rejections, after which the track is assumed wrong; judgement
    int min_accepted = 10;  ///< consecutive acceptances, after which a metric inertial front-end outweighs fixes ...
    double accepted_for_s = 90;  ///< s: ... for that long; reflections last a minute (bench canyon)
  };

  /// `gate_sigma`: `coupling.fix_gate`. `given`: the config has a start position; `heading_given`: a start heading.
  Fixes(double gate_sigma, bool given, bool heading_given)
      : gate_sigma_(gate_sigma),
        heading_known_(heading_given || given),
        placed_(given ? kAllAxes : 0),
        ever_placed_(placed_) {}

  /// The state of the track that a fix is compared with.
  struct Context {
    TrackPoint then, now;       ///< at the fix's time, and the newest
    double then_sigma_m = 0;    ///< of the former, horizontally, if it is ahead of the latter
    Eigen::Vector3d start_n;    ///< centre of the rotation of n when the first fix gives the heading
    bool north = false;         ///< a compass has given the heading
    bool has_priority = false;  ///< the front-end may outweigh a few fixes
    Instant priority_since;
    /// States that a fix does not change: by its heading, and by its position.
    StateSet kept_by_heading, kept_by_position;
  };
  UpdateResult use(PoseFilter& filter, const odo_fix& fix, const Context& at);

  /// ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_DOWN: the axes whose position in n is known.
  uint32_t placed() const { return placed_; }
  /// Time of the newest accepted horizontal position.
  Instant fixed() const { return fixed_; }
  /// Whether a fix was accepted.
  bool any() const { return any_; }
  /// Sum of the vertical shifts of n, m downwards: first heights, not corrections.
  double moved_down_m() const { return moved_down_m_; }

 private:
  bool is_first_heading(const odo_fix& fix, const Context& at) const;
  bool outweighs_fixes(int64_t t_ns, const Context& at) const;
  UpdateResult try_on(PoseFilter& filter, const odo_fix& fix, const Context& at);
  void place(PoseFilter& filter, Innovation& seen, uint32_t axes, const Context& at);
  UpdateResult rotate(PoseFilter& filter, const odo_fix& fix, const Context& at);
  void accept(const odo_fix& fix, double now_m);

  Parameters p_;
  double gate_sigma_;
  bool heading_known_;
  uint32_t placed_, ever_placed_;
  int rejected_ = 0, accepted_ = 0;            // consecutive
  double fixed_m_[3] = {}, moved_down_m_ = 0;  // by axis, path length at which the position was last fixed, m
  Instant fixed_;
  bool any_ = false;
};

}  // namespace odograph
