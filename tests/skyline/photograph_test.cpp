// SPDX-License-Identifier: Apache-2.0
//
// One photograph and a city model with height errors: fix/skyline's `photographs`.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "plugins/fix/skyline/ground.hpp"
#include "plugins/fix/skyline/photograph_level.hpp"
#include "plugins/fix/skyline/photograph_matcher.hpp"
#include "sdk/tools/simulation/random.hpp"

using namespace odograph;
using namespace odograph::skyline;
using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("photograph");

namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// A crossing of two streets: houses of various heights, each an object; `lift`: height errors of their roofs, m.
std::vector<Edge> a_crossing(const std::vector<double>& lift) {
  std::vector<Edge> edges;
  int object = 0;
  const auto house = [&](double north, double east, double a, double b, double height) {
    height += object < static_cast<int>(lift.size()) ? lift[static_cast<size_t>(object)] : 0;
    const Vector3d corners[] = {
        {north - a, east - b, 0}, {north + a, east - b, 0}, {north + a, east + b, 0}, {north - a, east + b, 0}};
    const Vector3d up(0, 0, -height);
    for (int i = 0; i < 4; ++i) {
      const Vector3d &p = corners[i], &q = corners[(i + 1) % 4];
      edges.push_back({p, q, object}), edges.push_back({p + up, q + up, object}), edges.push_back({p, p + up, object});
    }
    ++object;
  };
  const double heights[] = {11, 16, 9, 13, 18, 12, 8, 15, 10, 14};
  for (int side : {-1, 1})
    for (int i = 0; i < 5; ++i) {
      house(18 + 13 * i, side * 13.0, 6, 6, heights[(i + (side > 0 ? 5 : 0)) % 10]);
      house(-18 - 14 * i, side * 14.0, 6.5, 6, heights[(2 * i + 3) % 10]);
      house(side * 17.0, 22 + 12 * i, 5, 5.5, heights[(i + 7) % 10]);
      house(side * 17.0, -24 - 12 * i, 5, 5.5, heights[(3 * i + 1) % 10]);
    }
  return edges;
}

Quaterniond camera(double heading, double pitch, double roll = 0) {
  Eigen::Matrix3d R;
  R << -std::sin(heading), 0, std::cos(heading), std::cos(heading), 0, std::sin(heading), 0, 1, 0;
  return Quaterniond(R * Eigen::AngleAxisd(pitch, Vector3d::UnitX()) * Eigen::AngleAxisd(roll, Vector3d::UnitZ()));
}

/// The sky's edge in a picture of 70 by 54 degrees.
std::vector<SkyEdge> seen_in(const std::vector<Edge>& houses, const Vector3d& p_n, const Quaterniond& q_n_c) {
  City city(houses);
  city.select_near_edges(p_n, 1, 0.01);
  Horizon horizon;
  city.horizon(p_n, horizon);
  std::vector<SkyEdge> edges;
  for (size_t j = 0; j < Horizon::kDirections; ++j) {
    const double azimuth = (static_cast<double>(j) + 0.5) * 0.5 * kDegree;
    const auto ray = [&](double e) -> Vector3d {
      return q_n_c.conjugate() *
             Vector3d(std::cos(e) * std::cos(azimuth), std::cos(e) * std::sin(azimuth), -std::sin(e));
    };
    const auto inside = [](const Vector3d& r) {
      return r.z() > 0.1 && std::abs(r.x() / r.z()) < 0.70 && std::abs(r.y() / r.z()) < 0.51;
    };
    double top = 1.4;
    while (top > -0.5 && !inside(ray(top))) top -= 0.004;
    if (top < -0.4) continue;
    const double e = static_cast<double>(horizon.elevation[j]);
    if (e > top)
      edges.push_back({ray(top), false, true});
    else if (inside(ray(e)))
      edges.push_back({ray(e)});
  }
  return edges;
}

PhotographPrior prior_of(const Vector3d& p_n, const Quaterniond& q_n_c) {
  return {.p_n = p_n,
          .q_n_c = q_n_c,
          .sigma_m = 8,
          .yaw_sigma_rad = 15 * kDegree,
          .tilt_sigma_rad = 0.6 * kDegree,
          .eye_m = 1.6};
}

}  // namespace

TEST_CASE("a photograph of seventy degrees is placed though each roof is wrong, as well as it states") {
  Random random(7, 1);
  const Vector3d place(-6, 1.5, -1.6);
  int placed = 0, beyond = 0;
  for (int k = 0; k < 6; ++k) {
    CAPTURE(k);
    std::vector<double> lift(40);
    for (double& l : lift) l = 1.2 * random.normal();
    const auto model = a_crossing({});
    City city(model);
    const Ground ground(model);
    const Quaterniond q = camera((-20 + 25 * k) * kDegree, 10 * kDegree);
    const Quaterniond off(Eigen::AngleAxisd(10 * kDegree * random.normal(), Vector3d::UnitZ()));
    PhotographMatcher matcher(city, ground);
    const auto match = matcher.match(seen_in(a_crossing(lift), place, q),
                                     prior_of(place + 5 * Vector3d{random.normal(), random.normal(), 0}, off * q));
    if (!match) continue;
    ++placed;
    const Eigen::Vector2d d = (match->p_n - place).head<2>();
    beyond += d.dot(match->covariance.inverse() * d) > 11.8;
    CHECK(d.norm() < 4);
    CHECK(match->q_n_c.angularDistance(q) < 6 * kDegree);
    const Vector3d axis = q.conjugate() * match->q_n_c * Vector3d::UnitZ();
    CHECK(std::abs(axis.x()) < match->yaw_sigma_rad);
    // A house's height is as wrong as the camera's, and as the distance to it.
    const double up_m = place.z() - match->p_n.z();
    for (const RoofHeight& roof : match->roofs)
      if (roof.directions > 10)
        CHECK(std::abs(roof.height_m - up_m - lift[static_cast<size_t>(roof.object)]) < 0.1 + d.norm());
  }
  CHECK(placed >= 3);
  CHECK(beyond == 0);
}

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

TEST_CASE("a photograph is placed though its compass is wrong by a right angle and more") {
  const auto model = a_crossing({});
  City city(model);
  const Ground ground(model);
  const Vector3d place(-6, 1.5, -1.6);
  const Quaterniond q = camera(-10 * kDegree, 10 * kDegree);
  for (const double error : {90.0, -170.0}) {
    CAPTURE(error);
    const Quaterniond off(Eigen::AngleAxisd(error * kDegree, Vector3d::UnitZ()));
    PhotographMatcher matcher(city, ground);
    const auto match = matcher.match(seen_in(model, place, q), prior_of(place + Vector3d(4, -3, 0), off * q));
    CAPTURE(matcher.why());
    REQUIRE(match);
    CHECK((match->p_n - place).head<2>().norm() < 1);
    CHECK(match->q_n_c.angularDistance(q) < 2 * kDegree);
  }
}

TEST_CASE("a photograph with trees is located within its sigmas") {
  const Vector3d place(-6, 1.5, -1.6);
  const Quaterniond q = camera(0.5, 10 * kDegree);
  const auto model = a_crossing({});
  City city(model);
  const Ground ground(model);
  for (const double tree_part : {0.0, 0.2, 0.4}) {
    CAPTURE(tree_part);
    auto seen = seen_in(model, place, q);
    const auto trees = static_cast<size_t>(tree_part * static_cast<double>(seen.size()));
    for (size_t i = 0; i < trees; ++i) {
      seen[i].ray_c = Eigen::AngleAxisd((4 + 3 * std::sin(0.9 * static_cast<double>(i))) * kDegree, Vector3d::UnitX()) *
                      seen[i].ray_c;
    }
    PhotographMatcher matcher(city, ground);
    matcher.match(seen, prior_of(place + Vector3d(3, -2, 0), q));
    REQUIRE(matcher.tried());
    const double now_m = std::sqrt(matcher.tried()->covariance.trace() / 2);
    CHECK((matcher.tried()->p_n - place).head<2>().norm() < 3 * now_m);
    CHECK(now_m < 5);
  }
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

TEST_CASE("the ends of houses, which the line's slopes do not know, determine the position along a street") {
  std::vector<Edge> row;  // of equal heights along the street, with a gap; all is symmetric
  int object = 0;
  for (const double from : {-40.0, 3.0}) {
    for (const double h : {0.0, 9.0}) row.push_back({{12, from, -h}, {12, from + 37, -h}, object});
    ++object;
  }
  City city(row);
  const Ground ground(row);
  const Vector3d place(0, 0, -1.6);
  const Quaterniond q = camera(0, 15 * kDegree);
  const auto sigma_along = [&](const PhotographParameters& p, double& error_m) {
    PhotographMatcher matcher(city, ground, p);
    matcher.match(seen_in(row, place, q), prior_of(place + Vector3d(1, 1.2, 0), q));
    REQUIRE(matcher.tried());
    error_m = (matcher.tried()->p_n - place).y();
    return std::sqrt(matcher.tried()->covariance(1, 1));
  };
  PhotographParameters unmeasured;
  unmeasured.refinement.measured_gain = -1;  // of no place
  double error_m = 0;
  const double by_slopes_m = sigma_along(unmeasured, error_m), measured_m = sigma_along({}, error_m);
  MESSAGE("along the street " << measured_m << " m, by the slopes alone " << by_slopes_m << " m, error " << error_m);
  CHECK(measured_m < 0.5 * by_slopes_m);
  CHECK(std::abs(error_m) < 3 * measured_m);
}

TEST_CASE("a photograph whose skies lead to two places is not placed") {
  const auto model = a_crossing({});
  City city(model);
  const Ground ground(model);
  const Quaterniond q = camera(-10 * kDegree, 10 * kDegree);
  const Vector3d here(-6, 1.5, -1.6), there(3, 1.5, -1.6), between(-1.5, 1.5, -1.6);
  PhotographMatcher matcher(city, ground);
  matcher.clear();
  matcher.add(seen_in(model, here, q), prior_of(between, q));
  const auto alone = matcher.match();
  CAPTURE(matcher.why());
  REQUIRE(alone);
  CHECK((alone->p_n - here).head<2>().norm() < 1);
  matcher.add(seen_in(model, there, q), prior_of(between, q));
  CHECK_FALSE(matcher.match());
  CHECK_FALSE(matcher.why().empty());
}

TEST_CASE("a photograph of one long wall is not placed, with a reason") {
  std::vector<Edge> wall;
  const Vector3d up(0, 0, -10);
  const Vector3d a(-300, 12, 0), b(300, 12, 0);
  wall.push_back({a, b, 0}), wall.push_back({a + up, b + up, 0});
  City city(wall);
  const Ground ground(wall);
  PhotographMatcher matcher(city, ground);
  const Vector3d place(0, 0, -1.6);
  const Quaterniond q = camera(60 * kDegree, 15 * kDegree);
  CHECK_FALSE(matcher.match(seen_in(wall, place, q), prior_of(place, q)));
  CHECK_FALSE(matcher.why().empty());
  // Without any roof.
  CHECK_FALSE(matcher.match({}, prior_of(place, q)));
  CHECK(matcher.why().find("roofs end against the sky") != std::string::npos);
}

TEST_CASE("a photograph from elsewhere is not placed") {
  const auto model = a_crossing({});
  City city(model);
  const Ground ground(model);
  // Houses around a square, of other sizes and at other distances than those of the model.
  Random random(5, 1);
  std::vector<Edge> other;
  for (int i = 0; i < 16; ++i) {
    const double azimuth = (i + 0.6 * random.uniform()) * 22.5 * kDegree, r = 14 + 18 * random.uniform();
    const Vector3d from(r * std::cos(azimuth), r * std::sin(azimuth), 0);
    const Vector3d along =
        (5 + 4 * random.uniform()) * Vector3d(-std::sin(azimuth + 0.4 * random.normal()), std::cos(azimuth), 0);
    const Vector3d up(0, 0, -7 - 9 * random.uniform());
    other.push_back({from + up, from + along + up, i});
  }
  for (const double heading : {0.4, 3.5}) {
    CAPTURE(heading);
    PhotographMatcher matcher(city, ground);
    const Vector3d place(-6, 1.5, -1.6);
    const Quaterniond q = camera(heading, 10 * kDegree);
    CHECK_FALSE(matcher.match(seen_in(other, place, q), prior_of(place, q)));
    CHECK_FALSE(matcher.why().empty());
  }
}

TEST_CASE("upright lines determine how a photograph was held, and without them it is guessed") {
  Random random(3, 1);
  const Quaterniond q_n_c = camera(0, 18 * kDegree, 3 * kDegree);
  const Vector3d up_c = q_n_c.conjugate() * -Vector3d::UnitZ(), level_c(0, -1, 0);
  std::vector<SeenLine> lines;
  for (int i = 0; i < 60; ++i) {
    const Vector3d foot{std::cos(random.uniform(-0.5, 0.5)), std::sin(random.uniform(-0.5, 0.5)),
                        random.uniform(-0.1, 0)};
    const Vector3d a = q_n_c.conjugate() * foot.normalized(),
                   b = q_n_c.conjugate() * (foot - Vector3d(0, 0, 0.3)).normalized();
    lines.push_back({a.cross(b).normalized(), 0.2});
  }
  const auto levels = levels_of(lines, level_c);
  REQUIRE_FALSE(levels.empty());
  CHECK(levels.front().lines > 30);
  CHECK(std::acos(std::min(1.0, levels.front().up_c.dot(up_c))) < 0.5 * kDegree);
  const auto guesses = levels_of({}, level_c);
  REQUIRE_FALSE(guesses.empty());
  CHECK(guesses.front().lines == 0);
  CHECK(guesses.front().sigma_rad > 2 * kDegree);
}

TEST_SUITE_END();
