// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/evaluation/vo_figures.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"

namespace odograph {
namespace {

using Eigen::Vector3d;

double seconds_between(int64_t from_ns, int64_t to_ns) { return seconds(to_ns - from_ns); }

/// Indices of the poses that have a true pose, and the true path up to each.
struct Matched {
  const ComposedMotions& motions_;
  std::vector<size_t> index;
  StampedPoses truth;
  std::vector<double> path_m;

  size_t size() const { return index.size(); }
  const ComposedPose& pose(size_t k) const { return motions_.poses[index[k]]; }
  /// The last pose at or before a time; its counterpart, the first at or after it.
  std::optional<size_t> at_most(int64_t t_ns) const {
    const auto after = first_at_least(t_ns + 1);
    return after > 0 ? std::optional(after - 1) : std::nullopt;
  }
  std::optional<size_t> at_least(int64_t t_ns) const {
    const auto at = first_at_least(t_ns);
    return at < truth.size() ? std::optional(at) : std::nullopt;
  }

 private:
  size_t first_at_least(int64_t t_ns) const {
    return static_cast<size_t>(
        std::lower_bound(truth.begin(), truth.end(), t_ns, [](const StampedPose& x, int64_t t) { return x.t_ns < t; }) -
        truth.begin());
  }
};

Matched matched(const ComposedMotions& motions_, const StampedPoses& truth, double largest_gap_s) {
  Matched m{motions_, {}, {}, {}};
  for (size_t i = 0; i < motions_.poses.size(); ++i) {
    const auto x = pose_at(truth, motions_.poses[i].t_ns, largest_gap_s);
    if (!x) continue;
    m.path_m.push_back(m.truth.empty() ? 0 : m.path_m.back() + (x->p - m.truth.back().p).norm());
    m.index.push_back(i), m.truth.push_back(*x);
  }
  return m;
}

bool one_group(const Matched& m, size_t from, size_t to) {
  for (size_t i = m.index[from]; i <= m.index[to]; ++i)
    if (m.motions_.poses[i].scale_group != m.pose(from).scale_group) return false;
  return true;
}

/// Ratio of the odometry's displacement, in its own units, to the true one; 0 if the true displacement is too small.
double scale_over(const Matched& m, size_t from, size_t to, double min_straight) {
  const double true_m = (m.truth[to].p - m.truth[from].p).norm(),
               own = (m.pose(to).unscaled - m.pose(from).unscaled).norm();
  return true_m > min_straight * (m.path_m[to] - m.path_m[from]) && true_m > 0 ? own / true_m : 0;
}

StopFigures figures_of(const Stop& stop, const Matched& m, const VoFigureParameters& p) {
  StopFigures f{.stop = stop};
  const auto begin = m.at_least(stop.from_ns), end = m.at_most(stop.to_ns);
  if (!begin || !end || *begin >= *end) return f;
  size_t before = *begin, after = *end;
  while (before > 0 && m.path_m[*begin] - m.path_m[before] < p.stop_stretch_m) --before;
  while (after + 1 < m.size() && m.path_m[after] - m.path_m[*end] < p.stop_stretch_m) ++after;
  const double min_m = 0.9 * p.stop_stretch_m;
  f.new_group = !one_group(m, before, after);
  if (m.path_m[*begin] - m.path_m[before] > min_m) f.scale_before = scale_over(m, before, *begin, p.min_straight);
  if (m.path_m[after] - m.path_m[*end] > min_m) f.scale_after = scale_over(m, *end, after, p.min_straight);
  if (m.pose(*begin).metric && m.pose(*end).metric) {
    const Vector3d own = m.pose(*begin).q.conjugate() * (m.pose(*end).p_m - m.pose(*begin).p_m);
    f.drift_m = (own - m.truth[*begin].q.conjugate() * (m.truth[*end].p - m.truth[*begin].p)).norm();
  }
  return f;
}

std::vector<ScaleWindow> windows_of(const Matched& m, const VoFigureParameters& p) {
  std::vector<ScaleWindow> windows;
  for (size_t from = 0, to = 0; to < m.size(); ++to) {
    if (!m.pose(to).metric || m.pose(to).scale_group != m.pose(from).scale_group || !m.pose(from).metric) {
      from = to;
      continue;
    }
    const double own = (m.pose(to).p_m - m.pose(from).p_m).norm(), true_m = (m.truth[to].p - m.truth[from].p).norm();
    if (true_m < p.window_m) continue;
    if (own > 0)
      windows.push_back({m.truth[from].t_ns, m.truth[to].t_ns, 0.5 * (m.path_m[from] + m.path_m[to]),
                         std::log(own / true_m), m.pose(to).scale_sigma});
    from = to;
  }
  return windows;
}

std::vector<TrackedStretch> tracked_of(const Matched& m, const VoFigureParameters& p) {
  std::vector<TrackedStretch> stretches;
  const auto follows = [&](size_t k) { return m.pose(k).metric && m.pose(k).tracking; };
  for (size_t from = 0; from < m.size(); ++from) {
    if (!follows(from)) continue;
    size_t to = from;
    while (to + 1 < m.size() && follows(to + 1) && one_group(m, to, to + 1)) ++to;
    if (const double path_m = m.path_m[to] - m.path_m[from]; path_m >= p.min_tracked_m) {
      Pairs pairs;
      for (size_t k = from; k <= to; ++k)
        pairs.reference.push_back(m.truth[k]), pairs.estimate.push_back({m.pose(k).t_ns, m.pose(k).q, m.pose(k).p_m});
      const auto errors = absolute_errors(pairs.reference, align(pairs, Alignment::se3, nullptr));
      stretches.push_back({m.truth[from].t_ns, m.truth[to].t_ns, path_m, statistics_of(errors.translation_m).rmse});
    }
    from = to;
  }
  return stretches;
}

void count_frames(const ComposedMotions& motions_, const std::vector<int64_t>& frames_ns, VoFigures& f) {
  f.frames = frames_ns.size(), f.holes = motions_.holes;
  std::map<uint32_t, size_t> frames_of;
  size_t placed = 0, metric = 0, before = 0;
  for (size_t i = 1; i < motions_.poses.size(); ++i) {
    const ComposedPose& x = motions_.poses[i];
    ++frames_of[x.scale_group];
    placed += x.placed, metric += x.metric;
    if (x.metric) before = placed - metric;
  }
  size_t longest = 0;
  for (const auto& [group, count] : frames_of) longest = std::max(longest, count);
  const double all = static_cast<double>(std::max<size_t>(1, frames_ns.size()));
  f.groups = frames_of.size();
  f.placed_share = static_cast<double>(placed) / all, f.metric_share = static_cast<double>(metric) / all;
  f.before_metric_share = static_cast<double>(before) / all;
  f.longest_group_share = static_cast<double>(longest) / all;
}

void measure_start(const StampedPoses& truth, const std::vector<odo_vo_motion>& motions,
                   const std::vector<int64_t>& emitted_ns, const std::vector<int64_t>& frames_ns, double first_motion_m,
                   VoFigures& f) {
  f.start_s = f.start_from_motion_s = std::nan("");
  const auto first = std::find_if(motions.begin(), motions.end(),
                                  [](const odo_vo_motion& m) { return (m.header.flags & ODO_VO_METRIC) != 0; });
  if (first == motions.end() || frames_ns.empty()) return;
  const int64_t known = emitted_ns[static_cast<size_t>(first - motions.begin())];
  f.start_s = seconds_between(frames_ns.front(), known);
  const auto begin =
      std::find_if(truth.begin(), truth.end(), [&](const StampedPose& x) { return x.t_ns >= frames_ns.front(); });
  const auto moved =
      std::find_if(begin, truth.end(), [&](const StampedPose& x) { return (x.p - begin->p).norm() > first_motion_m; });
  if (moved != truth.end()) f.start_from_motion_s = seconds_between(moved->t_ns, known);
}

/// The metric poses rotated so that their stated gravity matches the reference's vertical; none if neither direction of
/// z is within 45 degrees of it.
std::optional<StampedPoses> gravity_aligned(const Matched& m, const StampedPoses& metric) {
  Vector3d own = Vector3d::Zero(), reference = Vector3d::Zero();
  for (size_t k = 0; k < m.size(); ++k)
    if (m.pose(k).metric && m.pose(k).gravity) {
      own += *m.pose(k).gravity;
      reference += m.truth[k].q * (m.pose(k).q.conjugate() * *m.pose(k).gravity);
    }
  if (own.norm() == 0 || std::abs(reference.normalized().z()) < std::sqrt(0.5)) return std::nullopt;
  const auto rotation = shortest_rotation(own, std::copysign(1.0, reference.z()) * Vector3d::UnitZ());
  StampedPoses out = metric;
  for (StampedPose& x : out) x.p = rotation * x.p, x.q = rotation * x.q;
  return out;
}

void measure_metric(const Matched& m, VoFigures& f) {
  f.se3_rmse_m = f.sim3_rmse_m = f.yaw_rmse_m = f.scale = std::nan("");
  f.own_path_m = path_length(m.motions_.metric());
  Pairs pairs;
  for (size_t k = 0; k < m.size(); ++k) {
    const ComposedPose& x = m.pose(k);
    if (x.metric) pairs.reference.push_back(m.truth[k]), pairs.estimate.push_back({x.t_ns, x.q, x.p_m});
  }
  if (pairs.reference.size() < 10) return;
  f.path_m = path_length(pairs.reference);
  const auto rmse = [](const Pairs& p, Alignment alignment, double* scale) {
    return statistics_of(absolute_errors(p.reference, align(p, alignment, scale)).translation_m).rmse;
  };
  f.se3_rmse_m = rmse(pairs, Alignment::se3, nullptr);
  f.sim3_rmse_m = rmse(pairs, Alignment::sim3, &f.scale);
  if (auto aligned = gravity_aligned(m, pairs.estimate))
    f.yaw_rmse_m = rmse({pairs.reference, std::move(*aligned)}, Alignment::yaw, nullptr);
}

void sum_up(const VoFigureParameters& p, VoFigures& f) {
  f.worst_tracked = f.worst_jump = f.standing_drift_m_min = f.overconfident_share = f.scale_nees = std::nan("");
  double drift_m = 0, standing_s = 0;
  for (const TrackedStretch& s : f.tracked) f.worst_tracked = std::fmax(f.worst_tracked, s.rmse_m / s.path_m);
  for (const StopFigures& s : f.stops) {
    if (s.measured()) f.worst_jump = std::fmax(f.worst_jump, std::abs(s.jump()));
    if (s.drift_m > 0) drift_m += s.drift_m, standing_s += seconds_between(s.stop.from_ns, s.stop.to_ns);
  }
  if (standing_s > 0) f.standing_drift_m_min = 60 * drift_m / standing_s;
  double wrong_s = 0, all_s = 0, squares = 0;
  size_t count = 0;
  for (const ScaleWindow& w : f.windows) {
    if (w.sigma <= 0) continue;
    const double normalised = w.log_scale / w.sigma, s = seconds_between(w.from_ns, w.to_ns);
    all_s += s, squares += normalised * normalised, ++count;
    if (std::abs(normalised) > p.confident_sigmas) wrong_s += s;
  }
  if (count > 0) f.overconfident_share = wrong_s / all_s, f.scale_nees = squares / static_cast<double>(count);
}

}  // namespace

std::vector<Stop> stops_of(const StampedPoses& truth, const StandingParameters& p) {
  std::vector<Stop> stops;
  const auto half = static_cast<int64_t>(0.5e9 * p.window_s);
  constexpr int64_t kMoving = INT64_MIN;
  int64_t since_ns = kMoving;
  const auto end = [&](int64_t t_ns) {
    if (since_ns != kMoving && seconds_between(since_ns, t_ns) >= p.min_s) stops.push_back({since_ns, t_ns});
    since_ns = kMoving;
  };
  for (const StampedPose& x : truth) {
    const int64_t from = std::max(truth.front().t_ns, x.t_ns - half), to = std::min(truth.back().t_ns, x.t_ns + half);
    const double moved_m = (position_at(truth, to) - position_at(truth, from)).norm();
    if (moved_m >= p.speed_mps * seconds_between(from, to))
      end(x.t_ns);
    else if (since_ns == kMoving)
      since_ns = x.t_ns;
  }
  if (!truth.empty()) end(truth.back().t_ns);
  return stops;
}

VoFigures vo_figures(const StampedPoses& truth, const std::vector<odo_vo_motion>& motions,
                     const std::vector<int64_t>& emitted_ns, const std::vector<int64_t>& frames_ns,
                     const VoFigureParameters& p) {
  VoFigures f{};
  const ComposedMotions motions_ = compose(motions);
  const Matched m = matched(motions_, truth, p.largest_gap_s);
  count_frames(motions_, frames_ns, f);
  measure_start(truth, motions, emitted_ns, frames_ns, p.first_motion_m, f);
  measure_metric(m, f);
  if (m.size() > 1) {
    for (const Stop& stop : stops_of(m.truth, p.standing)) f.stops.push_back(figures_of(stop, m, p));
    f.windows = windows_of(m, p);
    f.tracked = tracked_of(m, p);
  }
  sum_up(p, f);
  return f;
}

}  // namespace odograph
