// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <mutex>
#include <span>
#include <vector>

#include "sdk/host/base/geodesy.hpp"
#include "sdk/host/core/anchors.hpp"
#include "sdk/host/core/camera_table.hpp"
#include "sdk/host/core/pose_stream.hpp"
#include "sdk/host/core/scene.hpp"

namespace odograph {

/// The phone's pose in the world, written by the pipeline and queried by the app: poses of body and camera, anchors
/// (see anchor.h), geodetic positions. Its queries are [any].
class WorldView {
 public:
  /// `main_camera`: header.source of the pipeline's camera. `max_gap_ns`: see PoseStream. `walker_m`: see Scene.
  WorldView(const CameraTable& cameras, std::function<uint32_t()> main_camera, int64_t max_gap_ns, double walker_m)
      : cameras_(cameras), main_camera_(std::move(main_camera)), poses_(max_gap_ns), scene_(walker_m) {}

  /// PoseStream::at of the body or the camera (ODO_OF_*) in a world (ODO_WORLD_*). ODO_NOT_READY also without the
  /// extrinsics that a conversion needs.
  int32_t pose_of(uint32_t of, uint32_t world, int64_t t_ns, odo_pose& out) const;
  int32_t create_anchor(const odo_anchor_place& place, uint64_t& id);
  int32_t anchor(uint64_t id, uint32_t world, int64_t t_ns, odo_anchor& out) const;
  std::vector<uint64_t> anchor_ids() const { return anchors_.ids(); }
  int32_t remove_anchor(uint64_t id) { return anchors_.remove(id) ? ODO_OK : ODO_E_NOT_FOUND; }
  int32_t to_geodetic(const double* p_n, double* geodetic) const;
  int32_t from_geodetic(const double* geodetic, double* p_n) const;
  // See scene.h.
  int64_t points(uint32_t world, const std::function<odo_map_point*(uint64_t)>& element) const;
  std::vector<uint64_t> surface_ids() const;
  int32_t surface(uint64_t id, uint32_t world, odo_surface& out) const;
  int32_t hit_test(const odo_ray& ray, std::span<odo_hit> hits, uint32_t& count) const;

  // For the pipeline.
  Geodesy& geodesy() { return geodesy_; }
  PoseStream& poses() { return poses_; }
  Anchors& anchors() { return anchors_; }
  Scene& scene() { return scene_; }
  std::mutex& mutex() { return mutex_; }

 private:
  int32_t tracked_body(int64_t t_ns, odo_pose& out) const;
  Rigid to_world(uint32_t world, int64_t t_ns) const;
  int32_t view_through(const odo_ray& pixel, odo_pose& camera, Eigen::Vector3d& direction_c) const;
  int32_t ray_in_n(const odo_ray& ray, odo_pose& phone, Scene::Ray& out) const;

  const CameraTable& cameras_;
  const std::function<uint32_t()> main_camera_;
  Geodesy geodesy_;
  PoseStream poses_;
  Anchors anchors_{geodesy_};
  Scene scene_;
  mutable std::mutex mutex_;  // poses and anchors are corrected together
};

}  // namespace odograph
