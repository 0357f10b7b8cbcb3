// SPDX-License-Identifier: Apache-2.0
//
// An app that calls from several threads at once. Most useful under ThreadSanitizer (preset `tsan`).
#include <atomic>
#include <thread>

#include <odograph/anchor.h>
#include <odograph/odograph.h>

#include "tests/support/session_app.hpp"
#include "tests/support/messages.hpp"

TEST_SUITE_BEGIN("threads");

namespace {

constexpr int kThreads = 8, kRounds = 400;

/// One thread's calls in a round: each pushes a sensor of its own number, and all poll.
void push_and_poll(odo_session* session, int thread, int round, std::atomic<uint64_t>& pushed) {
  const int64_t t_ns = 1'000'000'000 + round * 10'000'000LL;
  if (thread == 0) {
    const double gyro[3] = {0.01, 0.02, 0.1}, accel[3] = {0.1, 9.81, 0.3};
    odo_session_push_imu(session, t_ns, gyro, accel);
  } else if (thread == 1) {
    static const std::vector<uint8_t> pixels(64 * 48, 90);
    auto frame = grey_frame_at(t_ns, pixels.data(), 64, 48);
    odo_session_push(session, &frame.header);
  } else {
    auto barometer = pressure_at(t_ns, 95000);
    barometer.header.source = static_cast<uint32_t>(thread);
    odo_session_push(session, &barometer.header);
  }
  ++pushed;
  odo_pose pose{};
  pose.header.struct_size = sizeof pose;
  odo_session_get_pose(session, ODO_TIME_LATEST, &pose);
  odo_session_get_smooth_pose(session, t_ns, &pose);
  odo_error error{sizeof error, ODO_OK, {}};
  odo_session_last_error(session, &error);
  odo_anchor_place place{.struct_size = sizeof place, .kind = ODO_ANCHOR_VIEW, .t_ns = ODO_TIME_LATEST};
  uint64_t id = 0;
  if (round % 16 == thread && odo_anchor_create(session, &place, &id) == ODO_OK) {
    odo_anchor anchor{};
    anchor.struct_size = sizeof anchor;
    odo_anchor_get(session, id, 0, ODO_TIME_LATEST, &anchor);
    odo_anchor_remove(session, id);
  }
  double geodetic[3];
  const double p_n[3] = {1, 2, 3};
  odo_session_to_geodetic(session, p_n, geodetic);
}

}  // namespace

TEST_CASE("with eight threads that push and poll, live and in replay, every sample is processed or counted") {
  for (const uint32_t run : {ODO_RUN_LIVE, ODO_RUN_REPLAY}) {
    CAPTURE(run);
    RunningApp app((kCameraPlugins ? kCamera : kWalk) + "absolute_fixers:\n  plugin: fix/waypoint\n", run);
    app.push(calibration(64, 48));
    std::atomic<uint64_t> pushed{1};
    std::vector<std::thread> threads;
    for (int k = 0; k < kThreads; ++k)
      threads.emplace_back([&app, &pushed, k] {
        for (int i = 0; i < kRounds; ++i) {
          push_and_poll(app.session, k, i, pushed);
          app.statistics();
        }
      });
    for (std::thread& thread : threads) thread.join();
    app.flush();
    const odo_statistics s = app.statistics();
    CHECK(pushed == 1 + kThreads * kRounds);
    CHECK(s.pushed == pushed);
    CHECK(s.processed + s.late + s.duplicate + s.invalid + s.overflow + s.wild == s.pushed);
    CHECK(s.processed > 0);
  }
}
