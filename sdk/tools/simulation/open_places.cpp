// SPDX-License-Identifier: Apache-2.0
//
// Squares and rivers along a street: areas without houses, distant fronts, water.
#include <algorithm>

#include "sdk/tools/simulation/random.hpp"
#include "sdk/tools/simulation/world.hpp"

namespace odograph {

using Eigen::Vector3d;
using Set = TextureSet;

void World::clear_places(const Scenario& c) {
  const double bank = 0.5 * c.world.street_width_m, width = c.world.open_width_m;
  double start = 0;
  for (const Leg& leg : legs_of(route_)) {
    const auto add = [&](const Eigen::Vector2d& stretch, double left, double right, bool river) {
      const double from = std::max(0.0, stretch[0] - start), to = std::min(leg.length, stretch[1] - start);
      if (to > from) cleared_.push_back({leg, from, to, left, right, river});
    };
    for (const auto& stretch : c.world.open) add(stretch, -0.5 * width, 0.5 * width, false);
    for (const auto& stretch : c.world.river) add(stretch, -width, -bank, true);
    start += leg.length;
  }
}

bool World::is_cleared(const Vector3d& p_n) const {
  return std::any_of(cleared_.begin(), cleared_.end(), [&](const Cleared& place) {
    const Vector3d d(p_n.x() - place.leg.from.x(), p_n.y() - place.leg.from.y(), 0);
    const double along = d.dot(place.leg.along), right = d.dot(place.leg.aside);
    return along >= place.from && along <= place.to && right >= place.left && right <= place.right;
  });
}

void World::build_far_fronts(const Scenario& c, uint64_t seed) {
  const auto legs = legs_of(route_);
  Random random(seed, 66);
  const auto front_along = [&](const Cleared& place, double side, double distance) {
    for (double d = place.from - 40; d < place.to + 40;) {
      const double width = random.uniform(9, 20), depth = random.uniform(8, 12);
      const Vector3d corner = place.leg.at(d, side * distance);
      const Vector3d front = width * place.leg.along, back = side * depth * place.leg.aside;
      const auto facade = static_cast<uint32_t>(random.next() % Set::kFacades);
      const auto tone = static_cast<float>(random.uniform(0.8, 1.15));
      const double tall = c.world.house_height_m * random.uniform(0.7, 1.5);
      d += width;
      const double clearance = 0.5 * c.world.street_width_m;
      bool free = true;
      for (const double a : {0.0, 0.5, 1.0})
        for (const double b : {0.05, 1.0}) {
          const Vector3d p = corner + a * front + b * back;
          free = free && is_free(legs, p, clearance) && !is_cleared(p);
        }
      if (!free) continue;
      const bool right = side > 0;  // seen from the route, the facade's u runs to the right
      add_house(right ? Vector3d(corner + front) : corner, right ? Vector3d(-front) : front, back, tall, facade, tone);
    }
  };
  for (const Cleared& place : cleared_) {
    front_along(place, -1, -place.left);
    if (!place.river) front_along(place, 1, place.right);
  }
}

/// The water moves as a whole and is periodic, so that it repeats without a visible seam.
void World::add_rivers() {
  constexpr double kStream_mps = 0.4, kAboveGround_m = 0.03;
  for (const Cleared& place : cleared_) {
    if (!place.river) continue;
    Mesh water;
    const double length = place.to - place.from + Set::kWater_m;
    water.add_quad({-Set::kWater_m, place.left, 0}, {length, 0, 0}, {0, place.right - place.left, 0}, Set::kWater);
    const Vector3d start = place.leg.at(place.from, 0);
    movers_.push_back({meshes_.size(), start.head<2>(), place.leg.heading(), Set::kWater_m, kStream_mps, 0,
                       -start.z() + kAboveGround_m});
    meshes_.push_back(std::move(water));
  }
}

}  // namespace odograph
