// SPDX-License-Identifier: Apache-2.0
//
// Merging by time at its limits: restarted counts, times just within and just beyond.
#include "tests/host/merged.hpp"

using Verdict = TimeOrder::Verdict;

TEST_SUITE_BEGIN("time_order_limits");

constexpr int64_t kMilli = 1'000'000, kSecond = 1000 * kMilli;

TEST_CASE("isolated implausible times are never accepted, however many, while good samples are between them") {
  Order order(1024, 50 * kMilli);
  for (int i = 0; i < 20; ++i) {
    CHECK(order.imu(i * 10 * kMilli) == Verdict::accepted);
    CHECK(order.imu(1000 * kSecond + i) == Verdict::implausible);
    CHECK(order.imu(2000 * kSecond + i) == Verdict::implausible);  // two in a row are not accepted either
  }
  CHECK(order.size() == 20);
  CHECK(order.imu(200 * kMilli) == Verdict::accepted);
  // Each stream has its own count, unless another one agrees.
  CHECK(order.imu(1000 * kSecond) == Verdict::implausible);
  CHECK(order.add(ODO_TYPE_MAGNETOMETER, 2000 * kSecond) == Verdict::implausible);
  CHECK(order.imu(1000 * kSecond + 1) == Verdict::implausible);
  CHECK(order.imu(1000 * kSecond + 2) == Verdict::accepted);  // the third of one stream, which has had a pause
  CHECK(order.imu(3000 * kSecond) == Verdict::implausible);
  CHECK(order.add(ODO_TYPE_FRAME, 3000 * kSecond + 1) == Verdict::accepted);  // agrees
  CHECK(order.imu(3000 * kSecond + 2) == Verdict::accepted);
}

TEST_CASE(
    "ten seconds ahead are plausible and a nanosecond more is not, and an isolated sample at a duplicate's time is "
    "not") {
  Order order(16, 50 * kMilli);
  CHECK(order.imu(0) == Verdict::accepted);
  CHECK(order.imu(10 * kSecond + 1) == Verdict::implausible);
  CHECK(order.imu(10 * kSecond) == Verdict::accepted);
  CHECK(order.imu(10 * kSecond) == Verdict::duplicate);
  CHECK(order.add(ODO_TYPE_IMU, 10 * kSecond, 1) == Verdict::accepted);  // of another sensor
  CHECK(order.add(ODO_TYPE_IMU, 10 * kSecond, 0, ODO_IMU_GYRO) == Verdict::accepted);
  CHECK(order.add(ODO_TYPE_IMU, 10 * kSecond, 0, ODO_IMU_ACCEL) == Verdict::accepted);
  CHECK(order.add(ODO_TYPE_IMU, 10 * kSecond, 0, ODO_IMU_ACCEL) == Verdict::duplicate);
  // A magnetometer's flags do not separate streams.
  CHECK(order.add(ODO_TYPE_MAGNETOMETER, 10 * kSecond, 0, 0) == Verdict::accepted);
  CHECK(order.add(ODO_TYPE_MAGNETOMETER, 10 * kSecond, 0, 1) == Verdict::duplicate);
}

TEST_CASE(
    "the fiftieth consecutive sample behind its sensor's time causes a restart, one in time between them restarts the "
    "count") {
  for (const uint32_t type : {ODO_TYPE_IMU, ODO_TYPE_MAGNETOMETER, ODO_TYPE_FRAME, ODO_TYPE_BAROMETER}) {
    CAPTURE(type);
    for (const uint32_t in_time : {0u, type, uint32_t(ODO_TYPE_IMU)}) {
      CAPTURE(in_time);
      Order order(4096, 0);
      REQUIRE(order.add(type, 5 * kSecond) == Verdict::accepted);
      REQUIRE(order.imu(5 * kSecond + 1) == Verdict::accepted);
      REQUIRE(order.all().size() == 2);
      for (int i = 0; i < 49; ++i) REQUIRE(order.add(type, i) == Verdict::late);
      if (in_time != 0) {
        REQUIRE(order.add(in_time, 5 * kSecond + 2) == Verdict::accepted);
        for (int i = 0; i < 49; ++i) REQUIRE(order.add(type, i) == Verdict::late);
      }
      CHECK(order.add(type, 60) == (type == ODO_TYPE_BAROMETER ? Verdict::late : Verdict::restarted));
    }
  }
}

TEST_CASE("late samples with increasing times are no clock that was set back, and restart the count") {
  Order order(4096, 10 * kMilli);
  REQUIRE(order.add(ODO_TYPE_MAGNETOMETER, 0) == Verdict::accepted);
  REQUIRE(order.imu(5 * kSecond) == Verdict::accepted);
  REQUIRE(order.all(INT64_MAX).size() == 2);
  for (int i = 1; i < 200; ++i) CHECK(order.add(ODO_TYPE_MAGNETOMETER, i * kMilli) == Verdict::late);
  for (int i = 0; i < 49; ++i) CHECK(order.add(ODO_TYPE_MAGNETOMETER, i) == Verdict::late);
  CHECK(order.add(ODO_TYPE_MAGNETOMETER, 300 * kMilli) == Verdict::late);
  for (int i = 0; i < 49; ++i) CHECK(order.add(ODO_TYPE_MAGNETOMETER, i) == Verdict::late);
  CHECK(order.add(ODO_TYPE_MAGNETOMETER, 50) == Verdict::restarted);
}

TEST_CASE("a starting sensor may be late by the longest wait and not a nanosecond more, and joins once") {
  for (const int64_t late_ns : {100 * kMilli - 1, 100 * kMilli, 100 * kMilli + 1}) {
    CAPTURE(late_ns);
    Order order(64, 100 * kMilli);
    REQUIRE(order.imu(5 * kSecond) == Verdict::accepted);
    REQUIRE(order.all(INT64_MAX).size() == 1);
    const bool joins = late_ns <= 100 * kMilli;
    CHECK(order.add(ODO_TYPE_FRAME, 5 * kSecond - late_ns) == (joins ? Verdict::accepted : Verdict::late));
    CHECK(order.add(ODO_TYPE_BAROMETER, 5 * kSecond - late_ns) == (joins ? Verdict::accepted : Verdict::late));
    CHECK(order.add(ODO_TYPE_RANGE, 5 * kSecond - late_ns) == Verdict::accepted);  // it may always be late
    if (!joins) continue;
    REQUIRE(order.add(ODO_TYPE_FRAME, 5 * kSecond) == Verdict::accepted);  // in time from here on
    REQUIRE(order.imu(6 * kSecond) == Verdict::accepted);
    REQUIRE(order.all(INT64_MAX).size() == 5);
    CHECK(order.add(ODO_TYPE_FRAME, 6 * kSecond - 10 * kMilli) == Verdict::late);
    REQUIRE(order.imu(8 * kSecond) == Verdict::accepted);
    REQUIRE(order.all(INT64_MAX).size() == 1);
    CHECK(order.add(ODO_TYPE_FRAME, 8 * kSecond - 10 * kMilli) ==
          Verdict::accepted);  // it starts again after its silence
  }
}

TEST_CASE("a sensor is waited for up to a second of silence, or the longest wait if that is longer") {
  for (const int64_t wait : {200 * kMilli, 1500 * kMilli}) {
    const int64_t silent = std::max(wait, kSecond);
    for (const int64_t since : {silent - 1, silent, silent + 1}) {
      CAPTURE(wait);
      CAPTURE(since);
      Order order(64, wait);
      REQUIRE(order.imu(0) == Verdict::accepted);
      REQUIRE(order.add(ODO_TYPE_FRAME, 10 * kSecond) == Verdict::accepted);
      REQUIRE(order.imu(10 * kSecond) == Verdict::accepted);
      order.all();
      REQUIRE(order.imu(10 * kSecond + since) == Verdict::accepted);
      CHECK(order.all().size() == (since > silent ? 1 : 0));  // otherwise it waits for the camera
      CHECK(order.ready() == false);
    }
  }
}

TEST_CASE(
    "nothing is released before the longest wait since the first sample, then the slowest sensor determines the wait") {
  for (const int64_t newest : {99 * kMilli, 100 * kMilli, 101 * kMilli}) {
    CAPTURE(newest);
    Order order(64, 100 * kMilli);
    REQUIRE(order.imu(0) == Verdict::accepted);
    REQUIRE(order.imu(newest) == Verdict::accepted);
    CHECK(order.ready() == (newest >= 100 * kMilli));
    CHECK(order.all().size() == (newest < 100 * kMilli ? 0 : 2));
  }
  Order order(64, 100 * kMilli);
  CHECK(order.latest_waiting_ns() == INT64_MIN);
  order.imu(0), order.add(ODO_TYPE_FRAME, 140 * kMilli), order.imu(150 * kMilli), order.imu(160 * kMilli);
  CHECK(order.latest_waiting_ns() == 160 * kMilli);
  CHECK(order.all() == std::vector<int64_t>{0, 140 * kMilli});
  CHECK(order.all(155 * kMilli) == std::vector<int64_t>{150 * kMilli});
}

TEST_CASE("an expected camera is waited for within the first second, and no longer once it has started") {
  for (const bool came : {false, true})
    for (const int64_t newest : {kSecond, kSecond + 1}) {
      Order order(64, 100 * kMilli);
      order.expect_camera();
      REQUIRE(order.imu(0) == Verdict::accepted);
      if (came) REQUIRE(order.add(ODO_TYPE_FRAME, newest - 1) == Verdict::accepted);
      REQUIRE(order.imu(newest) == Verdict::accepted);
      CHECK(order.all().size() == (came ? 2 : newest > kSecond ? 2 : 1));
    }
}

TEST_CASE("slow sensors and unknown messages are accepted however late, define no time, and keep their places") {
  Order order(64, 0);
  REQUIRE(order.imu(5 * kSecond) == Verdict::accepted);
  REQUIRE(order.all().size() == 1);
  const uint32_t slow[] = {ODO_TYPE_IMU_NOISE, ODO_TYPE_CALIBRATION, ODO_TYPE_GNSS, ODO_TYPE_WAYPOINT,
                           ODO_TYPE_VENDOR(1, 1)};
  for (const uint32_t type : slow) {
    CHECK(order.add(type, kSecond) == Verdict::accepted);
    CHECK(order.add(type, kSecond) == Verdict::accepted);  // the same time again
    CHECK(order.add(type, 5000 * kSecond) == Verdict::held);
  }
  CHECK(order.imu(5 * kSecond + 1) == Verdict::accepted);
  std::vector<uint32_t> types;
  for (OwnedMessage m; order.pop(m, kSecond);) types.push_back(m.header().type);
  REQUIRE(types.size() == 11);
  CHECK(types.back() == ODO_TYPE_IMU);
  CHECK(std::set<uint32_t>{types[0], types[1], types[2], types[3]} ==
        std::set<uint32_t>{ODO_TYPE_IMU_NOISE, ODO_TYPE_CALIBRATION});  // descriptions come first
  CHECK(order.add(ODO_TYPE_BAROMETER, 5 * kSecond) == Verdict::late);   // a late one sets nothing back
}

TEST_CASE("a restart discards all times and counts, and a full queue accepts again after a release") {
  Order order(2, 100 * kMilli);
  REQUIRE(order.imu(50 * kSecond) == Verdict::accepted);
  REQUIRE(order.add(ODO_TYPE_FRAME, 50 * kSecond) == Verdict::accepted);
  CHECK(order.imu(50 * kSecond + 1) == Verdict::full);
  CHECK(order.imu(50 * kSecond + 1) == Verdict::full);  // it was not recorded: no duplicate
  CHECK(order.imu(100 * kSecond) == Verdict::implausible);
  CHECK(order.imu(101 * kSecond) == Verdict::implausible);
  for (OwnedMessage m; order.drain(m);) {
  }
  CHECK(order.size() == 0);
  order.restart();
  CHECK(order.imu(0) == Verdict::accepted);
  CHECK(order.imu(100 * kSecond) == Verdict::implausible);  // the first of three again
  CHECK(order.imu(101 * kSecond) == Verdict::implausible);
  CHECK(order.imu(10 * kMilli) == Verdict::accepted);
  CHECK(order.imu(20 * kMilli) == Verdict::full);
}
