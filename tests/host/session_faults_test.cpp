// SPDX-License-Identifier: Apache-2.0
//
// Faults of an app, and interactions of plugins.
#include <Eigen/Core>
#include <odograph/odograph.h>

#include "tests/support/session_app.hpp"
#include "tests/support/test_plugins.hpp"
#include "tests/support/messages.hpp"

TEST_SUITE_BEGIN("session_faults");

namespace {

constexpr int64_t kMs = 1'000'000;

struct NeedyPlugins {
  const TestPlugins plugins{"needy_vo"};
};
/// With a front-end that needs the camera's calibration, which it has been given.
struct NeedyApp : NeedyPlugins, App {
  NeedyApp()
      : App("odograph: 1\nattitude:\n  plugin: attitude/vqf\nvo_frontend:\n  plugin: test/needy_vo\n", ODO_RUN_REPLAY,
            plugins.path()) {
    REQUIRE_MESSAGE(status == ODO_OK, message);
    const auto c = calibration(64, 48);
    odo_session_push(session, &c.header);
  }
};

}  // namespace

TEST_CASE("plugins that answer each other endlessly are cut off and reported") {
  const TestPlugins plugins{"fix_on_pose", "step_on_fix"};
  RunningApp app(
      "odograph: 1\nattitude:\n  plugin: attitude/vqf\nstep_estimator:\n  plugin: test/step_on_fix\n"
      "absolute_fixers:\n  - plugin: test/fix_on_pose\n",
      ODO_RUN_REPLAY, plugins.path());
  app.run(0, 100);
  const auto s = app.statistics();
  CHECK(s.processed == 100);
  CHECK(s.events_dropped >= 1);
  CHECK(s.steps == Between{100, 1000});                                   // for one sample
  CHECK(app.all<odo_fix>(ODO_TYPE_FIX).front().header.quality == 0.25f);  // as the plugin set it
  odo_error error{sizeof error, ODO_OK, {}};
  CHECK((odo_session_last_error(app.session, &error) == ODO_OK && error.status != ODO_OK));
  CHECK(contains(error.message, "in a loop"));
}

TEST_CASE("a plugin that requests corrections receives each one that the app receives, once, with the same numbers") {
  const TestPlugins plugins{"correction_echo"};
  RunningApp app(kWalk + "absolute_fixers:\n  - plugin: test/correction_echo\ncoupling: {type: localizer}\n" +
                     "navigation: {start: {position: [0 m, 0 m, 0 m], heading: 0 rad}}\n",
                 ODO_RUN_REPLAY, plugins.path());
  app.run(0, 3000);
  const auto corrections = app.all<odo_correction>(ODO_TYPE_CORRECTION);
  std::vector<odo_fix> echoes;
  for (const odo_fix& fix : app.all<odo_fix>(ODO_TYPE_FIX))
    if (fix.integrity == 1) echoes.push_back(fix);
  REQUIRE(!corrections.empty());
  REQUIRE(echoes.size() == corrections.size());
  for (size_t i = 0; i < echoes.size(); ++i) {
    CHECK(echoes[i].header.t_ns == corrections[i].header.t_ns);
    CHECK(Eigen::Vector3d(echoes[i].p_n) == Eigen::Vector3d(corrections[i].p_n));
    CHECK((echoes[i].header.flags & ODO_FLAG_ACCEPTED) == 0);
  }
}

TEST_CASE("after a reset or a clock that was set back a plugin receives the camera's calibration again") {
  NeedyApp app;
  const auto motions_of = [&](int64_t from_ns, bool breaks) {
    const size_t before = app.all<odo_vo_motion>(ODO_TYPE_VO_MOTION).size();
    for (int i = 0; i < 100; ++i) {
      const int walk = static_cast<int>((from_ns - 1'000 * kMs) / (10 * kMs)) + i;
      app.walk(walk, walk + 1);
      if (i % 10 == 0) app.frame(from_ns + i * 10 * kMs, breaks && i == 50 ? 666 : 0);
    }
    app.flush();
    return app.all<odo_vo_motion>(ODO_TYPE_VO_MOTION).size() - before;
  };
  CHECK(motions_of(60'000 * kMs, false) == 9);
  CHECK(motions_of(61'000 * kMs, true) == 8);  // the fault at one frame makes the next one a first one
  CHECK(app.statistics().plugin_faults == 1);
  motions_of(1'000 * kMs, false);  // the clock is set back
  CHECK(motions_of(2'000 * kMs, false) >= 9);
  CHECK(app.statistics().plugin_faults == 1);
  const auto corrections = app.all<odo_correction>(ODO_TYPE_CORRECTION);
  REQUIRE_FALSE(corrections.empty());
  CHECK(corrections.back().reason == ODO_CORRECTION_RESTART);
}

TEST_CASE("a camera that starts after the other sensors works and loses no frame") {
  for (const int late_ms : {100, 200, 1000, 5000}) {
    CAPTURE(late_ms);
    NeedyApp app;
    for (int i = 0; i < 1000; ++i) {
      app.walk(i, i + 1);
      const int ms = i * 10 - 60;  // a frame is delivered 60 ms after its time
      if (ms >= late_ms && ms % 30 == late_ms % 30) app.frame((1000 + ms) * kMs);
    }
    app.flush();
    const auto s = app.statistics();
    CHECK(s.late == 0);
    CHECK(s.frames == static_cast<uint64_t>((9930 - late_ms) / 30 + 1));
    CHECK(app.all<odo_vo_motion>(ODO_TYPE_VO_MOTION).size() == s.frames - 1);
  }
}

TEST_CASE("a burst of late samples after a stall is not taken for a clock that was set back") {
  App app(kWalk);
  app.walk(0, 1000);
  const auto before = app.pose(ODO_TIME_LATEST);
  const auto half = [&](uint32_t flag, int i) {
    const double t = 0.01 * i;
    app.push(imu_at(static_cast<int64_t>(t * 1e9) + 1'000 * kMs, {0, 0, 0}, {0, 9.81, 0}, flag));
  };
  for (int i = 1000; i < 1200; ++i) half(ODO_IMU_GYRO, i), half(ODO_IMU_ACCEL, i);
  for (int i = 1200; i < 1400; ++i) half(ODO_IMU_GYRO, i);
  for (int i = 1200; i < 1400; ++i) half(ODO_IMU_ACCEL, i);  // two seconds late, all at once
  for (int i = 1400; i < 1600; ++i) half(ODO_IMU_GYRO, i), half(ODO_IMU_ACCEL, i);
  app.flush();
  CHECK(app.statistics().late == Between{150, 200});
  CHECK(app.all<odo_correction>(ODO_TYPE_CORRECTION).empty());
  CHECK(app.pose(ODO_TIME_LATEST).distance_m >= before.distance_m);
  CHECK(app.pose(ODO_TIME_LATEST).header.t_ns >= 16'900 * kMs);
}

TEST_CASE("an outlier is rejected, counted and reported, and changes nothing that follows") {
  App clean(kWalk), app(kWalk);
  clean.run(0, 2000);
  for (int i = 0; i < 2000; i += 100) {
    app.walk(i, i + 100);
    const int64_t t_ns = 1'000 * kMs + (i + 99) * 10 * kMs + 5 * kMs;
    const double wild[2][3] = {{1e300, 0, 0}, {0, 30, 0}}, accel[3] = {0.1, 9.81, 0.4};
    const bool spike = i % 200 != 0;
    CHECK(odo_session_push_imu(app.session, t_ns, wild[spike ? 1 : 0], accel) == (spike ? ODO_OK : ODO_E_DISCARD));
  }
  app.walk(2000, 2001);
  clean.run(2000, 2001);
  app.flush();
  CHECK(app.statistics().wild == 20);
  CHECK(app.statistics().invalid == 0);
  CHECK(app.events == clean.events);
  auto field = make_message<odo_magnetometer>(ODO_TYPE_MAGNETOMETER, 30'000 * kMs);
  field.field_b[0] = 1e6;
  CHECK(app.push(field) == ODO_E_DISCARD);
  odo_error error = app.last_error();
  CHECK(contains(error.message, "outside the range of any such sensor"));
}

TEST_CASE("messages of another clock are discarded, counted and reported with their number, and the walk goes on") {
  constexpr int64_t kOtherClock_ns = 1'700'000'000'000'000'000;
  App clean(kWalk), app(kWalk);
  clean.run(0, 6000);
  for (int i = 0; i < 6000; i += 100) {
    app.walk(i, i + 100);
    auto waypoint = make_message<odo_waypoint>(ODO_TYPE_WAYPOINT, kOtherClock_ns + i * 10 * kMs);
    waypoint.sigma_m = 1;
    CHECK(app.push(waypoint) == ODO_OK);  // held back
    if (i == 3000) app.flush();
  }
  app.flush();
  CHECK(app.statistics().invalid == 60);
  CHECK(app.statistics().overflow == 0);
  CHECK(contains(app.said(), "its time is far ahead of all others"));
  CHECK(app.statistics().steps == clean.statistics().steps);
  CHECK(app.statistics().tracking_s == clean.statistics().tracking_s);
  CHECK(app.statistics().gaps == 0);
}

TEST_CASE("a fix that comes first after the phone has slept waits for the other sensors and is used") {
  App app(kWalk + "absolute_fixers:\n  - plugin: fix/waypoint\n    parameters: {use: all}\n");
  app.walk(0, 1000);
  auto waypoint = make_message<odo_waypoint>(ODO_TYPE_WAYPOINT, 1'000 * kMs + 8000 * 10 * kMs);  // 70 s later
  waypoint.sigma_m = 1;
  CHECK(app.push(waypoint) == ODO_OK);
  app.run(8000, 8200);
  CHECK(app.statistics().fixes_accepted + app.statistics().fixes_rejected == 1);
  CHECK(app.statistics().gaps == 1);
}

TEST_CASE("while the IMU is silent and the camera runs the state does not change") {
  NeedyApp app;
  for (int i = 0; i < 800; ++i) {
    if (i < 200) app.walk(i, i + 1);
    if (i % 10 == 0) app.frame((1000 + i * 10) * kMs);
  }
  app.flush();
  std::vector<odo_state> late;
  for (const auto& s : app.all<odo_state>(ODO_TYPE_STATE))
    if (s.header.t_ns > 4'100 * kMs) late.push_back(s);
  CHECK(late.size() <= 1);
  CHECK(app.pose(ODO_TIME_LATEST).state == ODO_DEGRADED);
  CHECK(app.pose(ODO_TIME_LATEST).reason == ODO_REASON_SENSOR_SILENT);
}

TEST_CASE("while the camera is off there is the orientation, and the position is flagged unknown") {
  NeedyApp app;
  double turned = 0;
  odo_pose last{};
  for (int i = 0; i < 900; ++i) {
    const int64_t now_ns = (1000 + i * 10) * kMs;
    const bool off = i >= 300 && i < 700;
    const double gyro[3] = {0, off ? 0.5 : 0, 0}, accel[3] = {0, 9.81, 0};
    odo_session_push_imu(app.session, now_ns, gyro, accel);
    if (i % 10 == 0 && !off) app.frame(now_ns);
    if (i < 380 || i >= 700) continue;
    const odo_pose p = app.pose(now_ns + 30 * kMs);
    CHECK((p.header.flags & (ODO_POSE_ORIENTATION | ODO_POSE_POSITION)) == ODO_POSE_ORIENTATION);
    CHECK((p.header.flags & ODO_POSE_CAMERA) != 0);
    CHECK(p.state == ODO_LOST);
    if (i > 380) {
      double dot = 0;
      for (int k = 0; k < 4; ++k) dot += p.q_n[k] * last.q_n[k];
      const double step = 2 * std::acos(std::min(1.0, std::abs(dot)));
      CHECK(std::abs(step - 0.005) < 0.001);  // 0.5 rad/s over 10 ms: no repetition, no jump
      turned += step;
    }
    last = p;
  }
  CHECK(turned == doctest::Approx(0.5 * 3.19).epsilon(0.02));
  CHECK((app.pose(ODO_TIME_LATEST).header.flags & ODO_POSE_POSITION) != 0);
}

TEST_CASE("a frame that cannot be held is counted and reported with a reason" * doctest::skip(!kCameraPlugins)) {
  RunningApp app("odograph: 1\nattitude:\n  plugin: attitude/vqf\nvo_frontend:\n  plugin: vo/five_point\n");
  app.push(calibration(64, 48));
  app.walk(0, 10);
  static const std::vector<uint8_t> pixels(64 * 48, 90);
  auto f = grey_frame_at(1'050'000'000, pixels.data(), 64, 48);
  f.loan.retain = [](void*) -> int32_t { return ODO_E_EXHAUSTED; }, f.loan.release = [](void*) {};
  CHECK(app.push(f) == ODO_E_EXHAUSTED);
  app.flush();
  CHECK(app.statistics().overflow == 1);
  const auto told = std::find_if(app.reports.begin(), app.reports.end(),
                                 [](const odo_report& r) { return std::string(r.key) == "dropped_frame"; });
  REQUIRE(told != app.reports.end());
  CHECK(told->status == ODO_E_EXHAUSTED);
  CHECK(contains(told->text, "they arrive faster than they are processed"));
}
