// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/world.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/scalar.hpp"
#include "sdk/tools/simulation/leg.hpp"
#include "sdk/tools/simulation/poster.hpp"
#include "sdk/tools/simulation/random.hpp"

namespace odograph {
namespace {

using Eigen::Vector3d;

constexpr double kElbow_m = 0.9;
using Set = TextureSet;

Mesh person(Random& random) {
  Mesh m;
  const auto tone = static_cast<float>(random.uniform(0.4, 1.7)), legs = static_cast<float>(random.uniform(0.3, 1.2));
  const double height = random.uniform(0.92, 1.08);
  m.add_box({0.15, -0.1, 0}, {0.2, 0.15, 0.85 * height}, 0, Set::kCloth, legs);
  m.add_box({-0.15, 0.1, 0}, {0.2, 0.15, 0.85 * height}, 0, Set::kCloth, legs);
  m.add_box({0, 0, -0.82 * height}, {0.26, 0.46, 0.62 * height}, 0, Set::kCloth, tone);
  m.add_box({0, 0, -1.48 * height}, {0.2, 0.17, 0.26}, 0, Set::kPaint, 1.3f);
  return m;
}

Mesh car(Random& random) {
  Mesh m;
  const auto tone = static_cast<float>(random.uniform(0.3, 1.7));
  m.add_box({0, 0, -0.25}, {4.3, 1.75, 0.65}, 0, Set::kPaint, tone);
  m.add_box({-0.3, 0, -0.9}, {2.3, 1.6, 0.55}, 0, Set::kPaint, 0.4f);
  for (const double x : {-1.35, 1.35}) m.add_box({x, 0, 0}, {0.65, 1.78, 0.6}, 0, Set::kAsphalt, 0.4f);
  return m;
}

}  // namespace

World::World(const Scenario& c, uint64_t seed, const CityModel* city)
    : device_(rtcNewDevice("threads=1")), textures_(seed), route_(c.route, c.corner_m) {
  Random random(seed, 60);
  double azimuth = random.uniform(0, 2 * kPi), height = random.uniform(0.5, 1.0);
  if (c.world.sun) azimuth = (*c.world.sun)[0], height = (*c.world.sun)[1];
  sun_ = Vector3d(std::cos(height) * std::cos(azimuth), std::cos(height) * std::sin(azimuth), -std::sin(height))
             .cast<float>();
  meshes_.emplace_back();
  if (c.world.type == "room")
    build_hall(seed);
  else if (c.world.type == "corridor")
    build_corridor();
  else if (city)
    project_route_onto(*city), build_city(*city, seed), plant(c.world.planted, seed);
  else
    clear_places(c), build_street(c, seed);
  add_known_objects(c, seed);
  add_movers(c, seed);
  for (const Mesh& mesh : meshes_) scenes_.push_back(mesh.build(device_));
}

World::~World() {
  for (RTCScene scene : scenes_) rtcReleaseScene(scene);
  rtcReleaseDevice(device_);
}

Eigen::Isometry3d World::Mover::at(double t) const {
  const double d = std::fmod(start_m + speed_mps * t, length_m);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << from.x() + d * std::cos(heading), from.y() + d * std::sin(heading), -up_m;
  T.linear() = Eigen::AngleAxisd(heading, Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

std::optional<World::Sight> World::look(const Vector3d& eye_n, const Vector3d& direction_n, double nearest_m) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  const Eigen::Vector3f eye = eye_n.cast<float>(), direction = direction_n.cast<float>();
  RTCRayHit hit{};
  hit.ray.org_x = eye.x(), hit.ray.org_y = eye.y(), hit.ray.org_z = eye.z();
  hit.ray.dir_x = direction.x(), hit.ray.dir_y = direction.y(), hit.ray.dir_z = direction.z();
  hit.ray.tnear = static_cast<float>(nearest_m), hit.ray.tfar = 1e5f, hit.ray.mask = ~0u;
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scenes_[0], &context, &hit);
  if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const Eigen::Vector3f normal(hit.hit.Ng_x, hit.hit.Ng_y, hit.hit.Ng_z);
  return Sight{static_cast<double>(hit.ray.tfar), normal.cast<double>().normalized()};
}

std::vector<World::SkylinePoint> World::skyline(const Vector3d& eye_n, size_t count) const {
  const auto look_towards = [&](double azimuth, double elevation) {
    const Vector3d direction(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                             -std::sin(elevation));
    const auto seen = look(eye_n, direction, 0.1);
    return seen ? static_cast<float>(seen->distance_m) : 0.0f;
  };
  constexpr double kStep = 1.0 * kPi / 180;
  std::vector<SkylinePoint> line;
  for (size_t k = 0; k < count; ++k) {
    const double azimuth = 2 * kPi * static_cast<double>(k) / static_cast<double>(count);
    double high = 0.5 * kPi - 1e-3, low = high;
    while (low > 0 && look_towards(azimuth, low) == 0) high = low, low -= kStep;
    low = std::max(low, 0.0);
    for (int i = 0; i < 9; ++i) {
      const double middle = 0.5 * (low + high);
      (look_towards(azimuth, middle) > 0 ? low : high) = middle;
    }
    line.push_back({static_cast<float>(low), look_towards(azimuth, low)});
  }
  return line;
}

void World::add_known_objects(const Scenario& c, uint64_t seed) {
  const auto hang = [&](const Vector3d& middle, const Vector3d& u, const Vector3d& v, Texture texture) {
    meshes_[0].add_picture(middle - 0.5 * u - 0.5 * v, u, v, static_cast<uint32_t>(textures_.all.size()));
    textures_.all.push_back(std::move(texture));
  };
  const auto survey = [&](const Vector3d& middle, const Vector3d& a, const Vector3d& b, cv::Mat poster) {
    known_objects_.push_back({static_cast<uint32_t>(known_objects_.size()),
                              std::move(poster),
                              {middle - a + b, middle + a + b, middle + a - b, middle - a - b}});
  };
  for (const auto& o : c.objects) {
    const auto place = route_.at(o.at_m);
    const Vector3d right(-std::sin(place.heading), std::cos(place.heading), 0);
    const Vector3d foot(place.north_east.x(), place.north_east.y(), -place.up);
    const Vector3d middle = foot + o.right_m * right - Vector3d(0, 0, o.up_m), down(0, 0, 1);
    const auto number = static_cast<uint32_t>(known_objects_.size());
    if (o.kind == "poster") {
      const double width_m = o.aspect * o.side_m;
      cv::Mat poster = poster_on_wall(seed * 1000 + number, o.aspect);
      hang(middle, width_m * right, o.side_m * down,
           poster_texture(poster, static_cast<float>(std::max(width_m, o.side_m))));
      survey(middle, 0.5 * width_m * right, 0.5 * o.side_m * down, std::move(poster));
    } else {
      // The board is white around its tag: 10 cells, of which the tag's black square takes 8.
      const double board_m = 1.25 * o.side_m;
      hang(middle, board_m * right, board_m * down, tag_texture(number, static_cast<float>(board_m)));
      survey(middle, 0.5 * o.side_m * right, 0.5 * o.side_m * down, {});
    }
  }
}

void World::add_movers(const Scenario& c, uint64_t seed) {
  if (c.world.type == "corridor") return;
  Random random(seed, 64);
  const size_t people = meshes_.size();
  for (int k = 0; k < 4; ++k) meshes_.push_back(person(random));
  const size_t cars = meshes_.size();
  for (int k = 0; k < 2; ++k) meshes_.push_back(car(random));
  const double edge = 0.5 * c.world.street_width_m;
  for (const Leg& leg : legs_of(route_)) {
    const auto send = [&](size_t mesh, double right, double speed) {
      const bool back = random.uniform() < 0.5;
      const Vector3d start = leg.at(back ? leg.length : 0, right);
      movers_.push_back({mesh, start.head<2>(), leg.heading() + (back ? kPi : 0), leg.length, speed,
                         random.uniform(0, leg.length), leg.from.z()});
    };
    const auto number = [&](int64_t density) {
      return static_cast<int>(std::floor(static_cast<double>(density) * leg.length / 100 + random.uniform()));
    };
    const auto aside = [&](double most) {  // keeps pedestrians clear of the camera's path
      const double right = random.uniform(-1, 1) * (most - kElbow_m);
      return right + std::copysign(kElbow_m, right);
    };
    for (int k = number(c.world.pedestrians); k > 0; --k) {
      const double speed = random.uniform(1.0, 1.7), right = aside(std::min(edge - 1, 4.5));
      send(people + random.next() % 4, right, speed);
    }
    for (int k = number(c.world.cars); k > 0 && !c.is_indoors() && edge > 5; --k) {
      const double speed = random.uniform(5, 11), side = random.uniform() < 0.5 ? -1 : 1;
      send(cars + random.next() % 2, side * std::min(edge - 5.2, 3.0), speed);
    }
  }
  add_rivers();
}

}  // namespace odograph
