// SPDX-License-Identifier: Apache-2.0
//
// Details of a session's interaction with plugins and app: calibrations, sizes, flags, states, reports, saved names.
#include <cfenv>
#include <chrono>
#include <thread>

#include <odograph/odograph.h>

#include "tests/support/obeys.hpp"
#include "tests/support/session_app.hpp"
#include "tests/support/test_plugins.hpp"
#include "tests/support/messages.hpp"

TEST_SUITE_BEGIN("session_details");

namespace {

const std::string kListens = "odograph: 1\nvo_frontend: {plugin: test/listens}\n";

/// The plugin's inputs of a type.
template <class Message>
std::vector<Message> given(const App& app, uint32_t type) {
  std::vector<Message> all;
  for (const std::string& bytes : app.events) {
    odo_header head;
    std::memcpy(&head, bytes.data(), sizeof head);
    if (head.type != ODO_TYPE_VENDOR(0, ODO_VENDOR_EVENT | 2)) continue;
    std::memcpy(&head, bytes.data() + sizeof head, sizeof head);
    if (head.type != type) continue;
    std::memcpy(static_cast<void*>(&all.emplace_back()), bytes.data() + sizeof head,
                std::min(sizeof(Message), bytes.size() - sizeof head));
  }
  return all;
}

int32_t push_frame(App& app, int64_t t_ns, uint32_t width, uint32_t height, uint32_t flags = 0, int64_t line_ns = 0) {
  static const std::vector<uint8_t> pixels(100 * 100, 90);
  auto f = grey_frame_at(t_ns, pixels.data(), width, height);
  f.header.flags = flags, f.line_time_ns = line_ns, f.fx = f.fy = 50;
  return app.push(f);
}

/// A message for `test/echo`, which emits its content.
template <class Event>
void echo(App& app, Event event, int64_t t_ns) {
  struct {
    odo_header head;
    Event event;
  } told{};
  event.header.t_ns = t_ns;
  told.head = event.header;
  told.head.struct_size = sizeof told, told.head.type = ODO_TYPE_VENDOR(0, 1);
  told.event = event;
  odo_session_push(app.session, &told.head);
  app.flush();
}

}  // namespace

TEST_CASE(
    "mount, time offset and row time each come from the config if it has them, else from the pushed calibration") {
  const TestPlugins plugins{"listens"};
  constexpr uint32_t kMount = ODO_CALIBRATION_EXTRINSICS, kOffset = ODO_CALIBRATION_TIME_OFFSET,
                     kRows = ODO_CALIBRATION_LINE_TIME;
  for (uint32_t own = 0; own < 8; ++own)
    for (uint32_t pushed = 0; pushed < 8; ++pushed) {
      CAPTURE(own);
      CAPTURE(pushed);
      const TemporaryFolder folder;
      const auto lens =
          write_text(folder / "lens.yaml", std::string("width: 64\nheight: 48\nfx: 70\nfy: 70\ncx: 32\ncy: 24\n") +
                                               (own & kMount ? "p_b_c: [1, 0, 0]\n" : "") +
                                               (own & kOffset ? "time_offset: 10 ms\n" : "") +
                                               (own & kRows ? "row_time: 10 us\n" : ""));
      RunningApp app(kListens + "camera: " + lens.string() + "\n", ODO_RUN_REPLAY, plugins.path());
      auto c = calibration(64, 48);
      c.header.flags = pushed;
      c.q_b_c[0] = 1, c.p_b_c[1] = 2, c.time_offset_ns = 20'000'000, c.line_time_ns = 20'000;
      CHECK(app.push(c) == ODO_OK);
      CHECK(push_frame(app, 2'000'000'000, 64, 48) == ODO_OK);
      CHECK(push_frame(app, 2'100'000'000, 64, 48, ODO_FRAME_LINE_TIME, 5'000) == ODO_OK);
      app.flush();
      const auto cameras = given<odo_calibration>(app, ODO_TYPE_CALIBRATION);
      const auto frames = given<odo_frame>(app, ODO_TYPE_FRAME);
      REQUIRE(!cameras.empty());
      REQUIRE(frames.size() == 2);
      const odo_calibration& got = cameras.back();
      const auto from = [&](uint32_t flag, int64_t config, int64_t app_s) {
        return own & flag ? config : pushed & flag ? app_s : 0;
      };
      CHECK(got.header.flags == ((own | pushed) & ~kOffset));  // the host applies the offset itself
      CHECK(got.time_offset_ns == 0);
      CHECK(got.fx == 70);  // always the config's lens
      if ((own | pushed) & kMount) CHECK(got.p_b_c[own & kMount ? 0 : 1] == (own & kMount ? 1 : 2));
      CHECK(frames[0].header.t_ns == 2'000'000'000 + from(kOffset, 10'000'000, 20'000'000));
      CHECK(((frames[0].header.flags & ODO_FRAME_LINE_TIME) != 0) == (((own | pushed) & kRows) != 0));
      CHECK(frames[0].line_time_ns == from(kRows, 10'000, 20'000));
      // The frame takes precedence over an app's calibration.
      CHECK(frames[1].line_time_ns == (own & kRows ? 10'000 : 5'000));
    }
}

TEST_CASE("after a clock that was set back each camera and each IMU is described again, by its last calibration") {
  const TestPlugins plugins{"listens"};
  RunningApp app(kListens, ODO_RUN_REPLAY, plugins.path());
  for (const uint32_t id : {1u, 2u, 1u}) {
    auto c = calibration(64, 48);
    app.walk(0, 1);
    c.header.source = id, c.fx = 100 * id + 1;
    app.push(c);
  }
  for (const uint32_t source : {1u, 2u}) {
    auto noise = make_message<odo_imu_noise>(ODO_TYPE_IMU_NOISE, 1'000'000'000);
    noise.header.source = source, noise.gyro_noise = source;
    app.push(noise);
  }
  app.run(1000, 1100);
  app.events.clear();
  app.run(0, 200);
  const auto cameras = given<odo_calibration>(app, ODO_TYPE_CALIBRATION);
  const auto noises = given<odo_imu_noise>(app, ODO_TYPE_IMU_NOISE);
  REQUIRE(cameras.size() == 2);
  CHECK(
      (cameras[0].header.source == 1 && cameras[0].fx == 101 && cameras[1].header.source == 2 && cameras[1].fx == 201));
  REQUIRE(noises.size() == 2);
  CHECK((noises[0].gyro_noise == 1 && noises[1].gyro_noise == 2));
  CHECK(app.statistics().events_dropped == 0);  // no plugin receives its own events
}

TEST_CASE("a frame has the size of its camera's calibration in both dimensions, or its own intrinsics") {
  const TestPlugins plugins{"listens"};
  RunningApp app(kListens, ODO_RUN_REPLAY, plugins.path());
  CHECK(push_frame(app, 900'000'000, 10, 10) == ODO_OK);  // the lens is unknown
  app.push(calibration(64, 48));
  int64_t t_ns = 1'000'000'000;
  for (const auto& [w, h] : {std::pair{64u, 48u}, {64u, 47u}, {63u, 48u}, {48u, 64u}}) {
    CHECK(push_frame(app, t_ns += 10'000'000, w, h) == (w == 64 && h == 48 ? ODO_OK : ODO_E_DISCARD));
    CHECK(push_frame(app, t_ns += 10'000'000, w, h, ODO_FRAME_INTRINSICS) == ODO_OK);
  }
}

TEST_CASE("only the host sets the accepted flag of a plugin's event") {
  const TestPlugins plugins{"echo"};
  RunningApp app("odograph: 1\nvo_frontend: {plugin: test/echo}\n", ODO_RUN_REPLAY, plugins.path());
  auto scale = make_message<odo_scale>(ODO_TYPE_SCALE, 0);
  scale.header.flags = ODO_FLAG_ACCEPTED | ODO_SCALE_STEADY;
  scale.scale = 1, scale.sigma = 0.1;
  echo(app, scale, 1'000'000'000);
  auto fix = make_message<odo_fix>(ODO_TYPE_FIX, 0);
  fix.header.flags = ODO_FLAG_ACCEPTED;
  echo(app, fix, 2'000'000'000);
  const auto scales = app.all<odo_scale>(ODO_TYPE_SCALE);
  const auto fixes = app.all<odo_fix>(ODO_TYPE_FIX);
  REQUIRE((scales.size() == 1 && fixes.size() == 1));
  CHECK(scales[0].header.flags == ODO_SCALE_STEADY);
  CHECK(fixes[0].header.flags == 0);
  CHECK(app.statistics().fixes_rejected == 1);
}

TEST_CASE("header.reserved is 0 for the plugins, whatever the app sets, and for the app, whatever a plugin sets") {
  const TestPlugins plugins{"listens", "echo"};
  RunningApp app(kListens, ODO_RUN_REPLAY, plugins.path());
  const auto push = [&](auto message) {
    message.header.reserved = 7;
    CHECK(app.push(message) == ODO_OK);
    app.flush();
    const auto got = given<decltype(message)>(app, message.header.type);
    REQUIRE(got.size() == 1);
    CHECK(got[0].header.reserved == 0);
  };
  push(calibration(64, 48));
  push(make_message<odo_imu_noise>(ODO_TYPE_IMU_NOISE, 1'000'000'000));
  static const std::vector<uint8_t> pixels(64 * 48, 90);
  push(grey_frame_at(2'000'000'000, pixels.data(), 64, 48));
  RunningApp other("odograph: 1\nvo_frontend: {plugin: test/echo}\n", ODO_RUN_REPLAY, plugins.path());
  auto scale = make_message<odo_scale>(ODO_TYPE_SCALE, 0);
  scale.header.reserved = 7, scale.scale = 1, scale.sigma = 0.1;
  echo(other, scale, 1'000'000'000);
  const auto scales = other.all<odo_scale>(ODO_TYPE_SCALE);
  REQUIRE(scales.size() == 1);
  CHECK(scales[0].header.reserved == 0);
}

TEST_CASE("a fix far from the origin of n is rejected, counted and reported") {
  const std::string config = kWalk +
                             "coupling: {type: localizer}\nnavigation: {origin: {latitude: 48 deg, longitude: 11 deg, "
                             "height: 500 m}}\nabsolute_fixers: [{plugin: "
                             "fix/gnss}]\n";
  constexpr double degree = 0.017453292519943295;
  for (const double latitude : {48.5, 57.0}) {  // 56 and 1,000 km north of the origin
    RunningApp app(config);
    app.walk(0, 300);
    for (int s = 4; s < 9; ++s) {
      auto gnss = make_message<odo_gnss>(ODO_TYPE_GNSS, 1'000'000'000LL * s);
      gnss.header.flags = ODO_GNSS_POSITION | ODO_GNSS_COVARIANCE;
      gnss.latitude_rad = latitude * degree, gnss.longitude_rad = 11 * degree;
      for (int k = 0; k < 3; ++k) gnss.covariance_n[4 * k] = 9;
      CHECK(app.push(gnss) == ODO_OK);
    }
    app.run(300, 1000);
    const bool far = latitude > 50;
    CHECK((app.statistics().fixes_accepted == 0) == far);
    CHECK((app.statistics().fixes_rejected >= 4) == far);
    CHECK(contains(app.said(), "km from the origin of n") == far);
    CHECK((std::abs(app.pose(ODO_TIME_LATEST).p_n[0]) < 100) == far);
  }
}

TEST_CASE("the time in each state is that between the reported states") {
  RunningApp app(kWalk);
  const auto barometer = [&](int from_ms, int to_ms) {
    for (int ms = from_ms; ms < to_ms; ms += 50) {
      app.push(pressure_at(1'000'000'000 + ms * 1'000'000LL, 101325));
    }
  };
  app.run(0, 1000), barometer(10'000, 18'000), app.walk(1800, 3000), barometer(30'000, 33'000), app.walk(3300, 4500);
  const auto states = app.all<odo_state>(ODO_TYPE_STATE);
  const auto poses = app.all<odo_pose>(ODO_TYPE_POSE);
  REQUIRE(states.size() >= 4);
  std::map<uint32_t, double> expected;
  for (size_t i = 0; i < states.size(); ++i) {
    const int64_t until = i + 1 < states.size() ? states[i + 1].header.t_ns : poses.back().header.t_ns;
    expected[states[i].state] += static_cast<double>(until - states[i].header.t_ns) * 1e-9;
  }
  const auto s = app.statistics();  // a pose may be older than the sample that revealed the silence
  CHECK(std::abs(s.tracking_s - expected[ODO_TRACKING]) < 0.2);
  CHECK(std::abs(s.degraded_s - expected[ODO_DEGRADED]) < 0.2);
  CHECK(std::abs(s.lost_s - expected[ODO_LOST]) < 0.2);
  CHECK(s.lost_s > 5);
}

TEST_CASE("a report has its count, status and newest time, and the last error has that status") {
  App app(kWalk);
  app.run(0, 100);
  auto small = make_message<odo_imu>(ODO_TYPE_IMU, 5);
  small.header.struct_size = ODO_IMU_SIZE_MIN - 1;
  for (int i = 0; i < 3; ++i) CHECK(app.push(small) == ODO_E_STRUCT_SIZE);
  std::this_thread::sleep_for(std::chrono::milliseconds(1020));
  app.push(small);
  app.flush();
  std::erase_if(app.reports, [](const odo_report& report) { return report.severity == ODO_SEVERITY_INFO; });
  REQUIRE(app.reports.size() == 2);
  for (const odo_report& report : app.reports) {
    CHECK(report.status == ODO_E_STRUCT_SIZE);
    CHECK(report.severity == ODO_SEVERITY_WARNING);
    CHECK(report.header.t_ns == 1'990'000'000);
    CHECK(report.header.source == 0);
    CHECK(std::string(report.key) == "invalid_imu");
  }
  CHECK((app.reports[0].count == 1 && app.reports[1].count == 3));
  odo_error error = app.last_error();
  CHECK(error.status == ODO_E_STRUCT_SIZE);
  CHECK(std::string(error.message).find("host: dropped a sample of imu") == 0);
}

TEST_CASE("each rejected sample is the last error, also within the second in which its kind is not reported") {
  App app(kWalk);
  app.run(0, 100);
  auto imu = imu_at(2'000'000'000, {0, 0, 0}, {0, 0, 0});
  for (const double wrong : {std::nan(""), HUGE_VAL, 1e5}) {
    imu.gyro_b[1] = wrong;
    for (int i = 0; i < 2; ++i) {
      CHECK(app.push(imu) == ODO_E_DISCARD);
      odo_error error = app.last_error();
      CHECK(error.status == ODO_E_DISCARD);
      CHECK(std::string(error.message).find("host: dropped a sample of imu") == 0);
    }
  }
}

TEST_CASE("a calibration without a mount keeps the mount, and another camera's does not change it") {
  App app(kWalk);
  auto c = calibration(64, 48);
  c.header.flags = ODO_CALIBRATION_EXTRINSICS, c.q_b_c[1] = 1, c.p_b_c[0] = 0.3, c.p_b_c[2] = 0.4;
  app.push(c);
  c.header.flags = 0, c.p_b_c[0] = 9;
  app.push(c);
  c.header.flags = ODO_CALIBRATION_EXTRINSICS, c.header.source = 2;
  app.push(c);
  app.run(0, 1000);
  odo_pose body{}, camera{};
  body.header.struct_size = camera.header.struct_size = sizeof body;
  REQUIRE(odo_session_get_pose_of(app.session, ODO_OF_BODY, 0, 9'000'000'000, &body) == ODO_OK);
  REQUIRE(odo_session_get_pose_of(app.session, ODO_OF_CAMERA, 0, 9'000'000'000, &camera) == ODO_OK);
  CHECK((body.header.flags ^ camera.header.flags) == ODO_POSE_CAMERA);
  CHECK(std::hypot(camera.p_n[0] - body.p_n[0], camera.p_n[1] - body.p_n[1], camera.p_n[2] - body.p_n[2]) ==
        doctest::Approx(0.5).epsilon(1e-9));
}

TEST_CASE("without extrinsics there is no camera pose of a walker") {
  App app(kWalk);
  app.push(calibration(64, 48));
  app.run(0, 1000);
  odo_pose pose{};
  pose.header.struct_size = sizeof pose;
  CHECK(odo_session_get_pose_of(app.session, ODO_OF_BODY, ODO_WORLD_SMOOTH, 9'000'000'000, &pose) == ODO_OK);
  CHECK(odo_session_get_pose_of(app.session, ODO_OF_CAMERA, ODO_WORLD_SMOOTH, 9'000'000'000, &pose) == ODO_NOT_READY);
}

TEST_CASE("two instances of one plugin are saved under separate names, and each gets its own state back" *
          doctest::skip(!kCameraPlugins)) {
  const TestPlugins plugins{"obeys"};
  const std::string yaml =
      "odograph: 1\nvo_frontend: {plugin: vo/five_point}\nscale_source: [{plugin: test/obeys}, {plugin: test/obeys}]\n";
  RunningApp app(yaml, ODO_RUN_REPLAY, plugins.path()), second(yaml, ODO_RUN_REPLAY, plugins.path());
  Order o = order(1'000'000'000);
  o.learn = 7;
  app.push(o);
  app.flush();
  const std::string blob = app.saved();
  CHECK(contains(blob, "test/obeys #2"));
  CHECK_FALSE(contains(blob, "#1"));
  REQUIRE(second.load(blob) == ODO_OK);
  CHECK(second.saved() == blob);
}

TEST_CASE("a live session processes pushes without a flush") {
  RunningApp app(kWalk, ODO_RUN_LIVE);
  std::this_thread::sleep_for(std::chrono::milliseconds(30));  // until its thread waits
  app.walk(0, 500);
  for (int i = 0; i < 500 && app.poses == 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  CHECK(app.poses > 0);
  odo_session_set_callback(app.session, nullptr, 0, nullptr, nullptr);
}

TEST_CASE("the rounding mode of an app's thread, or one left by a plugin, changes no digit" *
          doctest::skip(!kCameraPlugins)) {
  const TestPlugins plugins{"obeys"};
  struct Sample {
    double gyro[3], accel[3];
  };
  std::vector<Sample> samples;  // sines depend on the rounding mode
  for (int i = 0; i < 600; ++i) {
    const double phase = 0.12 * i;
    samples.push_back(
        {{0.05 * std::sin(phase), 0.01, 0.1}, {0.1, 9.81 + 2.2 * std::sin(phase), 0.4 * std::cos(phase)}});
  }
  const auto walked = [&](int app_rounds, uint32_t plugin_rounds) {
    RunningApp app(kWalk + "vo_frontend: {plugin: vo/five_point}\nscale_source: {plugin: test/obeys}\n", ODO_RUN_REPLAY,
                   plugins.path());
    Order o = order(2'000'000'001);
    o.rounds_up = plugin_rounds;
    std::fesetround(app_rounds);
    int64_t t_ns = 1'000'000'000;
    for (const Sample& s : samples) {
      odo_session_push_imu(app.session, t_ns += 10'000'000, s.gyro, s.accel);
      if (t_ns == 2'000'000'000) app.push(o);
    }
    app.flush();
    const odo_pose last = app.pose(ODO_TIME_LATEST);
    app.events.emplace_back(reinterpret_cast<const char*>(last.p_n), sizeof last.p_n);
    CHECK(std::fegetround() == app_rounds);
    std::fesetround(FE_TONEAREST);
    CHECK(contains(app.said(), "test/obeys: left another rounding mode behind in process") == (plugin_rounds != 0));
    return app.events;
  };
  const auto plain = walked(FE_TONEAREST, 0);
  CHECK(plain.size() > 10);
  CHECK(walked(FE_UPWARD, 0) == plain);
  CHECK(walked(FE_TOWARDZERO, 0) == plain);
  CHECK(walked(FE_TONEAREST, 1) == plain);
}

TEST_CASE("invalid positions are rejected in both directions") {
  RunningApp app(kWalk + "navigation: {origin: {latitude: 48.1 deg, longitude: 11.6 deg, height: 500 m}}\n");
  const double good_n[3] = {10, -20, 3};
  double geodetic[3], p_n[3];
  REQUIRE(odo_session_to_geodetic(app.session, good_n, geodetic) == ODO_OK);
  REQUIRE(odo_session_from_geodetic(app.session, geodetic, p_n) == ODO_OK);
  for (int i = 0; i < 3; ++i)
    for (const double wrong : {std::nan(""), HUGE_VAL, -1e9, 48.1e6}) {
      double bad_n[3] = {10, -20, 3}, bad[3] = {geodetic[0], geodetic[1], geodetic[2]}, out[3];
      bad_n[i] = bad[i] = wrong;
      CHECK(odo_session_to_geodetic(app.session, bad_n, out) == ODO_E_ARGUMENT);
      CHECK(odo_session_from_geodetic(app.session, bad, out) == ODO_E_ARGUMENT);
    }
}
