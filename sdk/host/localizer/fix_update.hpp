// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sdk/host/localizer/localizer.hpp"

namespace odograph {

/// Positions and headings from outside, of any subset of components, at their own time.
class FixUpdate {
 public:
  static constexpr uint32_t kHorizontal = ODO_FIX_NORTH | ODO_FIX_EAST, kAllAxes = kHorizontal | ODO_FIX_DOWN;

  struct Parameters {
    double start_heading_rad = 0.2;   ///< rad against north without a compass; opened by the first fix
    double max_integrity_risk = 0.5;  ///< a fix that is wrong more often than not is none
    double arc_rad = 0.05;            ///< rad: a heading that is off by more turns the track first
    int max_rejected = 5;             ///< in a row: then the track is wrong; judgement
    int agreed = 10;                  ///< in a row, after which a front-end that leads is believed instead ...
    double agreed_for_s = 90;         ///< s: ... for that long; reflections last a minute (bench canyon)
  };

  /// `gate_sigma`: `coupling.fix_gate`.
  explicit FixUpdate(double gate_sigma) : gate_sigma_(gate_sigma) {}
  /// `given`: the config has a start position, `heading_given` its heading.
  void reset(bool given, bool heading_given);

  /// What a fix is compared with.
  struct Context {
    TrackPoint then, now;        ///< at the fix's time, and the newest
    Eigen::Vector3d start_n;     ///< about which n turns where the first fix tells its heading
    bool north = false;          ///< a compass has told the heading
    bool path_is_given = false;  ///< papers: a fix moves the position, not scale and heading of the path
    bool leads = false;          ///< the front-end is not to be doubted for a few fixes
    int64_t leads_since_ns = INT64_MIN;
  };
  UpdateResult use(Localizer& localizer, const odo_fix& fix, const Context& at);

  /// ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_DOWN whose place against n is known.
  uint32_t placed() const { return placed_; }
  /// Of the path, where the position was known last; below 0 nowhere.
  double fixed_m() const { return fixed_m_; }
  int64_t fixed_ns() const { return fixed_ns_; }

 private:
  bool tells_first_heading(const odo_fix& fix, const Context& at) const;
  bool outweighs_fixes(int64_t t_ns, const Context& at) const;
  void place(Localizer& localizer, Innovation<4>& seen, uint32_t axes, double now_m);
  UpdateResult rotate(Localizer& localizer, const odo_fix& fix, const Context& at);
  void agree(const odo_fix& fix, double now_m);

  Parameters p_;
  double gate_sigma_;
  bool given_ = false, heading_known_ = false;
  uint32_t placed_ = 0;
  int rejected_ = 0, agreed_ = 0;  // in a row
  double fixed_m_ = -1;
  int64_t fixed_ns_ = INT64_MIN;
};

}  // namespace odograph
