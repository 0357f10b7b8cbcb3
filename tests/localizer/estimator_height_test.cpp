// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <doctest/doctest.h>

#include "tests/support/measured_walk.hpp"
#include "tests/support/messages.hpp"

using namespace odograph;

TEST_SUITE_BEGIN("estimator");

TEST_CASE("with steps alone, height fixes on a slope are applied fully, and the climb continues between them") {
  CouplingConfig config{.type = CouplingType::localizer};
  Composer composer(config, {}, {false, false});
  Random random(3, 7);
  const auto ns = [](double t_s) { return 1'000'000'000 + static_cast<int64_t>(std::llround(t_s * 1e9)); };
  const auto down_at = [](double t_s) { return -0.24 * std::clamp(t_s - 20, 0.0, 30.0); };  // flat, a slope, flat
  constexpr double kStep_s = 0.5, kTold_s = 0.4;
  double squares = 0, normalised = 0, n = 0;
  for (int i = 0; i < 7000; ++i) {
    const double t = 0.01 * i;
    auto imu = imu_at(ns(t), {0, 0, 0}, {0, 0, -9.81});
    composer.add_imu(imu);
    auto attitude = attitude_at(ns(t), Eigen::Quaterniond::Identity(), 4e-4);
    composer.update(&attitude);
    if (i % 50 == 40 && t > 1) {
      auto step = step_between(ns(t - kTold_s - kStep_s), ns(t - kTold_s), ns(t), 0.7, 0.07);
      step.mode = ODO_MODE_WALKING_TEXTING;
      composer.update(&step);
    }
    if (i % 100 == 41) {
      auto fix = make_message<odo_fix>(ODO_TYPE_FIX, ns(t - kTold_s));
      fix.header.flags = ODO_FIX_DOWN | ODO_FIX_COVARIANCE;
      fix.p_n[2] = down_at(t - kTold_s) + 0.25 * random.normal();
      fix.covariance_n[8] = 0.25 * 0.25;
      CHECK(composer.update(&fix).accepted);
    }
    Estimate now;
    if (t < 10 || i % 10 != 0 || composer.at(INT64_MIN, now) != ODO_OK) continue;
    const double error_m = now.pose.p_n[2] - down_at(t);
    squares += error_m * error_m, normalised += error_m * error_m / now.pose.covariance[35], n += 1;
  }
  CHECK(std::sqrt(squares / n) < 0.31);
  CHECK(normalised / n < 2);
  MESSAGE("heights now: " << std::sqrt(squares / n) << " m rms, normalised error squared " << normalised / n);
}

TEST_CASE("a pressure that arrives late refers to the height at its time") {
  CouplingConfig config{.type = CouplingType::localizer};
  StartPose start;
  start.given = start.heading_given = true;
  Composer composer(config, start, {true, false});
  const auto ns = [](int frame) { return 1'000'000'000 + int64_t(100'000'000) * frame; };
  const auto ascend = [&](int from, int to) {  // by 0.1 m per frame, with a camera that looks ahead
    for (int k = from; k <= to; ++k) {
      auto motion =
          motion_between(ns(k - 1), ns(k), {0, -0.1, 0}, ODO_VO_ROTATION | ODO_VO_TRANSLATION | ODO_VO_METRIC);
      motion.scale_sigma = 0.01;
      composer.update(FrameTime{ns(k)});
      composer.update(RelativeMotion{&motion, nullptr});
    }
  };
  const auto read = [&](int frame) {
    double low = 90'000, high = 100'000;  // Pa; the height at frame 0 is that of 100 kPa
    while (high - low > 1e-6) {
      const double middle = 0.5 * (low + high);
      (pressure_height_m(middle) - pressure_height_m(100'000) > 0.1 * frame ? low : high) = middle;
    }
    auto barometer = pressure_at(ns(frame), low);
    return composer.update(&barometer);
  };
  const auto down_m = [&] { return composer.localizer().x[kDown]; };
  composer.update(FrameTime{ns(0)});
  ascend(1, 10);
  CHECK(read(10).accepted);
  ascend(11, 60);
  const double before_m = down_m();
  CHECK(before_m == doctest::Approx(-6));
  CHECK(read(40).accepted);
  CHECK(std::abs(down_m() - before_m) < 1e-3);
}

TEST_SUITE_END();
