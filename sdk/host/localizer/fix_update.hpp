// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sdk/host/localizer/localizer.hpp"
#include "sdk/host/localizer/parameters.hpp"

namespace odograph {

/// Positions and headings from outside, of any subset of components, at their own time.
class FixUpdate {
 public:
  static constexpr uint32_t kHorizontal = ODO_FIX_NORTH | ODO_FIX_EAST, kAllAxes = kHorizontal | ODO_FIX_DOWN;

  FixUpdate(const LocalizerParameters& parameters, double gate_sigma) : p_(parameters), gate_sigma_(gate_sigma) {}
  /// `given`: the config has a start position, `heading_given` its heading.
  void reset(bool given, bool heading_given);

  /// What a fix is compared with.
  struct Context {
    TrackPoint then, now;         ///< at the fix's time, and the newest
    Eigen::Vector3d start_n;      ///< about which n turns where the first fix tells its heading
    bool north = false;           ///< a compass has told the heading
    bool way_is_given = false;    ///< papers: a fix moves the position, not scale and heading of the way
    bool leads = false;           ///< the front-end is not to be doubted for a few fixes
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
  UpdateResult turn(Localizer& localizer, const odo_fix& fix, const Context& at);
  void agree(const odo_fix& fix, double now_m);

  LocalizerParameters p_;
  double gate_sigma_;
  bool given_ = false, heading_known_ = false;
  uint32_t placed_ = 0;
  int rejected_ = 0, agreed_ = 0;  // in a row
  double fixed_m_ = -1;
  int64_t fixed_ns_ = INT64_MIN;
};

}  // namespace odograph
