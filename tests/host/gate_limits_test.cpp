// SPDX-License-Identifier: Apache-2.0
//
// Plausible ranges of sensors, at each limit and for each component; joined scales, at each limit.
#include "sdk/host/core/sample_gate.hpp"
#include "sdk/host/core/scale_join.hpp"
#include "sdk/host/messages/imu_joiner.hpp"
#include "sdk/host/messages/messages.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("gate_limits");

namespace {

constexpr int64_t kMs = 1'000'000;
constexpr uint32_t kBoth = ODO_IMU_GYRO | ODO_IMU_ACCEL;

odo_imu imu(int64_t t_ns, uint32_t flags = kBoth, uint32_t source = 0) {
  auto m = imu_at(t_ns, {0, 0, 0}, {0, 0, 0}, flags);
  m.header.source = source;
  return m;
}

struct Gate : SampleGate {
  std::vector<int64_t> out;
  int spikes = 0;
  void add(const odo_imu& m) {
    spikes += push(m, [this](const odo_imu& passed) { out.push_back(passed.header.t_ns); });
  }
};

odo_scale scale_of(uint32_t group, int64_t from_ns, int64_t to_ns, double value = 2, double sigma = 0.1) {
  auto s = make_message<odo_scale>(ODO_TYPE_SCALE, 0);
  s.scale = value, s.sigma = sigma, s.scale_group = group, s.valid_from_ns = from_ns, s.valid_to_ns = to_ns;
  return s;
}
odo_vo_motion motion(int64_t t_ns, uint32_t group) {
  auto m = make_message<odo_vo_motion>(ODO_TYPE_VO_MOTION, t_ns);
  m.scale_group = group;
  return m;
}

}  // namespace

TEST_CASE("each component of each sensor is valid up to its limit, on both sides") {
  const SampleGate gate;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      const auto within = [&](double gyro, double accel, double field) {
        odo_imu m = imu(0);
        m.gyro_b[axis] = sign * gyro, m.accel_b[axis] = sign * accel;
        auto f = make_message<odo_magnetometer>(ODO_TYPE_MAGNETOMETER, 0);
        f.field_b[axis] = sign * field;
        return gate.within_range(m.header) && gate.within_range(f.header);
      };
      CHECK(within(40, 180, 5.6e-3));
      CHECK_FALSE(within(40.001, 0, 0));
      CHECK_FALSE(within(0, 180.001, 0));
      CHECK_FALSE(within(0, 0, 5.601e-3));
      odo_imu gyro_alone = imu(0, ODO_IMU_GYRO), accel_alone = imu(0, ODO_IMU_ACCEL);
      gyro_alone.accel_b[axis] = accel_alone.gyro_b[axis] = sign * 1e9;  // not valid, not read
      CHECK(gate.within_range(gyro_alone.header));
      CHECK(gate.within_range(accel_alone.header));
    }
  for (const auto& [pressure, good] :
       {std::pair{24'999.0, false}, {25'000.0, true}, {145'000.0, true}, {145'001.0, false}}) {
    CHECK(gate.within_range(pressure_at(0, pressure).header) == good);
  }
}

TEST_CASE("a spike is a sample beyond the limit, over all axes, against neighbours within 50 ms") {
  struct Case {
    double gyro[3], accel[3];
    bool spike;
  };
  const Case cases[] = {{{11.99, 0, 0}, {}, false}, {{0, 12.01, 0}, {}, true}, {{0, 0, -12.01}, {}, true},
                        {{7, 7, 6.7}, {}, false},   {{7, 7, 7}, {}, true},     {{}, {79.9, 0, 0}, false},
                        {{}, {0, -80.1, 0}, true},  {{}, {50, 50, 40}, true},  {{}, {50, 50, 37}, false}};
  for (const Case& c : cases) {
    Gate gate;
    odo_imu sticks_out = imu(10 * kMs);
    std::copy(c.gyro, c.gyro + 3, sticks_out.gyro_b), std::copy(c.accel, c.accel + 3, sticks_out.accel_b);
    CAPTURE(c.gyro[1]);
    CAPTURE(c.accel[1]);
    gate.add(imu(0)), gate.add(sticks_out), gate.add(imu(20 * kMs));
    CHECK(gate.spikes == (c.spike ? 1 : 0));
    CHECK(gate.out.size() == (c.spike ? 2 : 3));
  }
  for (const int64_t apart : {50 * kMs - 1, 50 * kMs}) {  // before and after it
    for (const bool before : {false, true}) {
      Gate gate;
      odo_imu sticks_out = imu(before ? apart : 10 * kMs);
      sticks_out.gyro_b[0] = 30;
      gate.add(imu(0)), gate.add(sticks_out), gate.add(imu(sticks_out.header.t_ns + (before ? 10 * kMs : apart)));
      CHECK(gate.spikes == (apart < 50 * kMs ? 1 : 0));
    }
  }
}

TEST_CASE("a suspected spike is held until the next sample, per source and sensor, and a reset discards it") {
  Gate gate;
  odo_imu wild = imu(10 * kMs);
  wild.gyro_b[0] = 30;
  gate.add(imu(0)), gate.add(wild);
  CHECK(gate.out == std::vector<int64_t>{0});
  gate.add(imu(11 * kMs, kBoth, 1));  // of another IMU
  CHECK(gate.out == std::vector<int64_t>{0, 11 * kMs});
  gate.add(imu(20 * kMs));
  CHECK(gate.spikes == 1);
  wild.header.t_ns = 30 * kMs;
  gate.add(wild);
  odo_imu still = wild;
  still.header.t_ns = 40 * kMs;
  gate.add(still);  // persistent: both continue, in order
  CHECK(gate.out == std::vector<int64_t>{0, 11 * kMs, 20 * kMs, 30 * kMs, 40 * kMs});
  wild.header.t_ns = 50 * kMs, wild.gyro_b[0] = 0;
  gate.add(wild);
  CHECK(gate.out.size() == 5);
  gate.reset();
  gate.add(imu(1));  // the held one is discarded with the old clock
  CHECK(gate.out.back() == 1);
  CHECK(gate.out.size() == 6);
}

TEST_CASE("a scale applies to motions that end after its start and up to its end, of its own group") {
  for (const auto& [t_ns, holds] :
       {std::pair<int64_t, bool>{49, false}, {50, false}, {51, true}, {100, true}, {101, false}})
    for (const uint32_t group : {7u, 8u}) {
      ScaleJoin join(1), asked(1);
      CHECK(join.note(0, scale_of(7, 50, 100)) == ScaleUse::used);  // before the first motion it may still apply
      join.begin(motion(t_ns, group), false);
      CHECK((join.joined() != nullptr) == (holds && group == 7));
      CHECK(join.motion_ns() == t_ns);
      CHECK(join.group() == group);
      asked.begin(motion(t_ns, group), false);
      CHECK((asked.answer(0, scale_of(7, 50, 100)) == ScaleUse::used) == (group == 7 && (holds || t_ns < 100)));
      CHECK((asked.joined() != nullptr) == (holds && group == 7));
      CHECK((asked.note(0, scale_of(7, 50, 100)) == ScaleUse::used) ==
            (group == 7 && t_ns < 100));  // for motions to come
    }
}

TEST_CASE("scales and sigmas of zero are ignored, and the joined scale follows from valid ones") {
  for (const auto& [value, sigma] : {std::pair{0.0, 0.1}, {2.0, 0.0}, {2.0, -0.1}}) {
    ScaleJoin join(2);
    join.begin(motion(60, 7), false);
    join.answer(0, scale_of(7, 50, 100, 3, 0.3)), join.answer(1, scale_of(7, 50, 100, value, sigma));
    REQUIRE(join.joined());
    CHECK(join.joined()->scale == 3);
    CHECK(join.joined()->sigma == 0.3);
  }
  ScaleJoin join(1);  // a source with several scales for one motion: the newest is used
  join.begin(motion(60, 7), false);
  join.answer(0, scale_of(7, 50, 100, 3)), join.answer(0, scale_of(7, 50, 100, 4));
  CHECK(join.joined()->scale == 4);
  join.begin(motion(61, 7), false);
  CHECK(join.joined()->scale == 4);
}

TEST_CASE("a gyroscope sample waits 0.1 s for its accelerometer sample, at most 64 wait, and a reset discards them") {
  for (const int64_t later : {100 * kMs, 100 * kMs + 1}) {
    ImuJoiner joiner;
    std::vector<odo_imu> taken;
    const auto add = [&](const odo_imu& m) { joiner.push(m, [&](const odo_imu& t) { taken.push_back(t); }); };
    add(imu(0, ODO_IMU_GYRO)), add(imu(later, ODO_IMU_GYRO));
    CHECK(taken.size() == (later > 100 * kMs ? 1 : 0));
    joiner.reset();
    add(imu(10 * kMs, ODO_IMU_ACCEL)), add(imu(20 * kMs, ODO_IMU_ACCEL));
    CHECK(taken.size() == (later > 100 * kMs ? 1 : 0));
    for (int i = 0; i < 65; ++i) add(imu(20 * kMs + i, ODO_IMU_GYRO));  // all within the waiting time
    CHECK(taken.size() == (later > 100 * kMs ? 2 : 1));
    CHECK(taken.back().header.flags == ODO_IMU_GYRO);
    odo_imu end = imu(20 * kMs + 128, ODO_IMU_ACCEL);
    for (int k = 0; k < 3; ++k) end.accel_b[k] = 128 * (k + 1);
    taken.clear();
    add(end);
    REQUIRE(taken.size() == 64);
    for (int i = 1; i < 65; ++i)
      for (int k = 0; k < 3; ++k) CHECK(taken[i - 1].accel_b[k] == doctest::Approx(i * (k + 1)).epsilon(1e-12));
    joiner.reset();
    taken.clear();
    add(imu(20 * kMs + 130, ODO_IMU_GYRO)), add(imu(20 * kMs + 140, ODO_IMU_ACCEL));
    CHECK(taken.empty());  // no accelerometer before it
    add(imu(0, kBoth)), add(imu(0, 0));
    CHECK(taken.size() == 1);
  }
}
