// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/recording/phone_format.hpp"

#include "sdk/host/messages/messages.hpp"
#include "sdk/math/gravity.hpp"

namespace odograph::phone {
namespace {

constexpr double kMicro = 1e-6;
constexpr double kHectopascal = 100;
constexpr auto kSeconds = TimeUnit::seconds;
constexpr auto kMilliseconds = TimeUnit::milliseconds;
constexpr auto kNanoseconds = TimeUnit::nanoseconds;
const std::vector<const char*> kXyz = {"x", "y", "z"};

/// tszheichoi/awesome-sensor-logger: UNITS.md, COORDINATES.md, CROSSPLATFORM.md, VIDEO_SYNCHRONIZATION.md. On iOS
/// without "Standardise Units & Frames", accelerations have the opposite sign of specific force, and raw ones are in g.
Format sensor_logger() {
  const auto axes = [](Stream stream, const char* file, double scale = 1, When when = When::any, uint32_t flags = 0) {
    return Table{stream, file, "time", kNanoseconds, kXyz, scale, when, flags};
  };
  const auto place = [](const char* file) {
    return Table{.stream = Stream::place,
                 .file = file,
                 .time = "time",
                 .columns = {"latitude", "longitude", "?altitude", "?horizontalAccuracy", "?verticalAccuracy"}};
  };
  return {
      .name = "Sensor Logger",
      .marks = {"Metadata.csv", "AccelerometerUncalibrated.csv", "TotalAcceleration.csv", "GyroscopeUncalibrated.csv",
                "Gyroscope.csv"},
      .layout = Layout::csv,
      .tables = {axes(Stream::gyro, "GyroscopeUncalibrated.csv"),
                 axes(Stream::gyro, "Gyroscope.csv", 1, When::any, ODO_IMU_GYRO_CORRECTED),
                 axes(Stream::accel, "AccelerometerUncalibrated.csv", -kStandardGravity_mps2, When::apple),
                 axes(Stream::accel, "AccelerometerUncalibrated.csv", 1, When::android),
                 axes(Stream::accel, "TotalAcceleration.csv", 1, When::android, ODO_IMU_ACCEL_CORRECTED),
                 axes(Stream::linear_accel, "Accelerometer.csv", -1, When::apple, ODO_IMU_ACCEL_CORRECTED),
                 axes(Stream::linear_accel, "Accelerometer.csv", 1, When::android, ODO_IMU_ACCEL_CORRECTED),
                 axes(Stream::gravity, "Gravity.csv", -1, When::apple),
                 axes(Stream::gravity, "Gravity.csv", 1, When::android),
                 axes(Stream::field, "Magnetometer.csv", kMicro, When::any, ODO_MAGNETOMETER_CORRECTED),
                 axes(Stream::field, "MagnetometerUncalibrated.csv", kMicro),
                 {Stream::pressure, "Barometer.csv", "time", kNanoseconds, {"pressure"}, kHectopascal},
                 place("Location.csv"),
                 place("LocationGps.csv")},
      .video = "Camera/*.mp4|Camera/*.mov|*.mp4|*.mov",
      .pictures = "Camera/*.jpg|Camera/*.jpeg",
      .frame_times = FrameTimes::metadata_track,
      .switch_on_gyro = "switch on 'Gyroscope' (and, under its settings, the uncalibrated one)",
      .switch_on_accel =
          "switch on 'Accelerometer' and 'Gravity' (on Android also 'Total Acceleration'), best with "
          "'Log Uncalibrated Data'",
      .switch_on_video = "switch on 'Camera', rear, mode 'Video'",
      .switch_on_others = "'Magnetometer', 'Barometer', 'Location'",
  };
}

/// Exports of phyphox (phyphox/phyphox-android, DataExport.java): CSV with any separator and decimal mark, in one
/// folder or one level down. Its accelerometer contains gravity.
Format phyphox() {
  const auto axes = [](Stream stream, const char* file, std::vector<const char*> columns, double scale,
                       uint32_t flags) {
    return Table{stream, file, "time", kSeconds, std::move(columns), scale, When::any, flags};
  };
  return {
      .name = "phyphox",
      .marks = {"Gyroscope.csv", "*/Gyroscope.csv", "Accelerometer.csv", "*/Accelerometer.csv"},
      .layout = Layout::csv,
      .tables = {axes(Stream::gyro, "Gyroscope.csv|*/Gyroscope.csv",
                      {"x|gyroscope x", "y|gyroscope y", "z|gyroscope z"}, 1, ODO_IMU_GYRO_CORRECTED),
                 axes(Stream::accel, "Accelerometer.csv|*/Accelerometer.csv",
                      {"x|acceleration x", "y|acceleration y", "z|acceleration z"}, 1, 0),
                 axes(Stream::field, "Magnetometer.csv|*/Magnetometer.csv",
                      {"x|magnetic field x", "y|magnetic field y", "z|magnetic field z"}, kMicro,
                      ODO_MAGNETOMETER_CORRECTED),
                 axes(Stream::pressure, "Pressure.csv|*/Pressure.csv", {"pressure|x"}, kHectopascal, 0),
                 axes(Stream::place, "Location.csv|*/Location.csv",
                      {"latitude", "longitude", "?height", "?horizontal accuracy", "?vertical accuracy"}, 1, 0)},
      .head = "Time (s)",
      .switch_on_gyro = "an experiment of your own with 'Gyroscope' beside 'Accelerometer'",
      .switch_on_accel = "an experiment of your own with 'Accelerometer' (with g) beside 'Gyroscope'",
      .switch_on_video = "",
      .switch_on_others = "'Magnetic field', 'Pressure', 'Location'",
  };
}

/// SpectacularAI/docs, other/DATA_FORMAT.md.
Format spectacular() {
  const std::vector<const char*> values = {"/sensor/values/0", "/sensor/values/1", "/sensor/values/2"};
  const char *file = "data.jsonl", *time = "/time";
  return {
      .name = "Spectacular Rec",
      .marks = {"data.jsonl"},
      .layout = Layout::json_lines,
      .tables = {{Stream::gyro, file, time, kSeconds, values, 1, When::any, 0, "/sensor/type=gyroscope"},
                 {Stream::accel, file, time, kSeconds, values, 1, When::any, 0, "/sensor/type=accelerometer"},
                 {Stream::field, file, time, kSeconds, values, kMicro, When::any, 0, "/sensor/type=magnetometer"},
                 {Stream::place,
                  file,
                  time,
                  kSeconds,
                  {"/gps/latitude", "/gps/longitude", "?/gps/altitude", "?/gps/accuracy", "?/gps/verticalAccuracy"},
                  1,
                  When::any,
                  0,
                  "/gps"},
                 {Stream::frame,
                  file,
                  "/frames/0/time|/time",
                  kSeconds,
                  {"?/frames/0/cameraParameters/focalLengthX", "?/frames/0/cameraParameters/focalLengthY",
                   "?/frames/0/cameraParameters/principalPointX", "?/frames/0/cameraParameters/principalPointY"},
                  1,
                  When::any,
                  0,
                  "/frames"}},
      .video = "data.mp4|data.mov|data.mkv|data.avi|data.m4v",
      .switch_on_gyro = "nothing needs to be switched on: the phone has no gyroscope, or the file is cut off",
      .switch_on_accel = "nothing needs to be switched on: the phone has no accelerometer, or the file is cut off",
      .switch_on_video = "record with the camera",
      .switch_on_others = "GNSS",
  };
}

/// MobileRoboticsSkoltech/OpenCamera-Sensors, README.
Format opencamera() {
  const std::vector<const char*> xyz = {"#1", "#2", "#3"};
  return {
      .name = "OpenCamera Sensors",
      .marks = {"*_gyro.csv", "*_accel.csv", "*/*_gyro.csv", "*/*_accel.csv"},
      .layout = Layout::csv,
      .tables = {{Stream::gyro, "*_gyro.csv|*/*_gyro.csv", "#4", kNanoseconds, xyz},
                 {Stream::accel, "*_accel.csv|*/*_accel.csv", "#4", kNanoseconds, xyz},
                 {Stream::field, "*_magnetic.csv|*/*_magnetic.csv", "#4", kNanoseconds, xyz, kMicro},
                 {Stream::frame, "*_imu_timestamps.csv|*_timestamps.csv|*/*_imu_timestamps.csv|*/*_timestamps.csv",
                  "#1"}},
      .video = "VID*.mp4|*.mp4|*/*.mp4",
      .switch_on_gyro = "'IMU settings', 'Enable sync video IMU recording', gyroscope",
      .switch_on_accel = "'IMU settings', 'Enable sync video IMU recording', accelerometer",
      .switch_on_video = "the video is in DCIM/OpenCamera; put it beside the folder with the tables",
      .switch_on_others = "magnetometer in 'IMU settings'",
  };
}

/// DavidGillsjo/VideoIMUCapture-Android, protobuf/recording.proto: fields 4 (IMUData) and 5 (VideoFrameMetaData) of
/// VideoCaptureData.
Format video_imu_capture() {
  const char* file = "video_meta.pb3";
  return {
      .name = "VideoIMUCapture",
      .marks = {"video_meta.pb3"},
      .layout = Layout::protobuf,
      .tables = {{Stream::gyro, file, "1", kNanoseconds, {"2.1", "2.2", "2.3"}, 1, When::any, 0, "4"},
                 {Stream::accel, file, "1", kNanoseconds, {"4.1", "4.2", "4.3"}, 1, When::any, 0, "4"},
                 {Stream::field, file, "1", kNanoseconds, {"8.1", "8.2", "8.3"}, kMicro, When::any, 0, "4"},
                 {Stream::frame,
                  file,
                  "1",
                  kNanoseconds,
                  {"?8.1", "?8.1", "?none", "?none", "?3.1", "?5.1"},
                  1,
                  When::any,
                  0,
                  "5"}},
      .video = "video_recording.mp4|*.mp4",
      .switch_on_gyro = "nothing needs to be switched on: the phone has no gyroscope",
      .switch_on_accel = "nothing needs to be switched on: the phone has no accelerometer",
      .switch_on_video = "video_recording.mp4 is beside video_meta.pb3",
      .switch_on_others = "nothing more",
  };
}

/// OSUPCVLab/mobile-ar-sensor-logger. Its iOS app has already inverted the sign.
Format mars() {
  const char* imu = "gyro_accel.csv";
  const std::vector<const char*> lens = {
      "?fx", "?fy", "?cx", "?cy", "?exposure time|exposure duration", "?frame readout time"};
  return {
      .name = "MARS logger",
      .marks = {"gyro_accel.csv"},
      .layout = Layout::csv,
      .tables = {{Stream::gyro, imu, "timestamp", kNanoseconds, {"gx", "gy", "gz"}, 1, When::any, 0, "", "unix time"},
                 {Stream::accel, imu, "timestamp", kNanoseconds, {"ax", "ay", "az"}},
                 {Stream::place, "gps.csv", "timestamp", kNanoseconds, {"lat", "lon", "?alt"}},
                 {Stream::frame, "movie_metadata.csv", "timestamp", kNanoseconds, lens},
                 {Stream::frame, "frame_timestamps.txt", "frame timestamp|timestamp|#1"}},
      .video = "movie.mp4|*.mp4|*.mov",
      .switch_on_gyro = "nothing needs to be switched on: the phone has no gyroscope",
      .switch_on_accel = "nothing needs to be switched on: the phone has no accelerometer",
      .switch_on_video = "movie.mp4 is beside gyro_accel.csv",
      .switch_on_others = "nothing more",
  };
}

/// strayrobots/scanner, docs/format.md. The document states m/s^2, but the app writes Core Motion's values, in g and
/// with gravity's sign.
Format stray() {
  return {
      .name = "Stray Scanner",
      .marks = {"odometry.csv"},
      .layout = Layout::csv,
      .tables = {{Stream::gyro, "imu.csv", "timestamp", kSeconds, {"alpha_x", "alpha_y", "alpha_z"}},
                 {Stream::accel, "imu.csv", "timestamp", kSeconds, {"a_x", "a_y", "a_z"}, kByGravity},
                 {Stream::frame, "odometry.csv", "timestamp", kSeconds, {"?fx", "?fy", "?cx", "?cy"}},
                 {Stream::pose, "odometry.csv", "timestamp", kSeconds, {"x", "y", "z", "qx", "qy", "qz", "qw"}}},
      .video = "rgb.mp4|*.mp4",
      .switch_on_gyro = "nothing needs to be switched on; older versions of the app wrote no imu.csv",
      .switch_on_accel = "nothing needs to be switched on; older versions of the app wrote no imu.csv",
      .switch_on_video = "rgb.mp4 is beside odometry.csv",
      .switch_on_others = "nothing more",
  };
}

/// google/gps-measurement-tools: text format of GnssLogger.
Format gnss_logger() {
  using Columns = std::vector<const char*>;
  const auto rows = [](const char* kind, Stream stream, Columns columns, uint32_t flags = 0, double scale = 1) {
    Table table{.stream = stream, .file = "gnss_log*.txt|*.txt", .time = "elapsedRealtimeNanos"};
    table.columns = std::move(columns), table.scale = scale, table.flags = flags, table.kind = kind;
    table.unix_time = "utcTimeMillis", table.unix_unit = kMilliseconds;
    return table;
  };
  const Columns fix = {"LatitudeDegrees|Latitude", "LongitudeDegrees|Longitude", "?AltitudeMeters|Altitude",
                       "?AccuracyMeters|Accuracy", "?VerticalAccuracyMeters"};
  Table old_fix = rows("Fix", Stream::place, fix);  // without the time since the start of the phone
  old_fix.time = old_fix.unix_time = "(UTC)TimeInMs|UnixTimeMillis", old_fix.unit = kMilliseconds;
  return {
      .name = "GnssLogger",
      .marks = {"gnss_log*.txt"},
      .layout = Layout::named_rows,
      .tables = {rows("UncalGyro", Stream::gyro, {"UncalGyroXRadPerSec", "UncalGyroYRadPerSec", "UncalGyroZRadPerSec"}),
                 rows("Gyro", Stream::gyro, {"GyroXRadPerSec", "GyroYRadPerSec", "GyroZRadPerSec"},
                      ODO_IMU_GYRO_CORRECTED),
                 rows("UncalAccel", Stream::accel, {"UncalAccelXMps2", "UncalAccelYMps2", "UncalAccelZMps2"}),
                 rows("Accel", Stream::accel, {"AccelXMps2", "AccelYMps2", "AccelZMps2"}, ODO_IMU_ACCEL_CORRECTED),
                 rows("Mag", Stream::field, {"MagXMicroT", "MagYMicroT", "MagZMicroT"}, ODO_MAGNETOMETER_CORRECTED,
                      kMicro),
                 rows("UncalMag", Stream::field, {"UncalMagXMicroT", "UncalMagYMicroT", "UncalMagZMicroT"}, 0, kMicro),
                 rows("Fix", Stream::place, fix), old_fix},
      .switch_on_gyro = "switch on 'Sensors' beside 'Measurements' and 'Location' before the log begins",
      .switch_on_accel = "switch on 'Sensors' beside 'Measurements' and 'Location' before the log begins",
      .switch_on_video = "",
      .switch_on_others = "'Location'",
  };
}

/// A plain folder: times.csv (one row per picture) and imu.csv, with columns by name if there is a head, otherwise in
/// this order.
Format plain() {
  const auto rows = [](Stream stream, const char* file, std::vector<const char*> columns, double scale = 1) {
    return Table{stream, file, "t_ns|timestamp|time|#1", kNanoseconds, std::move(columns), scale};
  };
  return {
      .name = "plain folder",
      .marks = {"imu.csv"},
      .layout = Layout::csv,
      .tables = {rows(Stream::gyro, "imu.csv",
                      {"gyro_x|wx|gx|w_rs_s_x|#2", "gyro_y|wy|gy|w_rs_s_y|#3", "gyro_z|wz|gz|w_rs_s_z|#4"}),
                 rows(Stream::accel, "imu.csv",
                      {"accel_x|acc_x|ax|a_rs_s_x|#5", "accel_y|acc_y|ay|a_rs_s_y|#6", "accel_z|acc_z|az|a_rs_s_z|#7"}),
                 rows(Stream::frame, "times.csv|times.txt|timestamps.csv|timestamps.txt", {}),
                 rows(Stream::field, "magnetometer.csv|mag.csv", {"x|mag_x|#2", "y|mag_y|#3", "z|mag_z|#4"}, kMicro),
                 rows(Stream::pressure, "barometer.csv|pressure.csv", {"pressure|hpa|#2"}, kHectopascal),
                 rows(Stream::place, "gnss.csv|gps.csv|location.csv",
                      {"latitude|lat|#2", "longitude|lon|#3", "?height|altitude|alt|#4", "?sigma|accuracy|#5"})},
      .video = "video.mp4|*.mp4|*.mov|*.mkv|*.avi",
      .pictures = "*.png|*.jpg|*.jpeg|*.pgm|*.bmp|images/*.png|images/*.jpg|images/*.jpeg|images/*.pgm|images/*.bmp",
      .switch_on_gyro = "imu.csv has t_ns, gyro_x, gyro_y, gyro_z (rad/s), accel_x, accel_y, accel_z (m/s^2)",
      .switch_on_accel = "imu.csv has t_ns, gyro_x, gyro_y, gyro_z (rad/s), accel_x, accel_y, accel_z (m/s^2)",
      .switch_on_video = "pictures or a video beside imu.csv, and times.csv with one time in ns a picture",
      .switch_on_others = "magnetometer.csv (microtesla), barometer.csv (hPa), gnss.csv (degrees, m)",
  };
}

bool matches_one(const char* pattern, const char* name) {
  if (*pattern == '\0' || *pattern == '|') return *name == '\0';
  if (*pattern == '*')
    return matches_one(pattern + 1, name) || (*name != '\0' && *name != '/' && matches_one(pattern, name + 1));
  return *pattern == *name && matches_one(pattern + 1, name + 1);
}

}  // namespace

const std::vector<Format>& formats() {
  static const std::vector<Format> all = {phyphox(),           sensor_logger(), spectacular(),
                                          video_imu_capture(), mars(),          stray(),
                                          opencamera(),        gnss_logger(),   plain()};
  return all;
}

const char* name_of(Stream stream) {
  switch (stream) {
    case Stream::gyro: return "gyroscope";
    case Stream::accel: return "accelerometer";
    case Stream::linear_accel: return "acceleration without gravity";
    case Stream::gravity: return "gravity";
    case Stream::field: return "magnetometer";
    case Stream::pressure: return "barometer";
    case Stream::place: return "GNSS";
    case Stream::frame: return "times of frames";
    case Stream::pose: return "platform's poses";
  }
  return "";
}

bool matches(const std::string& pattern, const std::string& name) {
  for (size_t at = 0; at <= pattern.size();) {
    if (matches_one(pattern.c_str() + at, name.c_str())) return true;
    const size_t bar = pattern.find('|', at);
    if (bar == std::string::npos) return false;
    at = bar + 1;
  }
  return false;
}

}  // namespace odograph::phone
