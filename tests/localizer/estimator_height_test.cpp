// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <doctest/doctest.h>

#include "tests/support/measured_walk.hpp"

using namespace odograph;

TEST_SUITE_BEGIN("estimator");

TEST_CASE("with steps alone, height fixes on a slope are applied fully, and the climb continues between them") {
  CouplingConfig config;
  config.type = CouplingType::localizer;
  Composer composer(config, {}, {false, false});
  Random random(3, 7);
  const auto ns = [](double t_s) { return 1'000'000'000 + static_cast<int64_t>(std::llround(t_s * 1e9)); };
  const auto down_at = [](double t_s) { return -0.24 * std::clamp(t_s - 20, 0.0, 30.0); };  // flat, a slope, flat
  constexpr double kStep_s = 0.5, kTold_s = 0.4;
  double squares = 0, normalised = 0, n = 0;
  for (int i = 0; i < 7000; ++i) {
    const double t = 0.01 * i;
    auto imu = make_message<odo_imu>(ODO_TYPE_IMU, ns(t));
    imu.header.flags = ODO_IMU_GYRO | ODO_IMU_ACCEL;
    imu.accel_b[2] = -9.81;
    composer.add_imu(imu);
    auto attitude = make_message<odo_attitude>(ODO_TYPE_ATTITUDE, ns(t));
    attitude.q_n_b[0] = 1;
    attitude.covariance_n[0] = attitude.covariance_n[4] = 4e-4;
    composer.update(&attitude);
    if (i % 50 == 40 && t > 1) {
      auto step = make_message<odo_step>(ODO_TYPE_STEP, ns(t));
      step.header.flags = ODO_STEP_HEADING;
      step.t_start_ns = ns(t - kTold_s - kStep_s), step.t_end_ns = ns(t - kTold_s);
      step.length_m = 0.7, step.sigma_m = 0.07;
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

TEST_SUITE_END();
