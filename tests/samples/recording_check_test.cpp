// SPDX-License-Identifier: Apache-2.0
//
// `plugin check --recording`: detects and checks the fixes of a fixer whose input is only in a recording.
#include <odograph/recording.h>

#include "sdk/tools/recording/recording.hpp"
#include "sdk/tools/validator/check.hpp"
#include "samples/vendor_message/message.h"
#include "tests/samples/corridor_walk.hpp"

TEST_SUITE_BEGIN("recording_check");

namespace {

const PluginCheck& row(const std::vector<PluginCheck>& checks, const std::string& id) {
  const auto found = std::find_if(checks.begin(), checks.end(), [&](const PluginCheck& c) { return c.id == id; });
  REQUIRE_MESSAGE(found != checks.end(), id);
  return *found;
}

std::vector<PluginCheck> check(const std::string& plugin, const Messages& messages,
                               const std::vector<std::string>& only = {"entry", "recording"}) {
  CheckOptions options;
  options.only = only;
  options.recording = messages;
  return check_plugin(sample_plugins() + "/" + plugin + ".so", options);
}

bool any_failed(const std::vector<PluginCheck>& checks) {
  return std::any_of(checks.begin(), checks.end(),
                     [](const PluginCheck& c) { return c.outcome == PluginCheck::Outcome::failed; });
}

/// Poses of a walk and the ranges measured on it, recorded as by an app; returns the file.
std::filesystem::path record_ranges(const TemporaryFolder& folder) {
  const std::string file = (folder / "ranges.odo").string();
  const odo_string name{file.data(), file.size()};
  odo_recorder* recorder = nullptr;
  REQUIRE(odo_recorder_create(&name, &recorder, nullptr) == ODO_OK);
  for (int i = 0; i < 400; ++i) {
    auto pose = make_message<odo_pose>(ODO_TYPE_POSE, 1'000'000'000 + i * 50'000'000LL);
    pose.header.flags = ODO_POSE_ORIENTATION | ODO_POSE_POSITION | ODO_POSE_METRIC;
    pose.q_n[0] = 1, pose.p_n[0] = 0.05 * i, pose.state = ODO_TRACKING;
    CHECK(odo_recorder_write(recorder, &pose.header, nullptr, 0) == ODO_OK);
    auto range = make_message<odo_range>(ODO_TYPE_RANGE, pose.header.t_ns);
    range.header.flags = ODO_RANGE_TRANSMITTER;
    range.transmitter = 1, range.sigma_m = 0.1, range.p_n[0] = 30;
    range.range_m = 30 - pose.p_n[0];
    CHECK(odo_recorder_write(recorder, &range.header, nullptr, 0) == ODO_OK);
  }
  REQUIRE(odo_recorder_close(recorder) == ODO_OK);
  return file;
}

}  // namespace

TEST_CASE("a fixer by range gives fixes on a recording with ranges and poses, and they are checked") {
  const TemporaryFolder folder;
  const auto recording = required(read_recording(record_ranges(folder), {.events = true}));
  const auto checks = check("fix_range", [&](const auto& give) {
    for (const RecordedMessage& message : recording->messages) give(message.message.header());
  });
  CHECK(row(checks, "recording.given").detail == "pose 400, range 400");
  CHECK(row(checks, "recording.emitted").detail.starts_with("fix "));
  CHECK(row(checks, "recording.events.numbers").outcome == PluginCheck::Outcome::passed);
  CHECK(row(checks, "recording.fix.place").outcome == PluginCheck::Outcome::passed);
  CHECK_FALSE(any_failed(checks));
}

TEST_CASE("a plugin whose input is a vendor's messages is found to answer them, also invalid ones") {
  const auto scans = [](const auto& give) {
    example_wifi_scan scan{};
    scan.header.struct_size = sizeof scan;
    scan.header.type = EXAMPLE_TYPE_WIFI_SCAN;
    for (uint32_t i = 0; i < 5; ++i) {
      scan.header.t_ns = 1'000'000'000LL * (i + 1);
      scan.count = i == 4 ? UINT32_MAX : i;
      scan.access_points[0].rssi_dbm = -50;
      give(scan.header);
    }
  };
  const auto checks = check("zone_by_wifi", scans, {"recording"});
  CHECK(row(checks, "recording.given").detail == "type 0x80000001 5");
  CHECK(row(checks, "recording.emitted").detail == "type 0x80000402 4");
  CHECK_FALSE(any_failed(checks));
}

TEST_CASE("a recording without input for the plugin is not an error and is reported") {
  const auto checks = check("zone_by_wifi", [](const auto&) {}, {"recording"});
  CHECK(row(checks, "recording.given").outcome == PluginCheck::Outcome::not_applicable);
  CHECK(row(checks, "recording.emitted").outcome == PluginCheck::Outcome::not_applicable);
}
