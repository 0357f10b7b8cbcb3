// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <thread>

#include <odograph/odograph.h>

#include "sdk/host/messages/messages.hpp"
#include "tests/support/session_app.hpp"
#include "tests/support/messages.hpp"

TEST_SUITE_BEGIN("session");

TEST_CASE("steps and poses are computed from inertial samples, and the pose can be queried at any time") {
  RunningApp app(kWalk);
  CHECK(app.run(0, 3000) == ODO_OK);
  const auto s = app.statistics();
  CHECK(s.steps == Between{50, 60});
  CHECK(s.distance_m == doctest::Approx(0.7 * static_cast<double>(s.steps)).epsilon(0.1));
  CHECK(s.tracking_s > 25);
  odo_pose pose = app.pose(ODO_TIME_LATEST);
  CHECK((pose.header.flags & ODO_POSE_METRIC) != 0);
  odo_pose middle = app.pose(16'000'000'000);
  CHECK(middle.distance_m == Between{0.4 * pose.distance_m, pose.distance_m});
  CHECK(odo_session_get_pose(app.session, 900'000'000'000, &middle) == ODO_E_NOT_FOUND);
}

TEST_CASE("a replay is bit-identical, whatever the order of pushes between sensors") {
  App one(kWalk), other(kWalk);
  one.run(0, 2000);
  for (int i = 0; i < 2000; i += 50) other.run(i, i + 50);
  REQUIRE(one.events.size() > 1000);
  CHECK(one.events == other.events);
}

TEST_CASE("a live session with samples from several threads gives the replay's events") {
  App replay(kWalk), live(kWalk, ODO_RUN_LIVE);
  REQUIRE_MESSAGE(live.status == ODO_OK, live.message);
  replay.run(0, 1000);
  std::atomic<bool> stop{false};
  std::thread reader([&] {  // an app's render thread
    odo_pose pose{};
    while (!stop) {
      pose.header.struct_size = sizeof pose;
      odo_session_get_pose(live.session, ODO_TIME_LATEST, &pose);
      odo_error error{sizeof error, ODO_OK, {}};
      odo_session_last_error(live.session, &error);
    }
  });
  std::atomic<int64_t> now_ns{0};  // of the IMU: a sensor seconds ahead would make the others late
  std::thread barometer([&] {
    for (int i = 0; i < 200 && !stop; ++i) {
      while (now_ns < 1'000'000'000 + i * 50'000'000LL && !stop) std::this_thread::yield();
      live.push(pressure_at(1'000'000'000 + i * 50'000'000LL, 101325));
    }
  });
  for (int i = 0; i < 1000; i += 10) {
    live.walk(i, i + 10);
    now_ns = 1'000'000'000 + (i + 10) * 10'000'000LL;
  }
  now_ns = INT64_MAX;
  barometer.join();
  live.flush();
  odo_session_set_callback(live.session, nullptr, 0, nullptr, nullptr);
  stop = true;
  reader.join();
  const odo_statistics seen = live.statistics();
  CAPTURE(seen.late);
  CAPTURE(seen.overflow);
  CAPTURE(live.events.size());
  CAPTURE(replay.events.size());
  CHECK(live.events == replay.events);
}

TEST_CASE("a sensor that is permanently late is counted and does not affect the others") {
  App replay(kWalk), app(kWalk);
  replay.run(0, 1000);
  for (int i = 0; i < 1000; i += 10) {
    app.walk(i, i + 10);
    app.push(pressure_at(1'000'000'000 + (i - 300) * 10'000'000LL, 101325));
  }
  for (int i = 0; i < 200; ++i) {  // no further samples of the others
    app.push(pressure_at(8'000'000'000 + i * 1'000'000LL, 101325));
  }
  app.flush();
  CHECK(app.statistics().late > 250);
  CHECK(app.events == replay.events);
}

TEST_CASE("bad samples are counted, and the session recovers from them") {
  App app(kWalk);
  app.walk(0, 1000);
  const double nan3[3] = {std::numeric_limits<double>::quiet_NaN(), 0, 0}, zero[3] = {0, 0, 0};
  const double infinite[3] = {0, std::numeric_limits<double>::infinity(), 0};
  CHECK(odo_session_push_imu(app.session, 11'000'000'000, nan3, zero) == ODO_E_DISCARD);
  CHECK(odo_session_push_imu(app.session, 11'000'000'000, zero, infinite) == ODO_E_DISCARD);
  CHECK(odo_session_push_imu(app.session, 2'000'000'000, zero, zero) == ODO_E_DISCARD);        // far in the past
  CHECK(odo_session_push_imu(app.session, 999'000'000'000'000, zero, zero) == ODO_E_DISCARD);  // far ahead
  CHECK(odo_session_push_imu(app.session, 1'000'000'000 + 9'990'000'000, zero, zero) ==
        ODO_E_DISCARD);  // a repeated time
  auto s = app.statistics();
  CHECK(s.invalid == 3);
  CHECK(s.late == 1);
  CHECK(s.duplicate == 1);
  odo_error error = app.last_error();
  CHECK(error.status != ODO_OK);
  CHECK(contains(error.message, "imu"));
  CHECK(odo_session_last_error(app.session, &error) == ODO_OK);
  CHECK(error.status == ODO_OK);
  const auto steps = s.steps;
  app.walk(1600, 2600);  // six seconds of silence, then continues
  app.flush();
  s = app.statistics();
  CHECK(s.gaps == 1);
  CHECK(s.steps > steps + 14);
  odo_pose pose = app.pose(ODO_TIME_LATEST);
  CHECK(pose.state == ODO_TRACKING);
  for (const double x : pose.p_n) CHECK(std::isfinite(x));
}

TEST_CASE("steps return within two seconds after every sensor fault") {
  for (const std::string attitude : {"vqf", "magyq"}) {
    const std::string yaml =
        "odograph: 1\nattitude:\n  plugin: attitude/" + attitude + "\nstep_estimator:\n  plugin: step/odograph\n";
    enum Fault { silence, not_numbers, saturated, duplicated, reordered, jittered };
    for (const Fault fault : {silence, not_numbers, saturated, duplicated, reordered, jittered}) {
      CAPTURE(attitude);
      CAPTURE(static_cast<int>(fault));
      App app(yaml);
      const auto push = [&](int i, double scale, int64_t late_ns) {
        const double t = 0.01 * i;
        double gyro[3] = {0.05 * std::sin(6 * t), 0.01, 0.1 * std::sin(3 * t)};
        double accel[3] = {0.1, 9.81 + 2.2 * std::sin(2 * 3.14159265 * 1.9 * t), 0.4};
        for (double& x : accel) x = std::clamp(scale * x, -78.5, 78.5);
        for (double& x : gyro) x = std::clamp(scale * x, -34.9, 34.9);
        odo_session_push_imu(app.session, static_cast<int64_t>(t * 1e9) + 1'000'000'000 + late_ns, gyro, accel);
      };
      const double nan3[3] = {std::numeric_limits<double>::quiet_NaN(), 0, 0};
      app.walk(0, 2000);
      for (int i = 2000; i < 2400; ++i) {  // four seconds of it
        if (fault == not_numbers) odo_session_push_imu(app.session, i * 10'000'000LL + 1'000'000'000, nan3, nan3);
        if (fault == saturated) push(i, 1e5, 0);
        if (fault == duplicated) push(i, 1, 0), push(i, 1, 0);
        if (fault == reordered) push(i ^ 1, 1, 0);
        if (fault == jittered) push(i, 1, (i * 7919 % 100) * 200'000LL);
      }
      app.run(2400, 4000);
      std::vector<int64_t> ends;
      for (const odo_step& step : app.all<odo_step>(ODO_TYPE_STEP))
        if (step.t_start_ns > 25'000'000'000) ends.push_back(step.t_end_ns);
      REQUIRE(ends.size() > 2);
      CHECK(ends.front() < 27'000'000'000);  // a step that ended within two seconds of the fault's end
      CHECK(std::abs(static_cast<int>(ends.size()) - 29) < 4);  // the number walked from then on
      const auto s = app.statistics();
      if (fault == silence || fault == not_numbers) CHECK(s.gaps == 1);
      if (fault == not_numbers) CHECK(s.invalid == 400);
      if (fault == duplicated) CHECK(s.duplicate == 400);
      odo_pose pose = app.pose(ODO_TIME_LATEST);
      for (const double x : pose.p_n) CHECK(std::isfinite(x));
      CHECK(pose.state == ODO_TRACKING);
    }
  }
}

TEST_CASE("a sensor clock that is set back restarts the session") {
  App app(kWalk);
  app.walk(5000, 6000);
  app.run(0, 1000);
  CHECK(app.statistics().steps > 25);
  CHECK(app.statistics().late < 100);
}

TEST_CASE("a config's camera takes precedence over pushed calibrations, and needs none" *
          doctest::skip(!kCameraPlugins)) {
  const TemporaryFolder folder;
  const auto file = write_text(folder / "camera.yaml",
                               "width: 64\nheight: 48\nfx: 60\nfy: 60\ncx: 31.5\ncy: 23.5\ntime_offset: 30 ms\n");
  for (const bool pushed : {false, true}) {
    CAPTURE(pushed);
    App app(kCamera + "camera: " + file.string() + "\n");
    const auto wrong = calibration(320, 240);
    if (pushed) CHECK(app.push(wrong) == ODO_OK);
    app.walk(0, 20);
    const std::vector<uint8_t> pixels(64 * 48, 90);
    for (int i = 0; i < 3; ++i) {
      CHECK(app.push(grey_frame_at(1'200'000'000 + i * 100'000'000LL, pixels.data(), 64, 48)) == ODO_OK);
    }
    app.run(20, 50);
    odo_pose pose = app.pose(1'430'000'000);
    CHECK((pose.header.flags & ODO_POSE_CAMERA) != 0);
    odo_error error = app.last_error();
    CHECK_FALSE(contains(error.message, "calibration"));  // every frame had the right size
  }
}

TEST_CASE("too many waiting frames are rejected, not queued" * doctest::skip(!kCameraPlugins)) {
  App app(kCamera + "time_ordering:\n  frames: 3\n  max_wait: 5 s\n");
  app.push(calibration(64, 48));
  app.walk(0, 10);
  std::vector<uint8_t> pixels(64 * 48, 90);
  int refused = 0;
  for (int i = 0; i < 10; ++i) {
    auto f = grey_frame_at(1'200'000'000 + i * 50'000'000LL, pixels.data(), 64, 48);
    if (app.push(f) == ODO_E_EXHAUSTED) ++refused;
  }
  CHECK(refused == 7);
  CHECK(app.statistics().overflow == 7);
}

TEST_CASE("an estimator or a scale source is exchanged by one line of YAML" * doctest::skip(!kCameraPlugins)) {
  const auto steps_of = [](std::string yaml) {
    RunningApp app(yaml);
    app.run(0, 2000);
    return app.statistics();
  };
  std::string swapped = kWalk;
  swapped.replace(swapped.find("step/renaudin2012"), 17, "step/weinberg2002");
  const auto a = steps_of(kWalk), b = steps_of(swapped);
  CHECK(a.steps == b.steps);
  CHECK(a.distance_m != b.distance_m);
  std::string fixed = kCamera;
  fixed.replace(fixed.find("scale/step_length"), 17, "scale/fixed_step");
  CHECK(App(fixed).status == ODO_OK);
}
