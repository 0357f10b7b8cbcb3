// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cstring>
#include <thread>
#include <vector>

#include "sdk/host/plugin_host/services.hpp"

using namespace odograph;

TEST_SUITE_BEGIN("services");

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

TEST_SUITE_END();
