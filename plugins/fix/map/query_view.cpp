// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "plugins/fix/map/verification.hpp"

namespace odograph::place_map {

using Eigen::Vector2d;
using Eigen::Vector3d;

QueryView view_of(const Picture& picture, const FeatureParameters& p) {
  const double f = picture.lens.focal(), margin = 15 * f / p.finest_focal_px, nearest = std::cos(p.max_off_axis_rad);
  return {picture.t_ns,
          picture.down_c.normalized(),
          picture.tilt_sigma_rad,
          PictureLevels(picture, p).features(),
          picture.grey.cols * picture.grey.rows / (f * f),
          [&picture, margin, nearest](const Vector3d& x) {
            if (x.z() < nearest * x.norm()) return false;
            const Vector2d pixel = picture.lens.project(x.head<2>() / x.z());
            return pixel.x() > margin && pixel.y() > margin && pixel.x() < picture.grey.cols - margin &&
                   pixel.y() < picture.grey.rows - margin;
          }};
}

QueryView view_of(const KeyFrame& frame, const FeatureParameters& p) {
  QueryView view{frame.t_ns, frame.down_k, frame.tilt_sigma_rad, {}, 0, {}};
  Eigen::AlignedBox2d spanned;
  for (const KeptLandmark& landmark : frame.landmarks) {
    const Vector3d ray = Eigen::Vector3f::Map(landmark.p_k.data()).cast<double>().normalized();
    if (ray.z() < std::cos(p.max_off_axis_rad)) continue;
    spanned.extend(Vector2d(ray.head<2>() / ray.z()));
    for (size_t look = 0; look < 2; ++look)
      if (const int level = landmark.levels[look]; level >= 0)
        view.features.push_back(
            {ray, Vector2d::Zero(), landmark.descriptors[look], level, std::pow(p.ratio, level) / p.finest_focal_px});
  }
  if (!spanned.isEmpty()) view.area_sr = spanned.volume();
  view.shows = [spanned](const Vector3d& x) { return x.z() > 0 && spanned.contains(Vector2d(x.head<2>() / x.z())); };
  return view;
}

}  // namespace odograph::place_map
