// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/evaluation/evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace odograph {
namespace {

using Eigen::Vector3d;

double rotation_angle(const Eigen::Quaterniond& q) { return 2.0 * std::atan2(q.vec().norm(), std::abs(q.w())); }

Eigen::Isometry3d isometry(const StampedPose& x) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = x.q.toRotationMatrix();
  T.translation() = x.p;
  return T;
}

}  // namespace

Statistics statistics_of(std::vector<double> e) {
  Statistics s;
  s.n = e.size();
  if (e.empty()) return s;
  const double n = static_cast<double>(e.size());
  s.sse = std::inner_product(e.begin(), e.end(), e.begin(), 0.0);
  s.rmse = std::sqrt(s.sse / n);
  s.mean = std::accumulate(e.begin(), e.end(), 0.0) / n;
  double variance = 0;
  for (const double x : e) variance += (x - s.mean) * (x - s.mean);
  s.std = std::sqrt(variance / n);
  s.median = percentile(e, 0.5);
  const auto [low, high] = std::minmax_element(e.begin(), e.end());
  s.min = *low, s.max = *high;
  return s;
}

double percentile(std::vector<double> v, double p) {
  if (v.empty()) return 0.0;
  std::sort(v.begin(), v.end());
  const double rank = p * static_cast<double>(v.size() - 1);
  const auto below = static_cast<size_t>(rank);
  const size_t above = std::min(below + 1, v.size() - 1);
  return v[below] + (rank - static_cast<double>(below)) * (v[above] - v[below]);
}

double part_below(const std::vector<double>& errors, const std::vector<double>& others) {
  size_t below = 0;
  for (size_t i = 0; i < others.size(); ++i) below += errors[i] < others[i];
  return static_cast<double>(below) / static_cast<double>(others.size());
}

Result<Alignment> parse_alignment(const std::string& name) {
  if (name == "none") return Alignment::none;
  if (name == "first") return Alignment::first;
  if (name == "yaw") return Alignment::yaw;
  if (name == "se3") return Alignment::se3;
  if (name == "sim3") return Alignment::sim3;
  return Failure{ODO_E_ARGUMENT, "unknown alignment '" + name + "'; expected none, first, yaw, se3 or sim3"};
}

namespace {
/// Seconds as a double, rounded as the decimal text would be parsed, so that ties resolve as in evo.
double as_double_seconds(int64_t t_ns) { return static_cast<double>(static_cast<long double>(t_ns) / 1e9L); }
}  // namespace

Pairs associate(const StampedPoses& reference, const StampedPoses& estimate, double max_difference_s) {
  const bool estimate_is_longer = estimate.size() > reference.size();
  const StampedPoses& shorter = estimate_is_longer ? reference : estimate;
  const StampedPoses& longer = estimate_is_longer ? estimate : reference;
  // Neither file needs to be sorted: sort the longer one's times stably, then search them.
  std::vector<size_t> order(longer.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return longer[a].t_ns < longer[b].t_ns; });
  Pairs pairs;
  for (const StampedPose& pose : shorter) {
    const auto after = std::lower_bound(order.begin(), order.end(), pose.t_ns,
                                        [&](size_t i, int64_t t) { return longer[i].t_ns < t; });
    const double t_s = as_double_seconds(pose.t_ns);
    auto best = order.end();
    double best_s = max_difference_s;
    for (auto candidate = after == order.begin() ? after : after - 1; candidate != order.end() && candidate <= after;
         ++candidate) {
      const double difference_s = std::abs(as_double_seconds(longer[*candidate].t_ns) - t_s);
      if (difference_s < best_s || (difference_s <= best_s && best == order.end()))
        best = candidate, best_s = difference_s;
    }
    if (best == order.end()) continue;
    pairs.reference.push_back(estimate_is_longer ? pose : longer[*best]);
    pairs.estimate.push_back(estimate_is_longer ? longer[*best] : pose);
  }
  return pairs;
}

namespace {

StampedPoses transformed(const StampedPoses& trajectory, double scale, const Eigen::Isometry3d& T) {
  StampedPoses out = trajectory;
  const Eigen::Quaterniond q(T.linear());
  for (auto& x : out) {
    x.p = T * (scale * x.p);
    x.q = (q * x.q).normalized();
  }
  return out;
}

Eigen::Isometry3d yaw_alignment(const Pairs& pairs) {
  Vector3d from = Vector3d::Zero(), to = Vector3d::Zero();
  for (size_t i = 0; i < pairs.reference.size(); ++i) from += pairs.estimate[i].p, to += pairs.reference[i].p;
  from /= static_cast<double>(pairs.reference.size());
  to /= static_cast<double>(pairs.reference.size());
  double sine = 0, cosine = 0;
  for (size_t i = 0; i < pairs.reference.size(); ++i) {
    const Vector3d a = pairs.estimate[i].p - from, b = pairs.reference[i].p - to;
    cosine += a.x() * b.x() + a.y() * b.y();
    sine += a.x() * b.y() - a.y() * b.x();
  }
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(std::atan2(sine, cosine), Vector3d::UnitZ()).toRotationMatrix();
  T.translation() = to - T.linear() * from;
  return T;
}

}  // namespace

StampedPoses align(const Pairs& pairs, Alignment alignment, double* scale) {
  if (scale) *scale = 1.0;
  if (pairs.reference.empty() || alignment == Alignment::none) return pairs.estimate;
  if (alignment == Alignment::first)
    return transformed(pairs.estimate, 1.0,
                       isometry(pairs.reference.front()) * isometry(pairs.estimate.front()).inverse());
  if (alignment == Alignment::yaw) return transformed(pairs.estimate, 1.0, yaw_alignment(pairs));
  const auto n = static_cast<Eigen::Index>(pairs.reference.size());
  Eigen::Matrix3Xd from(3, n), to(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    from.col(i) = pairs.estimate[static_cast<size_t>(i)].p;
    to.col(i) = pairs.reference[static_cast<size_t>(i)].p;
  }
  const Eigen::Matrix4d S = Eigen::umeyama(from, to, alignment == Alignment::sim3);
  const double s = std::cbrt(S.topLeftCorner<3, 3>().determinant());
  if (scale) *scale = s;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = S.topLeftCorner<3, 3>() / s;
  T.translation() = S.topRightCorner<3, 1>();
  return transformed(pairs.estimate, s, T);
}

std::optional<ScalePart> scale_part(const StampedPoses& reference, const StampedPoses& aligned) {
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();
  const double n = static_cast<double>(reference.size());
  for (size_t i = 0; i < reference.size(); ++i) from += aligned[i].p / n, to += reference[i].p / n;
  double moments = 0, spread = 0, squares = 0;
  for (size_t i = 0; i < reference.size(); ++i) {
    moments += (aligned[i].p - from).dot(reference[i].p - to);
    spread += (aligned[i].p - from).squaredNorm();
  }
  if (!(moments > 0)) return {};
  const double factor = moments / spread;
  for (size_t i = 0; i < reference.size(); ++i)
    squares += (factor * (aligned[i].p - from) - (reference[i].p - to)).squaredNorm();
  return ScalePart{1 / factor, std::sqrt(squares / n)};
}

PoseErrors absolute_errors(const StampedPoses& reference, const StampedPoses& estimate) {
  PoseErrors errors;
  for (size_t i = 0; i < reference.size(); ++i) {
    errors.translation_m.push_back((estimate[i].p - reference[i].p).norm());
    errors.rotation_rad.push_back(rotation_angle(reference[i].q.conjugate() * estimate[i].q));
  }
  return errors;
}

PoseErrors relative_errors(const StampedPoses& reference, const StampedPoses& estimate, double delta, bool metres) {
  std::vector<size_t> ids;
  double path = delta;
  for (size_t i = 0; i < reference.size(); ++i) {
    if (metres) {
      if (i > 0) path += (reference[i].p - reference[i - 1].p).norm();
      if (path < delta) continue;
      path = 0;
      ids.push_back(i);
    } else if (i % static_cast<size_t>(std::max(1.0, delta)) == 0) {
      ids.push_back(i);
    }
  }
  PoseErrors errors;
  for (size_t k = 1; k < ids.size(); ++k) {
    const Eigen::Isometry3d Q = isometry(reference[ids[k - 1]]).inverse() * isometry(reference[ids[k]]);
    const Eigen::Isometry3d P = isometry(estimate[ids[k - 1]]).inverse() * isometry(estimate[ids[k]]);
    const Eigen::Isometry3d E = Q.inverse() * P;
    errors.translation_m.push_back(E.translation().norm());
    errors.rotation_rad.push_back(rotation_angle(Eigen::Quaterniond(E.linear())));
  }
  return errors;
}

std::vector<std::pair<double, double>> scale_along_path(const StampedPoses& reference, const StampedPoses& estimate,
                                                        double window_m) {
  std::vector<std::pair<double, double>> ratios;
  double path = 0, begin_path = 0;
  size_t begin = 0;
  for (size_t i = 1; i < reference.size(); ++i) {
    path += (reference[i].p - reference[i - 1].p).norm();
    if (path - begin_path < window_m) continue;
    const double r = (reference[i].p - reference[begin].p).norm(), e = (estimate[i].p - estimate[begin].p).norm();
    if (r > 0.1 * window_m) ratios.emplace_back(0.5 * (path + begin_path), e / r);
    begin = i;
    begin_path = path;
  }
  return ratios;
}

TrueLengths with_true_lengths(const Pairs& pairs, double window_m) {
  const StampedPoses &truth = pairs.reference, &estimate = pairs.estimate;
  TrueLengths out;
  if (truth.empty()) return out;
  std::vector<double> factor(truth.size(), 1.0);
  double path = 0;
  size_t begin = 0;
  for (size_t i = 1; i < truth.size(); ++i) {
    path += (truth[i].p - truth[i - 1].p).norm();
    if (path < window_m && i + 1 < truth.size()) continue;
    const double true_m = (truth[i].p - truth[begin].p).norm(), own = (estimate[i].p - estimate[begin].p).norm();
    for (size_t k = begin + 1; k <= i; ++k) factor[k] = own > 1e-12 ? true_m / own : 1.0;
    begin = i, path = 0;
  }
  out.track.push_back({truth[0].t_ns, truth[0].q, truth[0].p});
  const Eigen::Quaterniond rotation = truth[0].q * estimate[0].q.conjugate();
  for (size_t i = 1; i < truth.size(); ++i) {
    const Vector3d d_true = truth[i].p - truth[i - 1].p, d = rotation * (estimate[i].p - estimate[i - 1].p);
    const double standing =
        1e-3 * std::max(1e-9, (truth.back().p - truth[0].p).norm() / static_cast<double>(truth.size()));
    const bool moved = d.norm() > 1e-12;
    if (d_true.norm() > standing) {
      const Vector3d own = (rotation * estimate[i - 1].q).conjugate() * d, right = truth[i - 1].q.conjugate() * d_true;
      if (moved)
        out.direction_error_rad.push_back(std::atan2(own.cross(right).norm(), own.dot(right)));
      else
        ++out.without_motion;
    }
    out.track.push_back({truth[i].t_ns, rotation * estimate[i].q, out.track.back().p + factor[i] * d});
  }
  return out;
}

std::vector<double> scale_changes(const Pairs& pairs, double window_m) {
  const StampedPoses &truth = pairs.reference, &estimate = pairs.estimate;
  std::vector<double> changes;
  double path = 0, before = 0;  // scale of the first half; 0: none
  size_t begin = 0;
  bool second = false;
  for (size_t i = 1; i < truth.size(); ++i) {
    path += (truth[i].p - truth[i - 1].p).norm();
    if (path < 0.5 * window_m) continue;
    const double true_m = (truth[i].p - truth[begin].p).norm(), own = (estimate[i].p - estimate[begin].p).norm();
    const double scale = true_m > 0.25 * window_m && own > 1e-12 ? true_m / own : 0;
    if (second && scale > 0 && before > 0) changes.push_back(scale / before - 1);
    before = scale, second = !second, begin = i, path = 0;
  }
  return changes;
}

Vector3d position_at(const StampedPoses& trajectory, int64_t t_ns) {
  if (trajectory.empty()) return Vector3d::Zero();
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), t_ns,
                                      [](const StampedPose& x, int64_t t) { return x.t_ns < t; });
  if (after == trajectory.begin()) return trajectory.front().p;
  if (after == trajectory.end()) return trajectory.back().p;
  const StampedPose &a = *(after - 1), &b = *after;
  const double w = static_cast<double>(t_ns - a.t_ns) / static_cast<double>(b.t_ns - a.t_ns);
  return a.p + w * (b.p - a.p);
}

std::optional<StampedPose> pose_at(const StampedPoses& trajectory, int64_t t_ns, double largest_gap_s) {
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), t_ns,
                                      [](const StampedPose& x, int64_t t) { return x.t_ns < t; });
  if (after == trajectory.end()) return std::nullopt;
  if (after->t_ns == t_ns) return *after;
  if (after == trajectory.begin()) return std::nullopt;
  const StampedPose &a = *(after - 1), &b = *after;
  const double gap_ns = static_cast<double>(b.t_ns - a.t_ns), w = static_cast<double>(t_ns - a.t_ns) / gap_ns;
  if (gap_ns * 1e-9 > largest_gap_s) return std::nullopt;
  return StampedPose{t_ns, a.q.slerp(w, b.q), a.p + w * (b.p - a.p)};
}

double heading_offset(const StampedPoses& track, const std::vector<Waypoint>& waypoints, double metres) {
  if (waypoints.size() < 2) return 0.0;
  const Vector3d origin = position_at(track, waypoints.front().t_ns);
  double sine = 0, cosine = 0, length = 0;
  for (size_t i = 1; i < waypoints.size(); ++i) {
    length += (waypoints[i].p_n - waypoints[i - 1].p_n).head<2>().norm();
    if (i > 1 && length > metres) break;
    const Vector3d a = position_at(track, waypoints[i].t_ns) - origin, b = waypoints[i].p_n - waypoints.front().p_n;
    cosine += a.x() * b.x() + a.y() * b.y();
    sine += a.x() * b.y() - a.y() * b.x();
  }
  return std::atan2(sine, cosine);
}

StampedPoses align_to_waypoints(const StampedPoses& track, const std::vector<Waypoint>& waypoints, double yaw_rad) {
  if (waypoints.empty()) return track;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ()).toRotationMatrix();
  T.translation() = waypoints.front().p_n - T.linear() * position_at(track, waypoints.front().t_ns);
  return transformed(track, 1.0, T);
}

WaypointErrors waypoint_errors(const StampedPoses& track, const std::vector<Waypoint>& waypoints) {
  WaypointErrors errors;
  for (size_t i = 1; i < waypoints.size(); ++i) {
    errors.reference_m += (waypoints[i].p_n - waypoints[i - 1].p_n).head<2>().norm();
    errors.position_m.push_back((position_at(track, waypoints[i].t_ns) - waypoints[i].p_n).head<2>().norm());
  }
  if (waypoints.size() < 2) return errors;
  const int64_t from = waypoints.front().t_ns, to = waypoints.back().t_ns;
  Vector3d last = position_at(track, from);
  for (const StampedPose& x : track) {
    if (x.t_ns <= from || x.t_ns >= to) continue;
    errors.estimate_m += (x.p - last).head<2>().norm();
    last = x.p;
  }
  errors.estimate_m += (position_at(track, to) - last).head<2>().norm();
  return errors;
}

LegErrors leg_errors(const StampedPoses& track, const std::vector<Waypoint>& waypoints, double metres) {
  LegErrors out;
  if (waypoints.size() < 2) return out;
  // Tracks that are straight between waypoints, with one pose at each.
  StampedPoses headed{{waypoints.front().t_ns, Eigen::Quaterniond::Identity(), waypoints.front().p_n}};
  StampedPoses measured = headed;
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> legs;
  for (size_t i = 1; i < waypoints.size(); ++i) {
    const int64_t t = waypoints[i].t_ns;
    const Vector3d walked = position_at(track, t) - position_at(track, waypoints[i - 1].t_ns);
    const Vector3d leg = waypoints[i].p_n - waypoints[i - 1].p_n;
    const double walked_m = walked.head<2>().norm(), leg_m = leg.head<2>().norm();
    const auto along = [](const Vector3d& v, double v_m, double length_m) -> Vector3d {
      return Vector3d(v.x(), v.y(), 0) * (length_m / std::max(v_m, 1e-9));
    };
    headed.push_back({t, Eigen::Quaterniond::Identity(), headed.back().p + along(leg, leg_m, walked_m)});
    measured.push_back({t, Eigen::Quaterniond::Identity(), measured.back().p + along(walked, walked_m, leg_m)});
    if (walked_m >= 1 && leg_m >= 1) legs.emplace_back(walked.head<2>(), leg.head<2>());
  }
  out.true_headings_m = waypoint_errors(headed, waypoints).position_m;
  out.true_lengths_m =
      waypoint_errors(align_to_waypoints(measured, waypoints, heading_offset(measured, waypoints, metres)), waypoints)
          .position_m;
  const auto yaw_of = [](const auto& leg) {
    return std::atan2(leg.first.x() * leg.second.y() - leg.first.y() * leg.second.x(), leg.first.dot(leg.second));
  };
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const auto& leg : legs)
    mean += leg.second.norm() * Eigen::Vector2d(std::cos(yaw_of(leg)), std::sin(yaw_of(leg)));
  for (const auto& leg : legs) {
    out.heading_rad.push_back(std::remainder(yaw_of(leg) - std::atan2(mean.y(), mean.x()), 2 * EIGEN_PI));
    out.length.push_back(leg.first.norm() / leg.second.norm() - 1);
  }
  return out;
}

}  // namespace odograph
