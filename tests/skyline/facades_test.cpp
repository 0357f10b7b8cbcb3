// SPDX-License-Identifier: Apache-2.0
//
// A photograph's place and heading from the directions of the facades.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "plugins/fix/skyline/facades.hpp"
#include "plugins/fix/skyline/photograph_matcher.hpp"

using namespace odograph::skyline;
using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("facades");

namespace {

constexpr double kDegree = std::numbers::pi / 180;

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

}  // namespace

TEST_CASE("the ledges of two walls determine the heading, and at a wrong place they contradict it") {
  const Corner corner(35 * kDegree);
  const Vector3d place(-3, 0, -1.6);
  const Quaterniond q = camera();
  const Quaterniond turned(Eigen::AngleAxisd(-0.4, Vector3d::UnitZ()));
  Facades facades(corner.model());
  facades.set(corner.seen_from(place, q), turned * q);
  REQUIRE(facades.lines() > 6);
  const Eigen::Vector2d here = place.head<2>();
  double best = 0, least = 1e9;
  for (double yaw = -std::numbers::pi; yaw < std::numbers::pi; yaw += 0.5 * kDegree)
    if (const double cost = facades.cost(here, yaw); cost < least) least = cost, best = yaw;
  CHECK(std::abs(best - 0.4) < 1 * kDegree);
  CHECK(least < -8);
  CHECK(facades.cost(here, 0.4 + 10 * kDegree) > least + 5);
  CHECK(facades.cost(Eigen::Vector2d(20, 20), 0.4) > least + 5);  // behind the walls
  CHECK(facades.cost(Eigen::Vector2d(1000, 0), 0.4) == 0);        // no wall, no evidence
  facades.set({}, q);
  CHECK(facades.cost(here, 0.4) == 0);
}

TEST_CASE("lines that have nothing to do with the model contradict a place by a factor of ten at most") {
  const Corner corner(35 * kDegree);
  const Vector3d place(-3, 0, -1.6);
  const Quaterniond q = camera();
  Facades facades(corner.model());
  const Quaterniond turned(Eigen::AngleAxisd(0.8, Vector3d::UnitZ()));
  auto lines = corner.seen_from(place, q);
  for (SeenLine& line : lines) line.normal_c = q.conjugate() * (turned * (q * line.normal_c));
  facades.set(lines, q);
  CHECK(facades.cost(place.head<2>(), 0) > 1);
  CHECK(facades.cost(place.head<2>(), 0) < 2.31);
}

TEST_CASE("upright lines are not used: they have no direction") {
  const Corner corner(35 * kDegree);
  const auto lines = corner.seen_from(Vector3d(-3, 0, -1.6), camera());
  std::vector<SeenLine> upright;
  for (size_t i = 1; i < lines.size(); i += 2) upright.push_back(lines[i]);
  Facades facades(corner.model());
  facades.set(upright, camera());
  CHECK(facades.lines() == 0);
}

TEST_CASE("lines below the horizon are not used: they are on the ground as often as on walls") {
  const Corner corner(35 * kDegree);
  const Vector3d above(-3, 0, -20);
  Facades facades(corner.model());
  facades.set(corner.seen_from(above, camera()), camera());
  CHECK(facades.lines() == 0);
}

TEST_CASE("the likelihood of a photograph is higher where its facades fit too") {
  const Corner corner(35 * kDegree);
  const Vector3d place(-3, 0, -1.6);
  const Quaterniond q = camera();
  City city(corner.model());
  const Ground ground(corner.model());
  city.select_near_edges(place, 1, 0.01);
  Horizon horizon;
  city.horizon(place, horizon);
  std::vector<SkyEdge> edges;
  for (size_t j = 0; j < Horizon::kDirections; ++j) {
    const double azimuth = (static_cast<double>(j) + 0.5) * 0.5 * kDegree,
                 e = static_cast<double>(horizon.elevation[j]);
    const Vector3d ray(std::cos(e) * std::cos(azimuth), std::cos(e) * std::sin(azimuth), -std::sin(e));
    if (e > 0 && (q.conjugate() * ray).z() > 0.6) edges.push_back({q.conjugate() * ray});
  }
  const PhotographPrior prior{
      .p_n = place, .q_n_c = q, .sigma_m = 1, .yaw_sigma_rad = 0.1, .tilt_sigma_rad = 0.01, .eye_m = std::nullopt};
  PhotographMatcher matcher(city, ground);
  matcher.match(edges, prior);
  const double roofs_alone = matcher.gain();
  Facades facades(corner.model());
  facades.set(corner.seen_from(place, q), q);
  matcher.clear(), matcher.add(edges, prior, nullptr, &facades), matcher.match();
  CHECK(matcher.gain() > roofs_alone + 5);
}

TEST_SUITE_END();
