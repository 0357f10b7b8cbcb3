// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdio>
#include <string>

#include <odograph/types.h>

#include "sdk/host/fusion/outputs.hpp"
#include "sdk/host/plugin_host/services.hpp"

namespace odograph {

/// m from the origin of n. Beyond it, the vertical of n is off by more than 0.9 degrees (100 km / 6371 km) and its
/// plane lies 785 m above the ground, so either the origin or the fix is wrong.
inline constexpr double kFarthestFix_m = 100e3;

/// Whether a position is so far from the origin of n that n is meaningless there; reported.
inline bool is_beyond_frame(const odo_fix& fix, HostServices& host) {
  const double north_m = (fix.header.flags & ODO_FIX_NORTH) ? fix.p_n[0] : 0.0;
  const double east_m = (fix.header.flags & ODO_FIX_EAST) ? fix.p_n[1] : 0.0;
  const double distance_m = std::hypot(north_m, east_m);
  if (distance_m <= kFarthestFix_m) return false;
  char text[160];
  std::snprintf(text, sizeof text,
                "a fix lies %.0f km from the origin of n, expected at most %.0f km: is navigation.origin right?",
                distance_m / 1e3, kFarthestFix_m / 1e3);
  host.report(fix.header.source, ODO_SEVERITY_WARNING, "far_fix", text);
  return true;
}

/// Marks a recognised place that was used; one that was not is reported. Whether it was.
inline bool take_verdict(odo_header& place, const UpdateResult& result, HostServices& host) {
  if (result.accepted) place.flags |= ODO_FLAG_ACCEPTED;
  if (!result.accepted && result.dof > 0)
    host.report(place.source, ODO_SEVERITY_INFO, "rejected_place",
                "a recognised place was rejected: it contradicts the track by more than both allow");
  return result.accepted;
}

/// False: a motion of another camera than the main one has no effect.
inline bool report_other_camera(const odo_vo_motion& motion, int64_t main_camera, HostServices& host) {
  host.report(motion.header.source, ODO_SEVERITY_WARNING, "other_camera",
              "a motion of camera " + std::to_string(motion.camera) + "; expected one of the main camera, " +
                  std::to_string(main_camera),
              ODO_E_ARGUMENT);
  return false;
}

}  // namespace odograph
