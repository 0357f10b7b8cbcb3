// SPDX-License-Identifier: Apache-2.0
//
// One photograph and a city model with height errors: fix/skyline's `photographs`.
#include "plugins/fix/skyline/ground.hpp"
#include "plugins/fix/skyline/photograph_level.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "tests/skyline/crossing.hpp"
#include "tests/support/support.hpp"

using namespace odograph::skyline;
using namespace odograph::skyline::test;

TEST_SUITE_BEGIN("photograph");

namespace {

const Vector3d kPlace(-6, 1.5, -1.6);

struct Houses {
  std::vector<Edge> model = a_crossing({});
  City city{model};
  Ground ground{model};
};

}  // namespace

TEST_CASE("a photograph of seventy degrees is placed though each roof is wrong, as well as it states") {
  Random random(7, 1);
  int placed = 0, beyond = 0;
  for (int k = 0; k < 6; ++k) {
    CAPTURE(k);
    std::vector<double> lift(40);
    for (double& l : lift) l = 1.2 * random.normal();
    Houses at;
    const Quaterniond q = camera((-20 + 25 * k) * kDegree, 10 * kDegree);
    const Quaterniond off(Eigen::AngleAxisd(10 * kDegree * random.normal(), Vector3d::UnitZ()));
    PhotographMatcher matcher(at.city, at.ground);
    const auto match = matcher.match(seen_in(a_crossing(lift), kPlace, q),
                                     prior_of(kPlace + 5 * Vector3d{random.normal(), random.normal(), 0}, off * q));
    if (!match) continue;
    ++placed;
    const Eigen::Vector2d d = (match->p_n - kPlace).head<2>();
    beyond += d.dot(match->covariance.inverse() * d) > 11.8;
    CHECK(d.norm() < 4);
    CHECK(match->q_n_c.angularDistance(q) < 6 * kDegree);
    const Vector3d axis = q.conjugate() * match->q_n_c * Vector3d::UnitZ();
    CHECK(std::abs(axis.x()) < match->yaw_sigma_rad);
    // A house's height is as wrong as the camera's, and as the distance to it.
    const double up_m = kPlace.z() - match->p_n.z();
    for (const RoofHeight& roof : match->roofs)
      if (roof.directions > 10)
        CHECK(std::abs(roof.height_m - up_m - lift[static_cast<size_t>(roof.object)]) < 0.1 + d.norm());
  }
  CHECK(placed >= 3);
  CHECK(beyond == 0);
}

TEST_CASE("a photograph is placed though its compass is wrong by a right angle and more") {
  Houses at;
  const Quaterniond q = camera(-10 * kDegree, 10 * kDegree);
  for (const double error : {90.0, -170.0}) {
    CAPTURE(error);
    const Quaterniond off(Eigen::AngleAxisd(error * kDegree, Vector3d::UnitZ()));
    PhotographMatcher matcher(at.city, at.ground);
    const auto match = matcher.match(seen_in(at.model, kPlace, q), prior_of(kPlace + Vector3d(4, -3, 0), off * q));
    CAPTURE(matcher.why());
    REQUIRE(match);
    CHECK((match->p_n - kPlace).head<2>().norm() < 1);
    CHECK(match->q_n_c.angularDistance(q) < 2 * kDegree);
  }
}

TEST_CASE("a photograph with trees is located within its sigmas") {
  const Quaterniond q = camera(0.5, 10 * kDegree);
  Houses at;
  for (const double tree_part : {0.0, 0.2, 0.4}) {
    CAPTURE(tree_part);
    auto seen = seen_in(at.model, kPlace, q);
    const auto trees = static_cast<size_t>(tree_part * static_cast<double>(seen.size()));
    for (size_t i = 0; i < trees; ++i) {
      seen[i].ray_c = Eigen::AngleAxisd((4 + 3 * std::sin(0.9 * static_cast<double>(i))) * kDegree, Vector3d::UnitX()) *
                      seen[i].ray_c;
    }
    PhotographMatcher matcher(at.city, at.ground);
    matcher.match(seen, prior_of(kPlace + Vector3d(3, -2, 0), q));
    REQUIRE(matcher.tried());
    const double now_m = std::sqrt(matcher.tried()->covariance.trace() / 2);
    CHECK((matcher.tried()->p_n - kPlace).head<2>().norm() < 3 * now_m);
    CHECK(now_m < 5);
  }
}

TEST_CASE("the ends of houses, which the line's slopes do not know, determine the position along a street") {
  std::vector<Edge> row;  // of equal heights along the street, with a gap; all is symmetric
  int object = 0;
  for (const double from : {-40.0, 3.0}) {
    for (const double h : {0.0, 9.0}) row.push_back({{12, from, -h}, {12, from + 37, -h}, object});
    ++object;
  }
  Houses at{row};
  const Vector3d place(0, 0, -1.6);
  const Quaterniond q = camera(0, 15 * kDegree);
  const auto sigma_along = [&](const PhotographParameters& p, double& error_m) {
    PhotographMatcher matcher(at.city, at.ground, p);
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

TEST_CASE("the search of a photograph states what lies outside it, and the volume of the places that it measured") {
  Houses at;
  const Quaterniond q = camera(-10 * kDegree, 10 * kDegree);
  const auto attempt_of = [&](const PhotographParameters& p) {
    PhotographMatcher matcher(at.city, at.ground, p);
    matcher.match(seen_in(at.model, kPlace, q), prior_of(kPlace, q));
    REQUIRE(matcher.attempts().size() == 1);
    return matcher.attempts().front();
  };
  PhotographParameters p;
  CHECK(attempt_of(p).outside == doctest::Approx(std::exp(-4.5)));  // of two dimensions, three sigmas
  p.sigmas = 1;
  const auto measured = attempt_of(p);
  CHECK(measured.outside == doctest::Approx(std::exp(-0.5)));
  p.refinement.measured_gain = -1;  // of no place
  const auto& by_slopes = attempt_of(p).places.front();
  const auto& best = measured.places.front();
  CHECK(best.covariance.determinant() < 0.9 * by_slopes.covariance.determinant());
  CHECK(best.log_volume - by_slopes.log_volume ==
        doctest::Approx(0.5 * std::log(best.covariance.determinant() / by_slopes.covariance.determinant())));
}

TEST_CASE("a photograph whose skies lead to two places is not placed") {
  Houses at;
  const Quaterniond q = camera(-10 * kDegree, 10 * kDegree);
  const Vector3d here(-6, 1.5, -1.6), there(3, 1.5, -1.6), between(-1.5, 1.5, -1.6);
  PhotographMatcher matcher(at.city, at.ground);
  matcher.clear();
  matcher.add(seen_in(at.model, here, q), prior_of(between, q));
  const auto alone = matcher.match();
  CAPTURE(matcher.why());
  REQUIRE(alone);
  CHECK((alone->p_n - here).head<2>().norm() < 1);
  matcher.add(seen_in(at.model, there, q), prior_of(between, q));
  CHECK_FALSE(matcher.match());
  CHECK_FALSE(matcher.why().empty());
}

TEST_CASE("a photograph of one long wall is not placed, with a reason") {
  std::vector<Edge> wall;
  const Vector3d up(0, 0, -10);
  const Vector3d a(-300, 12, 0), b(300, 12, 0);
  wall.push_back({a, b, 0}), wall.push_back({a + up, b + up, 0});
  Houses at{wall};
  PhotographMatcher matcher(at.city, at.ground);
  const Vector3d place(0, 0, -1.6);
  const Quaterniond q = camera(60 * kDegree, 15 * kDegree);
  CHECK_FALSE(matcher.match(seen_in(wall, place, q), prior_of(place, q)));
  CHECK_FALSE(matcher.why().empty());
  // Without any roof.
  CHECK_FALSE(matcher.match({}, prior_of(place, q)));
  CHECK(contains(matcher.why(), "roofs are visible against the sky"));
}

TEST_CASE("a photograph from elsewhere is not placed") {
  Houses at;
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
    PhotographMatcher matcher(at.city, at.ground);
    const Quaterniond q = camera(heading, 10 * kDegree);
    CHECK_FALSE(matcher.match(seen_in(other, kPlace, q), prior_of(kPlace, q)));
    CHECK_FALSE(matcher.why().empty());
  }
}

TEST_CASE("upright lines determine how a photograph was held, and without them it is guessed") {
  Random random(3, 1);
  const Quaterniond q_n_c = camera(0, 18 * kDegree, 3 * kDegree);
  const Vector3d up_c = q_n_c.conjugate() * -Vector3d::UnitZ();
  const PhotographLevel unknown{Vector3d(0, -1, 0), 20 * kDegree, 0};
  std::vector<SeenLine> lines;
  for (int i = 0; i < 60; ++i) {
    const Vector3d foot{std::cos(random.uniform(-0.5, 0.5)), std::sin(random.uniform(-0.5, 0.5)),
                        random.uniform(-0.1, 0)};
    const Vector3d a = q_n_c.conjugate() * foot.normalized(),
                   b = q_n_c.conjugate() * (foot - Vector3d(0, 0, 0.3)).normalized();
    lines.push_back({a.cross(b).normalized(), 0.2});
  }
  const auto levels = levels_of(lines, unknown);
  REQUIRE_FALSE(levels.empty());
  CHECK(levels.front().lines > 30);
  CHECK(std::acos(std::min(1.0, levels.front().up_c.dot(up_c))) < 0.5 * kDegree);
  const Quaterniond level = camera(0.4, 0), held = levelled(level, up_c);
  CHECK((held.conjugate() * -Vector3d::UnitZ() - up_c).norm() < 1e-9);
  CHECK((held * Vector3d::UnitZ()).head<2>().normalized().isApprox((level * Vector3d::UnitZ()).head<2>()));
  const auto guesses = levels_of({}, unknown);
  REQUIRE_FALSE(guesses.empty());
  CHECK(guesses.front().lines == 0);
  CHECK(guesses.front().sigma_rad > 2 * kDegree);
  // A phone's own inclination: of the lines' zeniths those near it, otherwise itself.
  const Vector3d measured_c = camera(0, 22 * kDegree, 0).conjugate() * -Vector3d::UnitZ();
  const auto near = levels_of(lines, {measured_c, 5 * kDegree, 0});
  REQUIRE(near.size() == 1);
  CHECK(near.front().up_c.dot(up_c) > std::cos(0.5 * kDegree));
  const Vector3d other_c = camera(0, -20 * kDegree, 0).conjugate() * -Vector3d::UnitZ();
  for (const auto& seen : {lines, std::vector<SeenLine>{}}) {
    const auto own = levels_of(seen, {other_c, 5 * kDegree, 0});
    REQUIRE(own.size() == 1);
    CHECK(own.front().up_c == other_c);
  }
  CHECK(levels_of(lines, {Vector3d::UnitZ(), 20 * kDegree, 0}).front().up_c == Vector3d::UnitZ());  // faces the zenith
}
