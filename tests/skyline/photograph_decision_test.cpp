// SPDX-License-Identifier: Apache-2.0
//
// Whether a photograph is placed, by the places where it fits.
#include "plugins/fix/skyline/photograph_decision.hpp"
#include "plugins/fix/skyline/photograph_prior.hpp"
#include "plugins/fix/skyline/skyline_fixer.hpp"
#include "tests/skyline/rendered_street.hpp"

using namespace odograph::skyline;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("photograph");

namespace {

const PhotographDecisionParameters kParameters;
const Eigen::Matrix3d kAccurate = Vector3d(0.04, 0.04, 1e-4).asDiagonal();

}  // namespace

TEST_CASE("a place is accepted or rejected by other places, its agreement and its gain") {
  const PhotographPlace best{{0, 0, 0}, 60, -9, kAccurate};
  double straight_gain = 20;
  const auto decision_of = [&](std::vector<PhotographPlace> places, double agreement) {
    return decide({{.match = {.agreement = agreement},
                    .places = std::move(places),
                    .possible_gain = 80,
                    .straight_gain = straight_gain}},
                  kParameters);
  };
  const auto alone = decision_of({best}, 0.9);
  CHECK(alone.why.empty());
  CHECK(alone.other < 0.001);
  CHECK(alone.tried->covariance.trace() / 2 ==
        doctest::Approx(0.04 + kParameters.min_sigma_m * kParameters.min_sigma_m));
  const PhotographPlace elsewhere{{15, 0, 0}, 59, -9, kAccurate}, beside{{3, 0, 0}, 60, -9, kAccurate};
  CHECK(contains(decision_of({best, elsewhere}, 0.9).why, "probability of other places is"));
  CHECK(std::sqrt(decision_of({best, beside}, 0.9).tried->covariance(0, 0)) > 2);
  const double less = 4, weight = std::exp(-kParameters.spread_power * less);
  const PhotographPlace near{{3, 0, 0}, 60 - less, -9, kAccurate};
  CHECK(decision_of({best, near}, 0.9).tried->covariance(0, 0) ==
        doctest::Approx(0.04 + 9 * weight / (1 + weight) + kParameters.min_sigma_m * kParameters.min_sigma_m));
  const PhotographPlace turned{{0, 0, 1.5}, 60, -9, kAccurate};
  CHECK(contains(decision_of({best, turned}, 0.9).why, "determine the heading only to"));
  CHECK(decision_of({best}, 0.399).why ==
        "only 39 % of the sky's edge coincides with a roof of the model; 40 % are required");
  const auto chance = "the probability that this is chance is";
  CHECK(contains(decision_of({{{0, 0, 0}, 5, -9, kAccurate}}, 0.9).why, chance));
  straight_gain = 1;  // as good as unknown roofs
  CHECK(contains(decision_of({best}, 0.9).why, chance));
  straight_gain = 6;  // of many places one fits so by chance, of few none
  CHECK(contains(decision_of({{{0, 0, 0}, 60, -20, kAccurate}}, 0.9).why, chance));
  CHECK(decision_of({{{0, 0, 0}, 60, -6, kAccurate}}, 0.9).why.empty());
}

TEST_CASE("a place is no sharper than the model's corners") {
  const auto other = [&](double sigma_m, double sigma_rad) {
    const double volume = std::log(sigma_m * sigma_m * sigma_rad / (10 * 10 * 0.35));
    const Eigen::Matrix3d covariance =
        Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad).asDiagonal();
    return decide({{.match = {.agreement = 0.9},
                    .places = {{{0, 0, 0}, 12, volume, covariance}},
                    .possible_gain = 80,
                    .straight_gain = 40}},
                  kParameters)
        .other;
  };
  CHECK(other(0.01, 0.001) == doctest::Approx(other(0.001, 0.0001)).epsilon(0.05));
  CHECK(other(3, 0.1) < 0.2 * other(0.01, 0.001));
}

TEST_CASE("the likelier another place is, the less a photograph is placed") {
  bool was_placed = true;
  double risk = 0;
  for (double less = 12; less >= 0; less -= 0.1) {
    CAPTURE(less);
    const auto decision = decide({{.match = {.agreement = 0.9},
                                   .places = {{{0, 0, 0}, 60, -9, kAccurate}, {{15, 0, 0}, 60 - less, -9, kAccurate}},
                                   .possible_gain = 80,
                                   .straight_gain = 20}},
                                 kParameters);
    CHECK(decision.other >= risk);
    CHECK((was_placed || !decision.why.empty()));
    was_placed = decision.why.empty(), risk = decision.other;
  }
  CHECK_FALSE(was_placed);
  CHECK(risk == doctest::Approx(0.5));
}

TEST_CASE("lines of two directions do not turn a line of roofs that may be chance into evidence") {
  const auto why = [&](double roofs, double facades) {
    return decide({{.match = {.agreement = 0.9},
                    .places = {{{0, 0, 0}, roofs + facades, -9, kAccurate, facades}},
                    .possible_gain = 80,
                    .straight_gain = 20}},
                  kParameters)
        .why;
  };
  CHECK(why(60, 10).empty());
  CHECK(contains(why(2, 10), "this is chance"));
  CHECK(contains(why(2, 30), "this is chance"));
}

TEST_CASE(
    "the same place by several skies is no more evidence, and an area that was not searched is evidence against it") {
  PhotographAttempt attempt{
      .match = {.agreement = 0.9}, .places = {{{0, 0, 0}, 9, -9, kAccurate}}, .possible_gain = 80, .straight_gain = 20};
  const double once = decide({attempt}, kParameters).other;
  CHECK(once > 0.005);
  CHECK(decide({attempt, attempt, attempt}, kParameters).other == doctest::Approx(once));
  attempt.outside = 0.8;
  CHECK(decide({attempt}, kParameters).other > 5 * once);
}

TEST_CASE("a place that is not a number is not accepted") {
  const Eigen::Matrix3d undefined = Eigen::Matrix3d::Constant(std::nan(""));
  CHECK_FALSE(decide({{.match = {.agreement = 0.9},
                       .places = {{{0, 0, 0}, 60, -9, undefined}},
                       .possible_gain = 80,
                       .straight_gain = 20}},
                     kParameters)
                  .why.empty());
}

TEST_CASE("the covariance without a prior, and of a picture that adds nothing to it") {
  Eigen::Matrix2d measured;
  measured << 0.5, 0.2, 0.2, 2.0;
  const double sigma_m = 0.7;
  const Eigen::Matrix2d known = Eigen::Matrix2d::Identity() / (sigma_m * sigma_m),
                        corners = 0.3 * 0.3 * Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d both = (measured.inverse() + known).inverse() + corners;
  CHECK((covariance_without_prior(both, sigma_m, 0.3) - measured - corners).norm() < 1e-9);
  for (const double factor : {1.0, 1.5})
    CHECK(covariance_without_prior(factor * known.inverse(), sigma_m, 0, 30)(0, 0) == doctest::Approx(900));
}

TEST_CASE("a photograph's fix does not contain the pose that it was searched around, and no slant distance") {
  const TemporaryFolder folder;
  test::write_street(folder / "city.json");
  FixerConfig config;
  config.model = (folder / "city.json").string(), config.photographs = true;
  const Eigen::Vector3d place(3.2, -1.7, -1.5);
  CameraModel lens = test::kLens;
  lens.fx = lens.fy = 400, lens.cx = 639.5, lens.cy = 479.5;
  const auto variance = [&](double sigma_m) {
    SkylineFixer fixer(config);
    PipelinePose pose{1, place, Eigen::Quaterniond(0, 1, 0, 0)};
    pose.has_position = pose.is_of_camera = true;
    pose.photograph = {
        .p_n = place, .q_n_c = pose.q_n_c, .sigma_m = sigma_m, .yaw_sigma_rad = 0.1, .eye_m = std::nullopt};
    CHECK(fixer.add_pose(pose).empty());
    const auto outcomes =
        fixer.add_picture({.t_ns = 1, .grey = test::view_upwards(place, lens), .mask = {}, .chroma = {}, .lens = lens});
    REQUIRE(outcomes.size() == 1);
    const Fix* fix = std::get_if<Fix>(&outcomes.front());
    if (!fix) MESSAGE(std::get<Rejection>(outcomes.front()).second);
    REQUIRE(fix);
    CHECK_FALSE(fix->has_slant);
    CHECK(fix->match.tilt_sigma_rad > 0);
    CHECK(fix->match.tilt_sigma_rad <= pose.photograph.tilt_sigma_rad);
    CHECK((fix->match.p_n - place).head<2>().norm() < 0.6);
    const double min_m = PhotographDecisionParameters().min_sigma_m;
    return fix->match.covariance.trace() - 2 * (min_m * min_m + config.min_sigma * config.min_sigma);
  };
  const double wide = variance(6), narrow = variance(0.5);
  MESSAGE("variances beyond those of the corners: " << wide << " and " << narrow << " m^2");
  CHECK(narrow == Between{0.87 * wide, 2 * wide});  // with the prior in it 0.70 of it
}

TEST_CASE("a second sky with few roofs does not gain by the facades, which both have") {
  const auto attempt = [&](double east, double roofs, double possible) {
    return PhotographAttempt{.match = {.agreement = 0.9},
                             .places = {{{0, east, 0}, roofs + 15, -9, kAccurate, 15}},
                             .possible_gain = possible,
                             .straight_gain = 20};
  };
  CHECK(decide({attempt(0, 40, 80), attempt(25, 4, 27)}, kParameters).why.empty());
  CHECK_FALSE(decide({attempt(0, 40, 80), attempt(25, 14, 27)}, kParameters).why.empty());
}
