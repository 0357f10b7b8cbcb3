// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/recording/log_messages.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "sdk/math/scalar.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/tools/recording/distortion.hpp"
#include "sdk/tools/recording/log_fields.hpp"
#include "sdk/tools/recording/picture_header.hpp"

namespace odograph {
namespace {

void take_message(const odo_header& message, LoggedMessage& out) {
  if (message_is_good(message)) out.message.assign(message);
}

/// A covariance that begins with -1 marks a quantity as not measured.
bool measured(const double (&covariance)[9]) { return covariance[0] != -1; }

void read_imu(LogFields& in, LoggedMessage& out) {
  double unused[9], gyro_covariance[9]{}, accel_covariance[9]{};
  auto imu = make_message<odo_imu>(ODO_TYPE_IMU, 0);
  in.header(out);
  in.optional_numbers("orientation", unused, 4);
  in.optional_numbers("orientation_covariance", unused, 9);
  in.numbers("angular_velocity", imu.gyro_b, 3);
  in.optional_numbers("angular_velocity_covariance", gyro_covariance, 9);
  in.numbers("linear_acceleration", imu.accel_b, 3);
  in.optional_numbers("linear_acceleration_covariance", accel_covariance, 9);
  const auto any = [](const double(&v)[3]) { return v[0] != 0 || v[1] != 0 || v[2] != 0; };
  // Drivers set unmeasured quantities to zero, which no real sensor yields.
  imu.header.flags = (measured(gyro_covariance) && any(imu.gyro_b) ? ODO_IMU_GYRO : 0) |
                     (measured(accel_covariance) && any(imu.accel_b) ? ODO_IMU_ACCEL : 0);
  if (in.good() && imu.header.flags != 0) take_message(imu.header, out);
}

void read_field(LogFields& in, LoggedMessage& out) {
  auto m = make_message<odo_magnetometer>(ODO_TYPE_MAGNETOMETER, 0);
  in.header(out);
  in.numbers("magnetic_field", m.field_b, 3);
  if (in.good()) take_message(m.header, out);
}

void read_pressure(LogFields& in, LoggedMessage& out) {
  auto m = make_message<odo_barometer>(ODO_TYPE_BAROMETER, 0);
  in.header(out);
  in.numbers("fluid_pressure", &m.pressure_pa, 1);
  if (in.good()) take_message(m.header, out);
}

/// Degrees, m, and a covariance in east, north, up.
void take_place(const double (&place)[3], const double (&covariance)[9], uint32_t kind, LoggedMessage& out) {
  auto m = make_message<odo_gnss>(ODO_TYPE_GNSS, 0);
  m.header.flags = ODO_GNSS_POSITION;
  m.latitude_rad = place[0] * kRad_per_deg, m.longitude_rad = place[1] * kRad_per_deg;
  if (std::isfinite(place[2])) m.height_m = place[2], m.header.flags |= ODO_GNSS_HEIGHT;
  if (kind != 0) {
    constexpr int kAxis[3] = {1, 0, 2}, kSign[3] = {1, 1, -1};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) m.covariance_n[3 * i + j] = kSign[i] * kSign[j] * covariance[3 * kAxis[i] + kAxis[j]];
    m.header.flags |= ODO_GNSS_COVARIANCE;
  }
  take_message(m.header, out);
}

void read_place(LogFields& in, LoggedMessage& out) {
  double place[3]{}, covariance[9]{};
  in.header(out);
  const auto status = static_cast<int8_t>(in.byte("status/status"));
  in.half("status/service");
  in.numbers("latitude", &place[0], 1), in.numbers("longitude", &place[1], 1), in.numbers("altitude", &place[2], 1);
  in.optional_numbers("position_covariance", covariance, 9);
  const uint32_t kind = in.byte("position_covariance_type");
  if (in.good() && status >= 0) take_place(place, covariance, kind, out);
}

/// K is fx 0 cx 0 fy cy 0 0 1; all zero for an uncalibrated camera.
void take_lens(uint32_t width, uint32_t height, const std::string& model, const std::vector<double>& d,
               const double (&k)[9], LoggedMessage& out) {
  if (k[0] == 0) return;
  auto c = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  c.width = width, c.height = height;
  c.fx = k[0], c.fy = k[4], c.cx = k[2], c.cy = k[5];
  out.lens_fault = take_distortion(c, model, d);
  if (out.lens_fault.empty()) take_message(c.header, out);
}

void read_lens(LogFields& in, LoggedMessage& out) {
  double k[9]{};
  in.header(out);
  const uint32_t height = in.word("height"), width = in.word("width");
  const std::string model = in.text("distortion_model");
  const auto d = in.list("D|d");
  in.numbers("K|k", k, 9);
  if (in.good()) take_lens(width, height, model, d, k, out);
}

void read_image(LogFields& in, LoggedMessage& out) {
  in.header(out);
  LoggedMessage::Picture picture;
  picture.height = in.word("height"), picture.width = in.word("width");
  picture.encoding = in.text("encoding");
  in.byte("is_bigendian");
  picture.step = in.word("step");
  in.bytes("data", picture.bytes);
  if (in.good()) out.picture = std::move(picture);
}

void read_compressed(LogFields& in, LoggedMessage& out) {
  in.header(out);
  LoggedMessage::Picture picture;
  in.text("format");
  in.bytes("data", picture.bytes);
  if (in.good()) out.picture = std::move(picture);
}

void take_transform(std::string parent, std::string child, const double (&p)[3], const double (&q)[4],
                    LoggedMessage& out) {
  const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
  const Eigen::Vector3d shift(p[0], p[1], p[2]);
  if (std::abs(rotation.norm() - 1) < 0.01 && shift.norm() < 1e6)
    out.transforms.push_back({std::move(parent), std::move(child), rotation.normalized(), shift});
}

void read_transforms(LogFields& in, LoggedMessage& out) {
  const size_t count = in.begin_list("transforms");
  for (size_t i = 0; i < count && in.good(); ++i) {
    in.item(i);
    LoggedMessage head;
    double p[3]{}, q[4]{};
    in.header(head);
    const std::string child = in.text("child_frame_id");
    in.numbers("transform/translation", p, 3), in.numbers("transform/rotation", q, 4);
    if (in.good()) take_transform(head.frame, child, p, q, out);
  }
}

/// Foxglove's, as JSON.
void read_foxglove_transform(LogFields& in, LoggedMessage& out) {
  double p[3]{}, q[4]{};
  in.numbers("translation", p, 3), in.numbers("rotation", q, 4);
  if (in.good()) take_transform(in.text("parent_frame_id"), in.text("child_frame_id"), p, q, out);
}

struct Type {
  const char* name;
  void (*read)(LogFields&, LoggedMessage&);
  bool json_only = false;
};
constexpr Type kTypes[] = {
    {"sensor_msgs/Imu", read_imu},
    {"sensor_msgs/MagneticField", read_field},
    {"sensor_msgs/FluidPressure", read_pressure},
    {"sensor_msgs/NavSatFix", read_place},
    {"sensor_msgs/CameraInfo", read_lens},
    {"sensor_msgs/Image", read_image},
    {"sensor_msgs/CompressedImage", read_compressed},
    {"tf2_msgs/TFMessage", read_transforms},
    {"foxglove.RawImage", read_image, true},
    {"foxglove.CompressedImage", read_compressed, true},
    {"foxglove.LocationFix", read_place, true},
    {"foxglove.CameraCalibration", read_lens, true},
    {"foxglove.FrameTransform", read_foxglove_transform, true},
};

const Type* type_of(const std::string& name) {
  for (const Type& type : kTypes)
    if (name == type.name) return &type;
  return nullptr;
}

/// Pixel encodings as ROS names them: bytes per pixel, and the OpenCV conversion to BGR (-1: none needed, or grey).
struct Encoding {
  const char* name;
  int channels, conversion;
};
constexpr Encoding kEncodings[] = {
    {"mono8", 1, -1},
    {"8UC1", 1, -1},
    {"bgr8", 3, -1},
    {"8UC3", 3, -1},
    {"rgb8", 3, cv::COLOR_RGB2BGR},
    {"bgra8", 4, cv::COLOR_BGRA2BGR},
    {"8UC4", 4, cv::COLOR_BGRA2BGR},
    {"rgba8", 4, cv::COLOR_RGBA2BGR},
    {"bayer_rggb8", 1, cv::COLOR_BayerBG2BGR},  // OpenCV names the pattern by the second row's second and third pixel
    {"bayer_bggr8", 1, cv::COLOR_BayerRG2BGR},
    {"bayer_gbrg8", 1, cv::COLOR_BayerGR2BGR},
    {"bayer_grbg8", 1, cv::COLOR_BayerGB2BGR},
    {"yuv422", 2, cv::COLOR_YUV2BGR_UYVY},
    {"uyvy", 2, cv::COLOR_YUV2BGR_UYVY},
    {"yuv422_yuy2", 2, cv::COLOR_YUV2BGR_YUY2},
    {"yuyv", 2, cv::COLOR_YUV2BGR_YUY2},
};

const Encoding* encoding_of(const std::string& name) {
  for (const Encoding& encoding : kEncodings)
    if (name == encoding.name) return &encoding;
  return nullptr;
}

}  // namespace

std::string unsupported_reason(const LogTopic& topic) {
  const Type* type = type_of(topic.type);
  if (!type) return "of an unsupported type";
  if (topic.encoding == "json" || (!type->json_only && (topic.encoding == "ros1" || topic.encoding == "cdr")))
    return "";
  return "encoded as '" + topic.encoding + "'; expected " + (type->json_only ? "json" : "ros1, cdr or json");
}

Result<LoggedMessage> decode_logged(const LogTopic& topic, Bytes bytes, bool with_pixels) {
  const Type* type = type_of(topic.type);
  if (!type || !unsupported_reason(topic).empty()) return Failure{ODO_E_UNSUPPORTED, unsupported_reason(topic)};
  LoggedMessage out;
  const auto in = log_fields(topic.encoding, bytes, with_pixels);
  type->read(*in, out);
  if (!in->good()) return Failure{ODO_E_DATA, "a message that does not fit its type " + topic.type};
  return out;
}

bool is_supported_encoding(const std::string& encoding) { return encoding.empty() || encoding_of(encoding) != nullptr; }

cv::Mat image_of(const LoggedMessage::Picture& picture) {
  if (picture.encoding.empty()) {
    if (picture.bytes.empty() || !picture_size(picture.bytes, "picture")) return {};
    return cv::imdecode(picture.bytes, cv::IMREAD_ANYCOLOR | cv::IMREAD_IGNORE_ORIENTATION);
  }
  const Encoding* encoding = encoding_of(picture.encoding);
  const uint64_t row = encoding ? uint64_t(picture.width) * uint64_t(encoding->channels) : 0;
  if (!encoding || picture.width == 0 || picture.height == 0 || picture.width > kMaxSide || picture.height > kMaxSide ||
      picture.step < row || picture.bytes.size() < uint64_t(picture.step) * (picture.height - 1) + row)
    return {};
  const cv::Mat pixels(static_cast<int>(picture.height), static_cast<int>(picture.width), CV_8UC(encoding->channels),
                       const_cast<unsigned char*>(picture.bytes.data()), picture.step);
  if (encoding->conversion < 0) return pixels.clone();
  cv::Mat out;
  try {
    cv::cvtColor(pixels, out, encoding->conversion);
  } catch (const cv::Exception&) {  // odd side lengths
    return {};
  }
  return out;
}

}  // namespace odograph
