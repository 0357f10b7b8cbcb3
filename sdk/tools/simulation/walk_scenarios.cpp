// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/walk_scenarios.hpp"

#include "sdk/tools/simulation/random.hpp"

namespace odograph {

Scenario surveyor_walk(uint64_t seed) {
  Random random(seed, 130);
  Scenario s;
  s.walker.height_m = random.uniform(1.55, 1.92), s.walker.speed_mps = random.uniform(1.05, 1.55);
  s.walker.stand_s = 4;
  s.route = {{0, 0, 0}, {60, 0, 0}, {60, 45, 0}, {-10, 45, 0}};
  s.events = {{30, "stand", 8}, {45, "evade", 4},  {75, "look_around", 8}, {100, "swinging"},
              {125, "texting"}, {140, "stand", 5}, {150, "pocket"},        {168, "texting"}};
  return s;
}

Scenario viewer_walk(uint64_t seed) {
  Random random(seed, 131);
  Scenario s;
  s.walker.gait = "viewing";
  s.walker.height_m = random.uniform(1.55, 1.92), s.walker.speed_mps = random.uniform(0.5, 1.2);
  s.walker.stand_s = 4;
  s.route = {{0, 0, 0}, {25, 0, 0}, {25, 20, 0}, {0, 20, 0}};
  s.events = {{8, "look_around", 6},  {15, "speed"},        {20, "shuffle", 4}, {28, "sidestep", 3},
              {34, "stand", 8},       {40, "backwards", 4}, {46, "turn", 8},    {50, "speed"},
              {55, "look_around", 5}, {60, "handle", 6},    {64, "sidestep", 3}};
  for (auto& event : s.events) event.speed_mps = random.uniform(0.5, 1.2);
  return s;
}

Scenario pocket_walk(uint64_t seed) {
  Random random(seed, 132);
  Scenario s;
  s.walker.height_m = random.uniform(1.55, 1.92), s.walker.speed_mps = random.uniform(0.9, 1.5);
  s.walker.stand_s = 4, s.walker.carry = "leg";
  s.route = {{0, 0, 0}, {60, 0, 0}, {60, 45, 0}, {-30, 45, 0}};
  s.events = {{40, "stand", 8}, {70, "bag"}, {100, "stand", 8}, {140, "pocket"}};
  return s;
}

Scenario car_ride(uint64_t seed) {
  Random random(seed, 133);
  Scenario s;
  s.carrier = "car";
  s.vehicle.speed_mps = random.uniform(8, 14);
  s.route = {{0, 0, 0}};
  for (int k = 1; k <= 10; ++k) {  // around blocks of 300 by 150 m
    const Eigen::Vector3d corner(k % 4 == 1 || k % 4 == 2 ? 300 : 0, k % 4 == 2 || k % 4 == 3 ? 150 : 0, 0);
    s.route.push_back(corner);
    for (const double at : {40.0, 110.0})
      s.events.push_back({225.0 * k - at, at > 100 ? "bump" : "stand", at > 100 ? 0.0 : random.uniform(5, 40)});
  }
  return s;
}

Scenario standing(const std::string& what, bool viewer) {
  Scenario s;
  if (viewer) s.walker.gait = "viewing", s.walker.speed_mps = 0.8;
  s.walker.stand_s = 1;
  s.route = {{0, 0, 0}, {1, 0, 0}};
  const int times = what == "turn" ? 60 : what == "lift" ? 40 : 1;
  for (int k = 0; k < times; ++k) s.events.push_back({0.0, what, 600.0 / times});
  return s;
}

Scenario canyon_walk(double sigma_m) {
  Scenario s;
  s.walker.stand_s = 4;
  s.route = {{0, 0, 0}, {110, 0, 0}, {110, 90, 0}};
  s.gnss = {.sigma_m = sigma_m, .canyon_sigma_m = sigma_m, .correlation_s = 20, .availability = 1};
  return s;
}

}  // namespace odograph
