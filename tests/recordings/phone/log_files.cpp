// SPDX-License-Identifier: Apache-2.0
//
// The walk as recorded by ROS 2: MCAP, with messages in hand-made CDR.
#include <map>

#include <doctest/doctest.h>

#include "sdk/tools/recording/mcap_writer.hpp"
#include "tests/recordings/phone/app_files.hpp"
#include "tests/support/support.hpp"

namespace {

constexpr double kLoggedDegrees = 57.29577951308232;

/// CDR of ROS 2: each number aligned to its size, counted from the end of the head.
class Cdr {
 public:
  Cdr() = default;
  Cdr(int64_t t_ns, const char* frame) { header(t_ns, frame); }
  void header(int64_t t_ns, const char* frame) {
    number<int32_t>(static_cast<int32_t>(t_ns / 1'000'000'000)),
        number<uint32_t>(static_cast<uint32_t>(t_ns % 1'000'000'000));
    text(frame);
  }
  template <class Number>
  void number(Number value) {
    bytes_.resize((bytes_.size() + sizeof value - 1) / sizeof value * sizeof value);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void doubles(const double* values, size_t count) {
    for (size_t i = 0; i < count; ++i) number<double>(values ? values[i] : 0.0);
  }
  void text(const std::string& text) {
    number<uint32_t>(static_cast<uint32_t>(text.size() + 1));
    bytes_.append(text.c_str(), text.size() + 1);
  }
  void raw(const void* data, size_t size) {
    number<uint32_t>(static_cast<uint32_t>(size));
    bytes_.append(static_cast<const char*>(data), size);
  }
  std::string message() const { return std::string("\0\1\0\0", 4) + bytes_; }

 private:
  std::string bytes_;
};

std::string sample_of(const odo_header& header, std::string& topic) {
  Cdr out(header.t_ns, header.type == ODO_TYPE_GNSS ? "gnss" : "imu");
  if (header.type == ODO_TYPE_IMU) {
    topic = "Imu";
    out.doubles(nullptr, 4 + 9), out.doubles(as<odo_imu>(header).gyro_b, 3), out.doubles(nullptr, 9);
    out.doubles(as<odo_imu>(header).accel_b, 3), out.doubles(nullptr, 9);
  } else if (header.type == ODO_TYPE_MAGNETOMETER) {
    topic = "MagneticField";
    out.doubles(as<odo_magnetometer>(header).field_b, 3), out.doubles(nullptr, 9);
  } else if (header.type == ODO_TYPE_BAROMETER) {
    topic = "FluidPressure";
    out.number<double>(as<odo_barometer>(header).pressure_pa), out.number<double>(0);
  } else if (header.type == ODO_TYPE_GNSS) {
    topic = "NavSatFix";
    const auto& g = as<odo_gnss>(header);
    out.number<int8_t>(0), out.number<uint16_t>(1);
    out.number<double>(g.latitude_rad * kLoggedDegrees), out.number<double>(g.longitude_rad * kLoggedDegrees);
    out.number<double>(g.height_m);
    double covariance[9];
    east_north_up(g.covariance_n, covariance);
    out.doubles(covariance, 9), out.number<uint8_t>(3);
  }
  return out.message();
}

/// The camera's mount: tf2_msgs/TFMessage with one transform, from camera to imu.
std::string transform_of(const odo_calibration& c, int64_t t_ns) {
  const double q[4] = {c.q_b_c[1], c.q_b_c[2], c.q_b_c[3], c.q_b_c[0]};
  Cdr out;
  out.number<uint32_t>(1);
  out.header(t_ns, "imu");
  out.text("camera"), out.doubles(c.p_b_c, 3), out.doubles(q, 4);
  return out.message();
}

}  // namespace

void write_ros2_mcap(const PhoneWalk& walk, const fs::path& folder) {
  fs::create_directories(folder);
  auto writer = required(McapWriter::create(folder / "walk_0.mcap", "ros2"));
  std::map<std::string, uint16_t> topics;
  const auto write = [&](const std::string& topic, const std::string& type, int64_t t_ns, const std::string& message) {
    const auto [known, fresh] = topics.try_emplace(topic, uint16_t(0));
    if (fresh) known->second = (*writer)->add({topic, "cdr", type, "ros2msg", "# as ROS has it"});
    (*writer)->write(known->second, t_ns, message);
  };
  for (const auto& m : walk.recording.messages) {
    std::string type;
    const std::string message = sample_of(m.message.header(), type);
    if (!type.empty()) write("/" + type, "sensor_msgs/msg/" + type, m.message.header().t_ns, message);
  }
  const odo_calibration& c = walk.lens;
  write("/tf_static", "tf2_msgs/msg/TFMessage", walk.times_ns[0], transform_of(walk.lens, walk.times_ns[0]));
  for (size_t i = 0; i < walk.pictures.size(); ++i) {
    Cdr info(walk.times_ns[i], "camera");
    const double k[9] = {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1};
    info.number<uint32_t>(c.height), info.number<uint32_t>(c.width), info.text("plumb_bob");
    info.number<uint32_t>(4), info.doubles(c.distortion, 4), info.doubles(k, 9), info.doubles(nullptr, 9 + 12);
    write("/camera/camera_info", "sensor_msgs/msg/CameraInfo", walk.times_ns[i], info.message());
    cv::Mat picture = walk.pictures[i];
    Cdr image(walk.times_ns[i], "camera");
    image.number<uint32_t>(uint32_t(picture.rows)), image.number<uint32_t>(uint32_t(picture.cols));
    image.text(picture.channels() == 1 ? "mono8" : "bgr8"), image.number<uint8_t>(0);
    image.number<uint32_t>(uint32_t(picture.step)), image.raw(picture.data, picture.step * size_t(picture.rows));
    write("/camera/image_raw", "sensor_msgs/msg/Image", walk.times_ns[i], image.message());
  }
  write("/rosout", "rcl_interfaces/msg/Log", walk.times_ns[0], std::string("\0\1\0\0", 4));
  REQUIRE((*writer)->finish().ok());
}
