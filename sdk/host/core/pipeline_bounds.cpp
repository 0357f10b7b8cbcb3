// SPDX-License-Identifier: Apache-2.0
//
// What the local frame n cannot hold.
#include <cmath>
#include <cstdio>

#include "sdk/host/core/pipeline.hpp"

namespace odograph {

/// Whether a position lies so far from n's origin that n has no meaning there; reported.
bool Pipeline::is_beyond_frame(const odo_fix& fix) {
  const double north_m = (fix.header.flags & ODO_FIX_NORTH) ? fix.p_n[0] : 0.0;
  const double east_m = (fix.header.flags & ODO_FIX_EAST) ? fix.p_n[1] : 0.0;
  const double distance_m = std::hypot(north_m, east_m);
  if (distance_m <= Parameters{}.farthest_fix_m) return false;
  char text[160];
  std::snprintf(text, sizeof text,
                "a fix lies %.0f km from the origin of n, at most %.0f km make sense: is navigation.origin right?",
                distance_m / 1e3, Parameters{}.farthest_fix_m / 1e3);
  host_.report(fix.header.source, ODO_SEVERITY_WARNING, "far_fix", text);
  return true;
}

}  // namespace odograph
