// SPDX-License-Identifier: Apache-2.0
//
// No right recording is called wrong: all real ones, cut in pieces of half a minute.
#include <algorithm>
#include <string>
#include <vector>

#include "sdk/host/checks/input_checks.hpp"
#include "sdk/host/core/camera_table.hpp"
#include "sdk/host/messages/imu_joiner.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/recording/recording.hpp"
#include "tests/support/support.hpp"

using namespace odograph;
namespace fs = std::filesystem;

TEST_SUITE_BEGIN("input_checks_data");

namespace {

/// Keys of the faults found in a part of a recording.
std::vector<std::string> faults_in(const Recording& recording, int64_t from_ns, int64_t to_ns) {
  std::vector<std::string> found;
  HostServices host(1, {}, [&](const Report& report) {
    if (report.severity >= ODO_SEVERITY_WARNING) found.push_back(report.key + ": " + report.text);
  });
  InputChecks checks(host);
  ImuJoiner joiner;
  CameraTable cameras(std::nullopt);
  for (const RecordedMessage& each : recording.messages) {
    const odo_header& header = each.message.header();
    const bool description = is_description(header);
    if (!description && (header.t_ns < from_ns || header.t_ns >= to_ns)) continue;
    if (header.type == ODO_TYPE_CALIBRATION) {
      odo_calibration calibration = copy_as<odo_calibration>(header);
      cameras.take_calibration(calibration);
      checks.on_sample(calibration.header);
    } else if (header.type == ODO_TYPE_FRAME) {
      const auto frame = load_frame(each);
      if (!frame) continue;
      odo_frame timed = *frame;
      cameras.complete(timed);
      checks.on_sample(timed.header);
      frame->loan.release(frame->loan.owner);
    } else if (header.type == ODO_TYPE_IMU) {
      checks.on_push(header);
      joiner.push(as<odo_imu>(header), [&](const odo_imu& whole) { checks.on_imu(whole); });
    } else {
      checks.on_sample(header);
    }
  }
  return found;
}

/// Every recording of a data folder.
std::vector<fs::path> recordings_in(const std::string& name) {
  std::vector<fs::path> out;
  const fs::path folder = data_or_skip(name);
  if (folder.empty()) return out;
  if (fs::exists(folder / "mav0") || fs::exists(folder / "image_0")) return {folder};
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_directory() || entry.path().extension() == ".txt" || entry.path().extension() == ".csv")
      out.push_back(entry.path());
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

TEST_CASE("no fault is found in real recordings, cut in pieces of half a minute") {
  constexpr int64_t kPiece_ns = 30 * kSecond_ns;
  int pieces = 0;
  for (const char* set :
       {"phone_walks", "ridi", "ipin2023_t3/trials", "pace_walks", "oxford_steps", "euroc_mh05", "phone_house"})
    for (const fs::path& path : recordings_in(set)) {
      auto walk = read_walk(path);  // the layouts of published sets
      const auto recording = walk ? std::move(*walk) : read_recording(path);
      if (!recording || recording->messages.empty()) continue;
      int64_t first_ns = INT64_MAX, last_ns = INT64_MIN;
      for (const RecordedMessage& each : recording->messages)
        if (!is_description(each.message.header()))
          first_ns = std::min(first_ns, each.message.header().t_ns),
          last_ns = std::max(last_ns, each.message.header().t_ns);
      for (int64_t from_ns = first_ns; from_ns < last_ns; from_ns += kPiece_ns) {
        ++pieces;
        for (const std::string& fault : faults_in(*recording, from_ns, from_ns + kPiece_ns))
          FAIL_CHECK(path.filename().string(), " from second ", seconds(from_ns - first_ns), ": ", fault);
      }
    }
  MESSAGE(pieces << " pieces");
}
