// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/photograph_fixer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace odograph::skyline {
namespace {

/// Reduces the picture by an integer factor.
void shrink(Picture& picture, int by) {
  if (by <= 1) return;
  const cv::Size size = picture.grey.size() / by;
  const auto smaller = [&](cv::Mat& m, const cv::Size& to, int how) {
    if (!m.empty()) cv::resize(m(cv::Rect({0, 0}, to * by)).clone(), m, to, 0, 0, how);
  };
  smaller(picture.chroma.cb, size / 2, cv::INTER_AREA), smaller(picture.chroma.cr, size / 2, cv::INTER_AREA);
  smaller(picture.grey, size, cv::INTER_AREA), smaller(picture.mask, size, cv::INTER_NEAREST);
  CameraModel& lens = picture.lens;
  lens.fx /= by, lens.fy /= by;
  lens.cx = (lens.cx + 0.5) / by - 0.5, lens.cy = (lens.cy + 0.5) / by - 0.5;
}

}  // namespace

PhotographFixer::Outcome PhotographFixer::estimate_pose(Picture picture, const PhotographPrior& prior) {
  shrink(picture, (std::max(picture.grey.cols, picture.grey.rows) + p_.widest_px - 1) / p_.widest_px);
  const Eigen::Vector3d prior_up_c = prior.q_n_c.conjugate() * -Eigen::Vector3d::UnitZ();
  std::vector<PhotographLevel> levels = {{prior_up_c, prior.tilt_sigma_rad, 0}};
  const auto lines = lines_of(picture.grey, picture.lens, p_.level.lines);
  if (prior.tilt_sigma_rad > p_.level_rad) levels = levels_of(lines, prior_up_c, p_.level);
  matcher_.clear();
  bool sky_seen = false;
  const Chroma chroma = picture.chroma;
  for (const PhotographLevel& level : levels) {
    PhotographPrior held = prior;
    held.q_n_c = levelled(prior.q_n_c, level.up_c);
    held.tilt_sigma_rad = level.sigma_rad;
    facades_.set(lines, held.q_n_c, held.tilt_sigma_rad);
    // Colour shows more of the sky, but a colour cast misleads.
    for (const bool in_colour : {true, false}) {
      if (in_colour && chroma.empty()) continue;
      picture.chroma = in_colour ? chroma : Chroma{};
      const auto& edges = sky_detector_.find(picture, held.q_n_c.conjugate(), false);
      if (edges.empty()) continue;
      sky_seen = true;
      matcher_.add(edges, held, nullptr, &facades_);
    }
  }
  if (!sky_seen) return {.why = "no sky is visible above roofs", .no_sky = true};
  auto match = matcher_.match();
  return {std::move(match), matcher_.tried(),       matcher_.gain(),
          matcher_.why(),   matcher_.gain() < -1e8, matcher_.other()};
}

}  // namespace odograph::skyline
