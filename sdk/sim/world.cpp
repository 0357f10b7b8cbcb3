// SPDX-License-Identifier: Apache-2.0
#include "sdk/sim/world.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/sim/random.hpp"

namespace odograph {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPi = 3.14159265358979323846;
using Set = TextureSet;

/// A leg of the route between two of its corners.
struct Leg {
  Vector3d from, to;  // north, east, up
  Vector3d along;     // unit, level
  Vector3d aside;     // unit, to the right
  double length;

  /// d metres along and `right` metres beside it, on the ground, in n.
  Vector3d at(double d, double right) const {
    Vector3d p = from + d * along + right * aside;
    p.z() = -(from.z() + (to.z() - from.z()) * std::clamp(d / length, 0.0, 1.0));
    return p;
  }
  double heading() const { return std::atan2(along.y(), along.x()); }
};

std::vector<Leg> legs_of(const Route& route) {
  std::vector<Leg> legs;
  const auto& points = route.points();
  for (size_t i = 1; i < points.size(); ++i) {
    Vector3d along = points[i] - points[i - 1];
    along.z() = 0;
    const double length = along.norm();
    along /= length;
    legs.push_back({points[i - 1], points[i], along, {-along.y(), along.x(), 0}, length});
  }
  return legs;
}

double distance_to(const Leg& leg, const Vector3d& p_n) {
  const Vector3d d(p_n.x() - leg.from.x(), p_n.y() - leg.from.y(), 0);
  return (d - std::clamp(d.dot(leg.along), 0.0, leg.length) * leg.along).norm();
}

/// True when no leg comes nearer to the point than that.
bool is_free(const std::vector<Leg>& legs, const Vector3d& p_n, double clearance) {
  return std::all_of(legs.begin(), legs.end(), [&](const Leg& leg) { return distance_to(leg, p_n) >= clearance; });
}

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

World::World(const Scenario& c, uint64_t seed) : device_(rtcNewDevice("threads=1")), textures_(seed) {
  const Route route(c.route, c.corner_m);
  Random random(seed, 60);
  const double azimuth = random.uniform(0, 2 * kPi), height = random.uniform(0.5, 1.0);
  sun_ = Vector3d(std::cos(height) * std::cos(azimuth), std::cos(height) * std::sin(azimuth), -std::sin(height))
             .cast<float>();
  meshes_.emplace_back();
  if (c.world.type == "room")
    build_hall(c, route, seed);
  else if (c.world.type == "corridor")
    build_corridor(route);
  else
    build_street(c, route, seed);
  add_movers(c, route, seed);
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

void World::build_street(const Scenario& c, const Route& route, uint64_t seed) {
  Mesh& m = meshes_[0];
  const auto legs = legs_of(route);
  Vector3d low = route.points().front(), high = low;
  for (const auto& p : route.points()) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const double margin = 120;
  m.add_quad({low.x() - margin, low.y() - margin, -low.z() + 0.02}, {high.x() - low.x() + 2 * margin, 0, 0},
             {0, high.y() - low.y() + 2 * margin, 0}, Set::kPaving);
  double lift_m = 0.01;          // each road a little above the ones before
  for (const Leg& leg : legs) {  // the road itself, following its slope
    const Vector3d above(0, 0, -(lift_m += 0.004));
    const double half = std::min(3.0, 0.25 * c.world.street_width_m), lift = leg.to.z() == leg.from.z() ? 0.0 : 2.0;
    const Vector3d start = leg.at(0, -half - lift) + above;
    m.add_quad(start, leg.at(leg.length, -half - lift) + above - start, 2 * (half + lift) * leg.aside, Set::kAsphalt);
    for (double d = 2; d + 3 < leg.length; d += 7)  // lane marks
      m.add_quad(leg.at(d, -0.08) + 2 * above, 3 * leg.along, 0.16 * leg.aside, Set::kWall);
  }
  build_houses(c, route, seed);
  Random random(seed, 61);
  const double per_metre = 0.01, edge = 0.5 * c.world.street_width_m;
  const auto place = [&](int64_t density, double right, auto&& put) {
    for (const Leg& leg : legs)
      for (int64_t k = 0; k < std::llround(static_cast<double>(density) * per_metre * leg.length); ++k) {
        const double side = random.uniform() < 0.5 ? -1 : 1, d = random.uniform(0, leg.length);
        const Vector3d p = leg.at(d, side * right);
        if (is_free(legs, p, std::min(2.0, 0.6 * right))) put(p, leg.heading());
      }
  };
  place(c.world.trees, edge - 1.2, [&](const Vector3d& p, double) {
    const double height = random.uniform(2.2, 3.5);
    m.add_box(p, {0.3, 0.3, height}, random.uniform(0, 3), Set::kLeaves, 0.7f);
    m.add_ball(p - Vector3d(0, 0, height + 1.2), random.uniform(1.3, 2.4), Set::kLeaves, random.next());
  });
  place(c.world.parked_cars, edge - 3.0, [&](const Vector3d& p, double heading) {
    const auto tone = static_cast<float>(random.uniform(0.4, 1.6));
    m.add_box(p - Vector3d(0, 0, 0.25), {4.3, 1.75, 0.65}, heading, Set::kPaint, tone);
    m.add_box(p - Vector3d(0, 0, 0.9), {2.3, 1.6, 0.55}, heading, Set::kPaint, 0.4f);
  });
  place(6, edge - 0.6, [&](const Vector3d& p, double) { m.add_box(p, {0.12, 0.12, 5}, 0, Set::kAsphalt, 0.8f); });
}

void World::build_houses(const Scenario& c, const Route& route, uint64_t seed) {
  Mesh& m = meshes_[0];
  auto legs = legs_of(route);
  const double edge = 0.5 * c.world.street_width_m;
  Random random(seed, 62);
  const auto house = [&](const Vector3d& corner, const Vector3d& front, const Vector3d& back) {
    const double tall = c.world.house_height_m * random.uniform(0.6, 1.4);
    const Vector3d up(0, 0, -tall);
    const auto facade = static_cast<uint32_t>(random.next() % Set::kFacades);
    const auto tone = static_cast<float>(random.uniform(0.8, 1.15));
    // v runs down the wall from its top, so that windows stand upright.
    m.add_quad(corner + up, front, -up, facade, tone);
    m.add_quad(corner + up, back, -up, facade, tone);
    m.add_quad(corner + front + up, back, -up, facade, tone);
    m.add_quad(corner + up, front, back, Set::kAsphalt, 1.2f);
  };
  for (const Leg& leg : legs) {
    for (const double side : {-1.0, 1.0}) {
      for (double d = -30; d < leg.length + 30;) {
        const double width = random.uniform(8, 17), set_back = random.uniform(0, 2.5);
        const double depth = random.uniform(7, 12);
        const Vector3d corner = leg.at(d, side * (edge + set_back));
        const Vector3d front = width * leg.along, back = side * depth * leg.aside;
        bool free = true;
        for (const double a : {0.0, 0.5, 1.0})
          for (const double b : {0.0, 0.5, 1.0})
            free = free && is_free(legs, corner + a * front + b * back, edge - 0.2);
        // Seen from the street, the facade's u runs to the right.
        if (free) house(side > 0 ? Vector3d(corner + front) : corner, side > 0 ? Vector3d(-front) : front, back);
        d += width + (random.uniform() < 0.12 ? random.uniform(3, 9) : 0.0);
      }
    }
  }
  for (const bool end : {false, true}) {  // what closes the view at both ends
    const Leg& leg = end ? legs.back() : legs.front();
    const Vector3d middle = leg.at(end ? leg.length + 45 : -45, 0);
    for (int k = -3; k < 3; ++k)
      house(middle + (end ? 14.0 : -14.0) * k * leg.aside, (end ? 14 : -14) * leg.aside, (end ? 8 : -8) * leg.along);
  }
}

void World::build_hall(const Scenario&, const Route& route, uint64_t seed) {
  Mesh& m = meshes_[0];
  const auto legs = legs_of(route);
  Vector3d low = route.points().front(), high = low;
  for (const auto& p : route.points()) low = low.cwiseMin(p), high = high.cwiseMax(p);
  low -= Vector3d(5, 5, 0), high += Vector3d(5, 5, 0);
  const double north = high.x() - low.x(), east = high.y() - low.y();
  const Vector3d down(0, 0, 3.4);
  const Vector3d a(low.x(), low.y(), -3.4);
  m.add_quad(a + down, {north, 0, 0}, {0, east, 0}, Set::kPaving);
  m.add_quad(a, {north, 0, 0}, {0, east, 0}, Set::kWall);
  m.add_quad(a, {north, 0, 0}, down, 0);
  m.add_quad(a + Vector3d(0, east, 0), {north, 0, 0}, down, 1);
  m.add_quad(a, {0, east, 0}, down, 3);
  m.add_quad(a + Vector3d(north, 0, 0), {0, east, 0}, down, 4);
  Random random(seed, 63);
  for (int k = 0; k < static_cast<int>(north * east / 30); ++k) {
    const Vector3d p(random.uniform(low.x(), high.x()), random.uniform(low.y(), high.y()), 0);
    if (!is_free(legs, p, 1.2)) continue;
    if (k % 3 == 0)
      m.add_box(p, {0.5, 0.5, 3.4}, random.uniform(0, 1.5), 1, 1.0f);
    else
      m.add_box(p, {random.uniform(0.5, 1.5), random.uniform(0.5, 1.0), random.uniform(0.5, 1.6)}, random.uniform(0, 3),
                Set::kCloth, static_cast<float>(random.uniform(0.5, 1.6)));
  }
}

void World::build_corridor(const Route& route) {
  Mesh& m = meshes_[0];
  for (const Leg& leg : legs_of(route)) {
    const Vector3d run = (leg.length + 2.4) * leg.along, across = 2.4 * leg.aside, up(0, 0, -2.6);
    const Vector3d corner = leg.at(-1.2, -1.2);
    m.add_quad(corner, run, across, Set::kWall, 0.7f);
    m.add_quad(corner + up, run, across, Set::kWall, 1.1f);
    for (double d = 0; d < leg.length - 1; d += 6) {  // doors are all there is
      m.add_quad(leg.at(d + 2, -1.19), 0.9 * leg.along, {0, 0, -2.05}, Set::kWall, 0.8f);
      m.add_quad(leg.at(d + 4, 1.19), 0.9 * leg.along, {0, 0, -2.05}, Set::kWall, 0.85f);
    }
    m.add_quad(leg.at(0.8, -1.2), (leg.length - 1.6) * leg.along, up, Set::kWall);
    m.add_quad(leg.at(0.8, 1.2), (leg.length - 1.6) * leg.along, up, Set::kWall, 0.95f);
  }
  const auto legs = legs_of(route);
  m.add_quad(legs.front().at(-1.2, -1.2), 2.4 * legs.front().aside, {0, 0, -2.6}, Set::kWall, 0.9f);
  m.add_quad(legs.back().at(legs.back().length + 1.2, -1.2), 2.4 * legs.back().aside, {0, 0, -2.6}, Set::kWall, 0.9f);
}

void World::add_movers(const Scenario& c, const Route& route, uint64_t seed) {
  if (c.world.type == "corridor") return;
  Random random(seed, 64);
  const size_t people = meshes_.size();
  for (int k = 0; k < 4; ++k) meshes_.push_back(person(random));
  const size_t cars = meshes_.size();
  for (int k = 0; k < 2; ++k) meshes_.push_back(car(random));
  const double edge = 0.5 * c.world.street_width_m;
  for (const Leg& leg : legs_of(route)) {
    const auto send = [&](size_t mesh, double right, double speed) {
      const bool back = random.uniform() < 0.5;
      const Vector3d start = leg.at(back ? leg.length : 0, right);
      movers_.push_back({mesh, start.head<2>(), leg.heading() + (back ? kPi : 0), leg.length, speed,
                         random.uniform(0, leg.length), leg.from.z()});
    };
    const auto number = [&](int64_t density) {
      return static_cast<int>(std::floor(static_cast<double>(density) * leg.length / 100 + random.uniform()));
    };
    for (int k = number(c.world.pedestrians); k > 0; --k)
      send(people + random.next() % 4, random.uniform(-1, 1) * std::min(edge - 1, 4.5), random.uniform(1.0, 1.7));
    for (int k = number(c.world.cars); k > 0 && c.world.type == "street" && edge > 5; --k)
      send(cars + random.next() % 2, (random.uniform() < 0.5 ? -1 : 1) * std::min(edge - 5.2, 3.0),
           random.uniform(5, 11));
  }
}

}  // namespace odograph
