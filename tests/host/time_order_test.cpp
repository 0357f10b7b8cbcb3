// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <algorithm>

#include "sdk/host/core/time_order.hpp"
#include "sdk/host/messages/imu_joiner.hpp"
#include "tests/support/messages.hpp"

using namespace odograph;

TEST_SUITE_BEGIN("time_order");

namespace {

constexpr int64_t kMs = 1'000'000;

odo_header message(uint32_t type, int64_t t_ns) {
  odo_header h{};
  h.type = type;
  h.t_ns = t_ns;
  return h;
}

/// Whole messages for the queue, which copies by type.
AnyMessage whole(uint32_t type, int64_t t_ns) {
  odo_pose largest{};  // larger than any sample here
  largest.header = message(type, t_ns);
  largest.header.struct_size = static_cast<uint32_t>(message_info(type)->size);
  return AnyMessage(largest.header);
}

std::vector<std::pair<int64_t, uint32_t>> drain(TimeOrder& order) {
  std::vector<std::pair<int64_t, uint32_t>> out;
  OwnedMessage m;
  while (order.pop(m, INT64_MAX)) out.emplace_back(m.header().t_ns, m.header().type);
  return out;
}

}  // namespace

TEST_CASE("the order of release is independent of the arrival within the wait") {
  rc::check("shuffled arrivals", [] {
    std::vector<std::pair<int64_t, AnyMessage>> arrivals;  // arrival time, message
    for (int i = 0; i < 200; ++i) {
      const int64_t t = i * 5 * kMs;
      arrivals.emplace_back(t + *rc::gen::inRange<int64_t>(0, 90 * kMs), whole(ODO_TYPE_IMU, t));
      if (i % 7 == 0)
        arrivals.emplace_back(t + *rc::gen::inRange<int64_t>(0, 90 * kMs), whole(ODO_TYPE_MAGNETOMETER, t + kMs));
      if (i % 10 == 0)
        arrivals.emplace_back(t + *rc::gen::inRange<int64_t>(0, 90 * kMs), whole(ODO_TYPE_FRAME, t + 2 * kMs));
    }
    // Each sensor delivers in its own order; only the order between sensors is shuffled.
    std::stable_sort(arrivals.begin(), arrivals.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const uint32_t type : {ODO_TYPE_IMU, ODO_TYPE_MAGNETOMETER, ODO_TYPE_FRAME}) {
      std::vector<AnyMessage> of_type;
      for (const auto& a : arrivals)
        if (a.second.header().type == type) of_type.push_back(a.second);
      std::sort(of_type.begin(), of_type.end(),
                [](const auto& a, const auto& b) { return a.header().t_ns < b.header().t_ns; });
      size_t k = 0;
      for (auto& a : arrivals)
        if (a.second.header().type == type) a.second = of_type[k++];
    }
    TimeOrder order(1024, 200 * kMs);
    std::vector<std::pair<int64_t, uint32_t>> released;
    OwnedMessage m;
    for (const auto& [at, sample] : arrivals) {
      RC_ASSERT(order.push(OwnedMessage(sample.header())) == TimeOrder::Verdict::accepted);
      while (order.pop(m)) released.emplace_back(m.header().t_ns, m.header().type);
    }
    for (const auto& rest : drain(order)) released.push_back(rest);
    RC_ASSERT(released.size() == arrivals.size());
    RC_ASSERT(std::is_sorted(released.begin(), released.end()));
  });
}

TEST_CASE("a described camera is waited for before its first frame too, for a second") {
  for (const int first_ms : {200, 900, 1500}) {
    CAPTURE(first_ms);
    TimeOrder order(1024, 200 * kMs);
    OwnedMessage m;
    std::vector<std::pair<int64_t, uint32_t>> released;
    CHECK(order.push(OwnedMessage(whole(ODO_TYPE_CALIBRATION, 0).header())) == TimeOrder::Verdict::accepted);
    for (int t_ms = 0; t_ms < 2000; t_ms += 5) {
      order.push(OwnedMessage(whole(ODO_TYPE_IMU, t_ms * kMs).header()));
      const int frame_ms = t_ms - 45;  // a picture is delivered late
      if (frame_ms >= first_ms && frame_ms % 50 == 0)
        order.push(OwnedMessage(whole(ODO_TYPE_FRAME, frame_ms * kMs).header()));
      while (order.pop(m)) released.emplace_back(m.header().t_ns, m.header().type);
    }
    for (const auto& rest : drain(order)) released.push_back(rest);
    CHECK(released.front().second == ODO_TYPE_CALIBRATION);
    CHECK(std::is_sorted(released.begin() + 1, released.end()) == (first_ms < 1000));
    CHECK(released.size() == 401 + static_cast<size_t>((1950 - first_ms) / 50 + 1));
  }
}

TEST_CASE("late, duplicate and implausible samples are distinguished") {
  TimeOrder order(64, 50 * kMs);
  OwnedMessage m;
  for (int i = 0; i < 20; ++i) order.push(OwnedMessage(whole(ODO_TYPE_IMU, i * 10 * kMs).header()));
  while (order.pop(m)) {
  }
  CHECK(order.push(OwnedMessage(whole(ODO_TYPE_IMU, 190 * kMs).header())) == TimeOrder::Verdict::duplicate);
  CHECK(order.push(OwnedMessage(whole(ODO_TYPE_IMU, 20 * kMs).header())) == TimeOrder::Verdict::late);
  CHECK(order.push(OwnedMessage(whole(ODO_TYPE_IMU, 3'000'000 * kMs).header())) == TimeOrder::Verdict::implausible);
  CHECK(order.push(OwnedMessage(whole(ODO_TYPE_IMU, 200 * kMs).header())) == TimeOrder::Verdict::accepted);
  CHECK(order.push(OwnedMessage(whole(ODO_TYPE_GNSS, 10 * kMs).header())) ==
        TimeOrder::Verdict::accepted);  // slow sensors may be late
}

TEST_CASE("a sensor clock that is set back restarts the order instead of dropping everything") {
  TimeOrder order(256, 50 * kMs);
  OwnedMessage m;
  for (int i = 1000; i < 1100; ++i) {
    order.push(OwnedMessage(whole(ODO_TYPE_IMU, i * 10 * kMs).header()));
    while (order.pop(m)) {
    }
  }
  int pushes = 0;
  while (order.push(OwnedMessage(whole(ODO_TYPE_IMU, pushes * 10 * kMs).header())) != TimeOrder::Verdict::restarted)
    REQUIRE(++pushes < 100);
  while (order.drain(m)) {
  }
  order.restart();
  CHECK(order.push(OwnedMessage(whole(ODO_TYPE_IMU, ++pushes * 10 * kMs).header())) == TimeOrder::Verdict::accepted);
}

TEST_CASE("a full queue reports it and loses nothing that it holds") {
  TimeOrder order(64, 10'000 * kMs);
  int accepted = 0;
  for (int i = 0; i < 100; ++i)
    if (order.push(OwnedMessage(whole(ODO_TYPE_IMU, i * kMs).header())) == TimeOrder::Verdict::accepted) ++accepted;
  CHECK(accepted == 64);
  CHECK(drain(order).size() == 64);
}

TEST_CASE("a sensor that starts while others run is waited for from its first sample on, and loses none") {
  TimeOrder order(256, 200 * kMs);
  OwnedMessage m;
  std::vector<int64_t> frames, imu;
  int refused = 0;
  for (int i = 0; i < 400; ++i) {
    order.push(OwnedMessage(whole(ODO_TYPE_IMU, i * 5 * kMs).header()));
    const int64_t frame_ms = i * 5 - 60;  // delivered 60 ms after its time
    if (frame_ms >= 1000 && frame_ms % 30 == 10)
      refused +=
          order.push(OwnedMessage(whole(ODO_TYPE_FRAME, frame_ms * kMs).header())) != TimeOrder::Verdict::accepted;
    while (order.pop(m)) (m.header().type == ODO_TYPE_FRAME ? frames : imu).push_back(m.header().t_ns);
    if (frames.size() > 5) CHECK(imu.back() <= frames.back() + 31 * kMs);
  }
  CHECK(refused == 0);
  CHECK(frames.size() > 28);
  CHECK(std::is_sorted(frames.begin(), frames.end()));
  CHECK(std::is_sorted(imu.begin(), imu.end()));
}

TEST_CASE("a stalled stream that arrives late all at once does not restart the clock") {
  TimeOrder order(256, 50 * kMs);
  OwnedMessage m;
  const auto gyro = [](int i) {
    auto imu = whole(ODO_TYPE_IMU, i * 5 * kMs);
    imu.header().flags = ODO_IMU_GYRO;
    return imu;
  };
  const auto accel = [&](int i) {
    auto imu = gyro(i);
    imu.header().flags = ODO_IMU_ACCEL;
    return imu;
  };
  for (int i = 0; i < 600; ++i) {
    order.push(OwnedMessage(gyro(i).header()));
    if (i < 200 || i == 599)
      for (int late = i < 200 ? i : 200; late <= i; ++late) {
        const auto verdict = order.push(OwnedMessage(accel(late).header()));
        CHECK(verdict != TimeOrder::Verdict::restarted);
        CHECK((verdict == TimeOrder::Verdict::late) == (i == 599 && late * 5 < 598 * 5 - 50));
      }
    while (order.pop(m)) {
    }
  }
}

TEST_CASE("a silent sensor no longer delays the others") {
  TimeOrder order(256, 200 * kMs);
  OwnedMessage m;
  int64_t released = 0;
  for (int i = 0; i < 600; ++i) {
    order.push(OwnedMessage(whole(ODO_TYPE_IMU, i * 5 * kMs).header()));
    if (i < 100 && i % 6 == 0) order.push(OwnedMessage(whole(ODO_TYPE_FRAME, i * 5 * kMs).header()));
    while (order.pop(m)) released = m.header().t_ns;
    if (i == 200) CHECK(released == 800 * kMs);  // bounded by the wait
    if (i > 320) CHECK(released == i * 5 * kMs);
  }
}

TEST_CASE("times at the ends of the range cause no overflow") {
  TimeOrder order(16, 200 * kMs);
  for (const int64_t t : {INT64_MAX, INT64_MAX - 1, INT64_MIN + 1, int64_t(0), INT64_MAX})
    order.push(OwnedMessage(whole(ODO_TYPE_IMU, t).header()));
  OwnedMessage m;
  while (order.pop(m, INT64_MAX)) {
  }
  CHECK(order.size() == 0);
}

TEST_CASE("calibrations come before the frames of the same time") {
  TimeOrder order(64, 0);
  order.push(OwnedMessage(whole(ODO_TYPE_FRAME, 5).header()));
  order.push(OwnedMessage(whole(ODO_TYPE_CALIBRATION, 5).header()));
  const auto out = drain(order);
  CHECK(out.front().second == ODO_TYPE_CALIBRATION);
}

TEST_CASE("separate accelerometer and gyroscope samples are joined by interpolation") {
  ImuJoiner joiner;
  std::vector<odo_imu> whole_samples;
  const auto push = [&](uint32_t flag, int64_t t, double x) {
    auto imu = imu_at(t, {0, 0, 0}, {0, 0, 0}, flag);
    (flag == ODO_IMU_GYRO ? imu.gyro_b : imu.accel_b)[0] = x;
    joiner.push(imu, [&](const odo_imu& w) { whole_samples.push_back(w); });
  };
  push(ODO_IMU_GYRO, 50, 1.0);  // before the first accelerometer sample: no interpolation possible
  push(ODO_IMU_ACCEL, 100, 10.0);
  push(ODO_IMU_GYRO, 125, 2.0);
  push(ODO_IMU_GYRO, 175, 3.0);
  push(ODO_IMU_ACCEL, 200, 20.0);
  REQUIRE(whole_samples.size() == 2);
  CHECK(whole_samples[0].accel_b[0] == doctest::Approx(12.5));
  CHECK(whole_samples[1].accel_b[0] == doctest::Approx(17.5));
  CHECK(whole_samples[1].gyro_b[0] == 3.0);
}

TEST_CASE("samples of both sensors at one time are joined in either order of arrival") {
  for (const bool gyro_first : {false, true}) {
    CAPTURE(gyro_first);
    ImuJoiner joiner;
    std::vector<odo_imu> whole_samples;
    const auto push = [&](uint32_t flag, int64_t t) {
      auto imu = imu_at(t, {0, 0, 0}, {0, 0, 0}, flag);
      (flag == ODO_IMU_GYRO ? imu.gyro_b : imu.accel_b)[0] = static_cast<double>(t);
      joiner.push(imu, [&](const odo_imu& w) { whole_samples.push_back(w); });
    };
    for (int64_t t = 100; t <= 500; t += 100) {
      push(gyro_first ? ODO_IMU_GYRO : ODO_IMU_ACCEL, t);
      push(gyro_first ? ODO_IMU_ACCEL : ODO_IMU_GYRO, t);
    }
    REQUIRE(whole_samples.size() == 4);  // the first has no accelerometer sample before it, or the last none after it
    for (const odo_imu& w : whole_samples) CHECK(w.accel_b[0] == w.gyro_b[0]);
  }
}

TEST_CASE("a gyroscope without an accelerometer is passed on alone, in order, and once") {
  ImuJoiner joiner;
  std::vector<odo_imu> taken;
  const auto push = [&](uint32_t flag, int64_t t_ns) {
    auto imu = imu_at(t_ns, {0, 0, 0}, {0, 0, 0}, flag);
    joiner.push(imu, [&](const odo_imu& x) { taken.push_back(x); });
  };
  for (int64_t t = 0; t <= 1000; t += 5) push(ODO_IMU_GYRO, t * kMs);
  REQUIRE(taken.size() == 180);  // all but those of the last 100 ms
  push(ODO_IMU_ACCEL, 1002 * kMs);
  push(ODO_IMU_GYRO, 1005 * kMs);
  push(ODO_IMU_ACCEL, 1010 * kMs);
  REQUIRE(taken.size() == 181);
  for (size_t i = 0; i + 1 < taken.size(); ++i) CHECK(taken[i].header.flags == ODO_IMU_GYRO);
  for (size_t i = 0; i + 1 < taken.size(); ++i) CHECK(taken[i].header.t_ns < taken[i + 1].header.t_ns);
  CHECK(taken.back().header.flags == (ODO_IMU_GYRO | ODO_IMU_ACCEL));
}

TEST_CASE("another sensor's sample as old as the last released one is in time, and an older one is late") {
  TimeOrder order(64, 0);
  for (const uint32_t type : {ODO_TYPE_IMU, ODO_TYPE_MAGNETOMETER})
    REQUIRE(order.push(OwnedMessage(whole(type, kMs).header())) == TimeOrder::Verdict::accepted);
  REQUIRE(drain(order).size() == 2);  // both have joined
  REQUIRE(order.push(OwnedMessage(whole(ODO_TYPE_IMU, 10 * kMs).header())) == TimeOrder::Verdict::accepted);
  REQUIRE(drain(order).size() == 1);
  CHECK(order.push(OwnedMessage(whole(ODO_TYPE_MAGNETOMETER, 10 * kMs).header())) == TimeOrder::Verdict::accepted);
  REQUIRE(order.push(OwnedMessage(whole(ODO_TYPE_IMU, 20 * kMs).header())) == TimeOrder::Verdict::accepted);
  REQUIRE(drain(order).size() == 2);
  CHECK(order.push(OwnedMessage(whole(ODO_TYPE_MAGNETOMETER, 19 * kMs).header())) == TimeOrder::Verdict::late);
}

TEST_SUITE_END();
