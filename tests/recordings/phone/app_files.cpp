// SPDX-License-Identifier: Apache-2.0
#include "tests/recordings/phone/app_files.hpp"

#include <cmath>
#include <cstdio>
#include <fstream>

#include <archive.h>
#include <archive_entry.h>
#include <doctest/doctest.h>

#include "sdk/math/gravity.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/recording/odo_file.hpp"
#include "tests/recordings/phone/video_file.hpp"
#include "tests/support/support.hpp"

namespace {

constexpr int64_t kBoot_ns = 1'781'700'000'000'000'000;  // boot time of the phone
constexpr double kDegrees = 57.29577951308232;

std::string digits(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

/// Calls with every message of a type.
template <class Message, class Take>
void each(const PhoneWalk& walk, uint32_t type, Take&& take) {
  for (const auto& m : walk.recording.messages)
    if (m.message.header().type == type) take(as<Message>(m.message.header()));
}

/// A table of all samples of a sensor, made line by line.
template <class Message, class Line>
void write_table(const PhoneWalk& walk, const fs::path& file, const std::string& head, uint32_t type, Line&& line) {
  std::string text = head.empty() ? "" : head + "\n";
  each<Message>(walk, type, [&](const Message& m) { text += line(m) + "\n"; });
  fs::create_directories(file.parent_path());
  write_text(file, text);
}

std::string t_of(const odo_header& header) { return std::to_string(header.t_ns); }
std::string elapsed(const odo_header& header) { return digits(seconds(header.t_ns - kEpoch_ns)); }

/// Sensor Logger's rows: time, seconds, z, y, x.
std::string zyx(const odo_header& header, const double* v, double scale) {
  return t_of(header) + "," + elapsed(header) + "," + digits(scale * v[2]) + "," + digits(scale * v[1]) + "," +
         digits(scale * v[0]);
}

void write_sensor_logger(const PhoneWalk& walk, const fs::path& folder, bool apple, bool standardised, bool raw) {
  const std::string head = "time,seconds_elapsed,z,y,x";
  const double sign = apple && !standardised ? -1 : 1;
  const double gravity[3] = {0.1, 9.4, 2.6};
  const auto imu = [&](const char* name, auto&& line) {
    write_table<odo_imu>(walk, folder / name, head, ODO_TYPE_IMU, line);
  };
  imu("Gyroscope.csv", [](const odo_imu& m) { return zyx(m.header, m.gyro_b, 1); });
  if (raw) {
    imu("GyroscopeUncalibrated.csv", [](const odo_imu& m) { return zyx(m.header, m.gyro_b, 1); });
    const double scale = sign < 0 ? -1 / kStandardGravity_mps2 : 1;
    imu("AccelerometerUncalibrated.csv", [&](const odo_imu& m) { return zyx(m.header, m.accel_b, scale); });
  }
  imu("Accelerometer.csv", [&](const odo_imu& m) {
    double v[3];
    for (int i = 0; i < 3; ++i) v[i] = m.accel_b[i] - gravity[i];
    return zyx(m.header, v, sign);
  });
  imu("Gravity.csv", [&](const odo_imu& m) { return zyx(m.header, gravity, sign); });
  if (!apple) imu("TotalAcceleration.csv", [](const odo_imu& m) { return zyx(m.header, m.accel_b, 1); });
  write_table<odo_magnetometer>(walk, folder / "Magnetometer.csv", head, ODO_TYPE_MAGNETOMETER,
                                [](const odo_magnetometer& m) { return zyx(m.header, m.field_b, 1e6); });
  write_table<odo_barometer>(walk, folder / "Barometer.csv", "time,seconds_elapsed,relativeAltitude,pressure",
                             ODO_TYPE_BAROMETER, [](const odo_barometer& m) {
                               return t_of(m.header) + "," + elapsed(m.header) + ",0," + digits(m.pressure_pa / 100);
                             });
  write_table<odo_gnss>(walk, folder / "Location.csv",
                        "time,seconds_elapsed,bearingAccuracy,speedAccuracy,verticalAccuracy,horizontalAccuracy,speed,"
                        "bearing,altitude,longitude,latitude",
                        ODO_TYPE_GNSS, [](const odo_gnss& m) {
                          return t_of(m.header) + "," + elapsed(m.header) + ",-1,-1," +
                                 digits(std::sqrt(m.covariance_n[8])) + "," + digits(std::sqrt(2 * m.covariance_n[0])) +
                                 ",1.2,90," + digits(m.height_m) + "," + digits(m.longitude_rad * kDegrees) + "," +
                                 digits(m.latitude_rad * kDegrees);
                        });
  write_text(folder / "Metadata.csv", std::string("version,device name,recording epoch time,recording time,recording "
                                                  "timezone,platform,appVersion,standardisation\n") +
                                          "3," + (apple ? "iPhone14,5" : "SM-S721B") +
                                          ",1781801310952,2026-06-18_16-48-30,Europe/Paris," +
                                          (apple ? "ios" : "android") + ",1.60.0," + (standardised ? "true" : "false"));
  const fs::path video = folder / "Camera" / "1781801310305.mp4";  // 0.7 s before the first frame
  fs::create_directories(video.parent_path());
  REQUIRE(write_video(video, walk.pictures, walk.times_ns));
  std::vector<std::pair<int64_t, int64_t>> samples;
  for (const int64_t t : walk.times_ns) samples.emplace_back(t - walk.times_ns[0], t);
  samples.emplace_back(samples.back().first + 100'000'000, samples.back().second + 100'000'000);  // one too many
  add_metadata_track(video, samples);
}

std::string list3(const double* v) { return digits(v[0]) + "," + digits(v[1]) + "," + digits(v[2]); }

void write_spectacular(const PhoneWalk& walk, const fs::path& folder) {
  std::string text;
  size_t number = 0;
  const auto time = [](int64_t t_ns) {
    char seconds_text[40];
    std::snprintf(seconds_text, sizeof seconds_text, "%.9f", seconds(t_ns - kEpoch_ns));
    return std::string(",\"time\":") + seconds_text + "}\n";
  };
  const auto sensor = [&](const char* type, const double* v, int64_t t) {
    text += std::string("{\"sensor\":{\"type\":\"") + type + "\",\"values\":[" + list3(v) + "]}" + time(t);
  };
  for (const auto& m : walk.recording.messages) {
    const odo_header& h = m.message.header();
    if (h.type == ODO_TYPE_IMU) {
      sensor("gyroscope", as<odo_imu>(h).gyro_b, h.t_ns);
      sensor("accelerometer", as<odo_imu>(h).accel_b, h.t_ns);
    } else if (h.type == ODO_TYPE_MAGNETOMETER) {
      const double* f = as<odo_magnetometer>(h).field_b;
      const double micro[3] = {1e6 * f[0], 1e6 * f[1], 1e6 * f[2]};
      sensor("magnetometer", micro, h.t_ns);
    } else if (h.type == ODO_TYPE_GNSS) {
      const auto& g = as<odo_gnss>(h);
      text += "{\"gps\":{\"accuracy\":" + digits(std::sqrt(2 * g.covariance_n[0])) +
              ",\"altitude\":" + digits(g.height_m) + ",\"latitude\":" + digits(g.latitude_rad * kDegrees) +
              ",\"longitude\":" + digits(g.longitude_rad * kDegrees) +
              ",\"verticalAccuracy\":" + digits(std::sqrt(g.covariance_n[8])) + "}" + time(h.t_ns);
    } else if (h.type == ODO_TYPE_FRAME) {
      text += "{\"frames\":[{\"cameraInd\":0}],\"number\":" + std::to_string(number++) + time(h.t_ns);
    }
  }
  fs::create_directories(folder);
  write_text(folder / "data.jsonl", text);
  const Eigen::Matrix3d R_c_b = raw_quaternion(walk.lens.q_b_c).toRotationMatrix().transpose();
  const Eigen::Vector3d p_c_b = -R_c_b * Eigen::Vector3d(walk.lens.p_b_c);
  std::string T;
  for (int i = 0; i < 3; ++i)
    T += "[" + digits(R_c_b(i, 0)) + "," + digits(R_c_b(i, 1)) + "," + digits(R_c_b(i, 2)) + "," + digits(p_c_b[i]) +
         "],";
  write_text(folder / "calibration.json",
             "{\"cameras\":[{\"focalLengthX\":" + digits(walk.lens.fx) + ",\"focalLengthY\":" + digits(walk.lens.fy) +
                 ",\"principalPointX\":" + digits(walk.lens.cx) + ",\"principalPointY\":" + digits(walk.lens.cy) +
                 ",\"model\":\"pinhole\",\"imageWidth\":" + std::to_string(walk.lens.width) +
                 ",\"imageHeight\":" + std::to_string(walk.lens.height) + ",\"imuToCamera\":[" + T + "[0,0,0,1]]}]}");
  REQUIRE(write_video(folder / "data.mp4", walk.pictures, walk.times_ns));
}

void write_opencamera(const PhoneWalk& walk, const fs::path& folder) {
  const std::string name = "VID_20261125_101112";
  const fs::path tables = folder / "20261125_101112";
  const auto boot = [](const odo_header& h) { return std::to_string(h.t_ns - kBoot_ns); };
  write_table<odo_imu>(walk, tables / (name + "_gyro.csv"), "", ODO_TYPE_IMU,
                       [&](const odo_imu& m) { return list3(m.gyro_b) + "," + boot(m.header); });
  write_table<odo_imu>(walk, tables / (name + "_accel.csv"), "", ODO_TYPE_IMU,
                       [&](const odo_imu& m) { return list3(m.accel_b) + "," + boot(m.header); });
  write_table<odo_magnetometer>(walk, tables / (name + "_magnetic.csv"), "", ODO_TYPE_MAGNETOMETER,
                                [&](const odo_magnetometer& m) {
                                  return digits(1e6 * m.field_b[0]) + "," + digits(1e6 * m.field_b[1]) + "," +
                                         digits(1e6 * m.field_b[2]) + "," + boot(m.header);
                                });
  write_table<odo_frame>(walk, tables / (name + "_imu_timestamps.csv"), "", ODO_TYPE_FRAME,
                         [&](const odo_frame& m) { return boot(m.header); });
  REQUIRE(write_video(folder / (name + ".mp4"), walk.pictures, walk.times_ns));
}

void write_mars(const PhoneWalk& walk, const fs::path& folder) {
  const auto boot = [](const odo_header& h) { return std::to_string(h.t_ns - kBoot_ns); };
  write_table<odo_imu>(
      walk, folder / "gyro_accel.csv",
      "Timestamp[nanosec],gx[rad/s],gy[rad/s],gz[rad/s],ax[m/s^2],ay[m/s^2],az[m/s^2],Unix time[nanosec]", ODO_TYPE_IMU,
      [&](const odo_imu& m) {
        return boot(m.header) + "," + list3(m.gyro_b) + "," + list3(m.accel_b) + "," + t_of(m.header);
      });
  write_table<odo_frame>(walk, folder / "frame_timestamps.txt", "Frame timestamp[nanosec],Unix time[nanosec]",
                         ODO_TYPE_FRAME, [&](const odo_frame& m) { return boot(m.header) + "," + t_of(m.header); });
  REQUIRE(write_video(folder / "movie.mp4", walk.pictures, walk.times_ns));
}

/// Fields of a Protocol Buffers message.
std::string varint(uint64_t value) {
  std::string bytes;
  for (; value >= 0x80; value >>= 7) bytes += static_cast<char>(value | 0x80);
  return bytes + static_cast<char>(value);
}
std::string number_field(uint32_t field, uint64_t value) { return varint(field << 3) + varint(value); }
std::string bytes_field(uint32_t field, const std::string& bytes) {
  return varint(field << 3 | 2) + varint(bytes.size()) + bytes;
}
std::string floats_field(uint32_t field, const std::vector<double>& values) {
  std::string bytes;
  for (const double value : values) {
    const auto one = static_cast<float>(value);
    bytes.append(reinterpret_cast<const char*>(&one), sizeof one);
  }
  return bytes_field(field, bytes);
}

void write_video_imu_capture(const PhoneWalk& walk, const fs::path& folder) {
  const auto& c = walk.lens;
  std::string text = bytes_field(2, floats_field(1, {c.fx, c.fy, c.cx, c.cy, 0}) +
                                        bytes_field(11, number_field(1, c.width) + number_field(2, c.height)));
  each<odo_imu>(walk, ODO_TYPE_IMU, [&](const odo_imu& m) {
    text += bytes_field(4, number_field(1, static_cast<uint64_t>(m.header.t_ns)) +
                               floats_field(2, {m.gyro_b[0], m.gyro_b[1], m.gyro_b[2]}) +
                               floats_field(4, {m.accel_b[0], m.accel_b[1], m.accel_b[2]}));
  });
  uint64_t number = 0;
  each<odo_frame>(walk, ODO_TYPE_FRAME, [&](const odo_frame& m) {
    text += bytes_field(5, number_field(1, static_cast<uint64_t>(m.header.t_ns)) + number_field(2, number++));
  });
  fs::create_directories(folder);
  write_text(folder / "video_meta.pb3", text);
  REQUIRE(write_video(folder / "video_recording.mp4", walk.pictures, walk.times_ns));
}

void write_stray(const PhoneWalk& walk, const fs::path& folder) {
  const auto s = [](int64_t t_ns) {
    char text[40];
    std::snprintf(text, sizeof text, "%.9f", seconds(t_ns - kEpoch_ns));
    return std::string(text);
  };
  write_table<odo_imu>(
      walk, folder / "imu.csv", "timestamp, a_x, a_y, a_z, alpha_x, alpha_y, alpha_z", ODO_TYPE_IMU,
      [&](const odo_imu& m) {
        const double g = -1 / kStandardGravity_mps2, a[3] = {g * m.accel_b[0], g * m.accel_b[1], g * m.accel_b[2]};
        return s(m.header.t_ns) + ", " + list3(a) + ", " + list3(m.gyro_b);
      });
  // ARKit's world: y up, z backwards; the app writes the pose of a camera that looks along its own z.
  Eigen::Matrix3d R_w_n;
  R_w_n << 0, 1, 0, 0, 0, -1, -1, 0, 0;
  std::string odometry = "timestamp, frame, x, y, z, qx, qy, qz, qw\n";
  size_t number = 0;
  for (const StampedPose& pose : walk.recording.truth) {
    const Eigen::Quaterniond q = Eigen::Quaterniond(R_w_n) * pose.q;
    const Eigen::Vector3d p = R_w_n * pose.p;
    char frame[16];
    std::snprintf(frame, sizeof frame, "%06zu", number++);
    odometry += s(pose.t_ns) + ", " + frame + ", " + digits(p.x()) + ", " + digits(p.y()) + ", " + digits(p.z()) +
                ", " + digits(q.x()) + ", " + digits(q.y()) + ", " + digits(q.z()) + ", " + digits(q.w()) + "\n";
  }
  write_text(folder / "odometry.csv", odometry);
  const auto& c = walk.lens;
  write_text(folder / "camera_matrix.csv", digits(c.fx) + ", 0.0, " + digits(c.cx) + "\n0.0, " + digits(c.fy) + ", " +
                                               digits(c.cy) + "\n0.0, 0.0, 1.0");
  REQUIRE(write_video(folder / "rgb.mp4", walk.pictures, walk.times_ns));
}

void write_gnss_logger(const PhoneWalk& walk, const fs::path& folder) {
  std::string text =
      "# \n# Header Description:\n# \n# "
      "UncalAccel,utcTimeMillis,elapsedRealtimeNanos,UncalAccelXMps2,UncalAccelYMps2,UncalAccelZMps2,BiasXMps2,"
      "BiasYMps2,BiasZMps2\n"
      "# "
      "UncalGyro,utcTimeMillis,elapsedRealtimeNanos,UncalGyroXRadPerSec,UncalGyroYRadPerSec,UncalGyroZRadPerSec,"
      "DriftXRadPerSec,DriftYRadPerSec,DriftZRadPerSec\n"
      "# "
      "Fix,Provider,LatitudeDegrees,LongitudeDegrees,AltitudeMeters,SpeedMps,AccuracyMeters,BearingDegrees,"
      "UnixTimeMillis,SpeedAccuracyMps,BearingAccuracyDegrees,elapsedRealtimeNanos,VerticalAccuracyMeters\n";
  for (const auto& m : walk.recording.messages) {
    const odo_header& h = m.message.header();
    const std::string boot = std::to_string(h.t_ns - kBoot_ns), utc = std::to_string(h.t_ns / 1'000'000);
    if (h.type == ODO_TYPE_IMU) {
      text += "UncalAccel," + utc + "," + boot + "," + list3(as<odo_imu>(h).accel_b) + ",0,0,0\n";
      text += "UncalGyro," + utc + "," + boot + "," + list3(as<odo_imu>(h).gyro_b) + ",0,0,0\n";
    } else if (h.type == ODO_TYPE_GNSS) {
      const auto& g = as<odo_gnss>(h);
      text += "Fix,GPS," + digits(g.latitude_rad * kDegrees) + "," + digits(g.longitude_rad * kDegrees) + "," +
              digits(g.height_m) + ",1.2," + digits(std::sqrt(2 * g.covariance_n[0])) + ",90.0," + utc + ",0.3,10," +
              boot + "," + digits(std::sqrt(g.covariance_n[8])) + "\n";
    }
  }
  fs::create_directories(folder);
  write_text(folder / "gnss_log_2026_11_25_10_11_12.txt", text);
}

void write_plain(const PhoneWalk& walk, const fs::path& folder) {
  write_table<odo_imu>(
      walk, folder / "imu.csv", "t_ns,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z", ODO_TYPE_IMU,
      [](const odo_imu& m) { return t_of(m.header) + "," + list3(m.gyro_b) + "," + list3(m.accel_b); });
  write_table<odo_frame>(walk, folder / "times.csv", "t_ns", ODO_TYPE_FRAME,
                         [](const odo_frame& m) { return t_of(m.header); });
  REQUIRE(write_video(folder / "video.mp4", walk.pictures, walk.times_ns));
}

}  // namespace

const std::vector<App>& apps() {
  static const auto logger = [](bool apple, bool standardised, bool raw) {
    return [=](const PhoneWalk& walk, const fs::path& folder) {
      write_sensor_logger(walk, folder, apple, standardised, raw);
    };
  };
  static const std::vector<App> all = {
      {"Sensor Logger (Android)", logger(false, false, true)},
      {"Sensor Logger (Android)", logger(false, false, false)},
      {"Sensor Logger (iOS)", logger(true, false, true)},
      {"Sensor Logger (iOS)", logger(true, false, false)},
      {"Sensor Logger (iOS)", logger(true, true, false)},
      {"Spectacular Rec", write_spectacular, true},
      {"OpenCamera Sensors", write_opencamera},
      {"VideoIMUCapture", write_video_imu_capture, true},
      {"MARS logger", write_mars},
      {"Stray Scanner", write_stray, true},
      {"GnssLogger", write_gnss_logger, true},
      {"plain folder", write_plain},
      {"MCAP", write_ros2_mcap, true},
  };
  return all;
}

void east_north_up(const double* n, double* e) {
  constexpr size_t kAxis[3] = {1, 0, 2};
  constexpr int kSign[3] = {1, 1, -1};
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j) e[3 * i + j] = kSign[i] * kSign[j] * n[3 * kAxis[i] + kAxis[j]];
}

void write_lens(const PhoneWalk& walk, const fs::path& folder) {
  const auto& c = walk.lens;
  fs::create_directories(folder);
  write_text(folder / "camera.yaml", "model: pinhole\nwidth: " + std::to_string(c.width) +
                                         "\nheight: " + std::to_string(c.height) + "\nfx: " + digits(c.fx) +
                                         "\nfy: " + digits(c.fy) + "\ncx: " + digits(c.cx) + "\ncy: " + digits(c.cy) +
                                         "\ndistortion: [0, 0, 0, 0]\n");
}

void write_zip(const fs::path& folder, const fs::path& zip, const std::string& prefix) {
  archive* out = archive_write_new();
  archive_write_set_format_zip(out);
  REQUIRE(archive_write_open_filename(out, zip.c_str()) == ARCHIVE_OK);
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    const std::string bytes = read_text(entry.path());
    archive_entry* head = archive_entry_new();
    archive_entry_set_pathname(head, (prefix + entry.path().lexically_relative(folder).generic_string()).c_str());
    archive_entry_set_size(head, static_cast<la_int64_t>(bytes.size()));
    archive_entry_set_filetype(head, AE_IFREG);
    archive_entry_set_perm(head, 0644);
    REQUIRE(archive_write_header(out, head) == ARCHIVE_OK);
    archive_write_data(out, bytes.data(), bytes.size());
    archive_entry_free(head);
  }
  archive_write_close(out), archive_write_free(out);
}
