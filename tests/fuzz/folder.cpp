// SPDX-License-Identifier: Apache-2.0
//
// Recordings that are folders. The first byte selects the kind; the files follow, each up to a byte 0x1e.
#include <vector>

#include "sdk/tools/recording/read_phone.hpp"
#include "sdk/tools/recording/recording.hpp"
#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/scratch.hpp"

namespace {

struct Format {
  std::string name;
  std::vector<std::string> files;
  odograph::Result<odograph::Recording> (*read)(const std::filesystem::path&);
};

odograph::Result<odograph::Recording> read_app(const std::filesystem::path& folder) {
  return odograph::read_phone(folder);
}

const std::vector<Format>& formats() {
  using namespace odograph;
  static const std::vector<Format> all = {
      {"euroc",
       {"mav0/imu0/data.csv", "mav0/imu0/sensor.yaml", "mav0/cam0/data.csv", "mav0/cam0/sensor.yaml",
        "mav0/state_groundtruth_estimate0/data.csv"},
       [](const std::filesystem::path& folder) { return read_euroc(folder); }},
      {"tum",
       {"rgb.txt", "camera.yaml", "accelerometer.txt", "groundtruth.txt"},
       [](const std::filesystem::path& folder) { return read_tum_rgbd(folder); }},
      {"kitti", {"calib.txt", "times.txt", "poses.txt", "image_0/000000.png"}, read_kitti},
      {"advio",
       {"iphone/accelerometer.csv", "iphone/gyro.csv", "iphone/magnetometer.csv", "iphone/barometer.csv",
        "iphone/platform-location.csv", "iphone/frames.csv", "camera.yaml", "ground-truth/pose.csv",
        "iphone/frames/00001.png"},
       read_advio},
      {"images", {"camera.yaml", "groundtruth.tum", "000000.png"}, read_image_folder},
      {"logger",
       {"Metadata.csv", "Gyroscope.csv", "Accelerometer.csv", "Gravity.csv", "Barometer.csv", "Location.csv",
        "Camera/1781801310305.jpg"},
       read_app},
      {"spectacular", {"data.jsonl", "calibration.json"}, read_app},
      {"capture", {"video_meta.pb3"}, read_app},
      {"mars", {"gyro_accel.csv", "frame_timestamps.txt", "movie.mp4"}, read_app},
      {"stray", {"imu.csv", "odometry.csv", "camera_matrix.csv"}, read_app},
      {"gnss", {"gnss_log_1.txt"}, read_app},
      {"plain", {"imu.csv", "times.csv", "camera.yaml", "1.png"}, read_app},
  };
  return all;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  fuzz::Bytes left(data, size);
  const Format& format = formats()[left.take<uint8_t>() % formats().size()];
  for (const auto& file : format.files) fuzz::put(format.name + "/" + file, left.take_until(0x1e));
  (void)format.read(fuzz::folder() / format.name);
  return 0;
}
