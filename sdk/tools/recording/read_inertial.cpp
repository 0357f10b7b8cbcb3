// SPDX-License-Identifier: Apache-2.0
//
// Readers of recordings with inertial sensors: EuRoC/ASL, ADVIO, Indoor Location Competition.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sdk/host/config/camera_yaml.hpp"
#include "sdk/host/config/spec.hpp"
#include "sdk/math/scalar.hpp"
#include "sdk/math/gravity.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/recording/distortion.hpp"
#include "sdk/tools/recording/recording.hpp"
#include "sdk/tools/recording/text_rows.hpp"

namespace odograph {
namespace fs = std::filesystem;

namespace {

/// Adds one message per row, built by `make(values, t_ns)` from the numbers of the row.
template <class Make>
Result<bool> add_rows(Recording& recording, const fs::path& file, size_t least, bool nanoseconds, Make&& make) {
  return read_rows(file, [&](const TextRow& row) -> Result<bool> {
    const auto v = numbers(row, least);
    if (!v) return v.failure();
    const auto t = nanoseconds ? row.integer(0) : parse_seconds(row.fields[0]);
    if (!t) return row.wrong(t.failure().text);
    const auto message = make(*v, *t);
    recording.add(message.header);
    return true;
  });
}

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

/// A list of exactly `count` numbers (any number for 0), each within +-`limit`; failures state the position.
Result<std::vector<double>> reals(const std::string& file, const YamlNode& map, const char* key, size_t count,
                                  double limit) {
  const YamlNode* node = map.find(key);
  if (!node || node->kind != YamlNode::Kind::sequence || (count > 0 && node->items.size() != count))
    return Failure{ODO_E_DATA, at(file, node ? node->mark : map.mark,
                                  std::string(key) + ": expected a list of " +
                                      (count > 0 ? std::to_string(count) + " numbers" : "numbers"))};
  std::vector<double> values;
  for (const auto& item : node->items) {
    const auto value = parse_quantity(item.text, "");
    if (!value || !std::isfinite(*value) || std::abs(*value) > limit)
      return Failure{ODO_E_DATA,
                     at(file, item.mark,
                        std::string(key) + ": '" + item.text + "'; expected a number within +-" + number_text(limit))};
    values.push_back(*value);
  }
  return values;
}

/// The mount from T_BS, a 4 x 4 matrix from the camera to the body.
Result<bool> read_mount(const std::string& file, const YamlNode& T, odo_calibration& c) {
  const auto T_b_c = reals(file, T, "data", 16, 1e3);
  if (!T_b_c) return T_b_c.failure();
  Eigen::Matrix3d R;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) R(i, j) = (*T_b_c)[static_cast<size_t>(4 * i + j)];
  if (!((R * R.transpose() - Eigen::Matrix3d::Identity()).norm() < 0.01) || !(R.determinant() > 0))
    return Failure{ODO_E_DATA, at(file, T.find("data")->mark, "T_BS: its 3 x 3 part is no rotation")};
  const Eigen::Quaterniond q = Eigen::Quaterniond(R).normalized();
  put_quaternion(q, c.q_b_c);
  for (size_t i = 0; i < 3; ++i) c.p_b_c[i] = (*T_b_c)[4 * i + 3];
  c.header.flags = ODO_CALIBRATION_EXTRINSICS;
  return true;
}

/// sensor.yaml of a camera in the ASL format.
Result<odo_calibration> read_asl_camera(const fs::path& path, uint32_t id) {
  const std::string file = path.string();
  const auto node = read_yaml(file);
  if (!node) return node.failure();
  const auto intrinsics = reals(file, *node, "intrinsics", 4, 1e6);
  if (!intrinsics) return intrinsics.failure();
  const auto resolution = reals(file, *node, "resolution", 2, 1e6);
  if (!resolution) return resolution.failure();
  auto c = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  c.header.source = id;
  if (const YamlNode* camera = node->find("camera_model"); camera && camera->text != "pinhole")
    return Failure{ODO_E_DATA,
                   at(file, camera->mark, "camera_model '" + camera->text.substr(0, 40) + "'; expected pinhole")};
  c.fx = (*intrinsics)[0], c.fy = (*intrinsics)[1], c.cx = (*intrinsics)[2], c.cy = (*intrinsics)[3];
  for (const double pixels : *resolution)
    if (!(pixels >= 1 && pixels <= 16384 && pixels == std::floor(pixels)))
      return Failure{ODO_E_DATA, at(file, node->find("resolution")->mark,
                                    "resolution: " + number_text(pixels) + "; expected whole pixels, 1 to 16384")};
  c.width = static_cast<uint32_t>((*resolution)[0]), c.height = static_cast<uint32_t>((*resolution)[1]);
  std::vector<double> k;
  if (node->find("distortion_coefficients")) {
    const auto given = reals(file, *node, "distortion_coefficients", 0, 1e4);
    if (!given) return given.failure();
    k = *given;
  }
  const YamlNode* model = node->find("distortion_model");
  if (const std::string fault = take_distortion(c, model ? model->text : "", k); !fault.empty())
    return Failure{ODO_E_DATA, at(file, (model ? model : node->find("distortion_coefficients"))->mark, fault)};
  if (const YamlNode* T = node->find("T_BS"))
    if (const auto mount = read_mount(file, *T, c); !mount) return mount.failure();
  if (const std::string fault = message_fault(c.header); !fault.empty())
    return Failure{ODO_E_DATA, at(file, node->find("intrinsics")->mark, fault)};
  return c;
}

double scalar(const YamlNode& node, const char* key) {
  const YamlNode* found = node.find(key);
  const auto value = found ? parse_quantity(found->text, "") : Result<double>(0.0);
  return value ? *value : 0.0;
}

Result<bool> add_euroc_imu(Recording& recording, const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder / "sensor.yaml", error)) {
    const auto node = read_yaml((folder / "sensor.yaml").string());
    if (!node) return node.failure();
    auto noise = make_message<odo_imu_noise>(ODO_TYPE_IMU_NOISE, 0);
    noise.gyro_noise = scalar(*node, "gyroscope_noise_density");
    noise.gyro_walk = scalar(*node, "gyroscope_random_walk");
    noise.accel_noise = scalar(*node, "accelerometer_noise_density");
    noise.accel_walk = scalar(*node, "accelerometer_random_walk");
    if (noise.gyro_noise > 0) recording.add(noise.header);
  }
  if (!fs::exists(folder / "data.csv", error)) return true;
  return add_rows(recording, folder / "data.csv", 7, true, [](const auto& v, int64_t t) {
    auto imu = make_message<odo_imu>(ODO_TYPE_IMU, t);
    imu.header.flags = ODO_IMU_GYRO | ODO_IMU_ACCEL;
    for (size_t i = 0; i < 3; ++i) imu.gyro_b[i] = v[1 + i], imu.accel_b[i] = v[4 + i];
    return imu;
  });
}

Result<bool> add_euroc_camera(Recording& recording, const fs::path& folder, const ReadOptions& options) {
  std::error_code error;
  if (!fs::exists(folder, error)) return true;
  const bool described = fs::exists(folder / "sensor.yaml", error);
  if (described) {
    const auto camera = read_asl_camera(folder / "sensor.yaml", 0);
    if (!camera) return camera.failure();
    recording.add(camera->header);
  } else {
    recording.warnings.push_back("cam0 has no sensor.yaml: the config's 'camera: camera.yaml' must give the lens");
  }
  const auto sensor = described ? read_yaml((folder / "sensor.yaml").string()) : Result<YamlNode>(Failure{});
  auto frame = make_message<odo_frame>(ODO_TYPE_FRAME, 0);
  const double line_s = sensor ? scalar(*sensor, "line_delay") : 0;  // our own key, with Kalibr's name
  if (!(line_s >= 0 && line_s < 1e-2))
    return Failure{ODO_E_DATA, (folder / "sensor.yaml").string() + ": line_delay: " + number_text(line_s) +
                                   "; expected seconds from one row to the next, below 0.01"};
  frame.line_time_ns = nanoseconds(line_s);
  if (frame.line_time_ns > 0) frame.header.flags |= ODO_FRAME_LINE_TIME;
  return read_rows(folder / "data.csv", [&](const TextRow& row) -> Result<bool> {
    const auto t = row.integer(0);
    if (!t) return t.failure();
    const auto picture = picture_of(row, folder / "data", options);
    if (!picture) return picture.failure();
    frame.header.t_ns = *t;
    recording.add(frame.header, {std::make_shared<const fs::path>(*picture)});
    return true;
  });
}

/// Sets the truth of the camera if there is one: the file's is the body's.
Result<bool> set_euroc_truth(Recording& recording, const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) return true;
  auto truth = read_euroc_truth(file);
  if (!truth) return truth.failure();
  for (const auto& m : recording.messages)
    if (m.message.header().type == ODO_TYPE_CALIBRATION && (m.message.header().flags & ODO_CALIBRATION_EXTRINSICS)) {
      const auto& c = as<odo_calibration>(m.message.header());
      const Eigen::Quaterniond q_b_c = raw_quaternion(c.q_b_c);
      for (auto& x : *truth) {
        x.p += x.q * Eigen::Vector3d(c.p_b_c);
        x.q = x.q * q_b_c;
      }
    }
  recording.truth = std::move(*truth);
  return true;
}

odo_imu advio_imu(uint32_t flag, const std::vector<double>& v, int64_t t) {
  auto imu = make_message<odo_imu>(ODO_TYPE_IMU, t);
  imu.header.flags = flag;
  for (size_t i = 0; i < 3; ++i)  // iOS gives the direction of gravity, in g; specific force is its opposite
    (flag == ODO_IMU_GYRO ? imu.gyro_b : imu.accel_b)[i] =
        flag == ODO_IMU_GYRO ? v[1 + i] : -kStandardGravity_mps2 * v[1 + i];
  return imu;
}

odo_magnetometer advio_field(const std::vector<double>& v, int64_t t) {
  auto m = make_message<odo_magnetometer>(ODO_TYPE_MAGNETOMETER, t);
  for (size_t i = 0; i < 3; ++i) m.field_b[i] = v[1 + i] * 1e-6;
  return m;
}

odo_barometer advio_pressure(const std::vector<double>& v, int64_t t) {
  auto m = make_message<odo_barometer>(ODO_TYPE_BAROMETER, t);
  m.pressure_pa = v[1] * 1000.0;
  return m;
}

odo_gnss advio_place(const std::vector<double>& v, int64_t t) {
  auto m = make_message<odo_gnss>(ODO_TYPE_GNSS, t);
  m.header.flags = ODO_GNSS_POSITION | ODO_GNSS_HEIGHT | ODO_GNSS_COVARIANCE;
  m.latitude_rad = v[1] * kRad_per_deg, m.longitude_rad = v[2] * kRad_per_deg;
  m.height_m = v[4];
  m.covariance_n[0] = m.covariance_n[4] = 0.5 * v[3] * v[3];
  m.covariance_n[8] = v[5] * v[5];
  return m;
}

Result<bool> add_advio_frames(Recording& recording, const fs::path& folder) {
  const fs::path phone = folder / "iphone";
  std::error_code error;
  if (!fs::exists(phone / "frames", error) || !fs::exists(phone / "frames.csv", error)) {
    if (fs::exists(phone / "frames.mov", error))
      recording.warnings.push_back(
          "iphone/frames.mov is not read; for pictures run: ffmpeg -i frames.mov frames/%05d.png, and add a "
          "camera.yaml");
    return true;
  }
  const auto camera = read_camera_yaml(folder / "camera.yaml", nullptr);
  if (!camera) return camera.failure();
  recording.add(camera->header);
  int64_t index = 0;
  return read_rows(phone / "frames.csv", [&](const TextRow& row) -> Result<bool> {
    const auto t = parse_seconds(row.fields[0]);
    if (!t) return row.wrong(t.failure().text);
    char name[32];
    std::snprintf(name, sizeof name, "%05lld.png", static_cast<long long>(++index));
    recording.add(make_message<odo_frame>(ODO_TYPE_FRAME, *t).header,
                  {std::make_shared<const fs::path>(phone / "frames" / name)});
    return true;
  });
}

Result<bool> add_advio_truth(Recording& recording, const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) return true;
  return read_rows(file, [&](const TextRow& row) -> Result<bool> {
    const auto v = numbers(row, 8);
    const auto t = parse_seconds(row.fields[0]);
    if (!v) return v.failure();
    if (!t) return row.wrong(t.failure().text);
    recording.truth.push_back(
        {*t, Eigen::Quaterniond((*v)[4], (*v)[5], (*v)[6], (*v)[7]).normalized(), {(*v)[1], (*v)[2], (*v)[3]}});
    return true;
  });
}

}  // namespace

Result<Recording> read_euroc(const fs::path& given, const ReadOptions& options) {
  std::error_code error;
  const fs::path folder = fs::exists(given / "mav0", error) ? given / "mav0" : given;
  Recording recording{.format = "EuRoC/ASL", .path = given};
  if (const auto done = add_euroc_imu(recording, folder / "imu0"); !done) return done.failure();
  if (const auto done = add_euroc_camera(recording, folder / "cam0", options); !done) return done.failure();
  if (const auto done = set_euroc_truth(recording, folder / "state_groundtruth_estimate0/data.csv"); !done)
    return done.failure();
  if (recording.messages.empty()) return Failure{ODO_E_DATA, given.string() + ": neither imu0/data.csv nor cam0 in it"};
  recording.sort();
  return recording;
}

Result<Recording> read_advio(const fs::path& folder) {
  Recording recording{.format = "ADVIO", .path = folder};
  const fs::path phone = folder / "iphone";
  const auto add = [&](const char* name, size_t columns, auto&& message) -> Result<bool> {
    std::error_code error;
    return fs::exists(phone / name, error) ? add_rows(recording, phone / name, columns, false, message)
                                           : Result<bool>(true);
  };
  const auto accel = [](const auto& v, int64_t t) { return advio_imu(ODO_IMU_ACCEL, v, t); };
  const auto gyro = [](const auto& v, int64_t t) { return advio_imu(ODO_IMU_GYRO, v, t); };
  if (const auto done = add("accelerometer.csv", 4, accel); !done) return done.failure();
  if (const auto done = add("gyro.csv", 4, gyro); !done) return done.failure();
  if (const auto done = add("magnetometer.csv", 4, advio_field); !done) return done.failure();
  if (const auto done = add("barometer.csv", 2, advio_pressure); !done) return done.failure();
  if (const auto done = add("platform-location.csv", 6, advio_place); !done) return done.failure();
  if (const auto done = add_advio_frames(recording, folder); !done) return done.failure();
  if (const auto done = add_advio_truth(recording, folder / "ground-truth/pose.csv"); !done) return done.failure();
  if (recording.messages.empty()) return Failure{ODO_E_DATA, folder.string() + ": no sensor files in iphone/"};
  recording.sort();
  return recording;
}

Result<Recording> read_indoor_location(const fs::path& file) {
  Recording recording{.format = "Indoor Location Competition", .path = file};
  const auto done = read_rows(file, [&](const TextRow& row) -> Result<bool> {
    if (row.fields.size() < 2) return row.wrong("expected 'time TYPE values'");
    const std::string_view type = row.fields[1];
    const bool accel = type == "TYPE_ACCELEROMETER", gyro = type == "TYPE_GYROSCOPE",
               field = type == "TYPE_MAGNETIC_FIELD", attitude = type == "TYPE_ROTATION_VECTOR";
    if (!accel && !gyro && !field && !attitude && type != "TYPE_WAYPOINT") return true;  // WiFi, beacons
    const auto milliseconds = row.integer(0);
    if (!milliseconds) return milliseconds.failure();
    if (*milliseconds < 0 || *milliseconds > 9'000'000'000'000) return row.wrong("the time is out of range");
    double v[3] = {0, 0, 0};
    for (size_t i = 0; i < (type == "TYPE_WAYPOINT" ? 2u : 3u); ++i) {
      const auto value = row.number(2 + i);
      if (!value) return value.failure();
      v[i] = *value;
    }
    const int64_t t_ns = *milliseconds * 1'000'000;
    if (attitude) {  // vector part of the rotation from b to east, north, up
      const Eigen::Quaterniond q_enu_b(std::sqrt(std::max(0.0, 1 - v[0] * v[0] - v[1] * v[1] - v[2] * v[2])), v[0],
                                       v[1], v[2]);
      const Eigen::Quaterniond q_n_enu(0, std::sqrt(0.5), std::sqrt(0.5), 0);
      recording.phone_attitudes.push_back({t_ns, (q_n_enu * q_enu_b).normalized(), Eigen::Vector3d::Zero()});
    } else if (field) {
      auto m = make_message<odo_magnetometer>(ODO_TYPE_MAGNETOMETER, t_ns);
      for (int i = 0; i < 3; ++i) m.field_b[i] = v[i] * 1e-6;
      recording.add(m.header);
    } else if (accel || gyro) {
      auto m = make_message<odo_imu>(ODO_TYPE_IMU, t_ns);
      m.header.flags = accel ? ODO_IMU_ACCEL : ODO_IMU_GYRO;
      std::copy(v, v + 3, accel ? m.accel_b : m.gyro_b);
      recording.add(m.header);
    } else {
      auto m = make_message<odo_waypoint>(ODO_TYPE_WAYPOINT, t_ns);
      m.p_n[0] = v[1], m.p_n[1] = v[0];  // the floor map has x east and y north
      m.sigma_m = 0.5;
      recording.add(m.header);
    }
    return true;
  });
  if (!done) return done.failure();
  if (!recording.has(ODO_TYPE_IMU))
    return Failure{
        ODO_E_DATA,
        file.string() + ": no TYPE_ACCELEROMETER and TYPE_GYROSCOPE rows; not an Indoor Location Competition trace?"};
  recording.sort();
  return recording;
}

}  // namespace odograph
