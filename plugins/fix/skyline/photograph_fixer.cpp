// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/photograph_fixer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace odograph::skyline {
namespace {

/// Reduces a larger picture to this long side.
void shrink(Picture& picture, int widest_px) {
  const cv::Size from = picture.grey.size();
  const double part = static_cast<double>(widest_px) / std::max(from.width, from.height);
  if (part >= 1) return;
  const auto even = [&](int px) { return std::max(2, 2 * static_cast<int>(std::lround(0.5 * part * px))); };
  const cv::Size size(even(from.width), even(from.height));
  const auto smaller = [](cv::Mat& m, const cv::Size& to, int how) {
    if (!m.empty()) cv::resize(m.clone(), m, to, 0, 0, how);
  };
  smaller(picture.chroma.cb, size / 2, cv::INTER_AREA), smaller(picture.chroma.cr, size / 2, cv::INTER_AREA);
  smaller(picture.grey, size, cv::INTER_AREA), smaller(picture.mask, size, cv::INTER_NEAREST);
  const double x = static_cast<double>(size.width) / from.width, y = static_cast<double>(size.height) / from.height;
  CameraModel& lens = picture.lens;
  lens.fx *= x, lens.fy *= y;
  lens.cx = (lens.cx + 0.5) * x - 0.5, lens.cy = (lens.cy + 0.5) * y - 0.5;
}

}  // namespace

PhotographFixer::Outcome PhotographFixer::estimate_pose(Picture picture, const PhotographPrior& prior) {
  shrink(picture, p_.widest_px);
  const auto lines = lines_of(picture.grey, picture.mask, picture.lens, p_.level.lines);
  const PhotographLevel held_level{prior.q_n_c.conjugate() * -Eigen::Vector3d::UnitZ(), prior.tilt_sigma_rad, 0};
  const bool is_level_known = prior.tilt_sigma_rad <= p_.level_rad;
  const auto levels = is_level_known ? std::vector{held_level} : levels_of(lines, held_level, p_.level);
  matcher_.clear(), facades_.clear();
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
      if (!edges.empty()) matcher_.add(edges, held, nullptr, &facades_);
    }
  }
  auto match = matcher_.match();
  return {std::move(match), matcher_.why(), matcher_.reason()};
}

}  // namespace odograph::skyline
