// SPDX-License-Identifier: Apache-2.0
//
// Floors as integers, and lifts, which are neither walking nor standing.
#include "plugins/step/odograph/stair_detector.hpp"
#include "tests/support/test_fusion.hpp"
#include "sdk/host/fusion/floors.hpp"
#include "sdk/host/fusion/height.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/math/atmosphere.hpp"
#include "sdk/tools/replay/runner.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "sdk/tools/simulation/simulate.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("floors");

namespace {

constexpr int64_t kSecond = 1'000'000'000;

/// Half a minute at each height, a third of a metre per second between them, with noise.
struct Ascent {
  FloorEstimator floors;
  Random random{7, 1};
  int64_t t_ns = 0;
  double up_m = 0;

  FloorEstimator::Floor to(double m, double stay_s = 30) {
    const auto add = [&] { floors.add(t_ns += kSecond / 2, up_m + 0.1 * random.normal()); };
    while (std::abs(m - up_m) > 0.2) up_m += std::copysign(0.16, m - up_m), add();
    up_m = m;
    for (double t = 0; t < stay_s; t += 0.5) add();
    return floors.floor();
  }
};

}  // namespace

TEST_CASE("storeys of usual height are counted up and down, and a floor seen before is recognised") {
  Ascent ascent;
  CHECK(ascent.to(0).floor == 0);
  const auto first = ascent.to(3.3);
  CHECK(first.floor == 1);
  CHECK(first.probability > 0.8);
  CHECK(ascent.to(6.5).floor == 2);
  CHECK(ascent.to(9.9).floor == 3);
  const auto again = ascent.to(3.3);
  CHECK(again.floor == 1);
  CHECK(again.probability > 0.98);
  CHECK(ascent.to(0).floor == 0);
  CHECK(ascent.to(-3.1).floor == -1);
}

TEST_CASE("the probability is calibrated over buildings of all kinds with rests on landings") {
  Random random{11, 3};
  int places = 0, right = 0, certain = 0, certain_right = 0;
  double stated = 0;
  for (uint64_t building = 0; building < 80; ++building) {
    const double mean_m = random.uniform(2.6, 4.6);
    std::array<double, 12> floor_m{};  // from -3 to 8, the walk starts on 0
    for (size_t i = 1; i < floor_m.size(); ++i) floor_m[i] = floor_m[i - 1] + mean_m * (1 + 0.1 * random.normal());
    Ascent walk;
    walk.random = Random{building, 2};
    walk.to(0);
    for (int visit = 0, from = 3; visit < 12; ++visit) {
      const int to = static_cast<int>(random.uniform(0, 12));
      const double up_m = floor_m[size_t(to)] - floor_m[3];
      if (to != from && random.uniform(0, 1) < 0.3) {  // on the last flight
        const double below_m = floor_m[size_t(to + (to < from ? 1 : -1))] - floor_m[3];
        const double height_m = below_m + random.uniform(0.4, 0.6) * (up_m - below_m);
        walk.to(height_m, random.uniform(2, 20));
      }
      const auto floor = walk.to(up_m);
      const bool is_right = floor.floor == to - 3;
      ++places, right += is_right, stated += floor.probability;
      if (floor.probability > 0.9) ++certain, certain_right += is_right;
      from = to;
    }
  }
  MESSAGE(places << " places, right " << 100.0 * right / places << " %, stated " << 100 * stated / places << " %; of "
                 << certain << " stated above 90 %, right " << 100.0 * certain_right / certain << " %");
  CHECK(right > 0.7 * places);
  CHECK(stated / places < 1.0 * right / places + 0.05);
  CHECK(certain_right > 0.93 * certain);
}

TEST_CASE("after leaving the range of distinguishable floors and returning, the floors are recognised") {
  Ascent tower;
  tower.to(0), tower.to(3.3);
  CHECK(tower.to(400).probability < 0.1);
  CHECK(tower.to(3.3).floor == 1);
  CHECK(tower.to(0).floor == 0);
  CHECK(tower.floors.floor().probability > 0.95);
}

TEST_CASE("a building's high storeys are learnt from the first one") {
  Ascent learnt, unlearnt;
  learnt.to(0), unlearnt.to(0);
  learnt.to(4.3), learnt.to(8.6);
  const auto after = learnt.to(17.2), at_once = unlearnt.to(17.2);
  CHECK(after.floor == 4);
  CHECK(after.probability > 0.6);
  CHECK(at_once.probability < 0.5);  // four high ones, five usual ones or six low ones: ambiguous
}

TEST_CASE(
    "halfway up, on a landing, the floor is uncertain and reported as such, and a ramp or a step is not a floor") {
  Ascent ascent;
  ascent.to(0);
  CHECK(ascent.to(1.65, 3).probability < 0.8);
  CHECK(ascent.to(3.3).floor == 1);
  for (const double landing_m : {1.4, 1.65, 1.9}) {  // to read a sign, for example: it does not become a floor
    CAPTURE(landing_m);
    Ascent rest;
    rest.to(0);
    rest.to(-landing_m, 20);
    CHECK(rest.to(-3.3).floor == -1);
    CHECK(rest.to(-landing_m, 20).probability < 0.9);
    CHECK(rest.to(-6.0).floor == -2);
    CHECK(rest.to(0).floor == 0);
  }
  Ascent ramp;
  ramp.to(0);
  CHECK(ramp.to(0.6).floor == 0);
  CHECK(ramp.to(0.6).probability > 0.95);
}

TEST_CASE("pressure drift by a storey within an hour on one floor does not change the floor") {
  Ascent ascent;
  ascent.to(0);
  for (int minute = 0; minute < 60; ++minute) ascent.up_m = 0.05 * minute, ascent.to(0.05 * minute, 60);
  CHECK(ascent.floors.floor().floor == 0);
  CHECK(ascent.floors.floor().probability > 0.9);
}

namespace {

/// A ride between two stands at a given speed and barometer rate; whether and when it was detected.
struct Ride {
  bool seen = false, over = false;
  double since_s = 0, seen_s = 0;
};
Ride ride_of(double mps, double ride_s, double rate_hz, bool walks, double scatter_pa = 1.5) {
  LiftDetector detector;
  Random random(11, 2);
  Ride ride;
  int64_t stepped_ns = 0;
  for (double t = 0; t < 40 + ride_s; t += 1 / rate_hz) {
    const double up_m = mps * std::clamp(t - 20, 0.0, ride_s);
    const auto t_ns = static_cast<int64_t>(t * 1e9) + kSecond;
    if (walks || t < 15) stepped_ns = t_ns, detector.step(t_ns);
    if (!detector.add(t_ns, 101'325 - up_m / 0.0843 + scatter_pa * random.normal(), stepped_ns)) continue;
    if (detector.riding() && !ride.seen)
      ride.seen = true, ride.seen_s = t - 20, ride.since_s = 1e-9 * static_cast<double>(*detector.since()) - 21;
    ride.over = ride.seen && !detector.riding();
  }
  return ride;
}

}  // namespace

TEST_CASE("a lift is detected after a few seconds, an escalator before its end, and walked stairs are neither") {
  for (const double rate_hz : {1.0, 6.0, 25.0}) {
    CAPTURE(rate_hz);
    const Ride lift = ride_of(1.0, 10, rate_hz, false);
    CHECK(lift.seen);
    CHECK(lift.over);
    CHECK(lift.seen_s < 5);
    CHECK(std::abs(lift.since_s) < 4);
    const Ride down = ride_of(-1.6, 8, rate_hz, false);
    CHECK(down.seen);
    const Ride escalator = ride_of(0.25, 20, rate_hz, false);
    CHECK(escalator.seen);
    CHECK(escalator.over);
    CHECK_FALSE(ride_of(0.3, 20, rate_hz, true).seen);
    CHECK_FALSE(ride_of(0, 20, rate_hz, false, 3).seen);
  }
}

TEST_CASE("a walk with lift rides: the height follows, and poses report the lift and the floor") {
  Scenario s;
  s.walker.stand_s = 4;
  s.route = {{0, 0, 0}, {60, 0, 0}};
  s.events = {{20.0, "lift", 15.0}, {40.0, "lift", 15.0}};  // up by 14 m and down again
  const auto recording = required(simulated(s, 31));
  RunOptions options{.config = source("samples/configs/pocket_walk.yaml").string(),
                     .overrides = {{"absolute_fixers", "[]"}},
                     .plugin_path = plugin_folder().string(),
                     .collect_poses = true};
  const auto result = required(replay(*recording, options));
  double worst_m = 0, highest_m = 0, riding_m = 0;
  int on_floors = 0, late = 0;
  for (const odo_pose& pose : result->poses) {
    const auto state = std::lower_bound(recording->true_states.begin(), recording->true_states.end(), pose.header.t_ns,
                                        [](const TrueState& a, int64_t t) { return a.t_ns < t; });
    if (state == recording->true_states.end()) continue;
    const double true_m = -(state->p.z() - recording->true_states.front().p.z()), up_m = -pose.p_n[2];
    const bool between = true_m > 2 && true_m < 12;
    (between ? riding_m : worst_m) = std::max(between ? riding_m : worst_m, std::abs(up_m - true_m));
    highest_m = std::max(highest_m, up_m);
    const bool carried = pose.header.flags & ODO_POSE_CARRIED;
    if (true_m > 7 && true_m < 12) CHECK(carried);
    if (true_m < 0.5 || true_m > 13.9) ++on_floors, late += carried;
    if (true_m > 13.9 && up_m > 12.5) {
      REQUIRE((pose.header.flags & ODO_POSE_FLOOR) != 0);
      CHECK(pose.floor >= 3);  // 14 m are four floors, or five
      CHECK(pose.floor <= 5);
      CHECK(pose.floor_probability < 0.9);  // ambiguous
    }
  }
  CHECK(late < 0.15 * on_floors);
  CHECK(result->poses.back().floor == 0);
  CHECK(result->poses.back().floor_probability > 0.95);
  MESSAGE("off by " << worst_m << " m on floors, " << riding_m << " m in the lift");
  CHECK(worst_m < 2.5);
  CHECK(riding_m == Between{0, 6});
  CHECK(highest_m > 12);
  CHECK(std::abs(result->track.back().p.z() - result->track.front().p.z()) < 1.5);
}

TEST_CASE("a lift is a source of motion: its motion is no correction, and steps move the track again afterwards") {
  TestFusion fusion({.type = CouplingType::localizer}, {}, {false, false});
  Random random(3, 9);
  const auto ns = [](double t_s) { return kSecond + static_cast<int64_t>(std::llround(t_s * 1e9)); };
  const auto up_at = [](double t_s) { return 1.0 * std::clamp(t_s - 30, 0.0, 10.0); };
  size_t corrections = 0;
  bool rode = false, floor_said = false;
  for (int i = 0; i < 7000; ++i) {
    const double t = 0.01 * i;
    auto attitude = attitude_at(ns(t), Eigen::Quaterniond::Identity(), 4e-4);
    fusion.update(&attitude);
    const bool walks = t < 25 || t > 45;
    if (walks && i > 0 && i % 50 == 0) {
      auto step = step_between(ns(t - 0.9), ns(t - 0.4), ns(t), 0.7, 0.05);
      step.mode = ODO_MODE_WALKING_TEXTING;
      fusion.update(&step);
    }
    if (i % 20 == 0) {
      auto reading = pressure_at(ns(t), pressure_at_pa(up_at(t)) + 1.5 * random.normal());
      fusion.update(&reading);
    }
    Correction correction;
    odo_pose pose{};
    const bool corrected = fusion.take_correction(correction, pose);
    while (fusion.take_pose(pose)) continue;
    for (Notice notice = fusion.take_notice(); notice.key; notice = fusion.take_notice())
      floor_said |= std::string(notice.key) == "floor";
    const bool rides = fusion->source() == MotionSource::lift;
    rode = rode || rides;
    corrections += corrected && rides;
    if (rides) CHECK((t > 30 && t < 45));
    if (t > 36 && t < 40) CHECK(rides);
  }
  CHECK(rode);
  CHECK(corrections == 0);
  CHECK(floor_said);
  CHECK(fusion->source() == MotionSource::steps);
  CHECK(std::abs(-fusion.filter().x()[kDown] - 10) < 1);
  CHECK(fusion->floor().floor == 3);
  CHECK(fusion->floor().probability > 0.5);
}

TEST_SUITE_BEGIN("steps");

TEST_CASE("stairs are detected from pressure despite wind") {
  for (const double rate_hz : {1.0, 10.0}) {
    CAPTURE(rate_hz);
    Random random(4, 4);
    double gust = 0, wrong_s = 0, climbed_s = 0, late_s = 0;
    steps::StairDetector stairs;
    for (int i = 0; i < 600 * rate_hz; ++i) {
      const double t = i / rate_hz, keep = std::exp(-1 / (4 * rate_hz));
      gust = keep * gust + 4 * std::sqrt(1 - keep * keep) * random.normal();
      const double up_m = 0.28 * (std::clamp(t - 200, 0.0, 15.0) - std::clamp(t - 400, 0.0, 15.0));  // two flights
      stairs.add(static_cast<int64_t>(t * 1e9), 101325 - up_m / 0.0843 + gust + 2 * random.normal());
      const bool truth = (t > 200 && t < 215) || (t > 400 && t < 415);
      if (stairs.on_stairs() && !(t > 200 && t < 225) && !(t > 400 && t < 425)) wrong_s += 1 / rate_hz;
      if (truth) (stairs.on_stairs() ? climbed_s : late_s) += 1 / rate_hz;
    }
    CHECK(wrong_s < 6);     // of ten minutes
    CHECK(climbed_s > 10);  // of thirty seconds, with the window's delay of ten seconds twice
  }
}

TEST_CASE("a street of 17 % lifts as fast as stairs but is not taken for them, since the steps have the usual length") {
  const auto stairs_s = [](double length_m, double period_s) {
    Random random(5, 4);
    double gust = 0, on_s = 0, next_s = 30;
    steps::StairDetector stairs;
    for (int t = 0; t < 90; ++t) {
      gust = std::exp(-0.25) * gust + 4 * std::sqrt(1 - std::exp(-0.5)) * random.normal();
      const double up_m = 0.24 * std::clamp(t - 30.0, 0.0, 30.0);
      stairs.add(t * 1'000'000'000ll, 101325 - up_m / 0.0843 + gust + 2 * random.normal());
      for (; next_s < t; next_s += period_s)
        stairs.add_step(static_cast<int64_t>(next_s * 1e9), static_cast<int64_t>((next_s + period_s) * 1e9), length_m);
      on_s += stairs.on_stairs();
    }
    return on_s;
  };
  CHECK(stairs_s(0.75, 0.53) == 0);
  CHECK(stairs_s(0.40, 0.58) > 20);  // treads, estimated as somewhat longer steps
}

TEST_CASE("stairs end ten seconds after the last pressure sample, though steps continue") {
  steps::StairDetector stairs;
  for (int i = 0; i < 30; ++i) {
    stairs.add(i * 1'000'000'000ll, 101325 - 0.28 * i / 0.0843);
    stairs.add_step(i * 1'000'000'000ll, i * 1'000'000'000ll + 600'000'000, 0.35);
  }
  REQUIRE(stairs.on_stairs());
  for (int i = 30; i < 39; ++i) stairs.add_step(i * 1'000'000'000ll, i * 1'000'000'000ll + 600'000'000, 0.35);
  CHECK(stairs.on_stairs());
  for (int i = 39; i < 45; ++i) stairs.add_step(i * 1'000'000'000ll, i * 1'000'000'000ll + 600'000'000, 0.35);
  CHECK_FALSE(stairs.on_stairs());
}
