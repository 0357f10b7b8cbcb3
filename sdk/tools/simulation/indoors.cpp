// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/leg.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "sdk/tools/simulation/world.hpp"

namespace odograph {

using Eigen::Vector3d;
using Set = TextureSet;

void World::build_hall(uint64_t seed) {
  Mesh& m = meshes_[0];
  const auto legs = legs_of(route_);
  Vector3d low = route_.points().front(), high = low;
  for (const auto& p : route_.points()) low = low.cwiseMin(p), high = high.cwiseMax(p);
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
    const double y = random.uniform(low.y(), high.y()), x = random.uniform(low.x(), high.x());
    const Vector3d p(x, y, 0);
    if (!is_free(legs, p, 1.2)) continue;
    if (k % 3 == 0) {
      m.add_box(p, {0.5, 0.5, 3.4}, random.uniform(0, 1.5), 1, 1.0f);
      continue;
    }
    const auto tone = static_cast<float>(random.uniform(0.5, 1.6));
    const double heading = random.uniform(0, 3);
    m.add_box(p, {random.uniform(0.5, 1.5), random.uniform(0.5, 1.0), random.uniform(0.5, 1.6)}, heading, Set::kCloth,
              tone);
  }
}

void World::build_corridor() {
  Mesh& m = meshes_[0];
  for (const Leg& leg : legs_of(route_)) {
    const Vector3d run = (leg.length + 2.4) * leg.along, across = 2.4 * leg.aside, up(0, 0, -2.6);
    const Vector3d corner = leg.at(-1.2, -1.2);
    m.add_quad(corner, run, across, Set::kWall, 0.7f);
    m.add_quad(corner + up, run, across, Set::kWall, 1.1f);
    for (double d = 0; d < leg.length - 1; d += 6) {  // doors are the only features
      m.add_quad(leg.at(d + 2, -1.19), 0.9 * leg.along, {0, 0, -2.05}, Set::kWall, 0.8f);
      m.add_quad(leg.at(d + 4, 1.19), 0.9 * leg.along, {0, 0, -2.05}, Set::kWall, 0.85f);
    }
    m.add_quad(leg.at(0.8, -1.2), (leg.length - 1.6) * leg.along, up, Set::kWall);
    m.add_quad(leg.at(0.8, 1.2), (leg.length - 1.6) * leg.along, up, Set::kWall, 0.95f);
  }
  const auto legs = legs_of(route_);
  m.add_quad(legs.front().at(-1.2, -1.2), 2.4 * legs.front().aside, {0, 0, -2.6}, Set::kWall, 0.9f);
  m.add_quad(legs.back().at(legs.back().length + 1.2, -1.2), 2.4 * legs.back().aside, {0, 0, -2.6}, Set::kWall, 0.9f);
}

}  // namespace odograph
