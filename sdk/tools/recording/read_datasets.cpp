// SPDX-License-Identifier: Apache-2.0
//
// Readers of image datasets: TUM RGB-D, KITTI odometry, folders of images.

#include <algorithm>
#include <cmath>

#include "sdk/host/config/camera_yaml.hpp"
#include "sdk/tools/recording/read_table.hpp"
#include "sdk/tools/recording/recording.hpp"
#include "sdk/tools/recording/text_rows.hpp"

namespace odograph {
namespace fs = std::filesystem;

namespace {

bool is_picture(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg" || extension == ".pgm" ||
         extension == ".bmp";
}

/// Pictures of a folder in the order of their names, with numbers by value ("2.png" before "10.png").
std::vector<fs::path> pictures_of(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (is_picture(entry.path())) files.push_back(entry.path());
  const auto key = [](const fs::path& path) {
    const std::string stem = path.stem().string();
    const size_t digits = stem.find_last_not_of("0123456789");
    std::string number = stem.substr(digits == std::string::npos ? 0 : digits + 1);
    number.insert(0, number.size() < 20 ? 20 - number.size() : 0, '0');
    return std::pair(stem.substr(0, digits == std::string::npos ? 0 : digits + 1), number);
  };
  std::sort(files.begin(), files.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  return files;
}

void add_frame(Recording& recording, int64_t t_ns, uint32_t camera, const fs::path& picture) {
  auto frame = make_message<odo_frame>(ODO_TYPE_FRAME, t_ns);
  frame.header.source = camera;
  recording.add(frame.header, {std::make_shared<const fs::path>(picture)});
}

/// One time per picture, if the folder has such a table; ns, or seconds with a decimal point.
Result<std::vector<int64_t>> times_of_pictures(const fs::path& folder) {
  const phone::Table table{phone::Stream::frame, "", "t_ns|timestamp|time|#1"};
  for (const char* name : {"times.csv", "timestamps.csv", "times.txt", "timestamps.txt"}) {
    std::error_code error;
    if (!fs::exists(folder / name, error)) continue;
    phone::Rows rows{&table, folder / name, {}};
    if (const auto read = phone::read_csv(folder / name, rows); !read) return read.failure();
    if (!rows.missing_column.empty())
      return Failure{ODO_E_DATA, (folder / name).string() + ": no column 't_ns', 'timestamp' or 'time'"};
    std::vector<int64_t> times;
    for (const phone::Row& row : rows.rows) times.push_back(row.t_ns);
    return times;
  }
  return std::vector<int64_t>();
}

}  // namespace

Result<Recording> read_image_folder(const fs::path& folder) {
  Recording recording{.format = "image folder", .path = folder};
  double fps = 30;
  const auto camera = read_camera_yaml(folder / "camera.yaml", &fps);
  if (!camera) return camera.failure();
  recording.add(camera->header);
  auto files = pictures_of(folder);
  if (files.empty()) files = pictures_of(folder / "images");
  if (files.empty())
    return Failure{ODO_E_DATA, folder.string() + ": no pictures (png, jpg, pgm, bmp) beside camera.yaml"};
  const auto times = times_of_pictures(folder);
  if (!times) return times.failure();
  if (!times->empty() && times->size() != files.size())
    return Failure{ODO_E_DATA, folder.string() + ": " + std::to_string(files.size()) + " pictures, " +
                                   std::to_string(times->size()) + " times; expected one for each"};
  for (size_t i = 0; i < files.size(); ++i)
    add_frame(recording, times->empty() ? std::llround(static_cast<double>(i) * 1e9 / fps) : (*times)[i], 0, files[i]);
  if (times->empty()) {
    char rate[32];
    std::snprintf(rate, sizeof rate, "%g Hz", fps);
    recording.warnings.push_back(std::string("no times.csv: pictures are taken to be at ") + rate +
                                 " ('fps' in camera.yaml)");
  }
  recording.warnings.push_back(
      "pictures only, no imu.csv: the metric scale is not observable (docs/phone_recordings.md, plain folder)");
  std::error_code error;
  if (fs::exists(folder / "groundtruth.tum", error)) {
    auto truth = read_tum(folder / "groundtruth.tum");
    if (!truth) return truth.failure();
    recording.truth = std::move(*truth);
  }
  return recording;
}

Result<Recording> read_kitti(const fs::path& folder) {
  Recording recording{.format = "KITTI odometry", .path = folder};
  auto calibration = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  calibration.model = ODO_CAMERA_PINHOLE;
  const auto calib = read_rows_with_names(folder / "calib.txt", [&](const TextRow& row) -> Result<bool> {
    if (row.fields[0] != "P0:") return true;
    double P[12];
    for (size_t i = 0; i < 12; ++i) {
      const auto value = row.number(i + 1);
      if (!value) return value.failure();
      P[i] = *value;
    }
    calibration.fx = P[0], calibration.cx = P[2], calibration.fy = P[5], calibration.cy = P[6];
    return true;
  });
  if (!calib) return calib.failure();
  if (!(calibration.fx > 0))
    return Failure{ODO_E_DATA,
                   (folder / "calib.txt").string() + ": no line 'P0: ...' with the left camera's projection"};
  const auto times = read_times(folder / "times.txt");
  if (!times) return times.failure();
  const auto files = pictures_of(folder / "image_0");
  if (files.size() > times->size())
    return Failure{ODO_E_DATA, folder.string() + ": " + std::to_string(files.size()) + " pictures in image_0 but " +
                                   std::to_string(times->size()) + " times in times.txt"};
  if (files.empty()) return Failure{ODO_E_DATA, (folder / "image_0").string() + ": no pictures"};
  Result<odo_frame> first = Failure{};
  for (size_t i = 0; i < files.size() && !first; ++i) {  // a damaged picture costs only its frame
    RecordedMessage probe;
    probe.message.assign(make_message<odo_frame>(ODO_TYPE_FRAME, 0).header);
    probe.picture = {std::make_shared<const fs::path>(files[i])};
    first = load_frame(probe);
  }
  if (!first) return first.failure();
  calibration.width = first->width, calibration.height = first->height;
  first->loan.release(first->loan.owner);
  recording.add(calibration.header);
  for (size_t i = 0; i < files.size(); ++i) add_frame(recording, (*times)[i], 0, files[i]);
  std::error_code error;
  if (fs::exists(folder / "poses.txt", error)) {
    auto truth = read_kitti_poses(folder / "poses.txt", folder / "times.txt");
    if (!truth) return truth.failure();
    recording.truth = std::move(*truth);
  }
  return recording;
}

Result<Recording> read_tum_rgbd(const fs::path& folder, const ReadOptions& options) {
  Recording recording{.format = "TUM RGB-D", .path = folder};
  std::error_code error;
  if (fs::exists(folder / "camera.yaml", error)) {
    const auto camera = read_camera_yaml(folder / "camera.yaml", nullptr);
    if (!camera) return camera.failure();
    recording.add(camera->header);
  } else {  // the dataset's recommended values for sequences without their own
    auto calibration = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
    calibration.model = ODO_CAMERA_PINHOLE;
    calibration.width = 640, calibration.height = 480;
    calibration.fx = calibration.fy = 525.0, calibration.cx = 319.5, calibration.cy = 239.5;
    recording.add(calibration.header);
    recording.warnings.push_back("no camera.yaml: taking the dataset's default intrinsics (525, 525, 319.5, 239.5)");
  }
  const auto pictures = read_rows(folder / "rgb.txt", [&](const TextRow& row) -> Result<bool> {
    const auto t = parse_seconds(row.fields[0]);
    if (!t) return row.wrong(t.failure().text);
    const auto picture = picture_of(row, folder, options);
    if (!picture) return picture.failure();
    add_frame(recording, *t, 0, *picture);
    return true;
  });
  if (!pictures) return pictures.failure();
  if (fs::exists(folder / "accelerometer.txt", error)) {
    const auto accel = read_rows(folder / "accelerometer.txt", [&](const TextRow& row) -> Result<bool> {
      const auto v = numbers(row, 4);
      const auto t = parse_seconds(row.fields[0]);
      if (!v) return v.failure();
      if (!t) return row.wrong(t.failure().text);
      auto imu = make_message<odo_imu>(ODO_TYPE_IMU, *t);
      imu.header.flags = ODO_IMU_ACCEL;
      for (size_t i = 0; i < 3; ++i) imu.accel_b[i] = (*v)[i + 1];
      recording.add(imu.header);
      return true;
    });
    if (!accel) return accel.failure();
  }
  if (fs::exists(folder / "groundtruth.txt", error)) {
    auto truth = read_tum(folder / "groundtruth.txt");
    if (!truth) return truth.failure();
    recording.truth = std::move(*truth);
  }
  recording.sort();
  return recording;
}

}  // namespace odograph
