// SPDX-License-Identifier: Apache-2.0
//
// Whether a photograph is placed, by the places where it fits.
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "plugins/fix/skyline/photograph_decision.hpp"
#include "plugins/fix/skyline/photograph_prior.hpp"

using namespace odograph::skyline;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("photograph");

TEST_CASE("a place is accepted or rejected by other places, its agreement and its gain") {
  const PhotographDecisionParameters p;
  const Eigen::Matrix3d accurate = Vector3d(0.04, 0.04, 1e-4).asDiagonal();
  const PhotographPlace best{{0, 0, 0}, 60, -9, accurate};
  const auto decision_of = [&](std::vector<PhotographPlace> places, double agreement) {
    return decide({{.match = {.agreement = agreement}, .places = std::move(places), .possible_gain = 80}}, p);
  };
  const auto alone = decision_of({best}, 0.9);
  CHECK(alone.why.empty());
  CHECK(alone.other < 0.001);
  CHECK(alone.tried->covariance.trace() / 2 == doctest::Approx(0.04 + p.min_sigma_m * p.min_sigma_m));
  const PhotographPlace elsewhere{{15, 0, 0}, 59, -9, accurate}, beside{{3, 0, 0}, 60, -9, accurate};
  CHECK(decision_of({best, elsewhere}, 0.9).why.find("probability of other places is") != std::string::npos);
  CHECK(std::sqrt(decision_of({best, beside}, 0.9).tried->covariance(0, 0)) > 2);
  const PhotographPlace turned{{0, 0, 1.5}, 60, -9, accurate};
  CHECK(decision_of({best, turned}, 0.9).why.find("determine the heading only to") != std::string::npos);
  CHECK(decision_of({best}, 0.4).why ==
        "only 40 % of the sky's edge coincides with a roof of the model; 50 % are required");
  const auto chance = "the probability that this is chance is";
  CHECK(decision_of({{{0, 0, 0}, 9, -9, accurate}}, 0.9).why.find(chance) != std::string::npos);
}

TEST_CASE("the likelier another place is, the less a photograph is placed") {
  const PhotographDecisionParameters p;
  const Eigen::Matrix3d accurate = Vector3d(0.04, 0.04, 1e-4).asDiagonal();
  bool was_placed = true;
  double risk = 0;
  for (double less = 12; less >= 0; less -= 0.1) {
    CAPTURE(less);
    const auto decision = decide({{.match = {.agreement = 0.9},
                                   .places = {{{0, 0, 0}, 60, -9, accurate}, {{15, 0, 0}, 60 - less, -9, accurate}},
                                   .possible_gain = 80}},
                                 p);
    CHECK(decision.other >= risk);
    CHECK((was_placed || !decision.why.empty()));
    was_placed = decision.why.empty(), risk = decision.other;
  }
  CHECK_FALSE(was_placed);
  CHECK(risk == doctest::Approx(0.5));
}

TEST_CASE("lines of two directions do not turn a line of roofs that may be chance into evidence") {
  const PhotographDecisionParameters p;
  const Eigen::Matrix3d accurate = Vector3d(0.04, 0.04, 1e-4).asDiagonal();
  const auto why = [&](double roofs, double facades) {
    return decide({{.match = {.agreement = 0.9},
                    .places = {{{0, 0, 0}, roofs + facades, -9, accurate, facades}},
                    .possible_gain = 80}},
                  p)
        .why;
  };
  CHECK(why(60, 10).empty());
  CHECK(why(6, 10).find("this is chance") != std::string::npos);
  CHECK(why(6, 30).find("this is chance") != std::string::npos);
}

TEST_CASE(
    "the same place by several skies is no more evidence, and an area that was not searched is evidence against it") {
  const PhotographDecisionParameters p;
  const Eigen::Matrix3d accurate = Vector3d(0.04, 0.04, 1e-4).asDiagonal();
  PhotographAttempt attempt{
      .match = {.agreement = 0.9}, .places = {{{0, 0, 0}, 14, -9, accurate}}, .possible_gain = 80};
  const double once = decide({attempt}, p).other;
  CHECK(once > 0.005);
  CHECK(decide({attempt, attempt, attempt}, p).other == doctest::Approx(once));
  attempt.outside = 0.8;
  CHECK(decide({attempt}, p).other > 5 * once);
}

TEST_CASE("a place that is not a number is not accepted") {
  const PhotographDecisionParameters p;
  const Eigen::Matrix3d undefined = Eigen::Matrix3d::Constant(std::nan(""));
  CHECK_FALSE(
      decide({{.match = {.agreement = 0.9}, .places = {{{0, 0, 0}, 60, -9, undefined}}, .possible_gain = 80}}, p)
          .why.empty());
}

TEST_CASE("a fix does not contain the prior, which an estimator has already") {
  Eigen::Matrix2d measured;
  measured << 0.5, 0.2, 0.2, 2.0;
  const double sigma_m = 0.7;
  const Eigen::Matrix2d known = Eigen::Matrix2d::Identity() / (sigma_m * sigma_m);
  const Eigen::Matrix2d both = (measured.inverse() + known).inverse();
  CHECK((covariance_without_prior(both, sigma_m) - measured).norm() < 1e-9);
  // A picture that adds nothing has the prior's covariance, or more by its own minimum.
  for (const double factor : {1.0, 1.5})
    CHECK(covariance_without_prior(factor * known.inverse(), sigma_m)(0, 0) == doctest::Approx(900));
}

TEST_CASE("a second sky with few roofs does not gain by the facades, which both have") {
  const PhotographDecisionParameters p;
  const Eigen::Matrix3d accurate = Vector3d(0.04, 0.04, 1e-4).asDiagonal();
  const auto attempt = [&](double east, double roofs, double possible) {
    return PhotographAttempt{.match = {.agreement = 0.9},
                             .places = {{{0, east, 0}, roofs + 15, -9, accurate, 15}},
                             .possible_gain = possible};
  };
  CHECK(decide({attempt(0, 40, 80), attempt(25, 4, 27)}, p).why.empty());
  CHECK_FALSE(decide({attempt(0, 40, 80), attempt(25, 14, 27)}, p).why.empty());
}

TEST_SUITE_END();
