// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "sdk/math/time.hpp"
#include "sdk/tools/page/run_page.hpp"

namespace odograph {
namespace {

constexpr double kTogether_s = 0.05;  // maximum time difference of matched poses
constexpr double kFit_m = 10;         // of the waypoints, over which a track is aligned

bool is_metric(const Recording& recording, const RunResult& result) {
  const auto knows = [](const odo_vo_motion& motion) { return (motion.header.flags & ODO_VO_METRIC) != 0; };
  return !result.scales.empty() || !result.steps.empty() || !recording.has(ODO_TYPE_FRAME) ||
         std::any_of(result.motions.begin(), result.motions.end(), knows);
}

}  // namespace

double AlignedRun::rms_m() const {
  double squares = 0;
  for (const auto& [t, error] : error_m) squares += error * error;
  return error_m.empty() ? 0 : std::sqrt(squares / static_cast<double>(error_m.size()));
}

AlignedRun align_to_truth(const Recording& recording, const RunResult& result, std::optional<Alignment> alignment) {
  AlignedRun aligned;
  aligned.metric = is_metric(recording, result);
  const StampedPoses& track = result.track;
  if (track.empty()) return aligned;
  const auto since_start = [&](int64_t t_ns) { return seconds(t_ns - track.front().t_ns); };
  StampedPoses from, to;
  if (!recording.truth.empty()) {
    const Pairs pairs = associate(recording.truth, track, kTogether_s);
    if (pairs.reference.size() < 3) return aligned;
    from = pairs.estimate;
    const Alignment used = alignment.value_or(aligned.metric ? Alignment::yaw : Alignment::sim3);
    to = align(pairs, used, &aligned.scale);
    if (aligned.metric && used == Alignment::yaw) aligned.scale_part = scale_part(pairs.reference, to);
    for (size_t k = 0; k < to.size(); ++k)
      aligned.error_m.emplace_back(since_start(to[k].t_ns), (to[k].p - pairs.reference[k].p).norm());
  } else {
    const auto waypoints = recording.waypoints();
    if (waypoints.size() < 2) return aligned;
    from = track;
    to = align_to_waypoints(track, waypoints, heading_offset(track, waypoints, kFit_m));
    for (const Waypoint& w : waypoints)
      aligned.error_m.emplace_back(since_start(w.t_ns), (position_at(to, w.t_ns) - w.p_n).head<2>().norm());
  }
  aligned.to_truth.q = (to[0].q * from[0].q.conjugate()).normalized();
  aligned.to_truth.p = to[0].p - aligned.scale * (aligned.to_truth.q * from[0].p);
  return aligned;
}

}  // namespace odograph
