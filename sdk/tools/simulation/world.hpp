// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include <Eigen/Geometry>
#include <embree3/rtcore.h>

#include "sdk/tools/simulation/city_model.hpp"
#include "sdk/tools/simulation/leg.hpp"
#include "sdk/tools/simulation/route.hpp"
#include "sdk/tools/simulation/scenario.hpp"
#include "sdk/tools/simulation/texture.hpp"

namespace odograph {

/// Textured quadrilaterals for Embree (a packaged ray caster). Coordinates: n, or the object's own; m.
class Mesh {
 public:
  /// One face and its texture mapping: texture coordinates are (p - origin) along two unit vectors.
  struct Surface {
    Eigen::Vector3f normal, origin, along, down;
    uint32_t texture;
    float brightness;
  };
  /// A parallelogram; u runs along the first side, v along the second.
  void add_quad(const Eigen::Vector3d& corner, const Eigen::Vector3d& u, const Eigen::Vector3d& v, uint32_t texture,
                float brightness = 1.0f);
  /// A parallelogram that shows a whole picture once, from its corner on.
  void add_picture(const Eigen::Vector3d& corner, const Eigen::Vector3d& u, const Eigen::Vector3d& v, uint32_t texture);
  /// A box whose base is centred on `foot`, rotated about the vertical.
  void add_box(const Eigen::Vector3d& foot, const Eigen::Vector3d& size, double heading, uint32_t texture,
               float brightness = 1.0f);
  /// An irregular ball, for foliage.
  void add_ball(const Eigen::Vector3d& middle, double radius, uint32_t texture, uint64_t seed);
  /// For shapes other than boxes, such as city models.
  void add_triangle(const Eigen::Vector3d corners[3], const Surface& surface) {
    add({corners[0], corners[1], corners[2], corners[2]}, surface);
  }
  RTCScene build(RTCDevice device) const;  ///< also for empty meshes
  const Surface& surface(uint32_t i) const { return surfaces_[i]; }

 private:
  void add(const std::array<Eigen::Vector3d, 4>& corners, const Surface& surface);
  std::vector<float> vertices_;
  std::vector<Surface> surfaces_;
};

/// Streets, downtowns, city models, halls and corridors along a route, with moving objects. Thread: immutable after
/// construction.
class World {
 public:
  /// `city`: the model for a world of the type `city`; otherwise unused.
  World(const Scenario& scenario, uint64_t seed, const CityModel* city = nullptr);
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// A pedestrian or vehicle that repeatedly moves along a straight line.
  struct Mover {
    size_t mesh;  ///< index into meshes()
    Eigen::Vector2d from;
    double heading, length_m, speed_mps, start_m, up_m;
    Eigen::Isometry3d at(double t_s) const;
  };

  RTCDevice device() const { return device_; }
  const std::vector<Mesh>& meshes() const { return meshes_; }      ///< 0: static objects
  const std::vector<RTCScene>& scenes() const { return scenes_; }  ///< of each mesh
  const std::vector<Mover>& movers() const { return movers_; }
  const TextureSet& textures() const { return textures_; }
  Eigen::Vector3f sun() const { return sun_; }  ///< direction to the sun, in n
  /// The scenario's route, on the ground of the city model if there is one.
  const Route& route() const { return route_; }
  /// What a ray meets among the static objects: its distance, m, and the normal there. Nothing in the sky.
  struct Sight {
    double distance_m;
    Eigen::Vector3d normal_n;
  };
  std::optional<Sight> look(const Eigen::Vector3d& eye_n, const Eigen::Vector3d& direction_n,
                            double nearest_m = 0.01) const;
  /// The skyline in `count` directions, from north to east: elevation (rad) and distance (m; 0 where nothing is) of the
  /// highest edge.
  struct SkylinePoint {
    float elevation_rad, distance_m;
  };
  std::vector<SkylinePoint> skyline(const Eigen::Vector3d& eye_n, size_t count) const;
  /// Distance along the route at which it enters a building of the city model.
  std::optional<double> route_blocked_at_m() const { return blocked_at_m_; }
  const std::vector<Building>& buildings() const { return buildings_; }  ///< generated
  const std::vector<KnownObject>& known_objects() const { return known_objects_; }

 private:
  void build_street(const Scenario& c, uint64_t seed);
  void build_houses(const Scenario& c, uint64_t seed);
  void build_background(const Scenario& c, uint64_t seed);
  void clear_places(const Scenario& c);
  bool is_cleared(const Eigen::Vector3d& p_n) const;
  void build_far_fronts(const Scenario& c, uint64_t seed);
  void add_rivers();
  void add_house(const Eigen::Vector3d& corner, const Eigen::Vector3d& front, const Eigen::Vector3d& back,
                 double height_m, uint32_t facade, float tone);
  void build_city(const CityModel& city, uint64_t seed);
  void project_route_onto(const CityModel& city);
  void plant(const std::vector<Scenario::World::Planted>& planted, uint64_t seed);
  void build_hall(uint64_t seed);
  void build_corridor();
  void add_known_objects(const Scenario& c, uint64_t seed);
  void add_movers(const Scenario& c, uint64_t seed);

  /// A rectangle beside a leg without houses: a part of a square or of a river.
  struct Cleared {
    Leg leg;
    double from, to, left, right;  ///< m along the leg and to its right
    bool river;
  };

  RTCDevice device_;
  TextureSet textures_;
  Route route_;
  std::vector<Mesh> meshes_;
  std::vector<RTCScene> scenes_;
  std::vector<Mover> movers_;
  Eigen::Vector3f sun_;
  std::vector<Building> buildings_;
  std::vector<KnownObject> known_objects_;
  std::vector<Cleared> cleared_;
  std::optional<double> blocked_at_m_;
};

}  // namespace odograph
