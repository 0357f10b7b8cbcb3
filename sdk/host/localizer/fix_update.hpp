// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sdk/host/localizer/localizer.hpp"

namespace odograph {

/// Updates from position and heading fixes, with any subset of components, at the time of the fix.
class FixUpdate {
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

  /// `gate_sigma`: `coupling.fix_gate`.
  explicit FixUpdate(double gate_sigma) : gate_sigma_(gate_sigma) {}
  /// `given`: the config has a start position; `heading_given`: it has a start heading.
  void reset(bool given, bool heading_given);

  /// The state of the track that a fix is compared with.
  struct Context {
    TrackPoint then, now;        ///< at the fix's time, and the newest
    Eigen::Vector3d start_n;     ///< centre of the rotation of n when the first fix gives the heading
    bool north = false;          ///< a compass has given the heading
    bool path_is_given = false;  ///< paper mode: a fix moves the position, not the scale and heading of the path
    bool has_priority = false;   ///< the front-end may outweigh a few fixes
    int64_t priority_since_ns = INT64_MIN;
  };
  UpdateResult use(Localizer& localizer, const odo_fix& fix, const Context& at);

  /// ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_DOWN: the axes whose position in n is known.
  uint32_t placed() const { return placed_; }
  /// Path length at which the position was last fixed, m; negative if it never was.
  double fixed_m() const { return fixed_m_; }
  int64_t fixed_ns() const { return fixed_ns_; }

 private:
  bool is_first_heading(const odo_fix& fix, const Context& at) const;
  bool outweighs_fixes(int64_t t_ns, const Context& at) const;
  void place(Localizer& localizer, Innovation& seen, uint32_t axes, double now_m);
  UpdateResult rotate(Localizer& localizer, const odo_fix& fix, const Context& at);
  void accept(const odo_fix& fix, double now_m);

  Parameters p_;
  double gate_sigma_;
  bool given_ = false, heading_known_ = false;
  uint32_t placed_ = 0;
  int rejected_ = 0, accepted_ = 0;  // consecutive
  double fixed_m_ = -1;
  int64_t fixed_ns_ = INT64_MIN;
};

}  // namespace odograph
