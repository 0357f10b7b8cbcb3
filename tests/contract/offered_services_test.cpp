// SPDX-License-Identifier: Apache-2.0
//
// Services offered to plugins by host and app, and wake-up calls on request.
#include <chrono>
#include <thread>

#include <odograph/plugin.hpp>

#include "sdk/host/plugin_host/services.hpp"
#include "tests/support/session_app.hpp"
#include "tests/support/test_plugins.hpp"
#include "tests/support/replay_session.hpp"

TEST_SUITE_BEGIN("offered_services");

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

namespace {

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
  odo_session_options o = replay_options(yaml, folder);
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
  app.run(3, 4);
  CAPTURE(app.said());
  CHECK(app.all<odo_attitude>(ODO_TYPE_ATTITUDE).size() == 1);  // one call serves several requests
  Radio::requests_wake = true;
  CHECK(Radio::newest->wake());
  CHECK(app.flush() == ODO_OK);  // returns although each call requests another
  Radio::requests_wake = false;
}

TEST_CASE("suppressed reports are counted in the next one, once, separately for each origin and key") {
  std::vector<Report> told;
  HostServices services(0, {}, [&](const Report& report) { told.push_back(report); });
  services.name_instance(7, "test/plugin");
  const auto report = [&](uint32_t instance, const char* key, int times) {
    for (int i = 0; i < times; ++i) services.report(instance, 2, key, "trouble", ODO_E_DATA);
  };
  const auto a_second = [] { std::this_thread::sleep_for(std::chrono::milliseconds(1010)); };
  report(0, "a", 3), report(0, "b", 1), report(7, "a", 2);
  REQUIRE(told.size() == 3);
  CHECK(told[0].origin == "host");
  CHECK(told[2].origin == "test/plugin");
  CHECK(told[2].instance == 7);
  for (const Report& r : told) CHECK((r.count == 1 && r.text == "trouble" && r.status == ODO_E_DATA));
  a_second();
  told.clear(), report(0, "a", 5), report(0, "b", 1), report(7, "a", 1);
  REQUIRE(told.size() == 3);
  CHECK(told[0].count == 3);
  CHECK(told[0].text == "trouble (and 2 more like it)");
  CHECK((told[1].count == 1 && told[1].text == "trouble"));
  CHECK(told[2].count == 2);
  a_second();
  told.clear(), report(0, "a", 1), report(7, "a", 1);
  REQUIRE(told.size() == 2);
  CHECK(told[0].count == 5);
  CHECK(told[0].text == "trouble (and 4 more like it)");
  CHECK((told[1].count == 1 && told[1].text == "trouble"));
}

TEST_CASE("each service of the host states its size, and its reserved field is zero") {
  HostServices services(0, {}, nullptr);
  const auto offers = [&]<class Service>(const char* id, const Service*) {
    CAPTURE(id);
    const auto* service = static_cast<const Service*>(services.get_service(&services, id, std::strlen(id)));
    REQUIRE(service);
    CHECK(service->struct_size == sizeof(Service));
    CHECK(service->reserved == 0);
  };
  offers(ODO_SERVICE_REPORT, static_cast<const odo_report_service*>(nullptr));
  offers(ODO_SERVICE_RANDOM, static_cast<const odo_random_service*>(nullptr));
  offers(ODO_SERVICE_ASSETS, static_cast<const odo_asset_service*>(nullptr));
  offers(ODO_SERVICE_CONTENTS, static_cast<const odo_content_service*>(nullptr));
  offers(ODO_SERVICE_WAKE, static_cast<const odo_wake_service*>(nullptr));
}

TEST_CASE("an origin beyond the limit of distinct keys has one key for the rest") {
  std::vector<Report> told;
  HostServices services(0, {}, [&](const Report& report) { told.push_back(report); });
  for (int i = 0; i < 260; ++i) services.report(0, 1, "kind " + std::to_string(i), "x");
  REQUIRE(told.size() == 257);
  CHECK(told[255].key == "kind 255");
  CHECK(told[256].key == "more");
}

TEST_CASE("a plugin's reports do not suppress the host's reports about it") {
  std::vector<Report> told;
  HostServices services(0, {}, [&](const Report& report) { told.push_back(report); });
  services.name_instance(1, "a/plugin");
  const auto plugin = HostServices::Author::plugin;
  services.report(1, 1, "isolated", "a forgery", ODO_OK, plugin);
  for (int i = 0; i < 300; ++i) services.report(1, 1, "kind " + std::to_string(i), "x", ODO_OK, plugin);
  services.report(1, 1, "isolated", "was ended by a signal");
  REQUIRE(!told.empty());
  CHECK(told.back().text == "was ended by a signal");
}
