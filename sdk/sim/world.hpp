// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "sdk/sim/scenario.hpp"

namespace odograph {

/// A world of textured planes, rendered by Embree (a packaged ray caster). Coordinates: n (North-East-Down), m.
class World {
 public:
  /// A street whose facades accompany the scenario's path, or a room around it; textures are drawn from the seed.
  World(const Scenario& scenario, uint64_t seed);
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// An 8-bit grey picture of an ideal pinhole camera at T_n_c, without noise. The same bytes for any number of
  /// threads.
  cv::Mat render(const Eigen::Isometry3d& T_n_c, const Scenario& camera) const;

 private:
  struct Scene;  // Embree's handles
  struct Texture {
    std::vector<cv::Mat> levels;  // 8-bit grey, each half the size of the one before
    double metres = 1.0;          // side of the finest level's square
  };

  void add_quad(const Eigen::Vector3d& corner, const Eigen::Vector3d& u, const Eigen::Vector3d& v, size_t texture);
  void build_street(const Scenario& scenario);
  void build_room(const Scenario& scenario);
  size_t add_texture(uint64_t seed, bool facade, double metres);
  double shade(size_t texture, double u_m, double v_m, double footprint_m) const;

  std::unique_ptr<Scene> scene_;
  std::vector<Texture> textures_;
  struct Quad {
    Eigen::Vector3d u, v;  // sides
    size_t texture;
    double offset_m;  // shifts the texture, so that no two planes look the same
  };
  std::vector<Quad> quads_;
};

}  // namespace odograph
