// SPDX-License-Identifier: Apache-2.0
//
// Steps with the phone anywhere: on a leg, in a bag, on the body.
// Standing, a few steps, standing again: the steps are found, and the first ones are shorter.
#include "plugins/step/odograph/carry_mode.hpp"
#include "plugins/step/odograph/gait_finder.hpp"
#include "plugins/step/odograph/length_model.hpp"
#include "plugins/step/odograph/walk_direction.hpp"
#include "sdk/math/scalar.hpp"
#include "sdk/tools/evaluation/walk_truth.hpp"
#include "sdk/tools/simulation/carrying.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "sdk/tools/simulation/walk_scenarios.hpp"
#include "tests/plugins/found_gait.hpp"
#include "tests/support/runs.hpp"

using namespace odograph::steps;

TEST_SUITE_BEGIN("steps");

namespace {

/// Motion of a phone on a person who walks with `step_hz`.
struct Place {
  double vertical_mps2, other_foot, surge_mps2, swing_mps2, tilting_radps;
  double direction_rad = 0.7;
};

/// Both feet push, the second one by that fraction, 0.42 of a stride later; the surge leads by a good quarter of a
/// step; the swing is a pendulum's across both, once per stride.
std::vector<FoundStep> found_in(const Place& place, double step_hz, double walk_s, uint64_t seed) {
  Random random(seed, 1);
  double phase = 0;
  return found_gait(walk_s + 8, [&](double t) {
    phase += kPi * step_hz * 0.01;  // of the stride
    const double on = t > 4 && t < 4 + walk_s ? 1 : 0;
    const auto push = [&](double at) { return std::exp(3 * (std::cos(phase - at) - 1)); };
    const double up = on * place.vertical_mps2 * (push(0) + place.other_foot * push(2.6) - 0.6);
    const double surge = on * place.surge_mps2 * std::cos(2 * phase + 1.75);
    const double swing = on * place.swing_mps2 * std::cos(phase + 0.4);
    const Eigen::Vector2d along(std::cos(place.direction_rad), std::sin(place.direction_rad));
    const Eigen::Vector2d noise{0.05 * random.normal(), 0.05 * random.normal()};
    const Eigen::Vector2d horizontal = (surge + swing) * along + noise;
    const double rate = on * place.tilting_radps * std::sqrt(2.0) * std::cos(phase);
    return WalkSample{.vertical = up + 0.05 * random.normal(),
                      .level = horizontal.norm(),
                      .gyro = std::abs(rate) + 0.05,
                      .horizontal_n = horizontal,
                      .tilting_n = Eigen::Vector2d(rate, 0)};
  });
}

const Place kLeg{8, 0.5, 2, 3, 1.6}, kBag{5, 0.8, 1.5, 2.5, 0.6};

}  // namespace

TEST_CASE(
    "a phone on a leg or in a bag shows the steps of both feet, though only strides are alike and little is vertical") {
  for (const Place& place : {kLeg, kBag})
    for (const double hz : {1.5, 1.8, 2.2}) {
      CAPTURE(place.vertical_mps2);
      CAPTURE(hz);
      const auto steps = found_in(place, hz, 30, 5);
      CHECK(std::abs(static_cast<double>(steps.size()) - 30 * hz) <= 3);
      if (!steps.empty()) CHECK(steps.back().vertical_part < 0.75);
    }
}

TEST_CASE("a swinging arm that hides every other contact does not end a walk") {
  Random random(4, 1);
  const auto steps = found_gait(40, [&](double t) {
    const double on = t > 4 && t < 34 ? 1 : 0, phase = kPi * 1.85 * (t - 4);  // of the stride
    const double hidden = t > 15 && t < 21 ? 0.0 : 0.7;
    const auto push = [&](double at) { return std::exp(4 * (std::cos(phase - at) - 1)); };
    const double up = on * 5 * (push(0) + hidden * push(kPi) - 0.3), swing = on * 4 * std::cos(phase + 0.4);
    return WalkSample{.vertical = up + 0.05 * random.normal(),
                      .level = std::abs(swing),
                      .gyro = on * 1.4,
                      .horizontal_n = {swing, 0.05 * random.normal()}};
  });
  CHECK(std::abs(static_cast<double>(steps.size()) - 30 * 1.85) <= 3);
  for (size_t i = 1; i < steps.size(); ++i) CHECK(steps[i].t_start_ns - steps[i - 1].t_end_ns < 300'000'000);
}

TEST_CASE("steps at 2.4 to 3 Hz are found in a swinging hand, and the same motion four times as large is shaking") {
  const auto found_at = [](double hz, double swing_mps2) {
    Random random(8, 1);
    return found_gait(16, [&](double t) {
      const double on = t > 4 && t < 12 ? 1 : 0, phase = 2 * kPi * hz * (t - 4);
      const double level = on * 0.3 * swing_mps2 * std::cos(0.5 * phase);
      return WalkSample{.vertical = on * 0.5 * swing_mps2 * std::cos(phase) + 0.05 * random.normal(),
                        .level = std::abs(level),
                        .gyro = on * 0.4 * swing_mps2,
                        .horizontal_n = {level, 0.05 * random.normal()}};
    });
  };
  for (const double hz : {2.4, 3.0}) {
    CAPTURE(hz);
    CHECK(std::abs(static_cast<double>(found_at(hz, 14).size()) - 8 * hz) <= 3);
  }
  CHECK(found_at(1.6, 4 * 14).size() <= 4);  // of the decay after its end
}

TEST_CASE("equally strong motion by a hand without rhythm is no walk") {
  size_t found = 0;
  for (const uint64_t seed : {1, 2, 3}) {
    Random random(seed, 1);
    Eigen::Vector3d at = Eigen::Vector3d::Zero(), speed = at;  // each axis rings at 1.5 Hz, as in gestures
    constexpr double dt = 0.01, w = 2 * kPi * 1.5, damping = 0.3;
    const auto steps = found_gait(200, [&](double) {
      const Eigen::Vector3d push{random.normal(), random.normal(), random.normal()};
      speed += dt * (-w * w * at - 2 * damping * w * speed) + std::sqrt(4 * damping * w * dt) * w * push;
      at += dt * speed;
      const Eigen::Vector3d force = 2.0 * at;  // m/s^2, rms
      return WalkSample{.vertical = force.z(),
                        .level = force.head<2>().norm(),
                        .gyro = 1.5,
                        .horizontal_n = force.head<2>(),
                        .tilting_n = Eigen::Vector2d(0.6 * at.x(), 0.6 * at.y())};
    });
    found += steps.size();
  }
  CHECK(found <= 10);  // one per minute
}

TEST_CASE("the surge gives the walking direction in the phone's frame, with a consistent sigma") {
  WalkDirection direction;
  CHECK(direction.sigma_rad() > 3);
  for (const FoundStep& step : found_in(kLeg, 1.8, 20, 6)) direction.add(step.surge_n, 0.5);
  CHECK(std::abs(direction.offset_rad() - (kLeg.direction_rad - 0.5)) < 0.15);
  CHECK(direction.sigma_rad() < 0.2);
  WalkDirection noise;
  Random random(3, 1);
  for (int i = 0; i < 40; ++i) noise.add({random.normal(), random.normal()}, 0);
  CHECK(noise.sigma_rad() > 0.5);
}

TEST_CASE("a leg's swing is a pocket from the second step on") {
  CarryModeClassifier carry;
  CarryMode mode = CarryMode::texting;
  for (const FoundStep& step : found_in(kLeg, 1.8, 10, 7)) mode = carry.classify(step, {0, 0.98, 0});
  CHECK(mode == CarryMode::pocket);
  CHECK(carry.on_leg());
}

TEST_CASE("a thigh that swings a little less for a few steps stays one, and the direction does not flip") {
  CarryModeClassifier carry;
  FoundStep step{.swing_mps2 = 6, .frequency_hz = 1.8, .vertical_part = 0.8};
  const auto walk = [&](int steps, double radps) {
    step.gyro_radps = radps;
    for (int i = 0; i < steps; ++i) carry.classify(step, {0, -0.9, 0});
  };
  walk(10, 1.6);
  CHECK(carry.on_leg());
  walk(10, 1.25);
  CHECK(carry.on_leg());
  walk(20, 0.6);
  CHECK_FALSE(carry.on_leg());
  walk(10, 1.25);
  CHECK_FALSE(carry.on_leg());
}

namespace {

const FoundStep kUsualStep{
    .rise_m = 0.03, .gyro_radps = 0.5, .frequency_hz = 1.8, .vertical_part = 0.7, .repetition = 0.9};

}  // namespace

TEST_CASE("a step's length grows with cadence, rise and a second hump, and shrinks on a bending path") {
  const LengthModel model;
  const auto relative = [&](auto FoundStep::*what, double value) {
    FoundStep step = kUsualStep;
    step.*what = value;
    return model.length_m(step) / model.length_m(kUsualStep);
  };
  CHECK(relative(&FoundStep::frequency_hz, 1.3) < 0.85);
  CHECK(relative(&FoundStep::frequency_hz, 2.1) == doctest::Approx(1));  // among people a quick cadence is no pace
  CHECK(relative(&FoundStep::rise_m, 0.06) == doctest::Approx(std::pow(2, 0.22)));
  CHECK(relative(&FoundStep::rise_m, 0.015) > 0.8);  // cloth dampens the rise: a small one gives no short step
  CHECK(relative(&FoundStep::turning_radps, 0.2) < 0.9);
  CHECK(relative(&FoundStep::turning_radps, 5) == relative(&FoundStep::turning_radps, 0.3));
  CHECK(relative(&FoundStep::second_harmonic, 0.3) < 0.95);
  CHECK(relative(&FoundStep::rise_m, 1e3) < 1.5);  // beyond the fitted data the extrapolation is bounded
  CHECK(model.length_m({.rise_m = 0, .frequency_hz = 0}) > 0.1);
}

TEST_CASE(
    "a length is less certain the further its step is from those of the fit, and of an irregular walk by itself") {
  const LengthModel model;
  FoundStep fitted{.rise_m = 0.043, .frequency_hz = 1.9, .vertical_part = 0.7, .repetition = 0.9};
  fitted.turning_radps = 0.1, fitted.second_harmonic = 0.18;
  const double usual = model.estimate(fitted).common_sigma;
  CHECK(usual < 0.02);
  const auto more = [&](auto FoundStep::*what, auto near, auto far) {
    FoundStep step = fitted;
    step.*what = near;
    const double some = model.estimate(step).common_sigma;
    step.*what = far;
    CHECK(some > usual);
    CHECK(model.estimate(step).common_sigma > some);
  };
  more(&FoundStep::rise_m, 0.08, 0.16);
  more(&FoundStep::rise_m, 0.02, 0.008);
  more(&FoundStep::frequency_hz, 2.3, 3.0);
  more(&FoundStep::turning_radps, 0.3, 1.0);
  FoundStep strolled = fitted;
  strolled.repetition = 0.6;
  CHECK(model.estimate(strolled).own_sigma > 1.3 * model.estimate(fitted).own_sigma);
}

TEST_CASE("a bag swings with its strap's own period, with damping") {
  constexpr double kRate_hz = 400, kStrap_m = 0.5;
  std::vector<Eigen::Vector3d> trunk(4000, Eigen::Vector3d::Zero());
  for (size_t i = 100; i < trunk.size(); ++i) trunk[i].x() = 0.05;  // a forward jerk
  const Bag bag(trunk, Signal(trunk.size()), kStrap_m, 0.1, kRate_hz);
  std::vector<size_t> crossings;
  for (size_t i = 200; i + 2 < trunk.size(); ++i)
    if (bag.forward_rad[i - 1] < 0 && bag.forward_rad[i] >= 0) crossings.push_back(i);
  REQUIRE(crossings.size() > 3);
  const double period_s = static_cast<double>(crossings[3] - crossings[0]) / 3 / kRate_hz;
  CHECK(period_s == doctest::Approx(2 * kPi * std::sqrt(kStrap_m / 9.80665) / std::sqrt(1 - 0.01)).epsilon(0.01));
  CHECK(std::abs(bag.right_rad[500]) < 1e-12);
  CHECK(std::abs(bag.forward_rad[3990]) < 0.1 * std::abs(bag.forward_rad[150]));
}

TEST_CASE("there is at most a step per minute in lifts and in a car") {
  for (const bool drives : {false, true}) {
    CAPTURE(drives);
    const Recording recording = recorded_sensors(drives ? car_ride(3) : standing("lift", false), 3);
    const RunResult result = run_of(recording, source("samples/configs/pocket_walk.yaml"));
    const auto& states = recording.true_states;
    const double minutes = static_cast<double>(states.back().t_ns - states.front().t_ns) / 60e9;
    CHECK(minutes > 5);
    // The metre to the lift and away is walked.
    CHECK(static_cast<double>(result.steps.size()) <= minutes + static_cast<double>(recording.true_steps.size()));
    if (drives) continue;
    double highest_m = 0;
    for (const TrueState& state : states) highest_m = std::max(highest_m, states.front().p.z() - state.p.z());
    CHECK(highest_m > 10);  // it rode
  }
}

namespace {

struct Error {
  double count_percent, distance_percent, position_m;
  size_t steps;
};

std::vector<Error> errors_in(const std::filesystem::path& folder, const std::string& ending) {
  std::vector<Error> errors;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (!entry.path().filename().string().ends_with(ending) || entry.path().stem() == "index") continue;
    const Recording recording = recorded(entry.path());
    const RunResult result = run_of(recording, source("samples/configs/pocket_walk.yaml"));
    const WalkTruthFigures f = walk_truth_figures(recording, result.steps, result.track);
    errors.push_back({f.count_percent, 100 * (f.estimated_m / f.true_m - 1), f.position_m, result.steps.size()});
  }
  return errors;
}

std::vector<double> sizes(const std::vector<Error>& errors, double Error::*what) {
  std::vector<double> values;
  for (const Error& e : errors) values.push_back(std::abs(e.*what));
  return values;
}

}  // namespace

TEST_CASE("real walks with the phone in the hand, on the body, in a bag and on the leg are within limits" *
          doctest::test_suite("steps_data")) {
  const auto folder = data_or_skip("ridi");
  if (folder.empty()) return;
  const auto errors = errors_in(folder, ".csv");
  for (const Error& e : errors) CHECK(e.steps > 60);
  CHECK(percentile(sizes(errors, &Error::distance_percent), 0.5) < 5);
  CHECK(percentile(sizes(errors, &Error::distance_percent), 0.9) < 10);
  CHECK(percentile(sizes(errors, &Error::position_m), 0.5) < 1.1);
}

TEST_CASE("real steps match those counted by a switch in each shoe" * doctest::test_suite("steps_data")) {
  const auto folder = data_or_skip("oxford_steps");
  if (folder.empty()) return;
  const auto errors = errors_in(folder, "_accelerometer.csv");
  CHECK(percentile(sizes(errors, &Error::count_percent), 0.5) < 2);
  CHECK(percentile(sizes(errors, &Error::count_percent), 1) < 5);
}

TEST_CASE("a drive and a shaken phone have no steps, and quick stairs in a swinging hand do" *
          doctest::test_suite("steps_data")) {
  const auto folder = data_or_skip("pace_walks");
  if (folder.empty()) return;
  const auto steps_of = [&](const char* name) {
    return run_of(recorded(folder / name), source("samples/configs/pocket_walk.yaml")).steps;
  };
  CHECK(steps_of("car.txt").size() <= 3);
  CHECK(steps_of("shaken.txt").size() <= 3);
  const auto stairs = steps_of("steps_ladder.txt");
  for (const auto& [from_s, to_s] : {std::pair{114.8, 118.4}, {119.7, 122.7}}) {  // 2.4 Hz, visible in the acceleration
    const auto inside = std::count_if(stairs.begin(), stairs.end(), [&](const odo_step& step) {
      const double end_s = static_cast<double>(step.t_end_ns) * 1e-9;
      return end_s > from_s && end_s < to_s + 0.1;
    });
    CHECK(std::abs(static_cast<double>(inside) - 2.4 * (to_s - from_s)) <= 1.5);
  }
}

TEST_CASE("lengths follow one man's pace, with true lengths from 0.55 to 0.86 m" * doctest::test_suite("steps_data")) {
  const auto folder = data_or_skip("pace_walks");
  if (folder.empty()) return;
  constexpr double kWalk_m = 31.91;
  double sum = 0, sum_true = 0, products = 0, squares = 0, n = 0;
  for (const auto& [name, count] : {std::pair{"walk_A", 42.0},
                                    {"walk_B", 42},
                                    {"walk_C", 39},
                                    {"walk_D", 58},
                                    {"walk_E", 37},
                                    {"walk_F", 57},
                                    {"walk_G", 43}}) {
    const Recording recording = recorded(folder / (std::string(name) + ".txt"));
    const RunResult result = run_of(recording, source("samples/configs/pocket_walk.yaml"));
    const WalkTruthFigures f = walk_truth_figures(recording, result.steps, result.track);
    const double truth = kWalk_m / count, estimate = f.estimated_m / count;
    CHECK(std::abs(f.estimated_m - kWalk_m) < 3 * f.sigma_m);
    CHECK(f.sigma_m < 0.25 * kWalk_m);  // a fixed step (kFixedStep_m) errs by 27 % at the slowest pace
    n += 1, sum += estimate, sum_true += truth, products += estimate * truth, squares += truth * truth;
  }
  const double slope = (products - sum * sum_true / n) / (squares - sum_true * sum_true / n);
  // By the third root of the swing (Kim et al. 2004) the same steps have 0.65, by the rise alone 0.16.
  CHECK(slope == Between{0.75, 1.1});
}

namespace {

/// Steps at 1.8 Hz within these times, s; standing in between.
std::vector<FoundStep> found_in(const std::vector<std::pair<double, double>>& walks) {
  constexpr double kStep_hz = 1.8, kRise_m = 0.04, kTwoPi = 6.283185307179586;
  Random random(5, 1);
  return found_gait(walks.back().second + 5, [&](double t) {
    double up = 0.1 * random.normal();
    bool on = false;
    for (const auto& [from_s, to_s] : walks)
      if (t > from_s && t < to_s)
        on = true, up += 0.5 * kRise_m * std::pow(kTwoPi * kStep_hz, 2) * std::cos(kTwoPi * kStep_hz * (t - from_s));
    return WalkSample{.vertical = up, .level = on ? 0.6 : 0.05, .gyro = 0.05};
  });
}

size_t between(const std::vector<FoundStep>& steps, double from_s, double to_s) {
  return static_cast<size_t>(std::count_if(steps.begin(), steps.end(), [&](const FoundStep& step) {
    return step.t_end_ns > static_cast<int64_t>(from_s * 1e9) && step.t_end_ns < static_cast<int64_t>(to_s * 1e9);
  }));
}

}  // namespace

TEST_CASE("three steps between two stops count shortly after a walk, and may be gestures otherwise") {
  const double few_s = 2.4 / 1.8;  // three contacts
  const auto after = found_in({{4, 14}, {17, 17 + few_s}, {20, 20 + few_s}});
  CHECK(between(after, 16, 19) >= 2);
  CHECK(between(after, 19, 23) >= 2);
  CHECK(between(found_in({{4, 4 + few_s}, {7, 7 + few_s}}), 0, 12) == 0);
  const auto later = found_in({{4, 14}, {40, 40 + few_s}});
  CHECK(between(later, 30, 45) == 0);
}

TEST_CASE("the first step after a stop is half a step, and the fifth almost a whole one") {
  const auto steps = found_in({{4, 14}, {18, 28}});
  const LengthModel model;
  std::vector<double> parts;
  for (FoundStep step : steps) {
    if (step.t_end_ns < 16'000'000'000) continue;
    const double length_m = model.length_m(step);
    step.since_stood = 100;
    parts.push_back(length_m / model.length_m(step));
  }
  REQUIRE(parts.size() > 10);
  CHECK(parts[0] == doctest::Approx(0.5));
  CHECK(parts[1] > 0.7);
  CHECK(parts[4] > 0.95);
  CHECK(parts.back() > 0.999);
}
