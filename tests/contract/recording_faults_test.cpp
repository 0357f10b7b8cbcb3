// SPDX-License-Identifier: Apache-2.0
//
// Recordings through the C API: what cannot be read, written or recorded.
#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <vector>

#include <odograph/odograph.hpp>

#include "sdk/host/messages/messages.hpp"
#include "tests/support/recording_files.hpp"
#include "tests/support/support.hpp"

using namespace odograph;

TEST_SUITE_BEGIN("recording_faults");

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
  CHECK(wrapped.loss().find("3 of 10 records are lost") != std::string::npos);
  put_in(path, 16 + 5 * kRecord + 40, '#');
  times.clear();
  for (const odo::Recorded& recorded : wrapped) times.push_back(recorded.message.header().t_ns);
  CHECK(times == std::vector<int64_t>{0, 1, 4, 6, 7, 8});
  CHECK(wrapped.loss().find("1 record could be read when it was opened") != std::string::npos);
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

TEST_SUITE_END();
