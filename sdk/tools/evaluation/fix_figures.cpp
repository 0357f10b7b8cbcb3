// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/evaluation/fix_figures.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/time.hpp"
#include "sdk/tools/evaluation/pose_consistency.hpp"

namespace odograph {
namespace {

constexpr double kThreeSigmaOfTwo = 11.83;  // 99.73 % (3 sigma of one axis) for two degrees of freedom

/// Seconds of the recording in which, by the truth, roofs fill at least a third of the directions above ten degrees.
std::vector<int64_t> seconds_with_skyline(const Recording& recording) {
  std::vector<int64_t> seconds;
  for (const TrueSkyline& s : recording.true_skylines) {
    const auto high = std::count_if(s.elevation_rad.begin(), s.elevation_rad.end(), [](float e) { return e > 0.17f; });
    if (3 * static_cast<size_t>(high) >= s.elevation_rad.size()) seconds.push_back(s.t_ns);
  }
  return seconds;
}

double path_until(const StampedPoses& truth, int64_t t_ns) {
  double path_m = 0;
  for (size_t i = 1; i < truth.size() && truth[i].t_ns <= t_ns; ++i) path_m += (truth[i].p - truth[i - 1].p).norm();
  return path_m;
}

}  // namespace

FixFigures fix_figures(const Recording& recording, const std::vector<odo_fix>& fixes) {
  FixFigures f;
  for (const odo_fix& fix : fixes) {
    const Eigen::Vector3d d = Eigen::Vector3d(fix.p_n) - position_at(recording.truth, fix.header.t_ns);
    f.error_m.push_back(d.head<2>().norm());
    if (horizontal_nees(d, fix.covariance_n) > kThreeSigmaOfTwo) ++f.beyond;
  }
  if (!fixes.empty()) {
    f.first_after_m = path_until(recording.truth, fixes.front().header.t_ns);
    f.first_off_m = f.error_m.front();
  }
  for (const int64_t t_ns : seconds_with_skyline(recording)) {
    ++f.seconds;
    f.with_fix += std::any_of(fixes.begin(), fixes.end(),
                              [&](const odo_fix& fix) { return std::abs(fix.header.t_ns - t_ns) <= 500'000'000; });
  }
  return f;
}

std::vector<double> tilt_errors_deg(const StampedPoses& truth, const StampedPoses& track) {
  std::vector<double> tilt_deg;
  size_t k = 0;
  for (const StampedPose& pose : track) {
    while (k + 1 < truth.size() && truth[k].t_ns < pose.t_ns) ++k;
    if (truth.empty() || truth[k].t_ns != pose.t_ns) continue;
    const double cosine = (pose.q * (truth[k].q.conjugate() * Eigen::Vector3d::UnitZ())).z();
    tilt_deg.push_back(std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / EIGEN_PI);
  }
  return tilt_deg;
}

CanyonFigures canyon_figures(const std::vector<TrueState>& truth, const StampedPoses& track,
                             const CanyonParameters& p) {
  CanyonFigures row;
  std::vector<double> errors;
  size_t at = 0, walked_to = 0;
  double walked_m = 0;
  bool has_heading = false;
  for (const StampedPose& pose : track) {
    while (at + 1 < truth.size() && truth[at].t_ns < pose.t_ns) ++at;
    for (; walked_to + 20 <= at;
         walked_to += 20)  // every tenth of a second, so that hand motion does not add to the path
      walked_m += (truth[walked_to + 20].p - truth[walked_to].p).head<2>().norm();
    const double t = seconds(pose.t_ns - truth.front().t_ns);
    const double error = (pose.p - truth[at].p).head<2>().norm();
    if (!has_heading && walked_m >= p.yaw_after_m) {
      const Eigen::Quaterniond off = pose.q * truth[at].q.conjugate();
      row.yaw_deg = std::abs(std::remainder(2 * std::atan2(off.z(), off.w()), 2 * EIGEN_PI)) * 180 / EIGEN_PI;
      has_heading = true;
    }
    if (t > p.settled_s) errors.push_back(error);
    if (t > p.reflection_from_s && t < p.reflection_to_s + p.after_s)
      row.in_reflection_m = std::max(row.in_reflection_m, error);
  }
  row.median_m = percentile(errors, 0.5), row.largest_m = percentile(errors, 1.0);
  return row;
}

}  // namespace odograph
