// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/photograph_level.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sdk/math/rotation.hpp"

namespace odograph::skyline {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

double heading_of(const Quaterniond& q_n_c) {
  const Vector3d axis = q_n_c * Vector3d::UnitZ();
  return std::atan2(axis.y(), axis.x());
}

}  // namespace

std::vector<PhotographLevel> levels_of(const std::vector<SeenLine>& lines, const PhotographLevel& prior,
                                       const PhotographLevelParameters& p) {
  const Vector3d across(prior.up_c.x(), prior.up_c.y(), 0);
  if (across.norm() < p.min_across) return {prior};
  const Vector3d axis = Vector3d::UnitZ(), level_up_c = across.normalized(), right = axis.cross(level_up_c);
  // A positive `pitch` raises the camera's axis towards the zenith.
  const auto up_of = [&](double pitch, double roll) -> Vector3d {
    return AngleAxisd(roll, axis) * (AngleAxisd(-pitch, right) * level_up_c);
  };
  struct Scored {
    PhotographLevel level;
    double score;
  };
  std::vector<Scored> found;
  for (double pitch = p.lowest_rad; pitch <= p.highest_rad; pitch += p.pitch_step_rad)
    for (const double roll : {0.0, -p.roll_rad, p.roll_rad}) {
      const auto zenith = vanishing_zenith(lines, up_of(pitch, roll), p.lines);
      if (!zenith) continue;
      const double rolled = std::asin(std::clamp(zenith->up_c.dot(right), -1.0, 1.0)) / p.usual_roll_rad;
      const double score = zenith->lines / (1 + rolled * rolled);
      const PhotographLevel level{zenith->up_c, std::max(zenith->sigma_rad, p.min_sigma_rad), zenith->lines};
      const auto same = std::find_if(found.begin(), found.end(), [&](const Scored& s) {
        return s.level.up_c.dot(level.up_c) > std::cos(p.same_rad);
      });
      if (same == found.end())
        found.push_back({level, score});
      else if (score > same->score)
        *same = {level, score};
    }
  std::sort(found.begin(), found.end(), [](const Scored& a, const Scored& b) { return a.score > b.score; });
  std::vector<PhotographLevel> levels;
  for (const Scored& s : found)
    if (levels.size() < p.most && s.score >= p.others_part * found.front().score) levels.push_back(s.level);
  if (levels.empty() && prior.sigma_rad > 2 * p.unknown_sigma_rad)
    for (const double pitch : p.guesses_rad) levels.push_back({up_of(pitch, 0), p.unknown_sigma_rad, 0});
  const double nearest = std::cos(std::min(p.prior_sigmas * prior.sigma_rad, std::numbers::pi));
  std::erase_if(levels, [&](const PhotographLevel& level) { return level.up_c.dot(prior.up_c) < nearest; });
  if (levels.empty()) levels.push_back(prior);
  return levels;
}

Quaterniond levelled(const Quaterniond& q_n_c, const Vector3d& up_c) {
  const Quaterniond q = q_n_c * shortest_rotation(up_c, q_n_c.conjugate() * -Vector3d::UnitZ()).normalized();
  return AngleAxisd(heading_of(q_n_c) - heading_of(q), Vector3d::UnitZ()) * q;
}

}  // namespace odograph::skyline
