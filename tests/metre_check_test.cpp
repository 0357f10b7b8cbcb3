// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include "sdk/host/estimator/metre_check.hpp"

using odograph::inertial::MetreCheck;

TEST_SUITE_BEGIN("estimator");

namespace {

/// The step at which the judgement changes, from 1; 0 where it does not.
int changes_at(MetreCheck& check, int steps, double told_m, double seen_m) {
  for (int i = 1; i <= steps; ++i)
    if (check.add(told_m, seen_m)) return i;
  return 0;
}
void blind(MetreCheck& check) {
  for (int i = 0; i < 10; ++i) check.add_frame(0.1, false);
  check.add_frame(0.1, true);
}

}  // namespace

TEST_CASE(
    "a front-end whose metre doubles while it is blind is doubted within twelve steps, and trusted again once it has "
    "found back") {
  MetreCheck check;
  CHECK(changes_at(check, 60, 0.7, 0.75) == 0);
  CHECK_FALSE(check.doubted());
  CHECK(check.log_factor() == doctest::Approx(std::log(0.75 / 0.7)).epsilon(0.2));
  blind(check);
  const int after = changes_at(check, 12, 0.7, 1.5);
  CHECK(after > 3);
  CHECK(after <= 12);
  CHECK(check.doubted());
  CHECK(changes_at(check, 40, 0.7, 1.2) == 0);                                      // still half as long again
  CHECK(check.log_factor() == doctest::Approx(std::log(0.75 / 0.7)).epsilon(0.2));  // not learnt from what is doubted
  CHECK(changes_at(check, 40, 0.7, 0.72) > 20);
  CHECK_FALSE(check.doubted());
}

TEST_CASE(
    "a walker with steps much shorter than thought is learnt, not doubted; nor are the steps' lengths once they are "
    "taught") {
  MetreCheck check;
  CHECK(changes_at(check, 48, 0.7, 0.45) == 0);
  CHECK(changes_at(check, 12, 0.7, 0.55) == 0);  // goes briskly for once
  CHECK(changes_at(check, 24, 0.7, 0.45) == 0);
  CHECK(changes_at(check, 36, 0.45, 0.45) == 0);  // the step estimator has been taught
  blind(check);
  CHECK(changes_at(check, 12, 0.45, 0.7) > 0);
}

TEST_CASE("somebody who shuffles and then walks does not take the metre from a front-end that saw all the time") {
  MetreCheck check;
  check.add_frame(0.4, false);  // as at a start, or one dark frame
  CHECK(changes_at(check, 36, 0.5, 0.15) == 0);
  CHECK(changes_at(check, 60, 0.7, 0.75) == 0);
}

TEST_CASE("a front-end that was blind and agrees for three times twelve steps is believed as before") {
  MetreCheck check;
  CHECK(changes_at(check, 24, 0.7, 0.7) == 0);
  blind(check);
  CHECK(changes_at(check, 36, 0.7, 0.7) == 0);
  CHECK(changes_at(check, 24, 0.7, 1.5) == 0);
}

TEST_CASE("a new scale clears the doubt and keeps the walker") {
  MetreCheck check;
  changes_at(check, 36, 0.7, 0.6);
  blind(check);
  changes_at(check, 12, 0.7, 1.5);
  REQUIRE(check.doubted());
  const double factor = check.log_factor();
  check.restart();
  CHECK_FALSE(check.doubted());
  CHECK(check.log_factor() == factor);
}

TEST_SUITE_END();
