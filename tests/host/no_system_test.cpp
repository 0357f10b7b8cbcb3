// SPDX-License-Identifier: Apache-2.0
//
// The host over sdk/host/platform/none, as in a browser: supported functions, and errors of unsupported ones.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#define DOCTEST_CONFIG_NO_POSIX_SIGNALS
#include <doctest/doctest.h>

#include <fstream>
#include <string>

#include <odograph/attitude.h>
#include <odograph/odograph.h>
#include <odograph/recording.h>

#include "sdk/host/platform/features.hpp"
#include "sdk/host/platform/library.hpp"
#include "sdk/host/platform/temporary_folder.hpp"

extern "C" {
int32_t ODO_CALL odo_plugin_entry_attitude_vqf(const odo_host* host, odo_plugin* out);
int32_t ODO_CALL odo_plugin_entry_step_odograph(const odo_host* host, odo_plugin* out);
}

namespace {

odo_string str(const std::string& text) { return {text.data(), text.size()}; }

/// Result of odo_session_create.
struct Made {
  int32_t status;
  std::string text;
  odo_session* session;
};

Made make(const std::string& config, uint32_t run = ODO_RUN_REPLAY) {
  odo_register_plugin(odo_plugin_entry_attitude_vqf, nullptr);
  odo_register_plugin(odo_plugin_entry_step_odograph, nullptr);
  odo_session_options options{};
  options.struct_size = sizeof options;
  options.run = run;
  options.config_text = str(config);
  odo_error error{sizeof error, ODO_OK, {}};
  odo_session* session = nullptr;
  const int32_t status = odo_session_create(&options, &session, &error);
  return {status, error.message, session};
}

void check_refused(const Made& made, int32_t status, std::initializer_list<const char*> words) {
  INFO(made.text);
  CHECK(made.status == status);
  CHECK(made.session == nullptr);
  for (const char* each : words) CHECK(made.text.find(each) != std::string::npos);
}

const std::string kConfig = "odograph: 1\nattitude:\n  plugin: attitude/vqf\n";

}  // namespace

TEST_CASE("without an operating system a replay runs with linked plugins") {
  REQUIRE(std::string(odograph::kPlatform.name) == "none");
  const Made made = make(kConfig);
  REQUIRE_MESSAGE(made.status == ODO_OK, made.text);
  const double gyro[3] = {0, 0, 0}, accel[3] = {0, 0, 9.81};
  for (int64_t i = 0; i < 200; ++i) CHECK(odo_session_push_imu(made.session, i * 5'000'000, gyro, accel) == ODO_OK);
  CHECK(odo_session_flush(made.session) == ODO_OK);
  odo_pose pose{};
  pose.header.struct_size = sizeof pose;
  CHECK(odo_session_get_pose(made.session, ODO_TIME_LATEST, &pose) == ODO_OK);
  CHECK((pose.header.flags & ODO_POSE_ORIENTATION) != 0);
  odo_session_destroy(made.session);
}

TEST_CASE("without processes isolation is rejected with its location in the config") {
  check_refused(make(kConfig + "  isolation: process\n"), ODO_E_CONFIG,
                {":3:", "isolation: plugin 'attitude/vqf'", "platform (none)", "expected 'isolation: none'"});
  check_refused(make(kConfig + "plugins:\n  isolation: process\n"), ODO_E_CONFIG, {"isolation", "platform (none)"});
}

TEST_CASE("a plugin that is not linked is rejected with a list of the linked ones") {
  check_refused(make("odograph: 1\nattitude:\n  plugin: attitude/magyq\n"), ODO_E_CONFIG,
                {":3:", "'attitude/magyq' is not linked into this program", "expected one of attitude/vqf",
                 "odo_register_plugin"});
}

TEST_CASE("without libraries a plugin's file is rejected") {
  const odograph::TemporaryFolder folder;
  REQUIRE_FALSE(folder.path().empty());
  const auto manifest = folder / "a.odoplugin.json";
  std::ofstream(manifest) << R"({"odoplugin": 1, "id": "attitude/far", "version": "1.0.0", "summary": "s",
    "interfaces": [")" ODO_INTERFACE_ATTITUDE
                             R"("], "abi": [1, 0], "library": "a.so", "sha256": "0", "parameters": []})";
  check_refused(make("odograph: 1\nattitude:\n  plugin: " + manifest.string() + "\n"), ODO_E_CONFIG,
                {"loads no plugin from a file", "odo_register_plugin"});
  std::string why;
  CHECK(odograph::open_library("a.so", why) == nullptr);
  CHECK_FALSE(why.empty());
}

TEST_CASE("without threads a live session is rejected") {
  check_refused(make(kConfig, ODO_RUN_LIVE), ODO_E_UNSUPPORTED, {"ODO_RUN_LIVE", "no threads", "ODO_RUN_REPLAY"});
}

TEST_CASE("two recorders of one file exclude each other without the system's locks") {
  const odograph::TemporaryFolder folder;
  const std::string file = (folder / "a.odo").string();
  const odo_string path = str(file);
  odo_recorder *first = nullptr, *second = nullptr;
  REQUIRE(odo_recorder_create(&path, &first, nullptr) == ODO_OK);
  CHECK(odo_recorder_create(&path, &second, nullptr) == ODO_E_STATE);
  CHECK(odo_recorder_close(first) == ODO_OK);
  CHECK(odo_recorder_create(&path, &second, nullptr) == ODO_OK);
  CHECK(odo_recorder_close(second) == ODO_OK);
}
