// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/evaluation/excitation.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "sdk/math/time.hpp"

namespace odograph {

double detrended_rms(const StampedPoses& trajectory) {
  const auto n = static_cast<Eigen::Index>(trajectory.size());
  if (n < 4) return 0;
  const double span = static_cast<double>(trajectory.back().t_ns - trajectory.front().t_ns);
  Eigen::MatrixX3d A(n, 3), p(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& pose = trajectory[static_cast<size_t>(i)];
    const double t = static_cast<double>(pose.t_ns - trajectory.front().t_ns) / std::max(span, 1.0) - 0.5;
    A.row(i) << 1, t, t * t;
    p.row(i) = (pose.p - trajectory.front().p).transpose();
  }
  const Eigen::MatrixX3d left = p - A * A.colPivHouseholderQr().solve(p);
  return std::sqrt(left.squaredNorm() / static_cast<double>(n));
}

Excitation excitation_of(const Pairs& pairs, const ExcitationParameters& c) {
  Excitation result;
  std::vector<double> motion, error;
  const auto window_ns = nanoseconds(c.window_s);
  const auto step_ns = std::max<int64_t>(1, nanoseconds((1 - c.overlap) * c.window_s));
  if (pairs.reference.empty()) return result;
  size_t first = 0;
  const int64_t end_ns = pairs.reference.back().t_ns;
  for (int64_t t = pairs.reference.front().t_ns; t + window_ns <= end_ns; t += step_ns) {
    while (pairs.reference[first].t_ns < t) ++first;
    Pairs window;
    bool whole = true;
    int64_t before = t;
    for (size_t i = first; i < pairs.reference.size() && pairs.reference[i].t_ns <= t + window_ns; ++i) {
      window.reference.push_back(pairs.reference[i]), window.estimate.push_back(pairs.estimate[i]);
      whole = whole && seconds(pairs.reference[i].t_ns - before) <= c.max_gap_s;
      before = pairs.reference[i].t_ns;
    }
    whole = whole && seconds(t + window_ns - before) <= c.max_gap_s;
    if (!whole || window.reference.size() < 8 || path_length(window.reference) < c.min_speed_mps * c.window_s) continue;
    motion.push_back(detrended_rms(window.reference));
    StampedPoses off = align(window, Alignment::sim3, nullptr);
    for (size_t i = 0; i < off.size(); ++i) off[i].p -= window.reference[i].p;
    const double left = detrended_rms(off);
    error.push_back(std::isfinite(left) ? left : motion.back());  // it did not move at all: scale 0
  }
  if (motion.empty()) return result;
  result.motion_m = percentile(motion, 0.5), result.error_m = percentile(error, 0.5), result.windows = motion.size();
  const double s2 = result.motion_m * result.motion_m, n2 = result.error_m * result.error_m;
  result.attenuation = s2 / std::max(s2 + n2, 1e-30);
  return result;
}

}  // namespace odograph
