// SPDX-License-Identifier: Apache-2.0
//
// Eq. (3) and (4) of Gakne & O'Keefe 2018.
#include "plugins/fix/skyline/binary_sky.hpp"
#include "plugins/fix/skyline/matcher.hpp"
#include "tests/skyline/skyline_streets.hpp"
#include "tests/support/support.hpp"

using namespace odograph::skyline;
using namespace odograph::skyline::test;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("skyline");

namespace {

const Vector3d kPlace(3.2, -1.7, -1.5);
const Eigen::Quaterniond kUp(Eigen::AngleAxisd(0.3, Vector3d::UnitZ()) * Eigen::Quaterniond(0, 1, 0, 0));

std::vector<Edge> tall_street() {
  std::vector<Edge> edges;
  add_box(edges, 0, -25, 30, 20, 50), add_box(edges, 34, -27, 28, 22, 38), add_box(edges, -33, -26, 30, 20, 61);
  add_box(edges, 8, 24, 40, 18, 44), add_box(edges, 47, 26, 25, 20, 57), add_box(edges, -30, 25, 26, 20, 35);
  return edges;
}

}  // namespace

TEST_CASE("eq. (4): the slant distance to the highest roof in view, by hand") {
  // From 3.2 m north, 1.7 m west, 1.5 m up, the highest is the house of 50 m whose wall stands 15 m to the west: 13.3 m
  // away, h = 48.5 m, epsilon = atan(48.5 / 13.3) = 74.66 deg, d = 48.5 / sin(74.66 deg) = 50.29 m.
  Matcher matcher{City(tall_street())};
  const auto match =
      required(matcher.match(seen_from(tall_street(), kPlace, kUp, 45), {kPlace, kUp, 1, kDegree, 0.5 * kDegree, 40}));
  CHECK(match->slant_distance_m == doctest::Approx(50.29).epsilon(0.005));
  CHECK(match->landmark_n.y() == doctest::Approx(-15).epsilon(0.005));
  CHECK(match->landmark_n.z() == doctest::Approx(-50).epsilon(0.005));
}

TEST_CASE("eq. (3): the correlation of binary images, by hand") {
  // Two columns of 256 rows over 90 degrees. The model's roofs: 45 deg (128 rows of wall) and 67.5 deg (192 rows).
  std::array<float, BinarySky::kColumns> elevations{};
  elevations[0] = static_cast<float>(45 * kDegree), elevations[1] = static_cast<float>(67.5 * kDegree);
  const BinarySky model(elevations);
  const auto camera = [](bool open, bool below) {
    BinarySky image;
    image.add(0.25 * kDegree, 45 * kDegree, false, false), image.add(0.75 * kDegree, 45 * kDegree, open, below);
    return image;
  };
  // n = 512; the 64 rows between the roofs of the second column differ: (448 - 64) / 512.
  CHECK(camera(false, false).pixels_seen() == 512);
  CHECK(cross_correlation(camera(false, false), model) == doctest::Approx(0.75));
  // Without what lies below the second edge n = 384: (320 - 64) / 384. Without what lies above it nothing differs.
  CHECK(camera(true, false).pixels_seen() == 384);
  CHECK(cross_correlation(camera(true, false), model) == doctest::Approx(2.0 / 3));
  CHECK(cross_correlation(camera(false, true), model) == 1);
  CHECK(cross_correlation(BinarySky(), model) == 0);
  CHECK(model.is_sky(0, 128));
  CHECK_FALSE(model.is_sky(0, 127));
  // With images of 0 and 1 the sum of the products would be largest for a place without buildings: all of the sky is
  // common. With -1 it is not.
  CHECK(cross_correlation(camera(false, false), BinarySky(std::array<float, BinarySky::kColumns>{})) < 0.75);
}

TEST_CASE("a place is found by the correlation of binary images, eq. (3), and it is highest there") {
  MatcherParameters parameters;
  parameters.correlation = true;
  Matcher matcher{City(tall_street()), parameters};
  const auto match =
      required(matcher.match(seen_from(tall_street(), kPlace, kUp, 45),
                             {kPlace + Vector3d(-2.4, 1.9, 0), kUp, 2.0, 2 * kDegree, 0.5 * kDegree, 40}));
  CHECK((match->p_n - kPlace).head<2>().norm() < 0.5);
  CHECK(match->q_n_c.angularDistance(kUp) < 0.5 * kDegree);
  City city(tall_street());
  city.select_edges(kPlace, 60, 0.05);
  Horizon seen, there;
  city.horizon(kPlace, seen);
  double before = 1;
  for (const double off_m : {0.0, 1.0, 3.0, 9.0}) {  // Figure 7
    city.horizon(kPlace + Vector3d(off_m, 0, 0), there);
    const double correlation = cross_correlation(BinarySky(seen.elevation), BinarySky(there.elevation));
    CAPTURE(off_m);
    CHECK(correlation <= before);
    before = correlation;
  }
  CHECK(before < 0.98);
}
