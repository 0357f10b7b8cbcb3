// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <odograph/plugin.hpp>

namespace {

/// Fixes at positions confirmed by the user (a tap on a map, a surveyed mark).
class Waypoint {
 public:
  std::string use = "first";
  double min_sigma = 0.1;

  static constexpr odo::Description description{
      "fix/waypoint", "1.0.0", "Position fixes at positions confirmed by the user", ODO_INTERFACE_ABSOLUTE_FIXER};
  static std::vector<odo::Parameter<Waypoint>> parameters() {
    return {
        odo::choice("use", "first|all", &Waypoint::use, "first: only at the start of the track; all: every waypoint"),
        odo::real("min_sigma", "m", 0.001, 100, &Waypoint::min_sigma, "lower bound of the standard deviation")};
  }

  void on(const odo_waypoint& waypoint, odo::Output& output) {
    if (use == "first" && used_++ > 0) return;
    auto fix = odo::make<odo_fix>(waypoint.header.t_ns);
    fix.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE | ODO_FIX_INTEGRITY;
    if (waypoint.header.flags & ODO_WAYPOINT_VERTICAL) fix.header.flags |= ODO_FIX_DOWN;
    std::copy(waypoint.p_n, waypoint.p_n + 3, fix.p_n);
    if (waypoint.header.flags & ODO_WAYPOINT_LEVER) {
      fix.header.flags |= ODO_FIX_LEVER;
      std::copy(waypoint.lever_b, waypoint.lever_b + 3, fix.lever_b);
    }
    const double sigma = std::max(min_sigma, waypoint.sigma_m);
    for (int i = 0; i < 3; ++i) fix.covariance_n[4 * i] = sigma * sigma;
    fix.integrity = 0.01;
    output.emit(fix);
  }

 private:
  int used_ = 0;
};

}  // namespace

ODO_PLUGIN(Waypoint)
