// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <odograph/scene.h>

#include "sdk/host/base/rigid.hpp"
#include "sdk/math/frame_landmarks.hpp"
#include "sdk/math/voxel_map.hpp"

namespace odograph {

/// What is around the phone: landmarks of the front-end and surfaces of surface finders, in a frame m that moves with
/// the track, so that a correction moves both at once. Not thread-safe: poses, anchors and this change together, under
/// the lock of the world. Allocates at construction alone, but for the surfaces.
class Scene {
 public:
  struct Parameters {
    double cube_m = 0.1;           ///< one landmark in each; a hand's breadth
    double hit_cone_rad = 0.0087;  ///< half a degree: about a finger tip on a phone at arm's length
    double beside_rad = 0.035;     ///< 2 degrees around a landmark: how its surroundings lie
    double hand = 0.80;            ///< height of the hand over the walker's; 0.9 in Antigny et al. 2019, Table 1, 0.74
                                   ///< in the hall of phone_walks (docs/simulator.md)
    double hand_sigma = 0.08;      ///< the same: half of the difference
    double drift = 0.01;           ///< error of the track between two views, relative; docs/accuracy.md
    double explained = 3;          ///< sigmas from a surface within which a landmark is part of it
    size_t max_surfaces = 256;     ///< further ones are not kept
  };

  /// A surface in m.
  struct Surface {
    uint64_t id = 0;
    uint32_t kind = 0;
    Rigid T_m_s;
    double sigma_m = 0, tilt_sigma_rad = 0;
    double scale_sigma = 0;                           ///< relative, when it was measured
    Eigen::Vector3d eye_m = Eigen::Vector3d::Zero();  ///< where the phone was then
    int64_t t_ns = 0;
    std::vector<Eigen::Vector2d> outline;
    uint32_t source = 0, resets = 0;  ///< of the finder
    uint64_t own_id = 0;              ///< there
  };
  /// What is hit, in n.
  struct Hit {
    uint32_t what = 0;
    const Surface* surface = nullptr;
    Eigen::Vector3d p_n = Eigen::Vector3d::Zero(), normal_n = Eigen::Vector3d::Zero();
    double distance_m = 0, sigma_m = 0, scale_sigma = 0;  ///< as of odo_hit
    double moved_m = 0;                                   ///< by the phone since it was seen
  };
  struct Ray {
    Eigen::Vector3d origin_n, direction_n;  ///< of length 1
    double max_distance_m;
    uint32_t wanted;  ///< ODO_HIT_*
  };

  /// `walker_m`: height of the walker; 0: none, and no floor is assumed.
  explicit Scene(double walker_m = 0) : walker_m_(walker_m), points_(kSets, p_.cube_m) {}

  /// Landmarks of the frame whose pose follows.
  void hold(const odo_points& points) { frame_.hold(points); }
  /// A new pose: of the frame whose landmarks wait.
  void see(const odo_pose& pose);
  /// A point x in the old n is at `correction` * x.
  void correct(const Rigid& correction) { T_n_m_ = correction * T_n_m_; }
  /// A surface that its finder found, changed, merged or withdrew. Returns it with the session's id, or null if it is
  /// not kept; `message` gets the ids of the session.
  const Surface* take(odo_surface& message, uint32_t resets);
  /// Takes the surfaces that a finder, which has been reset, cannot withdraw any more.
  std::vector<Surface> take_orphans(uint32_t source, uint32_t resets);
  /// The clock was set back.
  void forget_pending() { frame_.forget(); }

  const Rigid& T_n_m() const { return T_n_m_; }
  bool is_metric() const { return scale_sigma_.has_value(); }
  const std::vector<Surface>& surfaces() const { return surfaces_; }
  const Surface* find(uint64_t id) const;
  /// Whether a surface has, or had, this id.
  bool knows(uint64_t id) const { return id <= last_id_; }
  /// Calls each(p_n, sigma_m, t_ns).
  template <class Visit>
  void visit_points(Visit&& each) const {
    visit_current([&](const MapPoint& point) { each(T_n_m_ * point.p, point.sigma_m(), point.t_ns); });
  }
  /// Writes the nearest hits, nearest first, and returns their number. `phone_n`: of that time.
  size_t cast(const Ray& ray, const Eigen::Vector3d& phone_n, Hit* hits, size_t capacity) const;

 private:
  static constexpr size_t kSets = ODO_MOST_MAP_POINTS / 8;
  template <class Visit>
  void visit_current(Visit&& each) const {
    points_.visit([&](const MapPoint& point) {
      if (scale_is_current(static_cast<double>(point.scale_sigma), scale_sigma_.value_or(1))) each(point);
    });
  }
  std::optional<Hit> hit_surface(const Ray& ray, const Surface& surface, const Eigen::Vector3d& phone_n,
                                 bool beyond) const;
  std::optional<Hit> hit_point(const Ray& ray, const Eigen::Vector3d& phone_n) const;
  double slope_beside(const MapPoint& landmark, const Eigen::Vector3d& origin_m) const;
  std::optional<Hit> hit_assumed_floor(const Ray& ray, const Eigen::Vector3d& phone_n) const;
  void remove(size_t i) { surfaces_.erase(surfaces_.begin() + static_cast<ptrdiff_t>(i)); }

  Parameters p_;
  double walker_m_;
  Rigid T_n_m_;
  Eigen::Vector3d eye_m_ = Eigen::Vector3d::Zero();  // of the newest pose
  VoxelMap points_;
  FrameLandmarks frame_;
  std::optional<double> scale_sigma_;  // relative, once the scale is known
  std::vector<Surface> surfaces_;
  uint64_t last_id_ = 0;
};

}  // namespace odograph
