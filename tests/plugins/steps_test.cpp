// SPDX-License-Identifier: Apache-2.0
#include <complex>

#include "plugins/step/odograph/gait_finder.hpp"
#include "plugins/step/odograph/carry_mode.hpp"
#include "sdk/math/scalar.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "tests/plugins/found_gait.hpp"
#include "tests/support/runs.hpp"

using namespace odograph::steps;

TEST_SUITE_BEGIN("steps");

namespace {

/// Feeds a walk of regular steps, standing before and after, and collects the found steps. `longer`: fraction by which
/// every other step is longer, and the next one shorter.
std::vector<FoundStep> found_at(double rate_hz, double step_hz, double rise_m, double walk_s, double jitter,
                                uint64_t seed, double longer = 0) {
  Resampler resampler;
  WalkSignal signal;
  StepFinder finder;
  Random random(seed, 1);
  std::vector<FoundStep> steps;
  for (double t = 0; t < walk_s + 8; t += (1 + jitter * random.uniform(-1, 1)) / rate_hz) {
    const bool walks = t > 4 && t < 4 + walk_s;
    const double pair = std::fmod(std::max(0.0, t - 4) * step_hz, 2), first = 1 + longer;  // of two steps
    const double w = 2 * kPi * step_hz;  // each leg pushes the body equally
    const double phase = 2 * kPi * (pair < first ? pair / first : (pair - first) / (2 - first));
    const double up = (walks ? 0.5 * rise_m * w * w * std::cos(phase) : 0.0) + 0.1 * random.normal();
    resampler.push(
        {.t_ns = static_cast<int64_t>(t * 1e9),
         .vertical = up,
         .level = walks ? 0.6 : 0.05,
         .gyro = walks ? 0.5 : 0.05},
        [&](const WalkSample& s) {
          signal.add(s);
          finder.update(signal);
          for (const FoundStep& step : finder.found()) steps.push_back(step);
        },
        [&] { signal.reset(), finder.reset(); });
  }
  return steps;
}

}  // namespace

TEST_CASE("a step ends at the peak of the push, also between two samples") {
  WalkSignal signal;
  StepFinder finder;
  int steps = 0;
  for (int k = 0; k < 1000; ++k) {
    const double t_s = 0.02 * k, step_hz = 1.6;  // a period of 31.25 samples; the mean is over four
    signal.add({.t_ns = k * Resampler::kCell_ns, .vertical = 3 * std::cos(2 * kPi * step_hz * t_s), .level = 0.6});
    finder.update(signal);
    for (const FoundStep& step : finder.found()) {
      if (k < 200) continue;  // before the mean is over four periods
      ++steps;
      const double contact_s = 1e-9 * static_cast<double>(step.t_end_ns) + StepFinder::Parameters().arm_lag_s;
      CHECK(std::abs(std::remainder(contact_s, 1 / step_hz)) < 0.002);
    }
  }
  CHECK(steps > 20);
}

TEST_CASE("rise and surge are those of a periodic motion, over three samples to half of those kept") {
  WalkSignal signal;
  constexpr size_t period = 25;  // the mean is over five
  const double w = 2 * kPi * WalkSignal::kRate_hz / period, lead_rad = 1.75;
  for (int k = 0; k < 240; ++k) {
    const double phase = 2 * kPi * k / period;
    signal.add({.t_ns = k * Resampler::kCell_ns,
                .vertical = 3 * std::cos(phase),
                .horizontal_n = std::cos(phase + lead_rad) * Eigen::Vector2d(0.6, -0.9)});
  }
  const size_t end = signal.smooth_count();
  const double kept = signal.gain(w / (2 * kPi));
  CHECK(signal.rise_between(end - period, end) == doctest::Approx(2 * 3 * kept / (w * w)).epsilon(0.02));
  CHECK((signal.surge_between(end - period, end, lead_rad) - Eigen::Vector2d(0.2, -0.3)).norm() < 1e-3);
  for (const size_t n : {size_t(2), WalkSignal::kKept / 2 + 1}) {
    CHECK(signal.rise_between(end - n, end) == 0);
    CHECK(signal.surge_between(end - n, end, lead_rad).norm() == 0);
  }
}

TEST_CASE("steps of unequal legs are found if one lasts at most two fifths longer") {
  for (const double longer : {0.1, 0.17}) {  // 1.22 and 1.41 times the other
    CAPTURE(longer);
    CHECK(found_at(100, 1.7, 0.04, 20, 0, 3, longer).size() == 34);
  }
}

TEST_CASE("steps are counted, timed and their rise is measured at any rate, regular or not") {
  for (const double rate : {25.0, 50.0, 100.0, 200.0, 500.0})
    for (const double hz : {1.4, 1.9, 2.6})
      for (const double jitter : {0.0, 0.6}) {
        CAPTURE(rate);
        CAPTURE(hz);
        CAPTURE(jitter);
        const auto steps = found_at(rate, hz, 0.04, 20, jitter, 3);
        CHECK(std::abs(static_cast<double>(steps.size()) - 20 * hz) <= 1.5);
        double interval = 0, rise = 0;
        for (const FoundStep& s : steps) {
          interval += static_cast<double>(s.t_end_ns - s.t_start_ns) * 1e-9 / static_cast<double>(steps.size());
          rise += s.rise_m / static_cast<double>(steps.size());
        }
        CHECK(interval == doctest::Approx(1 / hz).epsilon(0.03));
        CHECK(std::abs(rise - 0.04) < 0.15 * 0.04);  // without the attenuation by the smoothing
      }
}

namespace {

/// Steps found while the phone oscillates for a time, standing before and after: amplitude of the vertical acceleration
/// at the step frequency and, relative to it, at twice that; meanwhile the hand tilts at an rms rate of `tilting`
/// at 1.3 Hz.
std::vector<FoundStep> found_in_gentle(double step_hz, double amplitude_mps2, double second_harmonic,
                                       double tilting_radps, double walk_s) {
  Random random(7, 1);
  const double w = 2 * kPi * step_hz;
  return found_gait(walk_s + 8, [&](double t) {
    const double on = t > 4 && t < 4 + walk_s ? 1 : 0;
    const double up = on * amplitude_mps2 * (std::cos(w * (t - 4)) + second_harmonic * std::cos(2 * w * (t - 4) + 1.0));
    const Eigen::Vector2d noise{random.normal(), random.normal()};
    return WalkSample{.vertical = up + 0.08 * random.normal(),
                      .level = 0.3,
                      .gyro = 0.4,  // scanning
                      .horizontal_n = 0.1 * noise + on * Eigen::Vector2d(0.15 * std::sin(w * t), 0),
                      .tilting_n = tilting_radps * std::sqrt(2.0) * Eigen::Vector2d(std::sin(2 * kPi * 1.3 * t), 0)};
  });
}

}  // namespace

TEST_CASE("gentle steps are counted from 0.8 Hz and 0.2 m/s^2 on, also with a strong second harmonic") {
  for (const double hz : {0.8, 1.0, 1.25, 1.5, 1.7})
    for (const double second : {0.0, 0.6}) {
      CAPTURE(hz);
      CAPTURE(second);
      const auto steps = found_in_gentle(hz, 0.2, second, 0.05, 30);
      CHECK(std::abs(static_cast<double>(steps.size()) - 30 * hz) <= 3);
      for (size_t i = 1; i < steps.size(); ++i) CHECK(steps[i].t_start_ns >= steps[i - 1].t_end_ns);
    }
  for (const double hz : {2.0, 2.3, 2.6}) {  // quick ones need more
    CAPTURE(hz);
    CHECK(std::abs(static_cast<double>(found_in_gentle(hz, 0.5, 0, 0.05, 30).size()) - 30 * hz) <= 2);
  }
}

TEST_CASE("a hand that tilts the phone as in gestures hides gentle steps, so that gestures give none") {
  CHECK(found_in_gentle(1.3, 0.4, 0, 0.1, 30).size() > 30);
  CHECK(found_in_gentle(1.3, 0.4, 0, 0.5, 30).empty());
}

TEST_CASE("nothing is found after a vivid walk has ended, while it leaves the mean") {
  Random random(9, 1);
  const auto steps = found_gait(30, [&](double t) {
    const double up = t > 4 && t < 20 ? 3.5 * std::cos(2 * kPi * 1.83 * (t - 4)) : 0.0;
    return WalkSample{.vertical = up + 0.03 * random.normal(), .level = 0.3, .gyro = 0.3};
  });
  REQUIRE_FALSE(steps.empty());
  CHECK(static_cast<double>(steps.back().t_end_ns) * 1e-9 == doctest::Approx(20.0).epsilon(0.02));
}

TEST_CASE("a gentle step has the length of the literature at that cadence and rise, within its sigma") {
  const LengthModel model;
  // Orendurff et al. 2004 (J Rehabil Res Dev 41): 0.7 m/s with a rise of 27 mm, of which the arms that hold a phone
  // pass on about half. Grieve & Gear 1966: 1.2 Hz, and so 0.58 m.
  const FoundStep of_paper{.rise_m = 0.0137, .frequency_hz = 1.2, .gentle = true};
  const double sigma =
      std::hypot(Walker({}).factor_sigma(model.estimate(of_paper).pace), model.estimate(of_paper).common_sigma);
  CHECK(std::abs(std::log(model.length_m(of_paper) / 0.58)) < 2 * sigma);
  // The slope within persons is that of Grieve & Gear (0.72) or more: slower walkers halve their speed by both.
  FoundStep slow = of_paper;
  slow.frequency_hz = 1.6;
  const double exponent = std::log(model.length_m(slow) / model.length_m(of_paper)) / std::log(1.6 / 1.2);
  CHECK(exponent == Between{0.6, 1.2});
}

TEST_CASE("simulated users who look through the phone have correct counts and distances") {
  Scenario s;
  s.walker.gait = "viewing", s.walker.speed_mps = 0.8, s.walker.stand_s = 4;
  s.route = {{0, 0, 0}, {25, 0, 0}, {25, 20, 0}};
  s.events = {{10, "look_around", 6}, {18, "sidestep", 3}, {24, "stand", 5}, {30, "backwards", 3}, {36, "shuffle", 3}};
  std::vector<double> counts, distances;
  for (const uint64_t seed : {31, 32, 33, 34}) {
    const Recording recording = recorded_sensors(s, seed);
    const RunResult result = run_of(recording, source("samples/configs/phone_walk_odograph.yaml"));
    double truth = 0, estimate = 0;
    for (const odo_step& step : recording.true_steps) truth += step.length_m;
    for (const odo_step& step : result.steps) estimate += step.length_m;
    counts.push_back(
        std::abs(static_cast<double>(result.steps.size()) / static_cast<double>(recording.true_steps.size()) - 1));
    distances.push_back(std::abs(estimate / truth - 1));
  }
  CHECK(percentile(counts, 0.5) < 0.04);
  CHECK(percentile(counts, 1.0) < 0.10);
  CHECK(percentile(distances, 0.5) < 0.12);
  CHECK(percentile(distances, 1.0) < 0.25);
}

TEST_CASE("the slow walk through a house has its 58 steps, and a length within its sigma" *
          doctest::test_suite("steps_data")) {
  const auto folder = data_or_skip("phone_house");
  if (folder.empty()) return;
  Recording recording = recorded(folder);
  std::erase_if(recording.messages, [](const RecordedMessage& m) { return m.message.header().type != ODO_TYPE_IMU; });
  const RunResult result = run_of(recording, source("samples/configs/phone_walk_odograph.yaml"));
  double path_m = 0, sigma_m = 0;
  for (const odo_step& step : result.steps) path_m += step.length_m, sigma_m += step.sigma_m;
  CHECK(result.steps.size() == Between{50, 66});  // 58 are visible in the acceleration
  constexpr double kPath_m = 26;                  // by the size of tiles and of a door (docs/accuracy/odometry.md)
  CHECK(std::abs(path_m - kPath_m) < 2 * sigma_m);
  CHECK(sigma_m < 0.25 * kPath_m);  // 58 fixed steps (kFixedStep_m) err by 55 %
}

TEST_CASE("ten minutes of vivid gestures give almost no step, and turning on the spot none") {
  for (const char* what : {"handle", "turn"}) {
    Scenario s;
    s.route = {{0, 0, 0}, {1, 0, 0}};
    for (int k = 0; k < 60; ++k) s.events.push_back({0.0, what, 10.0});
    const Recording recording = recorded_sensors(s, 51);
    const RunResult result = run_of(recording, source("samples/configs/phone_walk_odograph.yaml"));
    // The metre there and back is walked. Other estimators count about 950 steps in those gestures.
    const size_t most = std::string_view(what) == "turn" ? 0 : 12;
    CHECK(result.steps.size() <= recording.true_steps.size() + most);
  }
}

TEST_CASE("a gap and broken samples end a walk and do not affect the next one") {
  Resampler resampler;
  WalkSignal signal;
  StepFinder finder;
  size_t steps = 0, gaps = 0;
  const auto feed = [&](double from, double to) {
    for (double t = from; t < to; t += 0.01) {
      const double w = 2 * kPi * 1.9;
      const WalkSample s{
          .t_ns = static_cast<int64_t>(t * 1e9), .vertical = 0.02 * w * w * std::cos(w * t), .level = 0.5, .gyro = 0.5};
      const auto take = [&](const WalkSample& x) {
        signal.add(x);
        finder.update(signal);
        steps += finder.found().size();
      };
      const auto gap = [&] { ++gaps, signal.reset(), finder.reset(); };
      resampler.push(s, take, gap);
      resampler.push(s, take, gap);                                                                          // twice
      resampler.push({.t_ns = s.t_ns - 30'000'000, .vertical = 1e3, .level = 1e3, .gyro = 1e3}, take, gap);  // late
    }
  };
  feed(0, 10);
  const size_t before = steps;
  CHECK(std::abs(static_cast<double>(before) - 18) <= 2);
  feed(13, 23);
  CHECK(gaps == 1);
  CHECK(std::abs(static_cast<double>(steps - before) - 18) <= 2);
}

TEST_CASE("a simulated walker has correct counts, times and modes, and no step while standing, typing or turning") {
  Scenario s;
  s.route = {{0, 0, 0}, {40, 0, 0}, {40, 20, 0}};
  s.walker.stand_s = 4;
  s.events = {{20, "handle", 30}, {30, "turn", 20}, {45, "swinging"}};
  for (const uint64_t seed : {41, 42, 43}) {
    const Recording recording = recorded_sensors(s, seed);
    const RunResult result = run_of(recording, source("samples/configs/phone_walk_odograph.yaml"));
    CHECK(std::abs(static_cast<double>(result.steps.size()) - static_cast<double>(recording.true_steps.size())) <= 3);
    std::vector<double> late;
    for (const odo_step& step : result.steps) {
      double nearest = 1e9;
      for (const odo_step& truth : recording.true_steps)
        nearest = std::min(nearest, std::abs(static_cast<double>(truth.t_end_ns - step.t_end_ns)));
      late.push_back(nearest * 1e-6);
    }
    CHECK(percentile(late, 0.5) < 60);
    CHECK(percentile(late, 0.95) < 150);
  }
}

TEST_CASE("a step's heading is the phone's in the middle of the step, also while the walker turns") {
  Scenario s;  // zigzag: turns of 90 degrees to both sides
  s.walker.stand_s = 3;
  s.route = {{0, 0, 0}, {8, 0, 0}, {8, 8, 0}, {16, 8, 0}, {16, 0, 0}, {24, 0, 0}, {24, 8, 0}, {32, 8, 0}};
  for (const uint64_t seed : {51, 52, 53}) {
    const Recording recording = recorded_sensors(s, seed);
    RunOptions options = options_of(source("samples/configs/phone_walk_odograph.yaml"));
    options.collect_attitudes = true;
    const RunResult result = run_of(recording, options);
    const auto heading_at = [&](int64_t t_ns) {
      const auto next = std::lower_bound(result.attitudes.begin(), result.attitudes.end(), t_ns,
                                         [](const odo_attitude& a, int64_t t) { return a.header.t_ns < t; });
      if (next == result.attitudes.end()) return std::nan("");
      const Eigen::Vector3d forward =
          Eigen::Quaterniond(next->q_n_b[0], next->q_n_b[1], next->q_n_b[2], next->q_n_b[3]) *
          Eigen::Vector3d(0, 1, -1);
      return std::atan2(forward.y(), forward.x());
    };
    // Delay: the lag with the best fit of the phone's heading, averaged over a stride about the step's middle.
    double late = 0, squares = 0;
    for (const odo_step& step : result.steps) {
      const int64_t length = step.t_end_ns - step.t_start_ns;
      std::complex<double> now = 0, before = 0, after = 0;
      for (int k = -10; k < 10; ++k) {
        const int64_t t = (step.t_start_ns + step.t_end_ns) / 2 + k * length / 10;
        now += std::polar(1.0, heading_at(t)), before += std::polar(1.0, heading_at(t - 200'000'000));
        after += std::polar(1.0, heading_at(t + 200'000'000));
      }
      if (!std::isfinite(std::abs(before + now + after))) continue;
      const double rate = std::arg(after / before) / 0.4, off = std::arg(std::polar(1.0, step.heading_rad) / now);
      late -= off * rate, squares += rate * rate;
    }
    MESSAGE("late by " << 1e3 * late / squares << " ms");
    CHECK(std::abs(late / squares) < 0.08);
  }
}

TEST_CASE("the real walks with the best of the step estimators are within limits" * doctest::test_suite("steps_data")) {
  const auto folder = data_or_skip("phone_walks");
  if (folder.empty()) return;
  std::vector<double> distance;
  double reference = 0, estimate = 0;
  int k = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".txt" || k++ % 4 != 0) continue;  // a quarter: a regression test
    const Recording recording = recorded(entry.path());
    const RunResult result = run_of(recording, source("samples/configs/phone_walk_odograph.yaml"));
    const auto e = waypoint_errors(result.track, recording.waypoints());
    distance.push_back(std::abs(e.distance_error()));
    reference += e.reference_m, estimate += e.estimate_m;
  }
  CHECK(percentile(distance, 0.5) < 0.06);
  CHECK(percentile(distance, 0.9) < 0.15);
  CHECK(std::abs(estimate / reference - 1) < 0.04);
}
