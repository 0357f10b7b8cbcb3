// SPDX-License-Identifier: Apache-2.0
#include <rapidcheck.h>

#include "sdk/host/messages/imu_joiner.hpp"
#include "tests/host/merged.hpp"
#include "tests/support/messages.hpp"

using Verdict = TimeOrder::Verdict;

TEST_SUITE_BEGIN("time_order");

namespace {

constexpr int64_t kMs = 1'000'000;

/// Inertial samples of one or both sensors as joined.
struct Joined {
  ImuJoiner joiner;
  std::vector<odo_imu> samples;
  void push(uint32_t flag, int64_t t_ns, double x = 0) {
    auto imu = imu_at(t_ns, {0, 0, 0}, {0, 0, 0}, flag);
    (flag == ODO_IMU_GYRO ? imu.gyro_b : imu.accel_b)[0] = x;
    joiner.push(imu, [&](const odo_imu& whole) { samples.push_back(whole); });
  }
};

}  // namespace

TEST_CASE("the order of release is independent of the arrival within the wait") {
  rc::check("shuffled arrivals", [] {
    struct Arrival {
      int64_t at_ns;
      uint32_t type;
      int64_t t_ns;
    };
    std::vector<Arrival> arrivals;
    const auto add = [&](uint32_t type, int64_t t_ns, int64_t since_ns) {
      arrivals.push_back({since_ns + *rc::gen::inRange<int64_t>(0, 90 * kMs), type, t_ns});
    };
    for (int i = 0; i < 200; ++i) {
      const int64_t t = i * 5 * kMs;
      add(ODO_TYPE_IMU, t, t);
      if (i % 7 == 0) add(ODO_TYPE_MAGNETOMETER, t + kMs, t);
      if (i % 10 == 0) add(ODO_TYPE_FRAME, t + 2 * kMs, t);
    }
    // Each sensor delivers in its own order; only the order between sensors is shuffled.
    std::map<uint32_t, std::vector<int64_t>> times;
    for (auto a = arrivals.rbegin(); a != arrivals.rend(); ++a) times[a->type].push_back(a->t_ns);
    std::ranges::stable_sort(arrivals, {}, &Arrival::at_ns);
    for (Arrival& a : arrivals) a.t_ns = times[a.type].back(), times[a.type].pop_back();
    Order order(1024, 200 * kMs);
    std::vector<std::pair<int64_t, uint32_t>> released;
    for (const Arrival& a : arrivals) {
      RC_ASSERT(order.add(a.type, a.t_ns) == Verdict::accepted);
      for (const auto& one : order.released()) released.push_back(one);
    }
    for (const auto& rest : order.released(INT64_MAX)) released.push_back(rest);
    RC_ASSERT(released.size() == arrivals.size());
    RC_ASSERT(std::is_sorted(released.begin(), released.end()));
  });
}

TEST_CASE("a described camera is waited for before its first frame too, for a second") {
  for (const int first_ms : {200, 900, 1500}) {
    CAPTURE(first_ms);
    Order order(1024, 200 * kMs);
    std::vector<std::pair<int64_t, uint32_t>> released;
    CHECK(order.add(ODO_TYPE_CALIBRATION, 0) == Verdict::accepted);
    for (int t_ms = 0; t_ms < 2000; t_ms += 5) {
      order.imu(t_ms * kMs);
      const int frame_ms = t_ms - 45;  // a picture is delivered late
      if (frame_ms >= first_ms && frame_ms % 50 == 0) order.add(ODO_TYPE_FRAME, frame_ms * kMs);
      for (const auto& one : order.released()) released.push_back(one);
    }
    for (const auto& rest : order.released(INT64_MAX)) released.push_back(rest);
    CHECK(released.front().second == ODO_TYPE_CALIBRATION);
    CHECK(std::is_sorted(released.begin() + 1, released.end()) == (first_ms < 1000));
    CHECK(released.size() == 401 + static_cast<size_t>((1950 - first_ms) / 50 + 1));
  }
}

TEST_CASE("late, duplicate and implausible samples are distinguished") {
  Order order(64, 50 * kMs);
  for (int i = 0; i < 20; ++i) order.imu(i * 10 * kMs);
  order.all();
  CHECK(order.imu(190 * kMs) == Verdict::duplicate);
  CHECK(order.imu(20 * kMs) == Verdict::late);
  CHECK(order.imu(3'000'000 * kMs) == Verdict::implausible);
  CHECK(order.imu(200 * kMs) == Verdict::accepted);
  CHECK(order.add(ODO_TYPE_GNSS, 10 * kMs) == Verdict::accepted);  // slow sensors may be late
}

TEST_CASE("a sensor clock that is set back restarts the order instead of dropping everything") {
  Order order(256, 50 * kMs);
  OwnedMessage m;
  for (int i = 1000; i < 1100; ++i) {
    order.imu(i * 10 * kMs);
    order.all();
  }
  int pushes = 0;
  while (order.imu(pushes * 10 * kMs) != Verdict::restarted) REQUIRE(++pushes < 100);
  while (order.drain(m)) {
  }
  order.restart();
  CHECK(order.imu(++pushes * 10 * kMs) == Verdict::accepted);
}

TEST_CASE("a full queue reports it and loses nothing that it holds") {
  Order order(64, 10'000 * kMs);
  int accepted = 0;
  for (int i = 0; i < 100; ++i)
    if (order.imu(i * kMs) == Verdict::accepted) ++accepted;
  CHECK(accepted == 64);
  CHECK(order.released(INT64_MAX).size() == 64);
}

TEST_CASE("a sensor that starts while others run is waited for from its first sample on, and loses none") {
  Order order(256, 200 * kMs);
  OwnedMessage m;
  std::vector<int64_t> frames, imu;
  int refused = 0;
  for (int i = 0; i < 400; ++i) {
    order.imu(i * 5 * kMs);
    const int64_t frame_ms = i * 5 - 60;  // delivered 60 ms after its time
    if (frame_ms >= 1000 && frame_ms % 30 == 10)
      refused += order.add(ODO_TYPE_FRAME, frame_ms * kMs) != Verdict::accepted;
    while (order.pop(m)) (m.header().type == ODO_TYPE_FRAME ? frames : imu).push_back(m.header().t_ns);
    if (frames.size() > 5) CHECK(imu.back() <= frames.back() + 31 * kMs);
  }
  CHECK(refused == 0);
  CHECK(frames.size() > 28);
  CHECK(std::is_sorted(frames.begin(), frames.end()));
  CHECK(std::is_sorted(imu.begin(), imu.end()));
}

TEST_CASE("a stalled stream that arrives late all at once does not restart the clock") {
  Order order(256, 50 * kMs);
  for (int i = 0; i < 600; ++i) {
    order.add(ODO_TYPE_IMU, i * 5 * kMs, 0, ODO_IMU_GYRO);
    if (i < 200 || i == 599)
      for (int late = i < 200 ? i : 200; late <= i; ++late) {
        const auto verdict = order.add(ODO_TYPE_IMU, late * 5 * kMs, 0, ODO_IMU_ACCEL);
        CHECK(verdict != Verdict::restarted);
        CHECK((verdict == Verdict::late) == (i == 599 && late * 5 < 598 * 5 - 50));
      }
    order.all();
  }
}

TEST_CASE("a silent sensor no longer delays the others") {
  Order order(256, 200 * kMs);
  OwnedMessage m;
  int64_t released = 0;
  for (int i = 0; i < 600; ++i) {
    order.imu(i * 5 * kMs);
    if (i < 100 && i % 6 == 0) order.add(ODO_TYPE_FRAME, i * 5 * kMs);
    while (order.pop(m)) released = m.header().t_ns;
    if (i == 200) CHECK(released == 800 * kMs);  // bounded by the wait
    if (i > 320) CHECK(released == i * 5 * kMs);
  }
}

TEST_CASE("times at the ends of the range cause no overflow") {
  Order order(16, 200 * kMs);
  for (const int64_t t : {INT64_MAX, INT64_MAX - 1, INT64_MIN + 1, int64_t(0), INT64_MAX}) order.imu(t);
  order.all(INT64_MAX);
  CHECK(order.size() == 0);
}

TEST_CASE("calibrations come before the frames of the same time") {
  Order order(64, 0);
  order.add(ODO_TYPE_FRAME, 5);
  order.add(ODO_TYPE_CALIBRATION, 5);
  const auto out = order.released(INT64_MAX);
  CHECK(out.front().second == ODO_TYPE_CALIBRATION);
}

TEST_CASE("separate accelerometer and gyroscope samples are joined by interpolation") {
  Joined joined;
  joined.push(ODO_IMU_GYRO, 50, 1.0);  // before the first accelerometer sample: no interpolation possible
  joined.push(ODO_IMU_ACCEL, 100, 10.0);
  joined.push(ODO_IMU_GYRO, 125, 2.0);
  joined.push(ODO_IMU_GYRO, 175, 3.0);
  joined.push(ODO_IMU_ACCEL, 200, 20.0);
  REQUIRE(joined.samples.size() == 2);
  CHECK(joined.samples[0].accel_b[0] == doctest::Approx(12.5));
  CHECK(joined.samples[1].accel_b[0] == doctest::Approx(17.5));
  CHECK(joined.samples[1].gyro_b[0] == 3.0);
}

TEST_CASE("samples of both sensors at one time are joined in either order of arrival") {
  for (const bool gyro_first : {false, true}) {
    CAPTURE(gyro_first);
    Joined joined;
    for (int64_t t = 100; t <= 500; t += 100) {
      joined.push(gyro_first ? ODO_IMU_GYRO : ODO_IMU_ACCEL, t, static_cast<double>(t));
      joined.push(gyro_first ? ODO_IMU_ACCEL : ODO_IMU_GYRO, t, static_cast<double>(t));
    }
    REQUIRE(joined.samples.size() == 4);  // the first has no accelerometer sample before it, or the last none after it
    for (const odo_imu& w : joined.samples) CHECK(w.accel_b[0] == w.gyro_b[0]);
  }
}

TEST_CASE("a gyroscope without an accelerometer is passed on alone, in order, and once") {
  Joined joined;
  const auto& taken = joined.samples;
  for (int64_t t = 0; t <= 1000; t += 5) joined.push(ODO_IMU_GYRO, t * kMs);
  REQUIRE(taken.size() == 180);  // all but those of the last 100 ms
  joined.push(ODO_IMU_ACCEL, 1002 * kMs);
  joined.push(ODO_IMU_GYRO, 1005 * kMs);
  joined.push(ODO_IMU_ACCEL, 1010 * kMs);
  REQUIRE(taken.size() == 181);
  for (size_t i = 0; i + 1 < taken.size(); ++i) CHECK(taken[i].header.flags == ODO_IMU_GYRO);
  for (size_t i = 0; i + 1 < taken.size(); ++i) CHECK(taken[i].header.t_ns < taken[i + 1].header.t_ns);
  CHECK(taken.back().header.flags == (ODO_IMU_GYRO | ODO_IMU_ACCEL));
}

TEST_CASE("another sensor's sample as old as the last released one is in time, and an older one is late") {
  Order order(64, 0);
  for (const uint32_t type : {ODO_TYPE_IMU, ODO_TYPE_MAGNETOMETER}) REQUIRE(order.add(type, kMs) == Verdict::accepted);
  REQUIRE(order.released(INT64_MAX).size() == 2);  // both have joined
  REQUIRE(order.imu(10 * kMs) == Verdict::accepted);
  REQUIRE(order.released(INT64_MAX).size() == 1);
  CHECK(order.add(ODO_TYPE_MAGNETOMETER, 10 * kMs) == Verdict::accepted);
  REQUIRE(order.imu(20 * kMs) == Verdict::accepted);
  REQUIRE(order.released(INT64_MAX).size() == 2);
  CHECK(order.add(ODO_TYPE_MAGNETOMETER, 19 * kMs) == Verdict::late);
}
