// SPDX-License-Identifier: Apache-2.0
//
// The line of a model's roofs, whose heights have errors, and its fit to a photograph's.
#include <unordered_map>

#include "plugins/fix/skyline/roof_line.hpp"
#include "plugins/fix/skyline/straight_edges.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "tests/skyline/crossing.hpp"
#include "tests/support/support.hpp"

using namespace odograph::skyline;
using namespace odograph::skyline::test;

TEST_SUITE_BEGIN("photograph");

TEST_CASE("a city with raised roofs has the skyline of that city") {
  const std::vector<double> lift = {2, -1.5, 0, 3, 0.5, -2, 1, 0, 0, -3};
  std::unordered_map<int, double> heights;
  for (int k = 0; k < 10; ++k) heights[k] = lift[static_cast<size_t>(k)];
  City corrected = City(a_crossing({})).with_roof_offsets(heights), real(a_crossing(lift));
  Horizon expected, raised;
  for (City* city : {&corrected, &real}) {
    city->select_near_edges({-6, 1.5, -1.6}, 1, 0.01);
    city->horizon({-6, 1.5, -1.6}, city == &real ? expected : raised);
  }
  for (size_t j = 0; j < Horizon::kDirections; ++j)
    CHECK(raised.elevation[j] == doctest::Approx(expected.elevation[j]).epsilon(1e-5));
}

TEST_CASE("a house that is lower than in the model shows those behind it") {
  std::vector<Edge> model, world;
  const auto wall = [](double north, double height, int object, std::vector<Edge>& to) {
    for (const double h : {0.0, height}) to.push_back({{north, -60, -h}, {north, 60, -h}, object});
  };
  wall(15, 8, 0, model), wall(40, 12, 1, model);    // the second is hidden
  wall(15, 5, 0, world), wall(40, 12.5, 1, world);  // and is not any more
  const Vector3d place(0, 0, -1.6);
  const Quaterniond q = camera(0, 10 * kDegree);
  City city(model);
  RoofTops tops;
  city.select_roofs(city.roofs_around(place, 2, 0.03, 4, 3), place, 2, 0.03, 4, 3);
  city.roof_tops(place, 3, Sector::all(), tops);
  RoofLine line;
  line.set(tops);
  RoofLineFit fit{RoofErrorParameters{}};
  fit.set(seen_in(world, place, q), q);
  const double cost = fit.cost(line, {});
  CHECK(fit.agreement() > 0.95);
  CHECK(cost < 0.5 * fit.no_match_cost());
  // The height error has its price: the hidden house alone fits better.
  City without({model.begin() + 2, model.end()});
  without.select_roofs(without.roofs_around(place, 2, 0.03, 4, 3), place, 2, 0.03, 4, 3);
  without.roof_tops(place, 3, Sector::all(), tops);
  line.set(tops);
  CHECK(fit.cost(line, {}) < cost);
}

TEST_CASE("the cost of a place does not change in steps with the camera's height, which the roofs' errors absorb") {
  std::vector<double> lift(40);
  Random random(3, 1);
  for (double& l : lift) l = 1.5 * random.normal();
  const auto model = a_crossing({});
  const Vector3d place(-6, 1.5, -1.6);
  City city(model);
  city.select_roofs(city.roofs_around(place, 2, 0.03, 4, 3), place, 2, 0.03, 4, 3);
  RoofTops tops;
  RoofLine line;
  city.roof_tops(place, 3, Sector::all(), tops);
  line.set(tops);
  for (int view = 0; view < 8; ++view) {
    CAPTURE(view);
    const Quaterniond q = camera(45 * kDegree * view, 10 * kDegree);
    RoofLineFit fit{RoofErrorParameters{}};
    fit.set(seen_in(a_crossing(lift), place, q), q);
    double before = fit.cost(line, {}), steepest = 0;
    for (int k = 1; k <= 12; ++k) {
      const double cost = fit.cost(line, {.up = 0.025 * k});
      steepest = std::max(steepest, std::abs(cost - before)), before = cost;
    }
    CHECK(steepest < 2);
  }
}

TEST_CASE("the roofs of a tile are those that its places can see") {
  const auto model = a_crossing({});
  City city(model);
  auto tile = city.roofs_around({0, 0, -1.6}, 18, 0.03, 4, 3);
  std::sort(tile.begin(), tile.end());
  size_t missing = 0;
  for (double north = -12; north <= 12; north += 3)
    for (double east = -12; east <= 12; east += 3)
      for (const int roof : city.roofs_around({north, east, -1.6}, 0.5, 0.03, 4, 3))
        missing += !std::binary_search(tile.begin(), tile.end(), roof);
  CHECK(missing == 0);
}

TEST_CASE("the normal equations of a roof line lead back to the camera's pose") {
  const auto model = a_crossing({});
  const Vector3d place(-6, 1.5, -1.6);
  const Quaterniond q = camera(0.5, 10 * kDegree);
  City city(model);
  const auto roofs = city.roofs_around(place, 3, 0.03, 4, 3);
  city.select_roofs(roofs, place, 3, 0.03, 4, 3);
  RoofLineFit fit{RoofErrorParameters{}};
  fit.set(seen_in(model, place, q), q);
  fit.set_line(0.3 * kDegree);
  const auto off = [](const Guess& g) {
    return std::hypot(g.north, g.east) + 20 * std::abs(g.yaw) + 20 * std::hypot(g.tilt_north, g.tilt_east);
  };
  Guess g{.north = 0.3, .east = -0.2, .yaw = 0.008, .tilt_north = 0.004, .tilt_east = -0.003};
  const double first = off(g);
  for (int step = 0; step < 8; ++step) {
    RoofTops tops;
    RoofLine line;
    city.roof_tops(place + Vector3d(g.north, g.east, 0), 3, Sector::all(), tops);
    line.set(tops);
    fit.cost(line, g);
    auto normal = fit.normal_equations(g);
    normal.information.diagonal()[5] += 100;  // the height of the camera is known to 0.1 m
    normal.gradient[5] += 100 * g.up;
    const Eigen::Matrix<double, 6, 1> by = -normal.information.ldlt().solve(normal.gradient);
    g.north += by[0], g.east += by[1], g.yaw += by[2], g.tilt_north += by[3], g.tilt_east += by[4], g.up += by[5];
  }
  MESSAGE("from " << first << " to " << off(g));
  CHECK(off(g) < 0.1 * first);
}

TEST_CASE("a skyline is divided at its corners, and where it is ragged it has no straight edge") {
  const auto ray = [](double azimuth, double elevation) {
    return SkyEdge{Vector3d(std::sin(azimuth) * std::cos(elevation), -std::sin(elevation),
                            std::cos(azimuth) * std::cos(elevation))};
  };
  std::vector<SkyEdge> line;
  Random random(11, 1);
  for (int k = 0; k < 90; ++k) {
    const double azimuth = (k - 45) * 0.5 * kDegree;
    if (k < 30)
      line.push_back(ray(azimuth, std::atan(0.3 * std::cos(azimuth))));  // a horizontal eave, 0.3 above the camera
    else if (k < 60)
      line.push_back(ray(azimuth, std::atan(0.1 * std::cos(azimuth))));
    else
      line.push_back(ray(azimuth, 0.1 + 0.1 * random.uniform()));
  }
  std::vector<double> weights(line.size(), 1);
  const StraightEdgeCosts costs{9, 0.1 * kDegree, 0.6, -0.22, 0.2};
  std::vector<int> edges = straight_edges(line, weights, costs);
  CHECK(std::count(edges.begin(), edges.begin() + 30, edges[0]) == 30);
  CHECK(std::count(edges.begin() + 30, edges.begin() + 60, edges[30]) == 30);
  CHECK(edges[0] != edges[30]);
  CHECK(std::count(edges.begin() + 60, edges.end(), kRagged) == 30);
  weights[15] = 0;  // a gap
  edges = straight_edges(line, weights, costs);
  CHECK(edges[15] == kRagged);
  CHECK(edges[0] != edges[29]);
  CHECK(straight_edges({}, {}, costs).empty());
}

TEST_CASE("the direction with which the list of a sky's edge begins does not matter") {
  const auto houses = a_crossing({});
  const Vector3d place(-6, 1.5, -1.6);
  const Quaterniond q = camera(0, 10 * kDegree);
  City city(houses);
  city.select_roofs(city.roofs_around(place, 2, 0.03, 4, 3), place, 2, 0.03, 4, 3);
  RoofTops tops;
  city.roof_tops(place, 3, Sector::all(), tops);
  RoofLine line;
  line.set(tops);
  std::vector<SkyEdge> edges = seen_in(houses, place, q);  // begins at north, the picture's middle
  RoofLineFit fit{RoofErrorParameters{}};
  const auto costs = [&] {
    fit.set(edges, q);
    const double cost = fit.cost(line, {.north = 0.5});
    return std::pair(cost, fit.straight_gain());
  };
  const auto first = costs();
  std::rotate(edges.begin(), edges.begin() + static_cast<std::ptrdiff_t>(edges.size() / 2), edges.end());
  CHECK(costs().first == doctest::Approx(first.first));
  CHECK(costs().second == doctest::Approx(first.second));
}

TEST_CASE("a roof is evidence with its ends, not by its length") {
  const auto wall = [](double from, double to) {
    return std::vector<Edge>{{{12, from, 0}, {12, to, 0}, 0}, {{12, from, -9}, {12, to, -9}, 0}};
  };
  const Vector3d place(0, 0, -1.6);
  const Quaterniond q = camera(0, 15 * kDegree);
  RoofLineFit fit{RoofErrorParameters{}};
  fit.set(seen_in(wall(-20, 4), place, q), q);
  const auto straight_gain = [&](double to) {
    City city(wall(-20, to));
    city.select_roofs(city.roofs_around(place, 2, 0.03, 4, 3), place, 2, 0.03, 4, 3);
    RoofTops tops;
    city.roof_tops(place, 3, Sector::all(), tops);
    RoofLine line;
    line.set(tops);
    CHECK(fit.cost(line, {}) < fit.no_match_cost());  // direction by direction a part of the roof is evidence
    return fit.straight_gain();
  };
  CHECK(straight_gain(4) > 5);
  CHECK(straight_gain(-1) < 0);
  CHECK(straight_gain(15) < straight_gain(4) - 3);
}
