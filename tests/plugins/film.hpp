// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>

#include "plugins/shared/camera/camera_model.hpp"
#include "sdk/tools/simulation/camera.hpp"

namespace odograph {

/// A generated street as a phone's camera sees it that is held upright and looks north, at 10 Hz.
class Film {
 public:
  Film(int width, int height, double focal_px, uint64_t seed) {
    scenario_.camera.width = width, scenario_.camera.height = height, scenario_.camera.focal_px = focal_px;
    world_.emplace(scenario_, seed);
    camera_.emplace(scenario_.camera, 1.0, seed);
    view_.emplace(*world_, *camera_, scenario_);
  }
  cv::Mat frame(const Eigen::Vector3d& p, size_t index, double yaw = 0) {
    Eigen::Matrix3d upright;
    upright << 0, 0, -1, 1, 0, 0, 0, -1, 0;  // the phone's x, y, z while its camera looks north
    const Eigen::AngleAxisd turned(yaw, Eigen::Vector3d::UnitZ());
    const Motion still(1.0, {p}, {Eigen::Quaterniond(turned) * Eigen::Quaterniond(upright)});
    return camera_->develop(view_->render(still, 0.1 * static_cast<double>(index)), index);
  }
  /// From p to what a camera ray meets, m; infinite where that is the sky.
  double distance(const Eigen::Vector3d& p, const Eigen::Vector3d& ray_c) const {
    const Eigen::Vector3f d = Eigen::Vector3d(ray_c.z(), ray_c.x(), ray_c.y()).normalized().cast<float>();
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit hit{};
    hit.ray.org_x = static_cast<float>(p.x()), hit.ray.org_y = static_cast<float>(p.y());
    hit.ray.org_z = static_cast<float>(p.z());
    hit.ray.dir_x = d.x(), hit.ray.dir_y = d.y(), hit.ray.dir_z = d.z();
    hit.ray.tfar = std::numeric_limits<float>::infinity(), hit.ray.mask = UINT32_MAX;
    hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(world_->scenes()[0], &context, &hit);
    return hit.ray.tfar;
  }
  CameraModel model() const {
    const auto& c = scenario_.camera;
    return {CameraModel::Distortion::radial_tangential,
            c.focal_px,
            c.focal_px,
            0.5 * (c.width - 1),
            0.5 * (c.height - 1),
            {}};
  }

 private:
  Scenario scenario_;
  std::optional<World> world_;
  std::optional<SimCamera> camera_;
  std::optional<View> view_;
};

}  // namespace odograph
