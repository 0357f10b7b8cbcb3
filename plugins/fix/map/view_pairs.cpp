// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/map/view_pairs.hpp"

#include <algorithm>
#include <cmath>

namespace odograph::place_map {
namespace {

using Eigen::Vector3d;

struct Nearest {
  int distance = 257;
  size_t other = 0;
  int second = 257;  // of a corner elsewhere
};

}  // namespace

std::optional<ViewMotion> motion_between(const CornerView& view, std::span<const Landmark> landmarks,
                                         const CornerView& older, const Rigid& T_o_c, const PoseParameters& pose,
                                         size_t fewest) {
  std::vector<Correspondence> common;
  for (const Landmark& landmark : landmarks) {
    const auto at = std::lower_bound(older.tracked.begin(), older.tracked.end(), landmark.id,
                                     [](const auto& entry, uint64_t id) { return entry.first < id; });
    if (at == older.tracked.end() || at->first != landmark.id) continue;
    const Vector3d ray = landmark.p_c.normalized();
    Correspondence& match = common.emplace_back();
    match.p_k = landmark.p_c, match.ray_c = at->second, match.sigma_rad = 0;
    match.along_sigma = std::sqrt(std::max(0.0, ray.dot(landmark.covariance * ray)));
  }
  if (common.size() < fewest) return std::nullopt;
  const Gravity gravity{view.down_c, older.down_c, 0.01};
  const auto refined = refine_pose(common, gravity, T_o_c, pose);
  if (!refined) return std::nullopt;
  const Eigen::Matrix<double, 6, 6> covariance = refined->information.inverse();
  return ViewMotion{refined->T_c_k, std::sqrt(covariance.topLeftCorner<3, 3>().trace() / 3)};
}

bool is_as_far(const Vector3d& p_c, std::span<const Landmark> tracked, const ViewPairParameters& p) {
  std::vector<std::pair<double, double>> near;  // angle to it, as 1 - cosine, and distance
  for (const Landmark& landmark : tracked)
    near.emplace_back(1 - p_c.normalized().dot(landmark.p_c.normalized()), landmark.p_c.norm());
  const auto last = near.begin() + static_cast<std::ptrdiff_t>(std::min(p.beside, near.size()));
  std::partial_sort(near.begin(), last, near.end());
  const auto [nearest, farthest] =
      std::minmax_element(near.begin(), last, [](const auto& a, const auto& b) { return a.second < b.second; });
  return last != near.begin() && p_c.norm() > nearest->second / p.deeper && p_c.norm() < farthest->second * p.deeper;
}

std::vector<PairedCorner> pair_corners(const CornerView& view, const CornerView& older, const ViewMotion& motion,
                                       const ViewPairParameters& p) {
  std::vector<PairedCorner> pairs;
  const Rigid T_c_o = motion.T_o_c.inverse();
  const Vector3d& p_c_o = T_c_o.p;
  const double base = p_c_o.norm();
  if (base < 0.02) return pairs;
  std::vector<Vector3d> turned;
  for (const Feature& feature : older.features) turned.push_back(T_c_o.q * feature.ray_c);
  std::vector<Nearest> forth(view.features.size()), back(older.features.size());
  std::vector<std::pair<int, size_t>> near;  // to one corner, by distance
  for (size_t i = 0; i < view.features.size(); ++i) {
    const Feature& a = view.features[i];
    near.clear();
    const Vector3d plane = p_c_o.cross(a.ray_c).normalized();
    for (size_t k = 0; k < older.features.size(); ++k) {
      const Feature& b = older.features[k];
      if (std::abs(a.level - b.level) > 1) continue;
      if (std::abs(plane.dot(turned[k])) > p.epipolar_rad + std::max(a.sigma_rad, b.sigma_rad)) continue;
      const int distance = hamming(a.descriptor, b.descriptor);
      near.emplace_back(distance, k);
      if (distance < forth[i].distance) forth[i] = {distance, k};
      if (distance < back[k].distance) back[k] = {distance, i};
    }
    for (const auto& [distance, k] : near)
      if ((turned[k] - turned[forth[i].other]).norm() > p.distinct_rad)
        forth[i].second = std::min(forth[i].second, distance);
  }
  for (size_t i = 0; i < view.features.size(); ++i) {
    if (forth[i].distance > p.max_distance || back[forth[i].other].other != i) continue;
    if (forth[i].distance > p.max_ratio * forth[i].second) continue;
    const Vector3d &a = view.features[i].ray_c, &b = turned[forth[i].other];
    // Distances along both rays at which they are nearest to each other.
    const double ab = a.dot(b), across = 1 - ab * ab, parallax = std::sqrt(std::max(0.0, across));
    if (parallax < p.min_parallax_rad) continue;
    const double to = (p_c_o.dot(a) - ab * p_c_o.dot(b)) / across;
    const double from = (ab * p_c_o.dot(a) - p_c_o.dot(b)) / across;
    if (!(to > p.min_range && from > p.min_range && to < p.max_range)) continue;
    const double pixel = 0.7 * std::max(view.features[i].sigma_rad, older.features[forth[i].other].sigma_rad);
    const double sigma = std::hypot(pixel, p.lens_rad, motion.rotation_sigma);
    pairs.push_back({i, older.ids[forth[i].other], forth[i].other, to * a, to * sigma, 1.4 * from * sigma / parallax});
  }
  return pairs;
}

}  // namespace odograph::place_map
