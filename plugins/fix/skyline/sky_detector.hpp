// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "plugins/fix/skyline/picture_job.hpp"
#include "plugins/fix/skyline/robust_sky.hpp"
#include "plugins/fix/skyline/sky_finder.hpp"

namespace odograph::skyline {

/// Finds the sky in pictures by the configured method; a new lens gives a new finder.
class SkyDetector {
 public:
  const std::vector<SkyEdge>& find(const Picture& picture, const Eigen::Quaterniond& q_c_n, bool flood_fill) {
    const Eigen::Vector3d up_c = q_c_n * -Eigen::Vector3d::UnitZ(), north_c = q_c_n * Eigen::Vector3d::UnitX();
    const bool same = picture.lens == lens_;
    lens_ = picture.lens;
    if (flood_fill) {
      if (!finder_ || !same) finder_.emplace(lens_, picture.grey.size());
      return finder_->find(picture.grey, up_c, north_c);
    }
    if (!robust_ || !same) robust_.emplace(RobustSkyFinder::Parameters{}, lens_, picture.grey.size());
    return robust_->find(picture.grey, picture.mask, up_c, north_c, picture.chroma);
  }

 private:
  CameraModel lens_;  // of the finders
  std::optional<SkyFinder> finder_;
  std::optional<RobustSkyFinder> robust_;
};

}  // namespace odograph::skyline
