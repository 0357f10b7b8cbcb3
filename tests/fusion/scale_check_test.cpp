// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/fusion/scale_check.hpp"
#include "tests/support/measured_walk.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("estimator");

namespace {

/// The step at which the decision changes, from 1; 0 if it does not.
int changes_at(ScaleCheck& check, int steps, double told_m, double seen_m) {
  for (int i = 1; i <= steps; ++i)
    if (check.add(told_m, seen_m)) return i;
  return 0;
}
void blind(ScaleCheck& check) {
  check.add_motion(0.1, true, true);
  for (int i = 0; i < 10; ++i) check.add_motion(0.1, false, false);  // lost, and without metric scale
  check.restart();                                                   // another scale
  check.add_motion(0.1, true, true);
}

}  // namespace

TEST_CASE(
    "a front-end whose scale doubles while blind is rejected within twelve steps, and accepted again once it has "
    "returned") {
  ScaleCheck check;
  CHECK(changes_at(check, 60, 0.7, 0.75) == 0);
  CHECK_FALSE(check.rejected());
  CHECK(check.log_factor() == doctest::Approx(std::log(0.75 / 0.7)).epsilon(0.2).scale(0));
  blind(check);
  const int after = changes_at(check, 12, 0.7, 1.5);
  CHECK(after > 3);
  CHECK(after <= 12);
  CHECK(check.rejected());
  CHECK(changes_at(check, 40, 0.7, 1.2) == 0);  // still half as long again
  CHECK(check.log_factor() ==
        doctest::Approx(std::log(0.75 / 0.7)).epsilon(0.2).scale(0));  // not estimated from rejected data
  CHECK(changes_at(check, 40, 0.7, 0.72) > 20);
  CHECK_FALSE(check.rejected());
}

TEST_CASE("a walker's much shorter steps are estimated and not rejected, and neither are the lengths once calibrated") {
  ScaleCheck check;
  CHECK(changes_at(check, 48, 0.7, 0.45) == 0);
  CHECK(changes_at(check, 12, 0.7, 0.55) == 0);  // a brisk stretch
  CHECK(changes_at(check, 24, 0.7, 0.45) == 0);
  CHECK(changes_at(check, 36, 0.45, 0.45) == 0);  // the step estimator is calibrated by now
  blind(check);
  CHECK(changes_at(check, 12, 0.45, 0.7) > 0);
}

TEST_CASE("shuffling followed by walking does not reject the scale of a front-end that was never blind") {
  ScaleCheck check;
  check.add_motion(0.4, false, true);  // as at a start, or for one dark frame
  CHECK(changes_at(check, 36, 0.5, 0.15) == 0);
  CHECK(changes_at(check, 60, 0.7, 0.75) == 0);
}

TEST_CASE("a front-end that was blind and agrees for three times twelve steps is accepted as before") {
  ScaleCheck check;
  CHECK(changes_at(check, 24, 0.7, 0.7) == 0);
  blind(check);
  CHECK(changes_at(check, 36, 0.7, 0.7) == 0);
  CHECK(changes_at(check, 24, 0.7, 1.5) == 0);
}

TEST_CASE("motion that differs too much from the steps does not change the walker's estimate") {
  ScaleCheck check;
  CHECK(changes_at(check, 48, 0.7, 0.7) == 0);
  const double factor = check.log_factor();
  CHECK(changes_at(check, 36, 0.5, 0.15) == 0);  // shuffling
  CHECK(check.log_factor() == factor);
  blind(check);
  CHECK(changes_at(check, 12, 0.7, 1.5) > 0);
  CHECK(check.log_factor() == factor);
  CHECK(std::sqrt(check.variance()) > 0.08);
}

TEST_CASE("an estimator rejects the scale of a front-end that returns from darkness with twice its motions") {
  for (const bool dark : {true, false}) {
    CAPTURE(dark);
    WalkMeasurements what;
    what.odometry.inverse_scale = 1, what.odometry.scale_sigma = 0.005, what.odometry.scale_walk = 0;
    what.odometry.position_m = 0.003, what.odometry.rotation_rad = 0.0005;
    what.change = [&](double t, odo_vo_motion& m) {
      if (dark && t > 30 && t < 31) m.state = ODO_DEGRADED;
      if (t > 31)
        for (double& p : m.p_c0_c1) p *= 2;
    };
    MeasuredWalk walk(walk_scenario(100), what, 3);
    TestFusion fusion({.type = CouplingType::localizer}, {}, {true, false});
    double told_s = 0;
    walk.run(fusion, [&](double t, const odo_pose&) {
      if (const auto notice = fusion.take_notice();
          notice.key && std::string(notice.key) == "odometry_metre" && told_s == 0)
        told_s = t;
    });
    MESSAGE("told after " << told_s << " s");
    if (dark) {
      CHECK(told_s == Between{31, 40});
    } else {
      CHECK(told_s == 0);  // without a reason a doubled scale is accepted
    }
  }
}

TEST_CASE("a new scale clears the rejection and keeps the walker's estimate") {
  ScaleCheck check;
  changes_at(check, 36, 0.7, 0.6);
  blind(check);
  changes_at(check, 12, 0.7, 1.5);
  REQUIRE(check.rejected());
  const double factor = check.log_factor();
  check.restart();
  CHECK_FALSE(check.rejected());
  CHECK(check.log_factor() == factor);
}

TEST_CASE("the scale sigma is never below the front-end's smallest reported sigma") {
  WalkMeasurements what;
  what.steps = false;
  what.odometry.inverse_scale = 1, what.odometry.scale_sigma = 0.02;
  what.odometry.position_m = 0.003, what.odometry.rotation_rad = 0.0005;
  what.change = [](double t, odo_vo_motion& m) { m.scale_sigma = t < 10 ? 0.05 : 0.02; };
  MeasuredWalk walk(walk_scenario(40), what, 1);
  TestFusion fusion({.type = CouplingType::localizer}, {}, {true, false});
  double min_before = 1, min_after = 1;
  walk.run(fusion, [&](double t, const odo_pose& pose) {
    if (pose.scale <= 0) return;
    double& of_now = t < 10 ? min_before : min_after;
    of_now = std::min(of_now, pose.scale_sigma / pose.scale);
  });
  MESSAGE("0.05 stated: " << min_before << ", 0.02: " << min_after);
  CHECK(min_before == Between{0.99 * 0.05, 1.02 * 0.05});
  CHECK(min_after == Between{0.99 * 0.02, 1.02 * 0.02});
}

TEST_CASE("correlated step errors of a walker limit the accuracy of his estimate") {
  const StepModel::Parameters assumed;
  const double n = assumed.correlation, keep = (n - 1) / (n + 1);  // the mean has the error of a single one of n
  double squares = 0;
  int count = 0;
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    WalkMeasurements what;
    what.odometry.inverse_scale = 1, what.odometry.scale_sigma = 0.005, what.odometry.scale_walk = 0;
    what.odometry.position_m = 0.003, what.odometry.rotation_rad = 0.0005;
    what.step_own = 0, what.step_factor_sigma = assumed.factor_sigma;
    Random random(seed, 5);
    double error = assumed.own_sigma * random.normal();
    what.change_step = [&](double, odo_step& step) {
      error = keep * error + std::sqrt(1 - keep * keep) * assumed.own_sigma * random.normal();
      step.length_m *= 1 + error;
      step.sigma_m = step.length_m * std::hypot(assumed.factor_sigma, assumed.own_sigma);
    };
    MeasuredWalk walk(walk_scenario(100), what, seed);
    TestFusion fusion({.type = CouplingType::localizer}, {}, {true, false});
    walk.run(fusion, [&](double t, const odo_pose&) {
      if (t < 20) return;
      const PoseFilter& filter = fusion.filter();
      squares += std::pow((filter.x()[kLogFactor] - walk.log_factor()) / filter.sigma(kLogFactor), 2), ++count;
    });
  }
  MESSAGE("normalised error squared of the walker's factor: " << squares / count);
  CHECK(squares / count == Between{0.3, 0.8});  // 0.46; 2.75 if each step counts as independent
}
