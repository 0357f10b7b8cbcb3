// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "sdk/tools/simulation/leg.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "sdk/tools/simulation/world.hpp"

namespace odograph {

using Eigen::Vector3d;
using Set = TextureSet;

void World::build_street(const Scenario& c, uint64_t seed) {
  Mesh& m = meshes_[0];
  const auto legs = legs_of(route_);
  Vector3d low = route_.points().front(), high = low;
  for (const auto& p : route_.points()) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const double margin = 120;
  m.add_quad({low.x() - margin, low.y() - margin, -low.z() + 0.02}, {high.x() - low.x() + 2 * margin, 0, 0},
             {0, high.y() - low.y() + 2 * margin, 0}, Set::kPaving);
  double lift_m = 0.01;          // each road slightly above the previous ones
  for (const Leg& leg : legs) {  // the road surface, following its slope
    const Vector3d above(0, 0, -(lift_m += 0.004));
    const double half = std::min(3.0, 0.25 * c.world.street_width_m), lift = leg.to.z() == leg.from.z() ? 0.0 : 2.0;
    const Vector3d start = leg.at(0, -half - lift) + above;
    m.add_quad(start, leg.at(leg.length, -half - lift) + above - start, 2 * (half + lift) * leg.aside, Set::kAsphalt);
    if (const double rise = leg.to.z() - leg.from.z(); std::abs(rise) > 0.2 * leg.length) {
      // Stairs: a tread of 0.29 m per step, above the slope, and its riser.
      const auto treads = static_cast<int>(std::lround(leg.length / 0.29));
      const double run = leg.length / treads, riser = rise / treads;
      for (int k = 0; k < treads; ++k) {
        Vector3d corner = leg.at(k * run, -half - lift);
        corner.z() -= 0.03 + std::max(riser, 0.0);
        m.add_quad(corner, 2 * (half + lift) * leg.aside, run * leg.along, Set::kPaving, k % 2 == 0 ? 1.1f : 0.95f);
        const Vector3d edge = riser > 0 ? corner : Vector3d(corner + run * leg.along);
        m.add_quad(edge, 2 * (half + lift) * leg.aside, {0, 0, std::abs(riser)}, Set::kPaving, 0.8f);
      }
      continue;
    }
    for (double d = 2; d + 3 < leg.length; d += 7)  // lane marks
      m.add_quad(leg.at(d, -0.08) + 2 * above, 3 * leg.along, 0.16 * leg.aside, Set::kWall);
  }
  build_houses(c, seed);
  if (c.world.type == "downtown") build_background(c, seed);
  build_far_fronts(c, seed);
  Random random(seed, 61);
  const double per_metre = 0.01, edge = 0.5 * c.world.street_width_m;
  const auto place = [&](int64_t density, double right, auto&& put) {
    for (const Leg& leg : legs)
      for (int64_t k = 0; k < std::llround(static_cast<double>(density) * per_metre * leg.length); ++k) {
        const double side = random.uniform() < 0.5 ? -1 : 1, d = random.uniform(0, leg.length);
        const Vector3d p = leg.at(d, side * right);
        if (is_free(legs, p, std::min(2.0, 0.6 * right)) && !is_cleared(p)) put(p, leg.heading());
      }
  };
  place(c.world.trees, edge - 1.2, [&](const Vector3d& p, double) {
    const double height = random.uniform(2.2, 3.5);
    m.add_box(p, {0.3, 0.3, height}, random.uniform(0, 3), Set::kLeaves, 0.7f);
    const uint64_t leaves = random.next();
    m.add_ball(p - Vector3d(0, 0, height + 1.2), random.uniform(1.3, 2.4), Set::kLeaves, leaves);
  });
  place(c.world.parked_cars, edge - 3.0, [&](const Vector3d& p, double heading) {
    const auto tone = static_cast<float>(random.uniform(0.4, 1.6));
    m.add_box(p - Vector3d(0, 0, 0.25), {4.3, 1.75, 0.65}, heading, Set::kPaint, tone);
    m.add_box(p - Vector3d(0, 0, 0.9), {2.3, 1.6, 0.55}, heading, Set::kPaint, 0.4f);
  });
  place(6, edge - 0.6, [&](const Vector3d& p, double) { m.add_box(p, {0.12, 0.12, 5}, 0, Set::kAsphalt, 0.8f); });
}

/// A house with one facade on the street; seen from there, the facade's u runs to the right.
void World::add_house(const Vector3d& corner, const Vector3d& front, const Vector3d& back, double height,
                      uint32_t facade, float tone) {
  Mesh& m = meshes_[0];
  const Vector3d up(0, 0, -height);
  // v runs down the wall from its top, so that windows are upright.
  m.add_quad(corner + up, front, -up, facade, tone);
  m.add_quad(corner + up, back, -up, facade, tone);
  m.add_quad(corner + front + up, back, -up, facade, tone);
  m.add_quad(corner + back + up, front, -up, facade, tone);
  m.add_quad(corner + up, front, back, Set::kAsphalt, 1.2f);
  buildings_.push_back({{corner, corner + front, corner + front + back, corner + back}, height, true});
}

void World::build_houses(const Scenario& c, uint64_t seed) {
  const auto legs = legs_of(route_);
  const bool towers = c.world.type == "downtown";
  const double edge = 0.5 * c.world.street_width_m;
  Random random(seed, 62), glass(seed, 67);
  const auto put = [&](const Vector3d& corner, const Vector3d& front, const Vector3d& back, double tall) {
    auto facade = static_cast<uint32_t>(random.next() % Set::kFacades);
    if (glass.uniform() < c.world.glass_fronts) facade = Set::kGlassFront;
    add_house(corner, front, back, tall, facade, static_cast<float>(random.uniform(0.8, 1.15)));
  };
  // Towers vary more than houses: from a third to twice the mean and more.
  const auto height = [&] {
    return c.world.house_height_m *
           (towers ? std::exp(std::clamp(0.55 * random.normal(), -1.1, 0.9)) : random.uniform(0.6, 1.4));
  };
  const auto leaves_street = [&](const Vector3d& corner, const Vector3d& front, const Vector3d& back) {
    for (const double a : {0.0, 0.5, 1.0})
      for (const double b : {0.0, 0.5, 1.0}) {
        const Vector3d p = corner + a * front + b * back;
        if (!is_free(legs, p, edge - 0.2) || is_cleared(p)) return false;
      }
    return true;
  };
  double leg_start = 0;
  for (const Leg& leg : legs) {
    for (const double side : {-1.0, 1.0}) {
      for (double d = -30; d < leg.length + 30;) {
        const double width = towers ? random.uniform(18, 38) : random.uniform(8, 17);
        const double set_back = random.uniform(0, towers ? 4 : 2.5);
        const double depth = towers ? random.uniform(18, 28) : random.uniform(7, 12);
        const Vector3d corner = leg.at(d, side * (edge + set_back));
        const Vector3d front = width * leg.along, back = side * depth * leg.aside;
        if (leaves_street(corner, front, back)) {
          put(side > 0 ? Vector3d(corner + front) : corner, side > 0 ? Vector3d(-front) : front, back, height());
          const double along = leg_start + d + 0.5 * width;
          for (const auto& gap : c.world.unmapped)
            if (along >= gap[0] && along <= gap[1]) buildings_.back().surveyed = false;
        }
        d += width + (random.uniform() < 0.12 ? random.uniform(3, 9) : 0.0) +
             (towers && random.uniform() < 0.2 ? c.world.street_width_m : 0.0);  // a side street
      }
    }
    leg_start += leg.length;
  }
  for (const bool end : {false, true}) {  // closes the view at both ends
    const Leg& leg = end ? legs.back() : legs.front();
    const Vector3d middle = leg.at(end ? leg.length + 45 : -45, 0);
    for (int k = -3; k < 3; ++k) {
      const Vector3d corner = middle + (end ? 14.0 : -14.0) * k * leg.aside;
      const Vector3d front = (end ? 14 : -14) * leg.aside, back = (end ? 8 : -8) * leg.along;
      if (leaves_street(corner, front, back)) put(corner, front, back, height());
    }
  }
}

/// Towers in the blocks behind those along the route.
void World::build_background(const Scenario& c, uint64_t seed) {
  const auto legs = legs_of(route_);
  Random random(seed, 65);
  Vector3d low = route_.points().front(), high = low;
  for (const auto& p : route_.points()) low = low.cwiseMin(p), high = high.cwiseMax(p);
  constexpr double kBlock = 58, kMargin = 160;
  for (double north = low.x() - kMargin; north < high.x() + kMargin; north += kBlock)
    for (double east = low.y() - kMargin; east < high.y() + kMargin; east += kBlock) {
      const double width = random.uniform(18, 34), depth = random.uniform(18, 34);
      const double y = east + random.uniform(0, 12), x = north + random.uniform(0, 12);
      const Vector3d corner(x, y, 0);
      const double tall = c.world.house_height_m * std::exp(std::clamp(0.6 * random.normal(), -1.0, 1.1));
      const auto facade = static_cast<uint32_t>(random.next() % Set::kFacades);
      const auto tone = static_cast<float>(random.uniform(0.8, 1.15));
      const Vector3d middle = corner + Vector3d(0.5 * width, 0.5 * depth, 0);
      if (!is_free(legs, middle, 0.5 * c.world.street_width_m + 34 + 0.5 * std::hypot(width, depth))) continue;
      if (is_cleared(middle)) continue;
      add_house(corner, {width, 0, 0}, {0, depth, 0}, tall, facade, tone);
    }
}

}  // namespace odograph
