// SPDX-License-Identifier: Apache-2.0
#include <opencv2/core.hpp>

#include "plugins/fix/skyline/place_finder.hpp"
#include "tests/skyline/skyline_streets.hpp"
#include "tests/support/support.hpp"

using namespace odograph::skyline;
using Eigen::Vector3d;
using test::add_box;
using test::kDegree;

TEST_SUITE_BEGIN("skyline_place");

namespace {

/// Blocks of houses separated by streets 14 m wide; heights by a seed, all equal with seed 0.
std::vector<Edge> a_town(uint64_t seed, int reach = 4) {
  cv::RNG random(seed);
  std::vector<Edge> edges;
  for (int n = -reach; n <= reach; ++n)
    for (int e = -reach; e <= reach; ++e)
      for (const double part : {-1.0, 1.0}) {
        const double height = seed ? random.uniform(7.0, 22.0) : 12, depth = seed ? random.uniform(4.0, 7.5) : 6;
        add_box(edges, 30.0 * n + 4 * part, 30.0 * e, 8, 2 * depth, height);
      }
  return edges;
}

/// A grid of places in the streets, 2 m apart.
SkylineDatabase database_of(const std::vector<Edge>& edges, const std::string& file) {
  std::vector<Vector3d> places;
  for (double n = -50; n <= 50; n += 2)
    for (double e = -50; e <= 50; e += 2) {
      const double in_n = std::abs(std::remainder(n, 30.0)), in_e = std::abs(std::remainder(e, 30.0));
      if (in_n > 8.5 || in_e > 8) places.emplace_back(n, e, -1.5);
    }
  DatabaseParameters p;
  p.spacing_m = 2, p.threads = 1;
  REQUIRE(build_database(edges, places, p, file, {}));
  return SkylineDatabase::open(file);
}

/// The view of a camera that faces up in a town; the picture's border is five degrees above the horizon.
std::vector<SkyEdge> seen_from(const std::vector<Edge>& edges, const Vector3d& eye, const Eigen::Quaterniond& q_n_c) {
  return test::seen_from(edges, eye, q_n_c, 5);
}

struct Drive {
  std::optional<PlaceFinder::Found> found;
  Vector3d place;  ///< true position at that time
  int pictures = 0;
};

/// Drives east along a street of `real`, with an odometry that starts at 0, has an arbitrary heading and a scale 3 %
/// too short.
Drive drive(const std::vector<Edge>& real, const SkylineDatabase& database, double height_m = 0) {
  constexpr double kHeading = 2.1, kMetre = 1 / 1.03;
  PlaceFinder finder({}, database, Vector3d::Zero());
  const Eigen::Quaterniond up(0, 1, 0, 0), turned(Eigen::AngleAxisd(-kHeading, Vector3d::UnitZ()));
  const Vector3d start(15.5, -33, -1.5 - height_m);
  Drive d;
  for (int k = 0; k < 12 && !d.found; ++k) {
    const double east = 4.5 * k;
    d.place = start + Vector3d(0, east, 0);
    const Vector3d p_odometry = kMetre * (turned * (d.place - start));
    if (!finder.is_far_enough(p_odometry)) continue;
    d.found = finder.add(seen_from(real, d.place, up), turned * up, p_odometry, [](uint64_t) {});
    ++d.pictures;
    if (d.found) CHECK(std::abs(std::remainder(d.found->yaw_rad - kHeading, 2 * std::numbers::pi)) < 2 * kDegree);
  }
  return d;
}

}  // namespace

TEST_CASE("a camera that was never placed is found by a few pictures, whatever heading the odometry started with") {
  const TemporaryFolder folder;
  for (const uint64_t seed : {1u, 2u, 3u}) {
    const auto town = a_town(seed);
    const auto database = database_of(town, folder / std::to_string(seed));
    for (const double height_m : {0.0, 1.2}) {
      const Drive d = drive(town, database, height_m);
      REQUIRE(d.found);
      CHECK((d.found->p_n - d.place).head<2>().norm() < 0.8);
      CHECK(d.found->second_best_ratio < 1e-4);
      CHECK(d.found->agreement > 0.8);
      CHECK(d.pictures >= 4);  // never by one alone
    }
  }
}

TEST_CASE("where every block looks alike nothing is told") {
  const TemporaryFolder folder;
  const auto town = a_town(0, 6);
  const Drive d = drive(town, database_of(town, folder / "alike"));
  CHECK_FALSE(d.found);
  CHECK(d.pictures == 12);
}

TEST_CASE("in a town that the database does not have nothing is told") {
  const TemporaryFolder folder;
  const auto database = database_of(a_town(1), folder / "here");
  for (const uint64_t seed : {7u, 8u, 9u}) CHECK_FALSE(drive(a_town(seed), database).found);
}

TEST_CASE("pictures that speak for one place alone count in a row: one of another town between them begins anew") {
  const TemporaryFolder folder;
  const auto town = a_town(1), other = a_town(7);
  const auto database = database_of(town, folder / "town");
  // For each picture of a drive, whether a place is found with one picture, or two in a row, in which its hypothesis is
  // the only one.
  const auto found_by = [&](int steady, bool disturbed) {
    PlaceFinder::Parameters p;
    p.pictures = 2, p.min_pictures = 2, p.min_path_m = 0, p.steady = steady;
    PlaceFinder finder(p, database, Vector3d::Zero());
    std::vector<bool> found;
    for (int k = 0; k < 12; ++k) {
      const Vector3d place(15.5, -33 + 4.5 * k, -1.5);
      const auto& seen = disturbed && k % 5 < 2 ? other : town;
      const Eigen::Quaterniond up(0, 1, 0, 0);
      found.push_back(finder.add(seen_from(seen, place, up), up, place, [](uint64_t) {}).has_value());
    }
    return found;
  };
  for (const bool disturbed : {false, true}) {
    const auto alone = found_by(1, disturbed), in_a_row = found_by(2, disturbed);
    int believed = 0, lonely = 0;
    for (size_t k = 1; k < alone.size(); ++k) {
      CHECK(in_a_row[k] == (alone[k] && alone[k - 1]));
      believed += in_a_row[k], lonely += alone[k] && !alone[k - 1];
    }
    MESSAGE("two in a row " << believed << " times, the first of a row " << lonely << " times");
    CHECK((disturbed ? lonely : believed) >= 2);
  }
}
