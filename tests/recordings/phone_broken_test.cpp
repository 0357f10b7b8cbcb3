// SPDX-License-Identifier: Apache-2.0
//
// Broken recordings of apps: errors name file, column and the setting to enable; archives are harmless.
#include "sdk/tools/recording/archive.hpp"
#include "sdk/tools/recording/recording.hpp"
#include "tests/recordings/phone/app_files.hpp"
#include "tests/recordings/phone/video_file.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("phone_broken");

namespace {

std::string failure_of(const fs::path& path) {
  const auto recording = read_recording(path);
  return recording ? "" : recording.failure().text;
}

}  // namespace

namespace {

/// A broken recording: its app, the damage, and the expected words of the error.
struct Broken {
  size_t app;
  std::function<void(const fs::path&)> harm;
  std::vector<std::string> named;
};

void replace(const fs::path& file, const std::string& from, const std::string& to) {
  std::string text = read_text(file);
  const size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  write_text(file, text.replace(at, from.size(), to));
}

/// The first row's part up to the second comma, replaced.
void corrupt_row(const fs::path& file, const std::string& row) {
  const std::string text = read_text(file);
  const size_t head = text.find('\n') + 1;
  write_text(file, text.substr(0, head) + row + "\n" + text.substr(head));
}

std::vector<Broken> broken_sensor_logger() {
  const auto without = [](const char* name) { return [name](const fs::path& folder) { fs::remove(folder / name); }; };
  return {
      {1,
       [](const fs::path& f) { fs::remove(f / "TotalAcceleration.csv"), fs::remove(f / "Gravity.csv"); },
       {"Accelerometer.csv", "Gravity.csv", "TotalAcceleration.csv", "Total Acceleration"}},
      {3, without("Gravity.csv"), {"Accelerometer.csv", "Gravity.csv", "switch on 'Accelerometer' and 'Gravity'"}},
      {1, without("Gyroscope.csv"), {"no gyroscope", "switch on 'Gyroscope'"}},
      {0,
       [](const fs::path& f) { replace(f / "Metadata.csv", "android", "symbian"); },
       {"Metadata.csv", "platform", "symbian"}},
      {1,
       [](const fs::path& f) { replace(f / "Gyroscope.csv", "z,y,x", "z,y,w"); },
       {"Gyroscope.csv", "no column 'x'"}},
      {1,
       [](const fs::path& f) { corrupt_row(f / "Gyroscope.csv", "1.7818E+18,0,0,0,0"); },
       {"Gyroscope.csv:2", "'time'", "spreadsheet"}},
      {1,
       [](const fs::path& f) { corrupt_row(f / "Gyroscope.csv", "1781801311000000000,0,0.1,abc,0"); },
       {"Gyroscope.csv:2", "'y'", "abc"}},
      {0,
       [](const fs::path& f) {
         write_text(f / "GyroscopeUncalibrated.csv", "time,z,y,x\n"), write_text(f / "Gyroscope.csv", "");
       },
       {"no gyroscope", "Gyroscope"}},
      {2,
       [](const fs::path& f) { replace(f / "Metadata.csv", ",false", ",true"); },
       {"AccelerometerUncalibrated.csv", "0.97 m/s^2", "in g?"}},
      {1,
       [](const fs::path& f) { write_text(f / "Camera/1781801310305.mp4", "no video"); },
       {"1781801310305.mp4", "not a video"}},
      {1,
       [](const fs::path& f) {
         const std::string bytes = read_text(f / "Camera/1781801310305.mp4");
         write_text(f / "Camera/1781801310305.mp4", bytes.substr(0, bytes.size() / 2));
       },
       {"1781801310305.mp4", "cut off?"}},
      {1,
       [](const fs::path& f) {
         REQUIRE(write_video(f / "clip.mp4", street_walk(false).pictures, street_walk(false).times_ns));
         fs::remove_all(f / "Camera");
       },
       {"clip.mp4", "no track with its frames' times"}},
  };
}

std::vector<Broken> broken_others() {
  const auto without = [](const char* name) { return [name](const fs::path& folder) { fs::remove(folder / name); }; };
  return {
      {5,
       [](const fs::path& f) { corrupt_row(f / "data.jsonl", "{\"sensor\":"); },
       {"data.jsonl:2", "not a JSON object"}},
      {5, [](const fs::path& f) { write_text(f / "calibration.json", "{}"); }, {"calibration.json", "no 'cameras'"}},
      {5,
       [](const fs::path& f) { replace(f / "calibration.json", "\"pinhole\"", "\"omni\""); },
       {"calibration.json", "omni"}},
      {6,
       [](const fs::path& f) { fs::remove(f / "20261125_101112/VID_20261125_101112_accel.csv"); },
       {"no accelerometer", "Enable sync video IMU recording"}},
      {6,
       [](const fs::path& f) { fs::remove(f / "20261125_101112/VID_20261125_101112_imu_timestamps.csv"); },
       {"VID_20261125_101112.mp4", "no times of its frames"}},
      {7,
       [](const fs::path& f) { write_text(f / "video_meta.pb3", "no message at all"); },
       {"video_meta.pb3", "VideoCaptureData"}},
      {8,
       [](const fs::path& f) { replace(f / "gyro_accel.csv", "gx[rad/s]", "wx[rad/s]"); },
       {"gyro_accel.csv", "no column 'gx'"}},
      {8,
       [](const fs::path& f) {
         std::string text = read_text(f / "frame_timestamps.txt");
         write_text(f / "frame_timestamps.txt", text.substr(0, text.size() / 3));
       },
       {"frame_timestamps.txt", "for the video's", "cut off?"}},
      {9, without("imu.csv"), {"no gyroscope", "imu.csv"}},
      {9, [](const fs::path& f) { write_text(f / "camera_matrix.csv", "1,2\n"); }, {"camera_matrix.csv"}},
      {10,
       [](const fs::path& f) { replace(f / "gnss_log_2026_11_25_10_11_12.txt", "# UncalGyro,", "# Uncal,"); },
       {"gnss_log", "UncalGyro", "names its columns"}},
      {11, [](const fs::path& f) { replace(f / "imu.csv", "accel_x", "temperature"); }, {"imu.csv", "accel_x"}},
      {11, without("times.csv"), {"video.mp4", "no times of its frames"}},
  };
}

const std::vector<Broken>& broken() {
  static const std::vector<Broken> all = [] {
    auto both = broken_sensor_logger();
    for (const Broken& one : broken_others()) both.push_back(one);
    return both;
  }();
  return all;
}

}  // namespace

TEST_CASE("the error of each of twenty-five broken recordings names the file, the column and the setting to enable") {
  CHECK(broken().size() == 25);
  std::map<size_t, std::shared_ptr<TemporaryFolder>> whole;
  for (size_t i = 0; i < broken().size(); ++i) {
    const Broken& one = broken()[i];
    CAPTURE(i);
    auto& original = whole[one.app];
    if (!original) {
      original = std::make_shared<TemporaryFolder>();
      apps()[one.app].write(street_walk(false), *original / "out");
      write_lens(street_walk(false), *original / "out");
      if (apps()[one.app].has_lens) fs::remove(*original / "out/camera.yaml");
    }
    const TemporaryFolder folder;
    fs::copy(*original / "out", folder / "out", fs::copy_options::recursive);
    one.harm(folder / "out");
    const std::string failure = failure_of(folder / "out");
    CAPTURE(failure);
    for (const std::string& name : one.named) CHECK(contains(failure, name));
  }
}

TEST_CASE("an archive's names cannot leave its folder, and its unpacked size is limited") {
  const TemporaryFolder folder;
  write_text(folder / "out.txt", ""), fs::create_directories(folder / "in");
  write_text(folder / "in/file.txt", std::string(300u << 20, 'a'));  // compresses a thousand to one
  write_zip(folder / "in", folder / "bomb.zip");
  CHECK(contains(failure_of(folder / "bomb.zip"), "100 times its size"));
  write_text(folder / "in/file.txt", "a");
  write_zip(folder / "in", folder / "out.zip", "../");
  CHECK(contains(failure_of(folder / "out.zip"), "'../file.txt' leads out of its folder"));
  write_zip(folder / "in", folder / "absolute.zip", "/tmp/");
  CHECK(contains(failure_of(folder / "absolute.zip"), "leads out"));
  write_text(folder / "damaged.zip", "PK\3\4 and nothing");
  CHECK(contains(failure_of(folder / "damaged.zip"), "unpacked"));
  const auto limited = unpack(folder / "bomb.zip", {.bytes = 1 << 20});
  CHECK(contains(limited.failure().text, "more than 1 MB"));
}

TEST_CASE("an archive starts no program, whatever its stated compression") {
  const TemporaryFolder folder;
  const fs::path ran = folder / "ran";
  for (const char* name : {"lrzip", "grzip", "lzop", "uncompress"}) {
    write_text(folder / name, "#!/bin/sh\ntouch " + ran.string() + "\n");
    fs::permissions(folder / name, fs::perms::owner_all);
  }
  const char* const search_path = std::getenv("PATH");
  REQUIRE(search_path);
  const std::string path = search_path;
  setenv("PATH", (folder.path().string() + ":" + path).c_str(), 1);
  for (const std::string& head :
       {std::string("LRZI\0\6", 6), std::string("GRZipII\0\2\4:)", 12), std::string("\x89LZO\0\r\n\x1a\n", 9)}) {
    write_text(folder / "a.gz", head + std::string(600, '\0'));
    CHECK_FALSE(unpack(folder / "a.gz").ok());
  }
  setenv("PATH", path.c_str(), 1);
  CHECK_FALSE(fs::exists(ran));
}
