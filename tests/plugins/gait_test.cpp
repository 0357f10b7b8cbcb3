// SPDX-License-Identifier: Apache-2.0
#include "plugins/shared/gait/gait.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "tests/support/plain_walk.hpp"
#include "tests/support/runs.hpp"

TEST_SUITE_BEGIN("gait");

namespace {

std::vector<gait::Step> steps_at(const PlainWalk& walk, double hz, double noise, uint64_t seed) {
  gait::Gait gait({}, {}, Eigen::Vector3d(0, 1, -1));
  Random random(seed, 9);
  std::vector<gait::Step> steps;
  for (double t = 0; t < walk.phone.duration_s(); t += 1 / hz) {
    const auto k = walk.phone.at(t);
    Eigen::Vector3d force = k.specific_force_b();
    for (int i = 0; i < 3; ++i) force[i] += noise * random.normal();
    if (const auto step = gait.update(static_cast<int64_t>(t * 1e9), k.angular_velocity_b, force))
      steps.push_back(*step);
  }
  return steps;
}

}  // namespace

TEST_CASE("the steps of a plain walk are found at every sample rate") {
  for (const double hz : {25.0, 50.0, 100.0, 200.0, 500.0}) {
    for (const double speed : {0.9, 1.35, 1.8}) {
      const PlainWalk walk(speed, 0.5 + 0.17 * speed, static_cast<uint64_t>(hz + 10 * speed));
      const auto steps = steps_at(walk, hz, 0.05, 1);
      CAPTURE(hz);
      CAPTURE(speed);
      CHECK(std::abs(static_cast<double>(steps.size()) - static_cast<double>(walk.steps.size())) <= 3);
      // In the middle of the walk each step ends near a true contact.
      std::vector<double> off;
      for (const auto& step : steps) {
        double nearest = 1;
        for (const auto& truth : walk.steps) {
          const double d = static_cast<double>(step.detected.t_end_ns) * 1e-9 - truth.t_end_s;
          if (std::abs(d) < std::abs(nearest)) nearest = d;
        }
        off.push_back(std::abs(nearest));
      }
      CHECK(percentile(off, 0.5) < 0.06);
    }
  }
}

TEST_CASE("the frequency is estimated from the spectrum, within 2 %") {
  for (const double hz : {50.0, 200.0}) {
    for (const double f : {1.4, 1.9, 2.4}) {
      gait::StepFrequency frequency;
      for (double t = 0; t < 6; t += 1 / hz)
        frequency.add(static_cast<int64_t>(t * 1e9), std::sin(6.283185 * f * t) + 0.4 * std::sin(3.1415926 * f * t));
      CHECK(frequency.estimate(f * 1.1) == doctest::Approx(f).epsilon(0.02));
    }
  }
}

TEST_CASE("there are no steps while the device lies or is held still") {
  gait::Gait gait({}, {}, Eigen::Vector3d(0, 1, -1));
  Random random(2, 3);
  int steps = 0;
  for (int i = 0; i < 60000; ++i) {
    const Eigen::Vector3d tremor{0.08 * random.normal(), 9.81 + 0.1 * random.normal() + 0.1 * std::sin(i * 0.02),
                                 0.08 * random.normal()};
    if (gait.update(i * 10'000'000LL, 0.05 * tremor, tremor)) ++steps;
  }
  CHECK(steps == 0);
}

TEST_CASE("steps, distance and position of the real walks do not get worse" * doctest::test_suite("gait_data")) {
  const auto folder = data_or_skip("phone_walks");
  if (folder.empty()) return;
  std::vector<double> distance;
  double reference = 0, estimate = 0;
  uint64_t steps = 0;
  int k = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".txt" || k++ % 4 != 0) continue;  // a quarter of them: a regression test
    const Recording recording = recorded(entry.path());
    const RunResult result = run_of(recording, source("samples/configs/phone_walk.yaml"));
    const auto e = waypoint_errors(result.track, recording.waypoints());
    distance.push_back(std::abs(e.distance_error()));
    reference += e.reference_m, estimate += e.estimate_m;
    steps += result.statistics.steps;
    CHECK(result.statistics.late == 0);
    CHECK(result.statistics.plugin_faults == 0);
  }
  CHECK(reference / static_cast<double>(steps) == Between{0.60, 0.72});  // metres per step of real walkers
  CHECK(percentile(distance, 0.5) < 0.13);
  CHECK(std::abs(estimate / reference - 1) < 0.12);
}
