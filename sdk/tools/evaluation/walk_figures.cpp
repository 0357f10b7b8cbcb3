// SPDX-License-Identifier: Apache-2.0
#include "sdk/math/rotation.hpp"
#include "sdk/tools/evaluation/walk_figures.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "sdk/math/time.hpp"
#include "sdk/tools/evaluation/start_alignment.hpp"

namespace odograph {
namespace {

double percent(double estimate, double truth) { return truth > 0 ? 100 * (estimate - truth) / truth : 0.0; }

void add_steps(const Recording& recording, const WalkEstimate& result, WalkFigures& f) {
  const auto& truth = recording.true_steps;
  double walked = 0, estimated = 0;
  for (const odo_step& step : truth) walked += step.length_m;
  for (const odo_step& step : result.steps) estimated += step.length_m;
  f.count_percent = percent(static_cast<double>(result.steps.size()), static_cast<double>(truth.size()));
  f.distance_percent = percent(estimated, walked);
  for (const odo_step& step : result.steps) {
    const auto nearest = std::min_element(truth.begin(), truth.end(), [&](const odo_step& a, const odo_step& b) {
      return std::abs(a.t_end_ns - step.t_end_ns) < std::abs(b.t_end_ns - step.t_end_ns);
    });
    if (nearest == truth.end() || std::abs(nearest->t_end_ns - step.t_end_ns) > 350'000'000) continue;
    f.start_ms.push_back(std::abs(static_cast<double>(step.t_start_ns - nearest->t_start_ns)) * 1e-6);
    f.end_ms.push_back(std::abs(static_cast<double>(step.t_end_ns - nearest->t_end_ns)) * 1e-6);
    f.latency_ms.push_back(static_cast<double>(step.header.t_ns - step.t_end_ns) * 1e-6);
    if (step.sigma_m > 0) f.normalised_error.push_back(std::pow((step.length_m - nearest->length_m) / step.sigma_m, 2));
  }
}

void add_modes(const Recording& recording, const WalkEstimate& result, WalkFigures& f) {
  size_t at = 0;
  const double dt =
      recording.true_states.size() > 1 ? seconds(recording.true_states[1].t_ns - recording.true_states[0].t_ns) : 0.0;
  for (const TrueState& state : recording.true_states) {
    while (at + 1 < result.modes.size() && result.modes[at + 1].header.t_ns <= state.t_ns) ++at;
    const uint32_t seen =
        result.modes.empty() || result.modes[0].header.t_ns > state.t_ns ? ODO_MODE_UNKNOWN : result.modes[at].mode;
    f.mode_all_s += dt;
    if (seen == state.mode) f.mode_right_s += dt;
  }
}

/// Inclination after the first 10 s, heading drift after half a minute, and heading error (95 % of the time) against
/// north or, without a magnetometer, against its value at that time.
void add_attitude(const Recording& recording, const WalkEstimate& result, WalkFigures& f) {
  size_t at = 0;
  double squares = 0;
  size_t n = 0;
  std::vector<double> strays;
  double first_deg = 0, last_deg = 0, first_s = -1, last_s = 0, before = 0, rotations = 0;
  for (const odo_attitude& a : result.attitudes) {
    while (at + 1 < recording.true_states.size() && recording.true_states[at].t_ns < a.header.t_ns) ++at;
    const Eigen::Quaterniond q = raw_quaternion(a.q_n_b), &truth = recording.true_states[at].q;
    const Eigen::Vector3d down = q * (truth.conjugate() * Eigen::Vector3d::UnitZ());
    const double t = seconds(a.header.t_ns - recording.true_states.front().t_ns);
    if (t < 10) continue;
    squares += std::pow(std::atan2(down.head<2>().norm(), down.z()) * 180 / EIGEN_PI, 2), ++n;
    const Eigen::Quaterniond error = q * truth.conjugate();
    double heading = 2 * std::atan2(error.z(), error.w()) * 180 / EIGEN_PI;
    heading = std::remainder(heading, 360.0);
    if (t >= 30) {
      if (first_s < 0) first_s = t, first_deg = heading, before = heading;
      rotations += std::remainder(heading - before, 360.0);
      before = heading, last_s = t, last_deg = first_deg + rotations;
      strays.push_back(std::abs((a.header.flags & ODO_ATTITUDE_MAGNETIC_NORTH) ? first_deg + rotations : rotations));
    }
  }
  if (n > 0) f.tilt_deg.push_back(std::sqrt(squares / static_cast<double>(n)));
  if (!strays.empty()) f.heading_error_deg.push_back(percentile(strays, 0.95));
  if (last_s > first_s + 30) f.drift_deg_min.push_back(std::abs(last_deg - first_deg) / (last_s - first_s) * 60);
}

}  // namespace

WalkFigures walk_figures(const Recording& recording, const WalkEstimate& estimate) {
  WalkFigures f;
  add_steps(recording, estimate, f);
  add_modes(recording, estimate, f);
  add_attitude(recording, estimate, f);
  return f;
}

double heading_drift(const std::vector<odo_attitude>& attitudes, const std::vector<StampedPose>& own) {
  std::vector<double> t_s, off_rad;
  size_t at = 0;
  for (const odo_attitude& a : attitudes) {
    while (at + 1 < own.size() && own[at + 1].t_ns <= a.header.t_ns) ++at;
    if (at + 1 >= own.size() || own[at].t_ns > a.header.t_ns) continue;
    const double w =
        static_cast<double>(a.header.t_ns - own[at].t_ns) / static_cast<double>(own[at + 1].t_ns - own[at].t_ns);
    const Eigen::Quaterniond q = raw_quaternion(a.q_n_b);
    const Eigen::Quaterniond off = q * own[at].q.slerp(w, own[at + 1].q).conjugate();
    const double heading = 2 * std::atan2(off.z(), off.w());
    const double last = off_rad.empty() ? heading : off_rad.back();
    off_rad.push_back(last + std::remainder(heading - last, 2 * EIGEN_PI));
    t_s.push_back(seconds(a.header.t_ns));
  }
  const size_t tenth = t_s.size() / 10;
  if (tenth < 10) return std::nan("");
  const auto median = [&](size_t from) {
    std::vector<double> part(off_rad.begin() + static_cast<std::ptrdiff_t>(from),
                             off_rad.begin() + static_cast<std::ptrdiff_t>(from + tenth));
    return percentile(part, 0.5);
  };
  const double seconds = t_s[t_s.size() - 1 - tenth / 2] - t_s[tenth / 2];
  return (median(t_s.size() - tenth) - median(0)) * 180 / EIGEN_PI / seconds * 60;
}

WalkedPlace place_walked_to(const Recording& recording, double walked_m) {
  const auto place_at = [&](int64_t t_ns) {
    WalkedPlace place{t_ns, 0};
    for (const odo_step& step : recording.true_steps) place.walked_m += step.t_end_ns <= t_ns ? step.length_m : 0.0;
    return place;
  };
  WalkedPlace best = place_at(recording.truth.back().t_ns);
  for (const Waypoint& mark : recording.waypoints()) {
    const WalkedPlace place = place_at(mark.t_ns);
    if (std::abs(place.walked_m - walked_m) < std::abs(best.walked_m - walked_m)) best = place;
  }
  return best;
}

std::vector<int64_t> object_fixes(const std::vector<odo_fix>& fixes) {
  constexpr uint32_t pose = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_ORIENTATION;
  std::vector<int64_t> times;
  for (const odo_fix& fix : fixes)
    if ((fix.header.flags & pose) == pose) times.push_back(fix.header.t_ns);
  std::sort(times.begin(), times.end());
  return times;
}

WalkedPlace before_objects(WalkedPlace place, const std::vector<int64_t>& object_fixes_ns) {
  constexpr int64_t kNear_ns = 20'000'000'000, kBefore_ns = 150'000'000;  // more than a frame of 10 Hz
  const int64_t at_ns = place.t_ns;
  for (auto t = object_fixes_ns.rbegin(); t != object_fixes_ns.rend(); ++t)
    if (*t <= at_ns && at_ns - *t < kNear_ns) place.t_ns = *t - kBefore_ns;
  return place;
}

StampedPoses joined(const StampedPoses& first, const StampedPoses& second, int64_t from_ns) {
  StampedPoses track;
  for (const StampedPose& pose : first)
    if (pose.t_ns < from_ns) track.push_back(pose);
  for (const StampedPose& pose : second)
    if (pose.t_ns >= from_ns) track.push_back(pose);
  return track;
}

PlaceErrors place_errors(const StampedPoses& truth, const StampedPoses& track, const std::vector<WalkedPlace>& places) {
  PlaceErrors e{statistics_of(horizontal_errors(truth, track)).mean, {}, {}};
  for (const WalkedPlace& place : places) {
    e.error_m.push_back(horizontal_error(truth, track, place.t_ns));
    e.error_percent.push_back(100 * e.error_m.back() / place.walked_m);
  }
  return e;
}

}  // namespace odograph
