// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/evaluation/walk_truth.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "sdk/host/fusion/floors.hpp"
#include "sdk/math/time.hpp"

namespace odograph {
namespace {

using Eigen::Vector2d;

/// About one stride to each side, to remove the motion of leg or hand.
constexpr int64_t kSmooth_ns = 500'000'000;
/// Two strides: shorter displacements are dominated by body sway.
constexpr int64_t kStretch_ns = 2'000'000'000;

StampedPoses smoothed(const StampedPoses& truth) {
  StampedPoses out;
  size_t from = 0, to = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int64_t next_ns = truth.empty() ? 0 : truth.front().t_ns;
  for (const StampedPose& pose : truth) {
    for (; to < truth.size() && truth[to].t_ns <= pose.t_ns + kSmooth_ns; ++to) sum += truth[to].p;
    for (; truth[from].t_ns < pose.t_ns - kSmooth_ns; ++from) sum -= truth[from].p;
    if (pose.t_ns < next_ns) continue;
    out.push_back({pose.t_ns, pose.q, sum / static_cast<double>(to - from)});
    next_ns += kSmooth_ns / 5;
  }
  return out;
}

TrueStretch between(const Waypoint& a, const Waypoint& b) {
  const Vector2d d = (b.p_n - a.p_n).head<2>();
  return {a.t_ns, b.t_ns, d.norm(), std::atan2(d.y(), d.x())};
}

/// Reference positions: every two seconds of a path, or the waypoints.
std::vector<Waypoint> places_of(const Recording& recording, const StampedPoses& path) {
  if (path.empty()) return recording.waypoints();
  std::vector<Waypoint> places;
  for (const StampedPose& pose : path)
    if (places.empty() || pose.t_ns >= places.back().t_ns + kStretch_ns) places.push_back({pose.t_ns, pose.p});
  return places;
}

std::vector<TrueStretch> stretches_of(const Recording& recording, const std::vector<Waypoint>& places) {
  std::vector<TrueStretch> all;
  for (size_t i = 1; i < places.size(); ++i) all.push_back(between(places[i - 1], places[i]));
  const auto& wheel = recording.true_distances;
  constexpr double kStretch_m = 10;  // a trundle wheel clicks once a metre, sometimes late
  for (size_t i = 1, from = 0; i < wheel.size(); ++i)
    if (wheel[i].walked_m - wheel[from].walked_m >= kStretch_m)
      all.push_back({wheel[from].t_ns, wheel[i].t_ns, wheel[i].walked_m - wheel[from].walked_m, std::nan("")}),
          from = i;
  return all;
}

/// Length, number and duration of the steps within a time, and the sum of their standard deviations.
struct Walked {
  double length_m = 0, sigma_m = 0, count = 0, walked_s = 0;
};
Walked walked(const std::vector<odo_step>& steps, int64_t from_ns, int64_t to_ns) {
  Walked sum;
  for (const odo_step& step : steps) {
    const int64_t inside = std::min(to_ns, step.t_end_ns) - std::max(from_ns, step.t_start_ns);
    if (inside <= 0) continue;
    const double part = static_cast<double>(inside) / static_cast<double>(step.t_end_ns - step.t_start_ns);
    sum.length_m += part * step.length_m, sum.sigma_m += part * step.sigma_m, sum.count += part;
    sum.walked_s += seconds(inside);
  }
  return sum;
}

void add_distance(const std::vector<odo_step>& steps, const std::vector<TrueStretch>& stretches,
                  const StampedPoses& path, WalkTruthFigures& f) {
  f.true_m = f.estimated_m = std::nan("");
  if (stretches.empty()) return;
  f.true_m = 0;
  for (const TrueStretch& s : stretches) f.true_m += s.length_m;
  if (!path.empty()) {  // its bends count
    f.true_m = 0;
    for (size_t i = 1; i < path.size(); ++i) f.true_m += (path[i].p - path[i - 1].p).head<2>().norm();
  }
  f.from_ns = stretches.front().from_ns, f.to_ns = stretches.back().to_ns;
  const Walked whole = walked(steps, f.from_ns, f.to_ns);
  f.estimated_m = whole.length_m, f.counted = whole.count, f.walked_s = whole.walked_s, f.sigma_m = whole.sigma_m;
  for (const TrueStretch& s : stretches) {
    const Walked own = walked(steps, s.from_ns, s.to_ns);
    const double whole_s = seconds(s.to_ns - s.from_ns);
    if (own.sigma_m > 0 && s.length_m > 0.5 * whole_s &&
        whole_s < 20)  // at rest and in bends, the displacement is not a length
      f.normalised_error.push_back(std::pow((own.length_m - s.length_m) / own.sigma_m, 2));
  }
}

/// Least-squares alignment of the track with the reference positions; its rms and the directions of its stretches.
void add_position(const StampedPoses& track, const std::vector<Waypoint>& places, WalkTruthFigures& f) {
  f.position_m = std::nan("");
  if (places.size() < 2 || track.empty()) return;
  Pairs pairs;
  for (const Waypoint& place : places) {
    pairs.reference.push_back({place.t_ns, Eigen::Quaterniond::Identity(), place.p_n});
    pairs.estimate.push_back({place.t_ns, Eigen::Quaterniond::Identity(), position_at(track, place.t_ns)});
  }
  const StampedPoses aligned = align(pairs, Alignment::yaw, nullptr);
  double squares = 0;
  for (size_t i = 0; i < aligned.size(); ++i) {
    squares += (aligned[i].p - places[i].p_n).head<2>().squaredNorm();
    if (i == 0) continue;
    const Vector2d a = (aligned[i].p - aligned[i - 1].p).head<2>(), b = (places[i].p_n - places[i - 1].p_n).head<2>();
    if (a.norm() > 0.5 && b.norm() > 0.5)
      f.heading_deg.push_back(std::abs(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b))) * 180 / EIGEN_PI);
  }
  f.position_m = std::sqrt(squares / static_cast<double>(aligned.size()));
}

/// Composes the steps along their own headings.
WalkTruthFigures::Composed composed_errors(const std::vector<odo_step>& steps, double fixed_m,
                                           const std::vector<Waypoint>& places) {
  const bool headings =
      std::all_of(steps.begin(), steps.end(), [](const odo_step& s) { return s.header.flags & ODO_STEP_HEADING; });
  if (places.size() < 2 || steps.empty() || !headings) return {std::nan(""), std::nan("")};
  StampedPoses composed{{steps.front().t_start_ns, Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero()}};
  for (const odo_step& step : steps) {
    StampedPose next = composed.back();
    if (step.t_start_ns > next.t_ns) next.t_ns = step.t_start_ns, composed.push_back(next);
    const double length = fixed_m > 0 ? fixed_m : step.length_m;
    next.p += length * Eigen::Vector3d(std::cos(step.heading_rad), std::sin(step.heading_rad), 0);
    if (step.t_end_ns > next.t_ns) next.t_ns = step.t_end_ns, composed.push_back(next);
  }
  const auto from_first = [&](const Waypoint& place) -> std::pair<Vector2d, Vector2d> {
    return {(position_at(composed, place.t_ns) - position_at(composed, places.front().t_ns)).head<2>(),
            (place.p_n - places.front().p_n).head<2>()};
  };
  double along = 0, across = 0;
  for (const Waypoint& place : places) {
    const auto [a, b] = from_first(place);
    along += a.dot(b), across += a.x() * b.y() - a.y() * b.x();
  }
  const Eigen::Rotation2Dd rotation(std::atan2(across, along));
  WalkTruthFigures::Composed errors{};
  for (const Waypoint& place : places) {
    const auto [a, b] = from_first(place);
    errors.end_m = (rotation * a - b).norm();
    errors.mean_m += errors.end_m / static_cast<double>(places.size() - 1);  // the first position has no error
  }
  return errors;
}

void add_floors(const Recording& recording, const StampedPoses& track, WalkTruthFigures& f) {
  constexpr double kFloor_m = 3;  // minimum height between two floors
  const auto& floors = recording.true_floors;
  for (size_t i = 1; i < floors.size(); ++i) {
    const double up_m = -(position_at(track, floors[i].t_ns) - position_at(track, floors[i - 1].t_ns)).z();
    const int changed = floors[i].floor - floors[i - 1].floor;
    const double told = std::abs(up_m) < 0.5 * kFloor_m ? 0 : up_m;
    f.floors += changed != 0;
    f.wrong_floors += (told > 0) - (told < 0) != (changed > 0) - (changed < 0);
  }
}

/// Floor numbers, each relative to the first place.
void add_floor_numbers(const Recording& recording, const StampedPoses& track, WalkTruthFigures& f) {
  f.floor_probability = std::nan("");
  const auto& places = recording.true_floors;
  if (places.empty() || track.empty()) return;
  FloorEstimator floors;
  int32_t first = 0;
  size_t done = 0;
  double probabilities = 0;
  for (const auto& place : places) {
    for (; done < track.size() && track[done].t_ns <= place.t_ns; ++done)
      floors.add(track[done].t_ns, -track[done].p.z());
    const auto [floor, probability] = floors.floor();
    if (f.floor_places == 0) first = floor;
    ++f.floor_places, f.floor_right += floor - first == place.floor - places.front().floor;
    probabilities += probability;
  }
  f.floor_probability = probabilities / f.floor_places;
}

}  // namespace

size_t plain_peak_count(const Recording& recording) {
  constexpr double kSmooth_s = 0.1, kMean_s = 1, kMinPeak_mps2 = 0.5, kApart_s = 0.3;
  double smooth = 0, mean = 0, before = 0;
  int64_t last_ns = INT64_MIN, peak_ns = INT64_MIN / 2;
  bool rises = false;
  size_t count = 0;
  for (const auto& m : recording.messages) {
    if (m.message.header().type != ODO_TYPE_IMU || !(m.message.header().flags & ODO_IMU_ACCEL)) continue;
    const auto& imu = as<odo_imu>(m.message.header());
    const double norm = Eigen::Vector3d(imu.accel_b).norm();
    if (last_ns == INT64_MIN) smooth = mean = norm, last_ns = imu.header.t_ns;
    const double dt = seconds(imu.header.t_ns - std::exchange(last_ns, imu.header.t_ns));
    smooth += -std::expm1(-dt / kSmooth_s) * (norm - smooth), mean += -std::expm1(-dt / kMean_s) * (norm - mean);
    const double value = smooth - mean;
    if (rises && value < before && before > kMinPeak_mps2 && seconds(imu.header.t_ns - peak_ns) > kApart_s)
      ++count, peak_ns = imu.header.t_ns;
    if (value != before) rises = value > before;
    before = value;
  }
  return count;
}

WalkTruthFigures walk_truth_figures(const Recording& recording, const std::vector<odo_step>& steps,
                                    const StampedPoses& track) {
  WalkTruthFigures f;
  f.true_steps = static_cast<double>(recording.true_steps.size());
  f.peaks = static_cast<double>(plain_peak_count(recording));
  const auto percent = [&](double count) {
    return f.true_steps > 0 ? 100 * (count - f.true_steps) / f.true_steps : std::nan("");
  };
  f.count_percent = percent(static_cast<double>(steps.size())), f.peaks_percent = percent(f.peaks);
  const StampedPoses path = smoothed(recording.truth);
  const auto places = places_of(recording, path);
  add_distance(steps, stretches_of(recording, places), path, f);
  add_position(track, places, f);
  add_floors(recording, track, f);
  add_floor_numbers(recording, track, f);
  f.adaptive = composed_errors(steps, 0, places), f.fixed = composed_errors(steps, kFixedStep_m, places);
  return f;
}

WalkerName walker_name(const Recording& recording) {
  const std::string stem = recording.path.stem().string();
  std::vector<std::string> parts(1);
  for (const char c : stem)
    if (c == '_')
      parts.emplace_back();
    else
      parts.back().push_back(c);
  const auto part = [&](size_t i) { return i < parts.size() ? parts[i] : std::string(); };
  if (recording.format == "RIDI") {  // hang_handheld_side_test2
    std::string place = part(1);
    place.erase(std::find_if(place.begin(), place.end(), [](char c) { return c >= '0' && c <= '9'; }), place.end());
    return {part(0), place == "handheld" ? "hand" : place};
  }
  if (recording.format == "Oxford steps") return {part(1), "hand"};       // Pixel_Jamie_Carpet_InHand_1
  if (recording.format == "IPIN") return {part(0), "hand"};               // T51_R02: trial and repetition
  return {parts.size() > 2 ? part(0) + '_' + part(1) : part(0), "hand"};  // site2_F6_...
}

}  // namespace odograph
