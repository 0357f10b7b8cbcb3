// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include <odograph/odograph.h>

#include "sdk/core/messages.hpp"
#include "tests/support.hpp"

using namespace odograph;

TEST_SUITE_BEGIN("session");

namespace {

const std::string kWalk =
    "odograph: 1\nattitude:\n  plugin: attitude/vqf\nstep_estimator:\n  plugin: step/renaudin2012\n";
const std::string kCamera =
    kWalk + "vo_frontend:\n  plugin: vo/five_point\nscale_source:\n  plugin: scale/step_length\n";

/// A session of the C API with everything that it says.
class App {
 public:
  explicit App(const std::string& yaml, uint32_t run = ODO_RUN_REPLAY) {
    odo_session_options o{};
    o.struct_size = sizeof o;
    o.run = run;
    o.config_text = {yaml.data(), yaml.size()};
    const std::string folder = plugin_folder().string();
    o.plugin_path = {folder.data(), folder.size()};
    odo_error error{};
    error.struct_size = sizeof error;
    status = odo_session_create(&o, &session, &error);
    message = error.message;
    if (session) odo_session_set_callback(session, 0xFFFFFFFFu, on_event, this);
  }
  ~App() { odo_session_destroy(session); }
  App(const App&) = delete;

  int32_t walk(int from, int to, double hz = 100) {
    int32_t worst = ODO_OK;
    for (int i = from; i < to; ++i) {
      const double t = i / hz;
      const double gyro[3] = {0.05 * std::sin(6 * t), 0.01, 0.1 * std::sin(3 * t)};
      const double accel[3] = {0.1, 9.81 + 2.2 * std::sin(2 * 3.14159265 * 1.9 * t), 0.4};
      worst =
          std::min(worst, odo_session_push_imu(session, static_cast<int64_t>(t * 1e9) + 1'000'000'000, gyro, accel));
    }
    return worst;
  }
  odo_statistics statistics() const {
    odo_statistics s{};
    s.struct_size = sizeof s;
    CHECK(odo_session_get_statistics(session, &s) == ODO_OK);
    return s;
  }

  odo_session* session = nullptr;
  int32_t status;
  std::string message;
  std::vector<std::string> events;  // the bytes of every event
  std::atomic<int> poses{0};

 private:
  static void on_event(void* user, const odo_header* event) {
    auto& self = *static_cast<App*>(user);
    self.events.emplace_back(reinterpret_cast<const char*>(event), event->struct_size);
    if (event->type == ODO_TYPE_POSE) {
      ++self.poses;
      odo_pose pose{};  // a callback may ask for the pose and for statistics
      pose.header.struct_size = sizeof pose;
      odo_session_get_pose(self.session, ODO_TIME_LATEST, &pose);
      self.statistics();
    }
  }
};

odo_calibration calibration(uint32_t width, uint32_t height) {
  auto c = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 1'000'000'000);
  c.model = ODO_CAMERA_PINHOLE;
  c.width = width, c.height = height;
  c.fx = c.fy = width, c.cx = width / 2.0, c.cy = height / 2.0;
  return c;
}

}  // namespace

TEST_CASE("a bad call is a status and a sentence, never a crash") {
  odo_session* session = nullptr;
  odo_error error{};
  error.struct_size = sizeof error;
  odo_session_options options{};
  CHECK(odo_session_create(nullptr, &session, &error) == ODO_E_ARGUMENT);
  CHECK(odo_session_create(&options, &session, &error) == ODO_E_STRUCT_SIZE);
  options.struct_size = sizeof options;
  CHECK(odo_session_create(&options, &session, &error) == ODO_E_ARGUMENT);
  CHECK(std::string(error.message).find("exactly one") != std::string::npos);
  const std::string missing = "/nowhere/pipeline.yaml";
  options.config_path = {missing.data(), missing.size()};
  CHECK(odo_session_create(&options, &session, &error) == ODO_E_NOT_FOUND);
  CHECK(std::string(error.message).find("/nowhere/pipeline.yaml:1:1") != std::string::npos);
  CHECK(session == nullptr);
  odo_session_destroy(nullptr);
  CHECK(odo_session_push(nullptr, nullptr) == ODO_E_ARGUMENT);
  CHECK(odo_session_flush(nullptr) == ODO_E_ARGUMENT);
  odo_pose pose{};
  App app(kWalk);
  REQUIRE_MESSAGE(app.status == ODO_OK, app.message);
  CHECK(odo_session_get_pose(app.session, 0, &pose) == ODO_E_STRUCT_SIZE);
  pose.header.struct_size = sizeof pose;
  CHECK(odo_session_get_pose(app.session, 0, &pose) == ODO_NOT_READY);
  odo_header header{};
  CHECK(odo_session_push(app.session, &header) == ODO_E_STRUCT_SIZE);
  header.struct_size = sizeof header;
  header.type = 999;
  CHECK(odo_session_push(app.session, &header) == ODO_E_UNSUPPORTED);
  header.type = ODO_TYPE_IMU;
  CHECK(odo_session_push(app.session, &header) == ODO_E_STRUCT_SIZE);
  double geodetic[3];
  const double p[3] = {0, 0, 0};
  CHECK(odo_session_to_geodetic(app.session, p, geodetic) == ODO_NOT_READY);
  CHECK(std::string(odo_version()).size() >= 5);
  CHECK(odo_abi_version() == (ODO_ABI_MAJOR << 16 | ODO_ABI_MINOR));
  for (int32_t s = -20; s < 5; ++s) CHECK(odo_status_text(s) != nullptr);
}

TEST_CASE("steps and poses come out of inertial samples, and the pose can be asked for at any time") {
  App app(kWalk);
  REQUIRE_MESSAGE(app.status == ODO_OK, app.message);
  CHECK(app.walk(0, 3000) == ODO_OK);
  odo_session_flush(app.session);
  const auto s = app.statistics();
  CHECK(s.steps > 50);
  CHECK(s.steps < 60);
  CHECK(s.distance_m == doctest::Approx(0.7 * static_cast<double>(s.steps)).epsilon(0.1));
  CHECK(s.tracking_s > 25);
  odo_pose pose{};
  pose.header.struct_size = sizeof pose;
  CHECK(odo_session_get_pose(app.session, ODO_TIME_LATEST, &pose) == ODO_OK);
  CHECK((pose.header.flags & ODO_POSE_METRIC) != 0);
  odo_pose middle{};
  middle.header.struct_size = sizeof middle;
  CHECK(odo_session_get_pose(app.session, 16'000'000'000, &middle) == ODO_OK);
  CHECK(middle.distance_m < pose.distance_m);
  CHECK(middle.distance_m > 0.4 * pose.distance_m);
  CHECK(odo_session_get_pose(app.session, 900'000'000'000, &middle) == ODO_E_NOT_FOUND);
}

TEST_CASE("replay is deterministic to the bit, however the pushes are cut") {
  App one(kWalk), other(kWalk);
  one.walk(0, 2000);
  odo_session_flush(one.session);
  for (int i = 0; i < 2000; i += 50) other.walk(i, i + 50);
  odo_session_flush(other.session);
  REQUIRE(one.events.size() > 1000);
  CHECK(one.events == other.events);
}

TEST_CASE("a live session with samples from several threads gives the replay's events") {
  App replay(kWalk), live(kWalk, ODO_RUN_LIVE);
  REQUIRE_MESSAGE(live.status == ODO_OK, live.message);
  replay.walk(0, 1000);
  odo_session_flush(replay.session);
  std::atomic<bool> stop{false};
  std::thread reader([&] {  // an app's render thread
    odo_pose pose{};
    while (!stop) {
      pose.header.struct_size = sizeof pose;
      odo_session_get_pose(live.session, ODO_TIME_LATEST, &pose);
      odo_error error{};
      error.struct_size = sizeof error;
      odo_session_last_error(live.session, &error);
    }
  });
  std::atomic<int64_t> now_ns{0};  // of the IMU: a sensor that ran seconds ahead would make the others late
  std::thread barometer([&] {
    for (int i = 0; i < 200 && !stop; ++i) {
      while (now_ns < 1'000'000'000 + i * 50'000'000LL && !stop) std::this_thread::yield();
      auto b = make_message<odo_barometer>(ODO_TYPE_BAROMETER, 1'000'000'000 + i * 50'000'000LL);
      b.pressure_pa = 101325;
      odo_session_push(live.session, &b.header);
    }
  });
  for (int i = 0; i < 1000; i += 10) {
    live.walk(i, i + 10);
    now_ns = 1'000'000'000 + (i + 10) * 10'000'000LL;
  }
  now_ns = INT64_MAX;
  barometer.join();
  odo_session_flush(live.session);
  odo_session_set_callback(live.session, 0, nullptr, nullptr);
  stop = true;
  reader.join();
  const odo_statistics seen = live.statistics();
  CAPTURE(seen.late);
  CAPTURE(seen.overflow);
  CAPTURE(live.events.size());
  CAPTURE(replay.events.size());
  CHECK(live.events == replay.events);
}

TEST_CASE("a sensor that is late for good is counted, and costs the others nothing") {
  App replay(kWalk), app(kWalk);
  replay.walk(0, 1000);
  odo_session_flush(replay.session);
  for (int i = 0; i < 1000; i += 10) {
    app.walk(i, i + 10);
    auto b = make_message<odo_barometer>(ODO_TYPE_BAROMETER, 1'000'000'000 + (i - 300) * 10'000'000LL);
    b.pressure_pa = 101325;
    odo_session_push(app.session, &b.header);
  }
  for (int i = 0; i < 200; ++i) {  // nothing else comes any more
    auto b = make_message<odo_barometer>(ODO_TYPE_BAROMETER, 8'000'000'000 + i * 1'000'000LL);
    b.pressure_pa = 101325;
    odo_session_push(app.session, &b.header);
  }
  odo_session_flush(app.session);
  CHECK(app.statistics().late > 250);
  CHECK(app.events == replay.events);
}

TEST_CASE("bad samples are counted, survived and recovered from") {
  App app(kWalk);
  app.walk(0, 1000);
  const double nan3[3] = {std::numeric_limits<double>::quiet_NaN(), 0, 0}, zero[3] = {0, 0, 0};
  const double infinite[3] = {0, std::numeric_limits<double>::infinity(), 0};
  CHECK(odo_session_push_imu(app.session, 11'000'000'000, nan3, zero) == ODO_E_DISCARD);
  CHECK(odo_session_push_imu(app.session, 11'000'000'000, zero, infinite) == ODO_E_DISCARD);
  CHECK(odo_session_push_imu(app.session, 2'000'000'000, zero, zero) == ODO_E_DISCARD);        // long past
  CHECK(odo_session_push_imu(app.session, 999'000'000'000'000, zero, zero) == ODO_E_DISCARD);  // far ahead
  CHECK(odo_session_push_imu(app.session, 1'000'000'000 + 9'990'000'000, zero, zero) ==
        ODO_E_DISCARD);  // twice the same time
  auto s = app.statistics();
  CHECK(s.invalid == 3);
  CHECK(s.late == 1);
  CHECK(s.duplicate == 1);
  odo_error error{};
  error.struct_size = sizeof error;
  CHECK(odo_session_last_error(app.session, &error) != ODO_OK);
  CHECK(std::string(error.message).find("imu") != std::string::npos);
  CHECK(odo_session_last_error(app.session, &error) == ODO_OK);
  const auto steps = s.steps;
  app.walk(1600, 2600);  // six seconds of silence, then on
  odo_session_flush(app.session);
  s = app.statistics();
  CHECK(s.gaps == 1);
  CHECK(s.steps > steps + 14);
  odo_pose pose{};
  pose.header.struct_size = sizeof pose;
  CHECK(odo_session_get_pose(app.session, ODO_TIME_LATEST, &pose) == ODO_OK);
  CHECK(pose.state == ODO_TRACKING);
  for (const double x : pose.p_n) CHECK(std::isfinite(x));
}

TEST_CASE("steps come back within two seconds of every fault of the sensor") {
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
      app.walk(2400, 4000);
      odo_session_flush(app.session);
      std::vector<int64_t> ends;
      for (const std::string& bytes : app.events) {
        odo_step step;
        if (reinterpret_cast<const odo_header*>(bytes.data())->type != ODO_TYPE_STEP) continue;
        std::memcpy(&step, bytes.data(), std::min(sizeof step, bytes.size()));
        if (step.t_start_ns > 25'000'000'000) ends.push_back(step.t_end_ns);
      }
      REQUIRE(ends.size() > 2);
      CHECK(ends.front() < 27'000'000'000);  // a step that ended within two seconds of the fault's end
      CHECK(std::abs(static_cast<int>(ends.size()) - 29) < 4);  // and no more, no fewer than were walked from then on
      const auto s = app.statistics();
      if (fault == silence || fault == not_numbers) CHECK(s.gaps == 1);
      if (fault == not_numbers) CHECK(s.invalid == 400);
      if (fault == duplicated) CHECK(s.duplicate == 400);
      odo_pose pose{};
      pose.header.struct_size = sizeof pose;
      CHECK(odo_session_get_pose(app.session, ODO_TIME_LATEST, &pose) == ODO_OK);
      for (const double x : pose.p_n) CHECK(std::isfinite(x));
      CHECK(pose.state == ODO_TRACKING);
    }
  }
}

TEST_CASE("position fixes teach the step estimator the walker's step length") {
  const std::string yaml =
      "odograph: 1\nattitude:\n  plugin: attitude/vqf\nstep_estimator:\n  plugin: step/odograph\n"
      "absolute_fixers:\n  - plugin: fix/waypoint\n    parameters: {use: all}\ncoupling:\n  fix_gate: 0\n";
  // Where the walker would be with his model's steps; the marks say that each is a tenth longer.
  App model(yaml);
  model.walk(0, 12000);
  odo_session_flush(model.session);
  std::vector<odo_waypoint> marks;
  double walked_m = 0;
  const odo_pose* last = nullptr;
  for (const std::string& bytes : model.events) {
    const auto* pose = reinterpret_cast<const odo_pose*>(bytes.data());
    if (pose->header.type != ODO_TYPE_POSE) continue;
    if (last) walked_m += std::hypot(pose->p_n[0] - last->p_n[0], pose->p_n[1] - last->p_n[1]);
    last = pose;
    if (walked_m < 12.0 * static_cast<double>(marks.size())) continue;
    auto mark = make_message<odo_waypoint>(ODO_TYPE_WAYPOINT, pose->header.t_ns);
    for (int k = 0; k < 3; ++k) mark.p_n[k] = 1.1 * pose->p_n[k];
    marks.push_back(mark);
  }
  REQUIRE(marks.size() > 5);
  App app(yaml);
  size_t next = 0;
  const auto mean_step_m = [&](int from, int to) {
    app.events.clear();
    for (int i = from; i < to; ++i) {
      app.walk(i, i + 1);
      while (next < marks.size() && marks[next].header.t_ns <= i * 10'000'000LL + 1'000'000'000)
        odo_session_push(app.session, &marks[next++].header);
    }
    odo_session_flush(app.session);
    double sum = 0;
    int n = 0;
    for (const std::string& bytes : app.events) {
      odo_step step;
      if (reinterpret_cast<const odo_header*>(bytes.data())->type != ODO_TYPE_STEP) continue;
      std::memcpy(&step, bytes.data(), std::min(sizeof step, bytes.size()));
      sum += step.length_m, ++n;
    }
    return sum / std::max(1, n);
  };
  const double before_m = mean_step_m(0, 1000), after_m = mean_step_m(1000, 12000);
  mean_step_m(12000, 12001);
  CHECK(app.statistics().fixes_accepted > 5);
  const double last_m = mean_step_m(12001, 13000);
  CHECK(last_m > 1.06 * before_m);
  CHECK(last_m < 1.13 * before_m);
  CHECK(after_m > before_m);
}

TEST_CASE("a camera that knows the metre teaches the step estimator too") {
  // The system made for the tests of vo/vit goes a metre a second; by his steps' model the walker goes 1.08.
  App app(std::string("odograph: 1\nattitude:\n  plugin: attitude/vqf\nstep_estimator:\n  plugin: step/odograph\n") +
          "vo_frontend:\n  plugin: vo/vit\n  parameters: {library: " + ODOGRAPH_TEST_VIT + ", wait: 5 s}\n");
  REQUIRE_MESSAGE(app.session, app.message);
  const auto c = calibration(64, 48);
  odo_session_push(app.session, &c.header);
  std::vector<uint8_t> pixels(64 * 48);
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<uint8_t>(i * 37);
  for (int i = 0; i < 15000; ++i) {
    app.walk(i, i + 1);
    if (i % 10 != 5) continue;
    auto f = make_message<odo_frame>(ODO_TYPE_FRAME, i * 10'000'000LL + 1'000'000'000);
    f.format = ODO_FORMAT_GREY8;
    f.width = 64, f.height = 48;
    f.planes[0] = {pixels.data(), 64, 1, 0};
    odo_session_push(app.session, &f.header);
  }
  odo_session_flush(app.session);
  std::vector<double> lengths;
  for (const std::string& bytes : app.events)
    if (odo_step step; reinterpret_cast<const odo_header*>(bytes.data())->type == ODO_TYPE_STEP) {
      std::memcpy(&step, bytes.data(), std::min(sizeof step, bytes.size()));
      lengths.push_back(step.length_m);
    }
  REQUIRE(lengths.size() > 250);
  const auto speed = [&](size_t from, size_t to) {
    double sum = 0;
    for (size_t i = from; i < to; ++i) sum += lengths[i];
    return 1.9 * sum / static_cast<double>(to - from);
  };
  CHECK(speed(0, 20) > 1.05);
  CHECK(speed(lengths.size() - 20, lengths.size()) == doctest::Approx(1.0).epsilon(0.025));
}

TEST_CASE("what a session has learnt goes on in the next one") {
  const std::string yaml = "odograph: 1\nattitude:\n  plugin: attitude/vqf\nstep_estimator:\n  plugin: step/odograph\n";
  const auto saved = [](const App& app) {
    std::string blob(static_cast<size_t>(odo_session_save(app.session, nullptr, 0)), ' ');
    CHECK(odo_session_save(app.session, blob.data(), blob.size()) == static_cast<int64_t>(blob.size()));
    return blob;
  };
  const auto walked_m = [](App& app) {
    app.walk(0, 2000);
    odo_session_flush(app.session);
    return app.statistics().distance_m;
  };
  App before(yaml + "  parameters: {factor: 1.2}\n");  // as if it had been learnt
  const std::string blob = saved(before);
  CHECK(blob.find("step/odograph") != std::string::npos);
  App plain(yaml), next(yaml);
  CHECK(odo_session_load(next.session, blob.data(), blob.size()) == ODO_OK);
  CHECK(saved(next) == blob);
  const double next_m = walked_m(next), plain_m = walked_m(plain);
  CHECK(next_m == doctest::Approx(1.2 * plain_m).epsilon(0.01));

  for (size_t i = 0; i < blob.size(); ++i) {  // whatever is damaged, nothing is taken
    std::string damaged = blob;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    CHECK(odo_session_load(plain.session, damaged.data(), damaged.size()) == ODO_E_DATA);
    CHECK(odo_session_load(plain.session, blob.data(), i) == ODO_E_DATA);
  }
  CHECK(saved(plain) == saved(App(yaml)));
  App other(kWalk);  // another estimator's is passed over
  CHECK(odo_session_load(other.session, blob.data(), blob.size()) == ODO_OK);
  CHECK(odo_session_load(nullptr, blob.data(), blob.size()) == ODO_E_ARGUMENT);

  next.walk(0, 100);  // a clock that was set back: the walker is the same
  for (int i = 0; i < 60; ++i) next.walk(i, i + 1);
  CHECK(saved(next) == blob);
}

TEST_CASE("a sensor clock that is set back starts the session anew") {
  App app(kWalk);
  app.walk(5000, 6000);
  app.walk(0, 1000);
  odo_session_flush(app.session);
  CHECK(app.statistics().steps > 25);
  CHECK(app.statistics().late < 100);
}

TEST_CASE("a frame is held without a copy while it waits, and given back exactly once") {
  static std::atomic<int> holds{0};
  static std::atomic<int> releases{0};
  holds = releases = 0;
  std::vector<uint8_t> pixels(64 * 48, 100);
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<uint8_t>((i * 7919) >> 3);
  {
    App app(kCamera);
    REQUIRE_MESSAGE(app.status == ODO_OK, app.message);
    const auto c = calibration(64, 48);
    CHECK(odo_session_push(app.session, &c.header) == ODO_OK);
    app.walk(0, 100);
    for (int i = 0; i < 20; ++i) {
      auto f = make_message<odo_frame>(ODO_TYPE_FRAME, 1'000'000'000 + i * 50'000'000LL);
      f.format = ODO_FORMAT_GREY8;
      f.width = 64, f.height = 48;
      f.planes[0] = {pixels.data(), 64, 1, 0};
      f.retain = [](const odo_frame*) -> int32_t { return ++holds, ODO_OK; };
      f.release = [](const odo_frame*) { ++releases; };
      const int32_t status = odo_session_push(app.session, &f.header);
      CHECK((status == ODO_OK || status == ODO_E_DISCARD));
      if (i % 2 == 0) {  // a frame that cannot be kept is copied instead
        f.header.t_ns += 25'000'000;
        f.retain = nullptr, f.release = nullptr;
        odo_session_push(app.session, &f.header);
      }
    }
    auto bad = make_message<odo_frame>(ODO_TYPE_FRAME, 5'000'000'000);
    CHECK(odo_session_push(app.session, &bad.header) == ODO_E_DISCARD);  // no pixels, no size
  }
  CHECK(holds > 0);
  CHECK(holds == releases);
}

TEST_CASE("a camera's time offset brings its frames onto the IMU's clock") {
  App app(kCamera);
  auto c = calibration(64, 48);
  c.header.flags = ODO_CALIBRATION_TIME_OFFSET;
  c.time_offset_ns = 30'000'000;
  odo_session_push(app.session, &c.header);
  app.walk(0, 20);
  const std::vector<uint8_t> pixels(64 * 48, 90);
  auto f = make_message<odo_frame>(ODO_TYPE_FRAME, 1'200'000'000);
  f.format = ODO_FORMAT_GREY8;
  f.width = 64, f.height = 48;
  f.planes[0] = {pixels.data(), 64, 1, 0};
  CHECK(odo_session_push(app.session, &f.header) == ODO_OK);
  app.walk(20, 50);
  odo_session_flush(app.session);
  odo_pose pose{};
  pose.header.struct_size = sizeof pose;
  CHECK(odo_session_get_pose(app.session, 1'230'000'000, &pose) == ODO_OK);
  CHECK(pose.header.t_ns == 1'230'000'000);
  CHECK((pose.header.flags & ODO_POSE_CAMERA) != 0);
}

TEST_CASE("a config's camera stands above what is pushed, and needs nothing to be pushed") {
  const TemporaryFolder folder;
  const auto file = write_text(folder / "camera.yaml",
                               "width: 64\nheight: 48\nfx: 60\nfy: 60\ncx: 31.5\ncy: 23.5\ntime_offset: 30 ms\n");
  for (const bool pushed : {false, true}) {
    CAPTURE(pushed);
    App app(kCamera + "camera: " + file.string() + "\n");
    const auto wrong = calibration(320, 240);
    if (pushed) CHECK(odo_session_push(app.session, &wrong.header) == ODO_OK);
    app.walk(0, 20);
    const std::vector<uint8_t> pixels(64 * 48, 90);
    for (int i = 0; i < 3; ++i) {
      auto f = make_message<odo_frame>(ODO_TYPE_FRAME, 1'200'000'000 + i * 100'000'000LL);
      f.format = ODO_FORMAT_GREY8;
      f.width = 64, f.height = 48;
      f.planes[0] = {pixels.data(), 64, 1, 0};
      CHECK(odo_session_push(app.session, &f.header) == ODO_OK);
    }
    app.walk(20, 50);
    odo_session_flush(app.session);
    odo_pose pose{};
    pose.header.struct_size = sizeof pose;
    CHECK(odo_session_get_pose(app.session, 1'430'000'000, &pose) == ODO_OK);
    CHECK((pose.header.flags & ODO_POSE_CAMERA) != 0);
    odo_error error{};
    error.struct_size = sizeof error;
    odo_session_last_error(app.session, &error);
    CHECK(std::string(error.message).find("calibration") == std::string::npos);  // every frame was of the right size
  }
}

TEST_CASE("too many waiting frames are refused, not piled up") {
  App app(kCamera + "time_ordering:\n  frames: 3\n  max_wait: 5 s\n");
  const auto c = calibration(64, 48);
  odo_session_push(app.session, &c.header);
  app.walk(0, 10);
  std::vector<uint8_t> pixels(64 * 48, 90);
  int refused = 0;
  for (int i = 0; i < 10; ++i) {
    auto f = make_message<odo_frame>(ODO_TYPE_FRAME, 1'200'000'000 + i * 50'000'000LL);
    f.format = ODO_FORMAT_GREY8;
    f.width = 64, f.height = 48;
    f.planes[0] = {pixels.data(), 64, 1, 0};
    if (odo_session_push(app.session, &f.header) == ODO_E_EXHAUSTED) ++refused;
  }
  CHECK(refused == 7);
  CHECK(app.statistics().overflow == 7);
}

TEST_CASE("swapping an estimator or a scale source is one line of YAML") {
  const auto steps_of = [](std::string yaml) {
    App app(yaml);
    REQUIRE_MESSAGE(app.status == ODO_OK, app.message);
    app.walk(0, 2000);
    odo_session_flush(app.session);
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

TEST_SUITE_END();
