// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/barometer/pressure_height.hpp"
#include "sdk/tools/simulation/sensors.hpp"
#include "tests/support/runs.hpp"

using namespace odograph::barometer;

TEST_SUITE_BEGIN("barometer");

namespace {

constexpr int64_t kSecond_ns = 1'000'000'000;

double pressure_at(double up_m) { return 101325.0 * std::pow(1 - 2.25577e-5 * up_m, 5.25588); }

}  // namespace

TEST_CASE("without weather and noise a climb of 9 m is 9 m at any height above sea level") {
  for (const double base_m : {0.0, 300.0, 2000.0}) {
    CAPTURE(base_m);
    PressureHeight height({});
    height.refer(0, -5, 0.01);
    std::optional<PressureHeight::Height> last;
    for (int k = 0; k < 100; ++k)
      if (const auto h = height.add(k * kSecond_ns, pressure_at(base_m + (k < 50 ? 0.0 : 9.0)))) last = h;
    REQUIRE(last.has_value());
    CHECK(last->down_m == doctest::Approx(-14).epsilon(0.002));
  }
}

TEST_CASE("after ten minutes of simulated weather the height errors match their sigmas") {
  double squares = 0, variances = 0;
  int within = 0;
  constexpr int kSeeds = 300;
  for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SimBarometer sensor({}, seed);
    PressureHeight height({});
    height.refer(0, 0, 0.01);
    std::optional<PressureHeight::Height> last;
    for (int k = 0; k <= 600; ++k)
      if (const auto h = height.add(k * kSecond_ns, sensor.measure(20))) last = h;
    REQUIRE(last.has_value());
    squares += last->down_m * last->down_m, variances += last->error_variance_m2;
    within += std::abs(last->down_m) < 2 * std::sqrt(last->error_variance_m2);
  }
  CHECK(squares / variances == Between{0.4, 1.2});  // the simulator has no trend
  CHECK(within >= 0.93 * kSeeds);
}

TEST_CASE("the sigma grows with the time since the reference, and a new reference resets it") {
  PressureHeight height({});
  height.refer(0, 0, 0.01);
  double after_ten_minutes = 0, after_reference = 0;
  for (int k = 0; k <= 700; ++k) {
    if (k == 650) height.refer(k * kSecond_ns, -3, 0.04);
    const auto h = height.add(k * kSecond_ns, 100000);
    if (h && k <= 601) after_ten_minutes = h->error_variance_m2;
    if (h && k > 655 && after_reference == 0) {
      after_reference = h->error_variance_m2;
      CHECK(h->down_m == doctest::Approx(-3));
    }
  }
  CHECK(std::sqrt(after_ten_minutes) > 0.8);
  CHECK(std::sqrt(after_reference) < 0.8);
  CHECK(after_reference < after_ten_minutes);
}

TEST_CASE("the sigma of the reference is part of every height derived from it") {
  const auto doubt_m2 = [](double reference_m2) {
    PressureHeight height({});
    height.refer(0, 0, reference_m2);
    std::optional<PressureHeight::Height> last;
    for (int k = 0; k <= 60; ++k)
      if (const auto h = height.add(k * kSecond_ns, 100000)) last = h;
    REQUIRE(last.has_value());
    return last->error_variance_m2;
  };
  CHECK(doubt_m2(4.0) - doubt_m2(1.0) == doctest::Approx(3.0).epsilon(1e-9));
}

TEST_CASE("pressures outside a walker's range are ignored, and a time that goes back restarts the average") {
  PressureHeight height({});
  height.refer(0, 0, 0.01);
  for (int k = 0; k < 20; ++k) height.add(k * kSecond_ns, 100000);
  for (const double wrong : {0.0, -5.0, std::nan(""), 1e9, 1000.0}) CHECK_FALSE(height.add(25 * kSecond_ns, wrong));
  CHECK_FALSE(height.add(5 * kSecond_ns, 100000));
}

TEST_CASE("stairs and slopes of 9 m are tracked from a waypoint with the height of the start") {
  const TemporaryFolder folder;
  std::ofstream(folder / "p.yaml") << "odograph: 1\nattitude:\n  plugin: attitude/vqf\nstep_estimator:\n  plugin: "
                                      "step/odograph\ncoupling:\n  type: localizer\nabsolute_fixers:\n  - plugin: "
                                      "fix/waypoint\n  - plugin: fix/barometer\n    parameters: {from_start: false}\n";
  Scenario s;
  s.walker.stand_s = 4;
  s.route = {{0, 0, 0}, {40, 0, 3}, {80, 0, 1}, {110, 0, 6}, {116, 0, 9}, {180, 0, 9}};
  s.events = {{.at_m = 0.5, .what = "stand", .for_s = 3, .waypoint = true}};
  std::vector<double> rms;
  for (const uint64_t seed : {2, 3, 4, 5, 6}) {
    const Recording recording = recorded_sensors(s, seed);
    const RunResult result = run_of(recording, folder / "p.yaml");
    double squares = 0, n = 0;
    size_t at = 0;
    const auto& truth = recording.true_states;
    for (const StampedPose& pose : result.track) {
      if (pose.t_ns < truth.front().t_ns + 20 * kSecond_ns) continue;
      while (at + 1 < truth.size() && truth[at].t_ns < pose.t_ns) ++at;
      squares += std::pow(pose.p.z() - truth[at].p.z(), 2), n += 1;
    }
    rms.push_back(std::sqrt(squares / n));
  }
  MESSAGE("vertical error, rms: median " << percentile(rms, 0.5) << " m, worst " << percentile(rms, 1.0) << " m");
  CHECK(percentile(rms, 0.5) < 2.0);
  CHECK(percentile(rms, 1.0) < 2.5);
}
