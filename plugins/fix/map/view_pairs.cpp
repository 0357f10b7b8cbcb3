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
};

}  // namespace

std::vector<PairedCorner> pair_corners(const CornerView& view, const CornerView& older, const Eigen::Quaterniond& q_c_o,
                                       const Vector3d& p_c_o, const ViewPairParameters& p) {
  std::vector<PairedCorner> pairs;
  const double base = p_c_o.norm();
  if (base < 0.02) return pairs;
  std::vector<Vector3d> turned;
  for (const Feature& feature : older.features) turned.push_back(q_c_o * feature.ray_c);
  std::vector<Nearest> forth(view.features.size()), back(older.features.size());
  for (size_t i = 0; i < view.features.size(); ++i) {
    const Feature& a = view.features[i];
    const Vector3d plane = p_c_o.cross(a.ray_c).normalized();
    for (size_t k = 0; k < older.features.size(); ++k) {
      const Feature& b = older.features[k];
      if (std::abs(a.level - b.level) > 1) continue;
      if (std::abs(plane.dot(turned[k])) > p.epipolar_rad + std::max(a.sigma_rad, b.sigma_rad)) continue;
      const int distance = hamming_within(a.descriptor, b.descriptor, p.max_distance);
      if (distance < forth[i].distance) forth[i] = {distance, k};
      if (distance < back[k].distance) back[k] = {distance, i};
    }
  }
  for (size_t i = 0; i < view.features.size(); ++i) {
    if (forth[i].distance > p.max_distance || back[forth[i].other].other != i) continue;
    const Vector3d &a = view.features[i].ray_c, &b = turned[forth[i].other];
    // Distances along both rays at which they are nearest to each other.
    const double ab = a.dot(b), across = 1 - ab * ab, parallax = std::sqrt(std::max(0.0, across));
    if (parallax < p.min_parallax_rad) continue;
    const double to = (p_c_o.dot(a) - ab * p_c_o.dot(b)) / across;
    const double from = (ab * p_c_o.dot(a) - p_c_o.dot(b)) / across;
    if (!(to > p.min_range && from > p.min_range && to < p.max_range)) continue;
    const double pixel = 0.7 * std::max(view.features[i].sigma_rad, older.features[forth[i].other].sigma_rad);
    const double sigma = std::hypot(pixel, p.lens_rad);
    pairs.push_back({i, older.ids[forth[i].other], forth[i].other, to * a, to * sigma, 1.4 * from * sigma / parallax});
  }
  return pairs;
}

}  // namespace odograph::place_map
