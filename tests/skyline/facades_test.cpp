// SPDX-License-Identifier: Apache-2.0
//
// A photograph's place and heading from the directions of the facades.
#include "plugins/fix/skyline/facades.hpp"
#include "plugins/fix/skyline/photograph_matcher.hpp"
#include "tests/support/support.hpp"

using namespace odograph::skyline;
using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("facades");

namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kLevel = 0.1 * kDegree;  // sigma of the inclination

/// Looks at 30 degrees and upwards by 12.
Quaterniond camera() {
  Eigen::Matrix3d level;  // x right, y down, z to the north
  level << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  return Quaterniond(Eigen::AngleAxisd(30 * kDegree, Vector3d::UnitZ()) * level *
                     Eigen::AngleAxisd(12 * kDegree, Vector3d::UnitX()));
}

/// Two walls that end at a corner north-east of the origin: one runs east, one runs at `slant` from north.
struct Corner {
  Vector3d north = {9, 10, 0}, along_east = {0, -1, 0}, along_slant;
  explicit Corner(double slant) : along_slant(-std::cos(slant), -std::sin(slant), 0) {}
  std::vector<Edge> model() const {
    std::vector<Edge> edges;
    for (const Vector3d& along : {along_east, along_slant})
      for (const double down : {0.0, -8.0}) {
        const Vector3d at = north + Vector3d(0, 0, down);
        edges.push_back({at, at + 25 * along, 0});
      }
    edges.push_back({Vector3d(40, -20, -8), Vector3d(10, 40, -8), 1});  // of a house behind
    return edges;
  }
  /// Ledges of three metres on both, seen from a place, and an upright line at the end of each.
  std::vector<SeenLine> seen_from(const Vector3d& place, const Quaterniond& q_n_c) const {
    std::vector<SeenLine> lines;
    const auto add = [&](const Vector3d& from, const Vector3d& to) {
      const Vector3d a = (q_n_c.conjugate() * (from - place)).normalized();
      const Vector3d b = (q_n_c.conjugate() * (to - place)).normalized();
      lines.push_back({a.cross(b).normalized(), std::acos(a.dot(b)), a, b});
    };
    for (const Vector3d& along : {along_east, along_slant})
      for (const double down : {-3.5, -5.0, -7.0})
        for (const double m : {0.5, 4.0, 8.0}) {
          const Vector3d from = north + m * along + Vector3d(0, 0, down);
          add(from, from + 3 * along), add(from, from + Vector3d(0, 0, -1));
        }
    return lines;
  }
};

const Corner kCorner(35 * kDegree);
const Vector3d kPlace(-3, 0, -1.6);
const Quaterniond kCamera = camera();

}  // namespace

TEST_CASE("the ledges of two walls determine the heading, and at a wrong place they contradict it") {
  const Quaterniond turned(Eigen::AngleAxisd(-0.4, Vector3d::UnitZ()));
  Facades facades(kCorner.model());
  facades.set(kCorner.seen_from(kPlace, kCamera), turned * kCamera, kLevel);
  REQUIRE(facades.lines() > 6);
  double best = 0, least = 1e9;
  for (double yaw = -std::numbers::pi; yaw < std::numbers::pi; yaw += 0.5 * kDegree)
    if (const double cost = facades.cost(kPlace, yaw); cost < least) least = cost, best = yaw;
  CHECK(std::abs(best - 0.4) < 1 * kDegree);
  CHECK(least < -6);
  CHECK(facades.cost(kPlace, 0.4 + 10 * kDegree) > least + 5);
  CHECK(facades.cost({20, 20, -1.6}, 0.4) > least + 5);  // behind the walls
  CHECK(facades.cost({1000, 0, -1.6}, 0.4) == 0);        // no wall, no evidence
  facades.set({}, kCamera, kLevel);
  CHECK(facades.cost(kPlace, 0.4) == 0);
}

TEST_CASE("lines that have nothing to do with the model contradict a place by a factor of ten at most") {
  Facades facades(kCorner.model());
  const Quaterniond turned(Eigen::AngleAxisd(0.8, Vector3d::UnitZ()));
  auto lines = kCorner.seen_from(kPlace, kCamera);
  for (SeenLine& line : lines) line.normal_c = kCamera.conjugate() * (turned * (kCamera * line.normal_c));
  facades.set(lines, kCamera, kLevel);
  CHECK(facades.cost(kPlace, 0) == Between{1, 2.31});
}

TEST_CASE("one long line is one piece of evidence, not one for each of its parts") {
  const std::vector<Edge> wall = {{{9, -30, 0}, {9, 30, 0}, 0}, {{9, -30, -8}, {9, 30, -8}, 0}};
  const auto seen = [&](const Vector3d& from, const Vector3d& to) {
    const Vector3d a = (kCamera.conjugate() * (from - kPlace)).normalized(),
                   b = (kCamera.conjugate() * (to - kPlace)).normalized();
    return SeenLine{a.cross(b).normalized(), std::acos(a.dot(b)), a, b};
  };
  Facades facades(wall);
  facades.set({seen({9, -2, -7}, {9, 16, -7})}, kCamera, kLevel);
  REQUIRE(facades.lines() > 8);
  CHECK(facades.cost(kPlace, 0) == Between{-4, -1.5});
}

TEST_CASE("a garage in front of a house does not hide its facade") {
  auto model = kCorner.model();
  const std::vector<Edge> houses = model;
  for (const double down : {0.0, -2.5}) model.push_back({{3, -8, down}, {6, 16, down}, 2});
  Facades with(model), without(houses);
  for (Facades* facades : {&with, &without}) facades->set(kCorner.seen_from(kPlace, kCamera), kCamera, kLevel);
  CHECK(without.cost(kPlace, 0) < -6);
  CHECK(with.cost(kPlace, 0) == without.cost(kPlace, 0));
}

TEST_CASE("the likelihood of the facades has no steps between places") {
  Facades facades(kCorner.model());
  facades.set(kCorner.seen_from(kPlace, kCamera), kCamera, kLevel);
  double before = facades.cost(kPlace, 0), largest = 0;
  for (double m = 0.005; m < 3; m += 0.005) {
    const double now = facades.cost(kPlace + Vector3d(-m, 0.3 * m, 0), 0);
    largest = std::max(largest, std::abs(now - before)), before = now;
  }
  CHECK(largest < 0.3);
}

TEST_CASE("where the inclination is hardly known lines do not determine the heading") {
  Facades facades(kCorner.model());
  // Pitched by four degrees.
  const Quaterniond pitched = kCamera * Quaterniond(Eigen::AngleAxisd(4 * kDegree, Vector3d::UnitX()));
  const auto excess = [&](double tilt_sigma_rad) {  // of the true heading's cost over the least one
    facades.set(kCorner.seen_from(kPlace, kCamera), pitched, tilt_sigma_rad);
    double least = 1e9;
    for (double yaw = -0.2; yaw <= 0.2; yaw += 0.5 * kDegree) least = std::min(least, facades.cost(kPlace, yaw));
    return facades.cost(kPlace, 0) - least;
  };
  const double unknown = excess(4 * kDegree);
  CHECK(unknown < 0.8);
  CHECK(excess(kLevel) > 1.5 * unknown);  // well known, it would matter
}

TEST_CASE("upright lines are not used: they have no direction") {
  const auto lines = kCorner.seen_from(kPlace, kCamera);
  std::vector<SeenLine> upright;
  for (size_t i = 1; i < lines.size(); i += 2) upright.push_back(lines[i]);
  Facades facades(kCorner.model());
  facades.set(upright, kCamera, kLevel);
  CHECK(facades.lines() == 0);
}

TEST_CASE("lines below the horizon are not used: they are on the ground as often as on walls") {
  const Vector3d above(-3, 0, -20);
  Facades facades(kCorner.model());
  facades.set(kCorner.seen_from(above, kCamera), kCamera, kLevel);
  CHECK(facades.lines() == 0);
}

TEST_CASE("the likelihood of a photograph is higher where its facades fit too") {
  City city(kCorner.model());
  const Ground ground(kCorner.model());
  city.select_near_edges(kPlace, 1, 0.01);
  Horizon horizon;
  city.horizon(kPlace, horizon);
  std::vector<SkyEdge> edges;
  for (size_t j = 0; j < Horizon::kDirections; ++j) {
    const double azimuth = (static_cast<double>(j) + 0.5) * 0.5 * kDegree,
                 e = static_cast<double>(horizon.elevation[j]);
    const Vector3d ray(std::cos(e) * std::cos(azimuth), std::cos(e) * std::sin(azimuth), -std::sin(e));
    if (e > 0 && (kCamera.conjugate() * ray).z() > 0.6) edges.push_back({kCamera.conjugate() * ray});
  }
  const PhotographPrior prior{.p_n = kPlace,
                              .q_n_c = kCamera,
                              .sigma_m = 1,
                              .yaw_sigma_rad = 0.1,
                              .tilt_sigma_rad = 0.01,
                              .eye_m = std::nullopt};
  PhotographMatcher matcher(city, ground);
  matcher.match(edges, prior);
  const double roofs_alone = matcher.gain();
  Facades facades(kCorner.model());
  facades.set(kCorner.seen_from(kPlace, kCamera), kCamera, kLevel);
  matcher.clear(), matcher.add(edges, prior, nullptr, &facades), matcher.match();
  CHECK(matcher.gain() > roofs_alone + 5);
}
