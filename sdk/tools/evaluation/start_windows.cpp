// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/evaluation/start_windows.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/evaluation/composed_motions.hpp"
#include "sdk/tools/evaluation/evaluation.hpp"

namespace odograph {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const double kNone = std::nan("");

/// Metric poses of one scale group that have a true pose.
struct Group {
  Pairs pairs;
  std::vector<double> sigma;  ///< stated with each

  double seconds_to(size_t k) const { return seconds(pairs.reference[k].t_ns - pairs.reference.front().t_ns); }
};

std::vector<Group> metric_groups(const ComposedMotions& composed, const StampedPoses& truth, double largest_gap_s) {
  std::vector<Group> groups;
  uint32_t id = 0;
  for (const ComposedPose& x : composed.poses) {
    if (!x.metric) continue;
    const auto real = pose_at(truth, x.t_ns, largest_gap_s);
    if (!real) continue;
    if (groups.empty() || x.scale_group != id) groups.emplace_back(), id = x.scale_group;
    groups.back().pairs.reference.push_back(*real);
    groups.back().pairs.estimate.push_back({x.t_ns, x.q, x.p_m});
    groups.back().sigma.push_back(x.scale_sigma);
  }
  return groups;
}

/// Rms distance from the mean position.
double extent_of(const StampedPoses& track) {
  Vector3d mean = Vector3d::Zero();
  for (const StampedPose& x : track) mean += x.p / static_cast<double>(track.size());
  double squares = 0;
  for (const StampedPose& x : track) squares += (x.p - mean).squaredNorm();
  return std::sqrt(squares / static_cast<double>(std::max<size_t>(1, track.size())));
}

std::vector<StatedScale> stated_scales(const Group& group, const StartWindowParameters& p) {
  std::vector<StatedScale> scales;
  const size_t n = group.sigma.size();
  size_t next = 0;
  for (size_t k = 0; k < n; ++k) {
    const bool last = k + 1 == n, due = next < p.after_s.size() && group.seconds_to(k) >= p.after_s[next];
    if (due) ++next;
    if (!due && !last) continue;
    const auto until = static_cast<std::ptrdiff_t>(k + 1);
    const Pairs until_now{{group.pairs.reference.begin(), group.pairs.reference.begin() + until},
                          {group.pairs.estimate.begin(), group.pairs.estimate.begin() + until}};
    if (until < 5 || extent_of(until_now.reference) < p.min_extent_m) continue;
    double to_truth = 1;
    align(until_now, Alignment::sim3, &to_truth);
    scales.push_back({group.seconds_to(k), -std::log(to_truth), group.sigma[k], last});
  }
  return scales;
}

/// Mean normalised squared errors of the metric motions, per degree of freedom.
void measure_motions(const StampedPoses& truth, const std::vector<odo_vo_motion>& motions, double largest_gap_s,
                     StartWindow& f) {
  double rotation = 0, displacement = 0;
  size_t n = 0;
  for (const odo_vo_motion& m : motions) {
    if (!(m.header.flags & ODO_VO_COVARIANCE) || !(m.header.flags & ODO_VO_METRIC)) continue;
    const auto from = pose_at(truth, m.t_from_ns, largest_gap_s), to = pose_at(truth, m.header.t_ns, largest_gap_s);
    if (!from || !to) continue;
    const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> P(m.covariance);
    const Vector3d rotated = log_rotation(raw_quaternion(m.q_c0_c1) * (from->q.conjugate() * to->q).conjugate());
    const Vector3d own(m.p_c0_c1), shift = own - from->q.conjugate() * (to->p - from->p);
    const Matrix3d R = P.topLeftCorner<3, 3>();
    const Matrix3d S = P.bottomRightCorner<3, 3>() + m.scale_sigma * m.scale_sigma * own * own.transpose();
    rotation += rotated.dot(R.ldlt().solve(rotated)) / 3, displacement += shift.dot(S.ldlt().solve(shift)) / 3;
    ++n;
  }
  const double by = n > 0 ? 1 / static_cast<double>(n) : kNone;
  f.rotation_nees = rotation * by, f.displacement_nees = displacement * by;
}

}  // namespace

StartWindow start_window(const StampedPoses& truth, const std::vector<odo_vo_motion>& motions, int64_t first_ns,
                         const StartWindowParameters& p) {
  StartWindow f{.start_s = kNone,
                .log_scale = kNone,
                .sigma = kNone,
                .se3_rmse_m = kNone,
                .sim3_rmse_m = kNone,
                .worst_sigmas = kNone};
  for (const odo_vo_motion& m : motions)
    if (std::isnan(f.start_s) && (m.header.flags & ODO_VO_METRIC)) f.start_s = seconds(m.header.t_ns - first_ns);
  measure_motions(truth, motions, p.largest_gap_s, f);
  const std::vector<Group> groups = metric_groups(compose(motions), truth, p.largest_gap_s);
  f.groups = groups.size();
  size_t longest = 0;
  for (const Group& group : groups) {
    const auto scales = stated_scales(group, p);
    f.scales.insert(f.scales.end(), scales.begin(), scales.end());
    if (group.sigma.size() <= std::max<size_t>(longest, 4) || scales.empty()) continue;
    longest = group.sigma.size();
    f.log_scale = scales.back().log_scale, f.sigma = scales.back().sigma;
    f.path_m = path_length(group.pairs.reference);
    const auto rms = [&](Alignment alignment) {
      return statistics_of(absolute_errors(group.pairs.reference, align(group.pairs, alignment, nullptr)).translation_m)
          .rmse;
    };
    f.se3_rmse_m = rms(Alignment::se3), f.sim3_rmse_m = rms(Alignment::sim3);
  }
  for (const StatedScale& stated : f.scales) {
    const double sigmas = std::abs(stated.log_scale) / std::max(1e-6, stated.sigma);
    if (!(sigmas <= f.worst_sigmas)) f.worst_sigmas = sigmas;
  }
  return f;
}

}  // namespace odograph
