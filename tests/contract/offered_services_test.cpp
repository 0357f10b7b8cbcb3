// SPDX-License-Identifier: Apache-2.0
//
// Services offered to plugins by host and app, and wake-up calls on request.
#include <doctest/doctest.h>

#include <chrono>
#include <thread>

#include <odograph/plugin.hpp>

#include "tests/support/session_app.hpp"
#include "tests/support/test_plugins.hpp"

namespace {

/// A plugin with its own input: the test, which calls wake() of the newest instance.
struct Radio {
  static constexpr odo::Description description{"test/radio", "1.0.0", "Emits when it is woken.",
                                                ODO_INTERFACE_ATTITUDE};
  static std::vector<odo::Parameter<Radio>> parameters() { return {}; }
  static inline const odo::Output* newest = nullptr;
  static inline std::atomic<int> calls{0};
  static inline std::atomic<bool> requests_wake{false};
  void configured(odo::Output& output) { newest = &output; }
  void on(const odo_imu& imu, odo::Output&) { last_ns = imu.header.t_ns; }
  void woken(odo::Output& output) {
    ++calls;
    if (requests_wake) output.wake();
    auto attitude = odo::make<odo_attitude>(last_ns);
    attitude.q_n_b[0] = 1;
    output.emit(attitude);
  }
  int64_t last_ns = 1'000'000'000;
};

}  // namespace

ODO_PLUGIN_NAMED(Radio, radio_entry)

using namespace odograph;

TEST_SUITE_BEGIN("offered_services");

namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

const int kNumber = 42;
const void* ODO_CALL offer(void* user, const char* id, uint64_t size) {
  const std::string_view wanted(id, size);
  static_cast<std::string*>(user)->append(wanted).append(" ");
  return wanted == "acme.number/1" ? &kNumber : nullptr;
}

struct Outcome {
  std::string asked;     // by the app
  std::string reported;  // at creation and at save
};

Outcome outcome(const std::string& isolation) {
  const TestPlugins plugins{"asks_services"};
  const TemporaryFolder assets;
  write_text(assets / "asset.txt", "contents");
  const std::string yaml = "odograph: 1\nattitude: {plugin: test/asks_services, isolation: " + isolation + "}\n";
  const std::string folder = plugins.path(), asset_path = assets.path().string();
  Outcome out;
  odo_session_options o{};
  o.struct_size = sizeof o;
  o.run = ODO_RUN_REPLAY;
  o.config_text = {yaml.data(), yaml.size()};
  o.plugin_path = {folder.data(), folder.size()};
  o.asset_path = {asset_path.data(), asset_path.size()};
  o.user = &out.asked;
  o.get_service = offer;
  odo_error error{sizeof error, ODO_OK, {}};
  odo_session* session = nullptr;
  REQUIRE_MESSAGE(odo_session_create(&o, &session, &error) == ODO_OK, std::string(error.message));
  const auto on_report = [](void* user, const odo_header* event) {
    const auto& report = as<odo_report>(*event);
    static_cast<std::string*>(user)->append(report.key).append(": ").append(report.text).append("\n");
  };
  const uint32_t type = ODO_TYPE_REPORT;
  odo_session_set_callback(session, &type, 1, on_report, &out.reported);
  CHECK(odo_session_save(session, nullptr, 0) > 0);
  odo_session_flush(session);
  odo_session_destroy(session);
  return out;
}

}  // namespace

TEST_CASE("the app's services are offered by id, and assets come from the app before the host") {
  const Outcome out = outcome("none");
  CHECK(contains(out.asked, "acme.number/1 odo.contents/1 "));
  CHECK_FALSE(contains(out.asked, "odo.report"));
  CHECK_FALSE(contains(out.asked, "odo.wake"));
  CHECK(contains(out.reported, "number 42\n"));
  CHECK(contains(out.reported, "asset 8 ntents\n"));
  CHECK(contains(out.reported, "wake yes\n"));
}

TEST_CASE("an isolated plugin reads assets, has no service of the app's and cannot be woken" *
          doctest::skip(!kPlatform.processes)) {
  const Outcome out = outcome("process");
  CHECK(out.asked.empty());
  CHECK(contains(out.reported, "number none\n"));
  CHECK(contains(out.reported, "asset 8 ntents\n"));
  CHECK(contains(out.reported, "wake no\n"));
}

TEST_CASE("an oversized state is reported, in process and isolated") {
  for (const std::string isolation : {"none", "process"}) {
    if (isolation == "process" && !kPlatform.processes) continue;
    CAPTURE(isolation);
    CHECK(contains(outcome(isolation).reported,
                   "state_too_large: has 16777217 bytes of state to save; expected at most 16777216"));
  }
}

TEST_CASE("a plugin that requests it is called without a message, at the latest with the next sample") {
  REQUIRE(odo_register_plugin(radio_entry, nullptr) == ODO_OK);
  RunningApp app("odograph: 1\nattitude: {plugin: test/radio}\n");
  app.walk(0, 3);
  CHECK(app.all<odo_attitude>(ODO_TYPE_ATTITUDE).empty());
  std::thread([] {
    for (int i = 0; i < 3; ++i) CHECK(Radio::newest->wake());
  }).join();
  app.walk(3, 4);
  odo_session_flush(app.session);
  CAPTURE(app.said());
  CHECK(app.all<odo_attitude>(ODO_TYPE_ATTITUDE).size() == 1);  // one call serves several requests
  Radio::requests_wake = true;
  CHECK(Radio::newest->wake());
  CHECK(odo_session_flush(app.session) == ODO_OK);  // returns although each call requests another
  Radio::requests_wake = false;
}

TEST_SUITE_END();
