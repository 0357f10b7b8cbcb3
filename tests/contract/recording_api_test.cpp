// SPDX-License-Identifier: Apache-2.0
//
// Recordings through the C API: frames, damage, validation, bit-identical replays, concurrent recorders. What is read
// back as written is a subject of the conformance suite.
#if defined(__linux__)
#include <csignal>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#endif

#include <odograph/messages.h>
#include <odograph/odograph.hpp>
#include <odograph/recording.h>

#include "sdk/host/messages/messages.hpp"
#include "sdk/host/messages/record_file.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/recording_files.hpp"
#include "tests/support/session_app.hpp"
#include "tests/support/test_plugins.hpp"

TEST_SUITE_BEGIN("recording_api");

namespace {

constexpr uint32_t kWifi = ODO_TYPE_VENDOR(7, 1);

struct Wifi {
  odo_header header;
  double rssi_dbm[250];
};

}  // namespace

TEST_CASE("a recorder validates like a session: impossible numbers are rejected and nothing else is lost") {
  const TemporaryFolder folder;
  odo_recorder* out = recorder(folder / "bounds.odo");
  auto gnss = make_message<odo_gnss>(ODO_TYPE_GNSS, 5);
  gnss.header.flags = ODO_GNSS_POSITION;
  gnss.latitude_rad = 0.8;
  CHECK(odo_recorder_write(out, &gnss.header, nullptr, 0) == ODO_OK);
  for (const double wrong : {48.1, std::nan(""), 1e300}) {
    gnss.latitude_rad = wrong;
    CHECK(odo_recorder_write(out, &gnss.header, nullptr, 0) == ODO_E_DISCARD);
  }
  auto frame = make_message<odo_frame>(ODO_TYPE_FRAME, 6);
  frame.header.flags = ODO_FRAME_INTRINSICS;
  CHECK(odo_recorder_write(out, &frame.header, nullptr, 0) == ODO_E_DISCARD);  // a focal length of 0
  frame.header.flags = 0;
  CHECK(odo_recorder_write(out, &frame.header, nullptr, 0) == ODO_OK);
  CHECK(odo_recorder_close(out) == ODO_OK);
  odo_recording* in = recording(folder / "bounds.odo");
  REQUIRE(in);
  const odo_header* message = nullptr;
  for (const uint32_t type : {ODO_TYPE_GNSS, ODO_TYPE_FRAME}) {
    REQUIRE(odo_recording_next(in, &message, nullptr, nullptr) == ODO_OK);
    CHECK(message->type == type);
  }
  CHECK(odo_recording_next(in, &message, nullptr, nullptr) == ODO_END);
  odo_recording_close(in);
}

TEST_CASE("a crafted recording yields no borrowed memory and no reserved number") {
  const TemporaryFolder folder;
  const auto path = folder / "crafted.odo";
  {
    auto writer = required(RecordWriter::create(path));
    auto lent = make_message<odo_borrowed>(ODO_TYPE_VENDOR(3, 0x801), 5);
    lent.loan.owner = &lent;
    for (const uint32_t type : {ODO_TYPE_VENDOR(3, 0x801), 0x5000u, ODO_TYPE_VENDOR(3, 1)}) {
      lent.header.type = type;
      CHECK(writer->write(type, {reinterpret_cast<const unsigned char*>(&lent), sizeof lent}));
    }
    CHECK(writer->finish().ok());
  }
  const std::string file = path.string();
  const odo_string name{file.data(), file.size()};
  odo_recording* recording = nullptr;
  REQUIRE(odo_recording_open(&name, &recording, nullptr) == ODO_OK);
  const odo_header* message = nullptr;
  REQUIRE(odo_recording_next(recording, &message, nullptr, nullptr) == ODO_OK);
  CHECK(message->type == ODO_TYPE_VENDOR(3, 1));
  CHECK(odo_recording_next(recording, &message, nullptr, nullptr) == ODO_END);
  odo_recording_close(recording);
}

TEST_CASE("a pipeline with two step estimators, two scale sources and vendors' messages replays bit-identically" *
          doctest::skip(!kCameraPlugins)) {
  const TestPlugins plugins{"wifi_fixer"};
  const std::string yaml =
      "odograph: 1\nattitude:\n  plugin: attitude/vqf\nstep_estimator:\n  - plugin: step/renaudin2012\n"
      "  - plugin: step/weinberg2002\nvo_frontend:\n  plugin: vo/five_point\nscale_source:\n"
      "  - plugin: scale/fixed_step\n  - plugin: scale/step_length\nabsolute_fixers:\n  - plugin: test/wifi_fixer\n";
  const TemporaryFolder folder;
  const auto path = folder / "run.odo";
  RunningApp live(yaml, ODO_RUN_REPLAY, plugins.path());
  odo_recorder* out = recorder(path);
  const auto push = [&](const odo_header& message) {
    CHECK(odo_recorder_write(out, &message, nullptr, 0) == ODO_OK);
    CHECK(odo_session_push(live.session, &message) == ODO_OK);
  };
  for (int i = 0; i < 1500; ++i) {
    const double t = i / 100.0;
    auto imu = imu_at(static_cast<int64_t>(t * 1e9) + 1'000'000'000, {0, 0, 0.1 * std::sin(3 * t)},
                      {0, 9.81 + 2.2 * std::sin(2 * 3.14159265 * 1.9 * t), 0});
    push(imu.header);
    Wifi wifi{};
    wifi.header.struct_size = sizeof wifi, wifi.header.type = kWifi, wifi.header.t_ns = imu.header.t_ns + 7;
    if (i % 100 == 50) push(wifi.header);
  }
  live.flush();
  CHECK(odo_recorder_close(out) == ODO_OK);
  CHECK(live.all<odo_fix>(ODO_TYPE_FIX).size() == 15);
  CHECK(live.statistics().unknown == 0);
  CHECK(live.statistics().plugin_faults == 0);

  App again(yaml, ODO_RUN_REPLAY, plugins.path());
  odo_recording* in = recording(path);
  REQUIRE(in);
  const odo_header* message = nullptr;
  while (odo_recording_next(in, &message, nullptr, nullptr) == ODO_OK)
    CHECK(odo_session_push(again.session, message) == ODO_OK);
  again.flush();
  odo_recording_close(in);
  CHECK(live.events.size() > 1500);
  CHECK(live.events == again.events);
}

TEST_CASE("the second recorder on a path is rejected, for new and existing files, and the first loses nothing") {
  const TemporaryFolder folder;
  const std::string path = (folder / "twice.odo").string();
  const odo_string name{path.data(), path.size()};
  for (const int32_t count : {1000, 300}) {  // a new file, then one beside an existing one
    odo_recorder* first = recorder(path);
    odo_recorder* second = nullptr;
    odo_error error{sizeof error, ODO_OK, {}};
    CHECK(odo_recorder_create(&name, &second, &error) == ODO_E_STATE);
    CHECK(second == nullptr);
    CHECK(contains(error.message, "is being written by another recorder"));
    for (int i = 0; i < count; ++i) {
      auto imu = imu_at(1'000'000'000 + 5'000'000LL * i, {0, 0, 0}, {0, 0, 0}, ODO_IMU_GYRO);
      CHECK(odo_recorder_write(first, &imu.header, nullptr, 0) == ODO_OK);
    }
    CHECK(odo_recorder_close(first) == ODO_OK);
    odo_recording* in = recording(path);
    REQUIRE(in);
    int read = 0;
    for (const odo_header* message = nullptr; odo_recording_next(in, &message, nullptr, nullptr) == ODO_OK;) ++read;
    CHECK(read == count);
    CHECK(odo_recording_loss(in, &error) == ODO_OK);
    CHECK(error.status == ODO_OK);
    odo_recording_close(in);
  }
}

namespace {

void put_in(const std::filesystem::path& path, uintmax_t offset, char byte) {
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(static_cast<std::streamoff>(offset));
  file.put(byte);
}

}  // namespace

TEST_CASE("records that become unreadable after opening cost themselves alone, and every reader states the loss") {
  const TemporaryFolder folder;
  const auto path = folder / "later.odo";
  odo_recorder* out = recorder(path);
  for (int i = 0; i < 10; ++i) {
    const auto imu = make_message<odo_imu>(ODO_TYPE_IMU, i);
    CHECK(odo_recorder_write(out, &imu.header, nullptr, 0) == ODO_OK);
  }
  CHECK(odo_recorder_close(out) == ODO_OK);
  constexpr uintmax_t kRecord = 16 + sizeof(odo_imu);

  odo_recording* in = recording(path);
  REQUIRE(in);
  for (const uintmax_t index : {2u, 3u, 9u}) put_in(path, 16 + index * kRecord + 40, '#');
  std::vector<int64_t> times;
  std::vector<int32_t> statuses;
  const odo_header* message = nullptr;
  for (int32_t status = ODO_OK; status != ODO_END && statuses.size() < 20;) {
    statuses.push_back(status = odo_recording_next(in, &message, nullptr, nullptr));
    CHECK((message != nullptr) == (status == ODO_OK));
    if (status == ODO_OK) times.push_back(message->t_ns);
  }
  CHECK(times == std::vector<int64_t>{0, 1, 4, 5, 6, 7, 8});
  CHECK(std::count(statuses.begin(), statuses.end(), ODO_E_DATA) == 3);
  odo_error loss{sizeof loss, ODO_OK, {}};
  CHECK(odo_recording_loss(in, &loss) == ODO_OK);
  CHECK(loss.status == ODO_E_DATA);
  CHECK(std::string(loss.message) == "3 records could be read when it was opened, but not later");
  odo_recording_close(in);

  odo::Recording wrapped(path.string());
  CHECK(contains(wrapped.loss(), "3 of 10 records are lost"));
  put_in(path, 16 + 5 * kRecord + 40, '#');
  times.clear();
  for (const odo::Recorded& recorded : wrapped) times.push_back(recorded.message.header().t_ns);
  CHECK(times == std::vector<int64_t>{0, 1, 4, 6, 7, 8});
  CHECK(contains(wrapped.loss(), "1 record could be read when it was opened"));
}

TEST_CASE("a closed recording without messages is complete, an unclosed one is damaged") {
  const TemporaryFolder folder;
  CHECK(odo_recorder_close(recorder(folder / "empty.odo")) == ODO_OK);
  odo_recording* in = recording(folder / "empty.odo");
  REQUIRE(in);
  odo_error loss{sizeof loss, ODO_OK, {}};
  CHECK(odo_recording_loss(in, &loss) == ODO_OK);
  CHECK(loss.status == ODO_OK);
  const odo_header* message = nullptr;
  CHECK(odo_recording_next(in, &message, nullptr, nullptr) == ODO_END);
  odo_recording_close(in);
  std::filesystem::resize_file(folder / "empty.odo", 16);
  CHECK(recording(folder / "empty.odo", ODO_E_DATA) == nullptr);
}

#if defined(__linux__)
TEST_CASE(
    "a limit of file size is an error of the recorder and not the end of the app, which keeps its own rule for the "
    "signal") {
  const TemporaryFolder folder;
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    const rlimit limit{1 << 16, 1 << 16};
    if (setrlimit(RLIMIT_FSIZE, &limit) != 0) _exit(2);
    odo_recorder* out = recorder(folder / "limited.odo");
    auto imu = make_message<odo_imu>(ODO_TYPE_IMU, 0);
    int refused = 0;
    for (int i = 0; i < 4000; ++i) {
      imu.header.t_ns = i * 5'000'000LL;
      refused += odo_recorder_write(out, &imu.header, nullptr, 0) < 0;
    }
    const bool closed = odo_recorder_close(out) == ODO_OK;
    sigset_t pending, blocked;
    sigpending(&pending), pthread_sigmask(SIG_BLOCK, nullptr, &blocked);
    const bool untouched = sigismember(&pending, SIGXFSZ) == 0 && sigismember(&blocked, SIGXFSZ) == 0;
    _exit(refused == 0 ? 3 : closed ? 4 : untouched ? 0 : 5);
  }
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  CHECK_FALSE(WIFSIGNALED(status));
  CHECK(WEXITSTATUS(status) == 0);
}
#endif
