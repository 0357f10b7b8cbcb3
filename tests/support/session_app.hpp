// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

#include <odograph/odograph.h>

#include "sdk/host/messages/messages.hpp"
#include "sdk/host/platform/features.hpp"
#include "tests/support/support.hpp"
#include "tests/support/replay_session.hpp"

namespace odograph {

inline const std::string kWalk =
    "odograph: 1\nattitude:\n  plugin: attitude/vqf\nstep_estimator:\n  plugin: step/renaudin2012\n";
inline const std::string kCamera =
    kWalk + "vo_frontend:\n  plugin: vo/five_point\nscale_source:\n  plugin: scale/step_length\n";

/// A session of the C API with all its output.
class App {
 public:
  /// `plugins`: an additional folder of plugins.
  explicit App(const std::string& yaml, uint32_t run = ODO_RUN_REPLAY, const std::string& plugins = {}) {
    const std::string folder = plugin_folder().string() + (plugins.empty() ? "" : kPlatform.path_separator + plugins);
    odo_session_options o = replay_options(yaml, folder);
    o.run = run;
    odo_error error{sizeof error, ODO_OK, {}};
    status = odo_session_create(&o, &session, &error);
    message = error.message;
    if (session) odo_session_set_callback(session, nullptr, ODO_ALL_EVENTS, on_event, this);
  }
  ~App() { odo_session_destroy(session); }
  App(const App&) = delete;

  int32_t walk(int from, int to, double hz = 100) const {
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
  int32_t flush() const { return odo_session_flush(session); }
  /// Walks and flushes.
  int32_t run(int from, int to) const {
    const int32_t worst = walk(from, to);
    return std::min(worst, flush());
  }
  template <class Message>
  int32_t push(const Message& sample) const {
    return odo_session_push(session, &sample.header);
  }
  /// What the session saves.
  std::string saved() const {
    std::string blob(static_cast<size_t>(odo_session_save(session, nullptr, 0)), '\0');
    CHECK(odo_session_save(session, blob.data(), blob.size()) == static_cast<int64_t>(blob.size()));
    return blob;
  }
  int32_t load(const std::string& blob) const { return odo_session_load(session, blob.data(), blob.size()); }
  /// All reports, one line each.
  std::string said() const {
    std::string lines;
    for (const odo_report& report : reports) lines += std::string(report.plugin) + ": " + report.text + "\n";
    return lines;
  }
  /// One grey frame of 64 x 48 pixels, copied by the session.
  int32_t frame(int64_t t_ns, int64_t exposure_ns = 0) {
    static const std::vector<uint8_t> pixels(64 * 48, 90);
    auto f = make_message<odo_frame>(ODO_TYPE_FRAME, t_ns);
    f.format = ODO_FORMAT_GREY8;
    f.width = 64, f.height = 48;
    f.exposure_ns = exposure_ns;
    f.planes[0] = {pixels.data(), 64, 1, 0};
    return odo_session_push(session, &f.header);
  }
  odo_pose pose(int64_t t_ns, bool smooth = false) const {
    odo_pose p{};
    p.header.struct_size = sizeof p;
    CHECK((smooth ? odo_session_get_smooth_pose : odo_session_get_pose)(session, t_ns, &p) == ODO_OK);
    return p;
  }
  odo_error last_error() const {
    odo_error error{sizeof error, ODO_OK, {}};
    CHECK(odo_session_last_error(session, &error) == ODO_OK);
    return error;
  }
  /// All events of a type so far.
  template <class Event>
  std::vector<Event> all(uint32_t type) const {
    std::vector<Event> found;
    for (const std::string& bytes : events) {
      if (reinterpret_cast<const odo_header*>(bytes.data())->type != type) continue;
      std::memcpy(static_cast<void*>(&found.emplace_back()), bytes.data(), std::min(sizeof(Event), bytes.size()));
    }
    return found;
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
  std::vector<std::string> events;  // the bytes of every event but reports
  std::vector<odo_report> reports;
  std::atomic<int> poses{0};

 private:
  static void on_event(void* user, const odo_header* event) {
    auto& self = *static_cast<App*>(user);
    if (event->type == ODO_TYPE_REPORT) {  // reports are not part of a run's results
      self.reports.push_back(as<odo_report>(*event));
      return;
    }
    self.events.emplace_back(reinterpret_cast<const char*>(event), event->struct_size);
    if (event->type == ODO_TYPE_POSE) {
      ++self.poses;
      odo_pose pose{};  // a callback may query the pose and the statistics
      pose.header.struct_size = sizeof pose;
      odo_session_get_pose(self.session, ODO_TIME_LATEST, &pose);
      self.statistics();
    }
  }
};

/// A session that must have been created.
class RunningApp : public App {
 public:
  explicit RunningApp(const std::string& yaml, uint32_t run = ODO_RUN_REPLAY, const std::string& plugins = {})
      : App(yaml, run, plugins) {
    REQUIRE_MESSAGE(status == ODO_OK, message);
  }
};

inline odo_calibration calibration(uint32_t width, uint32_t height) {
  auto c = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 1'000'000'000);
  c.model = ODO_CAMERA_PINHOLE;
  c.width = width, c.height = height;
  c.fx = c.fy = width, c.cx = width / 2.0, c.cy = height / 2.0;
  return c;
}

}  // namespace odograph
