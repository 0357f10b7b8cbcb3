// SPDX-License-Identifier: Apache-2.0
#include <rapidcheck.h>

#include "sdk/host/core/sample_gate.hpp"
#include "sdk/host/messages/messages.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("sample_gate");

namespace {

odo_imu sample(int i, double gyro, double accel, uint32_t flags = ODO_IMU_GYRO | ODO_IMU_ACCEL) {
  return imu_at(1'000'000'000 + i * 5'000'000LL, {gyro, 0, 0}, {0, accel, 0}, flags);
}

struct Passed {
  SampleGate gate;
  std::vector<odo_imu> out;
  int spikes = 0;
  void push(const odo_imu& imu) {
    spikes += gate.push(imu, [this](const odo_imu& passed) { out.push_back(passed); });
  }
};

}  // namespace

TEST_CASE("a single outlier is dropped, and nothing else") {
  Passed passed;
  for (int i = 0; i < 100; ++i) passed.push(sample(i, i == 50 ? 30.0 : 0.1, 9.81));
  for (int i = 100; i < 200; ++i) passed.push(sample(i, 0.1, i == 150 ? -150.0 : 9.81));
  CHECK(passed.spikes == 2);
  REQUIRE(passed.out.size() == 198);
  for (const auto& imu : passed.out) CHECK(std::abs(imu.gyro_b[0]) < 1);
}

TEST_CASE("a lasting shock, a saturated sensor and a pause lose nothing") {
  Passed passed;
  for (int i = 0; i < 300; ++i) {
    const bool shock = i >= 50 && i < 52, saturated = i >= 100 && i < 150;
    passed.push(sample(i < 200 ? i : i + 100, saturated ? 34.9 : 0.1, shock ? 150.0 : i < 200 ? 9.81 : -140.0));
  }
  CHECK(passed.spikes == 0);
  REQUIRE(passed.out.size() == 300);
  for (size_t i = 1; i < passed.out.size(); ++i) CHECK(passed.out[i].header.t_ns > passed.out[i - 1].header.t_ns);
}

TEST_CASE("separate sensors are checked separately") {
  Passed passed;
  for (int i = 0; i < 100; ++i) {
    passed.push(sample(2 * i, i == 50 ? 30.0 : 0.1, 0, ODO_IMU_GYRO));
    passed.push(sample(2 * i + 1, 0, 9.81, ODO_IMU_ACCEL));
  }
  CHECK(passed.spikes == 1);
  CHECK(passed.out.size() == 199);
}

TEST_CASE("all motions possible for a hand pass") {
  rc::check("band-limited motion", [] {
    const double hz = *rc::gen::inRange(1, 8), phase = *rc::gen::inRange(0, 628) * 0.01;
    const double rate = 500 / (2 * 3.14159265 * hz), force = *rc::gen::inRange(0, 60);
    Passed passed;
    for (int i = 0; i < 400; ++i) {
      const double x = 2 * 3.14159265 * hz * i * 0.005 + phase;
      passed.push(sample(i, std::min(rate, 30.0) * std::sin(x), 9.81 + force * std::cos(x)));
    }
    RC_ASSERT(passed.spikes == 0);
    RC_ASSERT(passed.out.size() == 400u);
  });
}
