// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/inertial/standing.hpp"

#include <algorithm>

#include "plugins/shared/camera/two_view.hpp"
#include "plugins/vo/odograph/inertial/observe.hpp"

namespace odograph::vio {

std::optional<double> residual_flow(const FrameCorners& before, const FrameCorners& now, const Camera& camera,
                                    size_t least) {
  std::vector<cv::Point2d> first, second;
  Clone still;
  still.focal_px = camera.lens.focal();
  for (const Corner& corner : now.corners) {
    const auto at = std::lower_bound(before.corners.begin(), before.corners.end(), corner.track,
                                     [](const Corner& c, uint64_t track) { return c.track < track; });
    if (at == before.corners.end() || at->track != corner.track) continue;
    const Eigen::Vector3d a = ray_of(still, camera, at->pixel, at->row);
    const Eigen::Vector3d b = ray_of(still, camera, corner.pixel, corner.row);
    first.emplace_back(a.x(), a.y()), second.emplace_back(b.x(), b.y());
  }
  if (first.size() < least) return std::nullopt;
  const auto rotation = pure_rotation(first, second);
  if (!rotation) return std::nullopt;
  return rotation->median_residual_rad * camera.lens.focal();
}

}  // namespace odograph::vio
