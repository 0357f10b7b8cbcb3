// SPDX-License-Identifier: Apache-2.0
//
// Validation of messages: every number of every type in turn, at and beside its limits.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "sdk/host/messages/messages.hpp"
#include "tests/support/support.hpp"

using namespace odograph;

TEST_SUITE_BEGIN("messages");

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();

/// Constraint of a number; `natural`: 0 or more; `any`: the host's own, or never accepted from outside.
enum class Rule { finite, natural, positive, share, unit, direction, lat, lon, height, place, sensed, matrix, any };

struct Field {
  uint32_t type;
  const char* name;
  size_t offset, size;
  Rule rule;
  uint32_t flag;  // its valid flag; 0: always valid
  size_t count() const { return size / sizeof(double); }
};

constexpr uint32_t kPosition = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_DOWN | ODO_FIX_GEODETIC;

#define ODO_FIELD(type, message, field, rule, flag) \
  Field { type, #field, offsetof(message, field), sizeof(message::field), Rule::rule, flag }

const Field kFields[] = {
    ODO_FIELD(ODO_TYPE_IMU, odo_imu, gyro_b, sensed, ODO_IMU_GYRO),
    ODO_FIELD(ODO_TYPE_IMU, odo_imu, accel_b, sensed, ODO_IMU_ACCEL),
    ODO_FIELD(ODO_TYPE_MAGNETOMETER, odo_magnetometer, field_b, sensed, 0),
    ODO_FIELD(ODO_TYPE_MAGNETOMETER, odo_magnetometer, sigma_t, natural, ODO_MAGNETOMETER_SIGMA),
    ODO_FIELD(ODO_TYPE_BAROMETER, odo_barometer, pressure_pa, sensed, 0),
    ODO_FIELD(ODO_TYPE_BAROMETER, odo_barometer, sigma_pa, natural, ODO_BAROMETER_SIGMA),
    ODO_FIELD(ODO_TYPE_GNSS, odo_gnss, latitude_rad, lat, ODO_GNSS_POSITION),
    ODO_FIELD(ODO_TYPE_GNSS, odo_gnss, longitude_rad, lon, ODO_GNSS_POSITION),
    ODO_FIELD(ODO_TYPE_GNSS, odo_gnss, height_m, height, ODO_GNSS_HEIGHT),
    ODO_FIELD(ODO_TYPE_GNSS, odo_gnss, covariance_n, matrix, ODO_GNSS_COVARIANCE),
    ODO_FIELD(ODO_TYPE_GNSS, odo_gnss, velocity_n, finite, ODO_GNSS_VELOCITY),
    ODO_FIELD(ODO_TYPE_GNSS, odo_gnss, lever_b, finite, ODO_GNSS_LEVER),
    ODO_FIELD(ODO_TYPE_FRAME, odo_frame, fx, positive, ODO_FRAME_INTRINSICS),
    ODO_FIELD(ODO_TYPE_FRAME, odo_frame, fy, positive, ODO_FRAME_INTRINSICS),
    ODO_FIELD(ODO_TYPE_FRAME, odo_frame, cx, finite, ODO_FRAME_INTRINSICS),
    ODO_FIELD(ODO_TYPE_FRAME, odo_frame, cy, finite, ODO_FRAME_INTRINSICS),
    ODO_FIELD(ODO_TYPE_CALIBRATION, odo_calibration, fx, positive, 0),
    ODO_FIELD(ODO_TYPE_CALIBRATION, odo_calibration, fy, positive, 0),
    ODO_FIELD(ODO_TYPE_CALIBRATION, odo_calibration, cx, finite, 0),
    ODO_FIELD(ODO_TYPE_CALIBRATION, odo_calibration, cy, finite, 0),
    ODO_FIELD(ODO_TYPE_CALIBRATION, odo_calibration, distortion, finite, 0),
    ODO_FIELD(ODO_TYPE_CALIBRATION, odo_calibration, q_b_c, unit, ODO_CALIBRATION_EXTRINSICS),
    ODO_FIELD(ODO_TYPE_CALIBRATION, odo_calibration, p_b_c, finite, ODO_CALIBRATION_EXTRINSICS),
    ODO_FIELD(ODO_TYPE_IMU_NOISE, odo_imu_noise, gyro_noise, natural, 0),
    ODO_FIELD(ODO_TYPE_IMU_NOISE, odo_imu_noise, gyro_walk, natural, 0),
    ODO_FIELD(ODO_TYPE_IMU_NOISE, odo_imu_noise, accel_noise, natural, 0),
    ODO_FIELD(ODO_TYPE_IMU_NOISE, odo_imu_noise, accel_walk, natural, 0),
    ODO_FIELD(ODO_TYPE_WAYPOINT, odo_waypoint, p_n, place, 0),
    ODO_FIELD(ODO_TYPE_WAYPOINT, odo_waypoint, sigma_m, natural, 0),
    ODO_FIELD(ODO_TYPE_WAYPOINT, odo_waypoint, lever_b, finite, ODO_WAYPOINT_LEVER),
    ODO_FIELD(ODO_TYPE_EARTH_FIELD, odo_earth_field, declination_rad, finite, ODO_EARTH_FIELD_DECLINATION),
    ODO_FIELD(ODO_TYPE_EARTH_FIELD, odo_earth_field, inclination_rad, finite, ODO_EARTH_FIELD_INCLINATION),
    ODO_FIELD(ODO_TYPE_EARTH_FIELD, odo_earth_field, intensity_t, positive, ODO_EARTH_FIELD_INTENSITY),
    ODO_FIELD(ODO_TYPE_PLATFORM_POSE, odo_platform_pose, q_w, unit, 0),
    ODO_FIELD(ODO_TYPE_PLATFORM_POSE, odo_platform_pose, p_w, finite, 0),
    ODO_FIELD(ODO_TYPE_PLATFORM_POSE, odo_platform_pose, covariance, matrix, ODO_PLATFORM_POSE_COVARIANCE),
    ODO_FIELD(ODO_TYPE_RANGE, odo_range, range_m, natural, 0),
    ODO_FIELD(ODO_TYPE_RANGE, odo_range, sigma_m, positive, 0),
    ODO_FIELD(ODO_TYPE_RANGE, odo_range, p_n, place, ODO_RANGE_TRANSMITTER),
    ODO_FIELD(ODO_TYPE_RANGE, odo_range, transmitter_sigma_m, natural, ODO_RANGE_TRANSMITTER),
    ODO_FIELD(ODO_TYPE_RANGE, odo_range, lever_b, finite, ODO_RANGE_LEVER),
    ODO_FIELD(ODO_TYPE_SYSTEM_STEP, odo_system_step, distance_m, natural, ODO_SYSTEM_STEP_DISTANCE),
    ODO_FIELD(ODO_TYPE_ATTITUDE, odo_attitude, q_n_b, unit, 0),
    ODO_FIELD(ODO_TYPE_ATTITUDE, odo_attitude, covariance_n, matrix, ODO_ATTITUDE_COVARIANCE),
    ODO_FIELD(ODO_TYPE_ATTITUDE, odo_attitude, gyro_bias_b, finite, ODO_ATTITUDE_GYRO_BIAS),
    ODO_FIELD(ODO_TYPE_STEP, odo_step, length_m, natural, 0),
    ODO_FIELD(ODO_TYPE_STEP, odo_step, sigma_m, natural, 0),
    ODO_FIELD(ODO_TYPE_STEP, odo_step, frequency_hz, finite, 0),
    ODO_FIELD(ODO_TYPE_STEP, odo_step, heading_rad, finite, ODO_STEP_HEADING),
    ODO_FIELD(ODO_TYPE_STEP, odo_step, heading_sigma_rad, positive, ODO_STEP_HEADING_SIGMA),
    ODO_FIELD(ODO_TYPE_VO_MOTION, odo_vo_motion, q_c0_c1, unit, ODO_VO_ROTATION),
    ODO_FIELD(ODO_TYPE_VO_MOTION, odo_vo_motion, p_c0_c1, finite, ODO_VO_TRANSLATION),
    ODO_FIELD(ODO_TYPE_VO_MOTION, odo_vo_motion, covariance, matrix, ODO_VO_COVARIANCE),
    ODO_FIELD(ODO_TYPE_VO_MOTION, odo_vo_motion, q_n_c0, any, ODO_FLAG_NAVIGATION),
    ODO_FIELD(ODO_TYPE_VO_MOTION, odo_vo_motion, scale_sigma, natural, ODO_VO_METRIC | ODO_VO_INERTIAL),
    ODO_FIELD(ODO_TYPE_VO_MOTION, odo_vo_motion, velocity_c1, finite, ODO_VO_INERTIAL),
    ODO_FIELD(ODO_TYPE_VO_MOTION, odo_vo_motion, gravity_c1, direction, ODO_VO_INERTIAL),
    ODO_FIELD(ODO_TYPE_VO_MOTION, odo_vo_motion, gyro_bias_b, finite, ODO_VO_INERTIAL),
    ODO_FIELD(ODO_TYPE_VO_MOTION, odo_vo_motion, accel_bias_b, finite, ODO_VO_INERTIAL),
    ODO_FIELD(ODO_TYPE_SCALE, odo_scale, scale, natural, 0),
    ODO_FIELD(ODO_TYPE_SCALE, odo_scale, sigma, natural, 0),
    ODO_FIELD(ODO_TYPE_SCALE, odo_scale, displacement_m, finite, 0),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, p_n, place, kPosition),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, covariance_n, matrix, ODO_FIX_COVARIANCE),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, q_n_b, unit, ODO_FIX_ORIENTATION),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, orientation_cov_n, matrix, ODO_FIX_ORIENTATION_COVARIANCE),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, yaw_rad, finite, ODO_FIX_YAW),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, yaw_sigma_rad, positive, ODO_FIX_YAW),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, latitude_rad, lat, ODO_FIX_GEODETIC),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, longitude_rad, lon, ODO_FIX_GEODETIC),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, height_m, height, ODO_FIX_GEODETIC),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, integrity, share, ODO_FIX_INTEGRITY),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, landmark_n, place, ODO_FIX_SLANT),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, slant_distance_m, natural, ODO_FIX_SLANT),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, lever_b, finite, ODO_FIX_LEVER),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, yaw_axis_b, direction, ODO_FIX_YAW),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, cross_covariance_n, finite, ODO_FIX_CROSS_COVARIANCE),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, slant_sigma_m, positive, ODO_FIX_SLANT_SIGMA),
    ODO_FIELD(ODO_TYPE_REFINED, odo_refined, fx, positive, 0),
    ODO_FIELD(ODO_TYPE_REFINED, odo_refined, fy, positive, 0),
    ODO_FIELD(ODO_TYPE_REFINED, odo_refined, cx, finite, 0),
    ODO_FIELD(ODO_TYPE_REFINED, odo_refined, cy, finite, 0),
    ODO_FIELD(ODO_TYPE_REFINED, odo_refined, distortion, finite, 0),
    ODO_FIELD(ODO_TYPE_REFINED, odo_refined, q_b_c, unit, ODO_REFINED_EXTRINSICS),
    ODO_FIELD(ODO_TYPE_REFINED, odo_refined, p_b_c, finite, ODO_REFINED_EXTRINSICS),
    ODO_FIELD(ODO_TYPE_RELATIVE_POSE, odo_relative_pose, q_b0_b1, unit, ODO_RELATIVE_POSE_ROTATION),
    ODO_FIELD(ODO_TYPE_RELATIVE_POSE, odo_relative_pose, p_b0_b1, finite, ODO_RELATIVE_POSE_TRANSLATION),
    ODO_FIELD(ODO_TYPE_RELATIVE_POSE, odo_relative_pose, covariance, matrix, 0),
};
#undef ODO_FIELD

const uint8_t kPixel = 0;

/// A valid message with all flags set, all numbers different from zero.
AnyMessage good(uint32_t type) {
  alignas(8) unsigned char zero[ODO_LARGEST_MESSAGE] = {};
  auto& header = *reinterpret_cast<odo_header*>(zero);
  header.struct_size = static_cast<uint32_t>(message_info(type)->size);
  header.type = type;
  header.t_ns = 1000;
  AnyMessage made(header);
  auto* bytes = reinterpret_cast<unsigned char*>(&made.header());
  for (const Field& field : kFields) {
    if (field.type != type) continue;
    auto* values = reinterpret_cast<double*>(bytes + field.offset);
    const double value =
        field.rule == Rule::direction ? std::sqrt(1.0 / 3) : 0.5;  // four of these are a unit quaternion
    for (size_t i = 0; i < field.count(); ++i) values[i] = value;
    const size_t rows = field.count() == 36 ? 6 : 3;
    for (size_t i = 0; field.rule == Rule::matrix && i < field.count(); ++i)
      values[i] = i % (rows + 1) == 0 ? 0.5 : 0.0;
    made.header().flags |= field.flag;
  }
  if (type == ODO_TYPE_FRAME) {
    auto& m = reinterpret_cast<odo_frame&>(made.header());
    m.width = m.height = 1, m.format = ODO_FORMAT_GREY8;
    for (odo_plane& plane : m.planes) plane.data = &kPixel;
    m.mask.data = &kPixel;
    m.header.flags |= ODO_FRAME_MASK;
  }
  if (type == ODO_TYPE_CALIBRATION) {
    auto& m = reinterpret_cast<odo_calibration&>(made.header());
    m.width = m.height = 1, m.model = ODO_CAMERA_PINHOLE;
  }
  if (type == ODO_TYPE_STEP) reinterpret_cast<odo_step&>(made.header()).t_end_ns = 1;
  return made;
}

std::string fault_with(const Field& field, size_t i, double value, uint32_t cleared = 0) {
  AnyMessage m = good(field.type);
  reinterpret_cast<double*>(reinterpret_cast<unsigned char*>(&m.header()) + field.offset)[i] = value;
  m.header().flags &= ~cleared;
  // Without its covariance a position or an orientation is rejected.
  if (field.type == ODO_TYPE_FIX && cleared == ODO_FIX_COVARIANCE) m.header().flags &= ~kPosition;
  if (field.type == ODO_TYPE_FIX && cleared == ODO_FIX_ORIENTATION_COVARIANCE) m.header().flags &= ~ODO_FIX_ORIENTATION;
  return message_fault(m.header());
}

std::set<uint32_t> judged_types() {
  std::set<uint32_t> types;
  for (const Field& field : kFields) types.insert(field.type);
  return types;
}

}  // namespace

namespace {

/// Checks that each double of a struct in the ABI's headers is listed; returns their number.
size_t check_listed(uint32_t type, const std::string& name) {
  static const std::string text =
      read_text(source("abi/include/odograph/samples.h")) + read_text(source("abi/include/odograph/events.h"));
  static const std::regex member("double ([^;]+);"), field("([a-z_][a-z_0-9]*)(\\[[0-9]+\\])?");
  const size_t begin = text.find("typedef struct " + name + " {"), end = text.find("} " + name + ";");
  REQUIRE(begin < end);
  const std::string body = text.substr(begin, end - begin);
  size_t found = 0;
  for (std::sregex_iterator m(body.begin(), body.end(), member), none; m != none; ++m) {
    const std::string list = (*m)[1];
    for (std::sregex_iterator f(list.begin(), list.end(), field); f != none; ++f, ++found) {
      const std::string one = (*f)[1];
      CAPTURE(name);
      CAPTURE(one);
      CHECK(std::count_if(std::begin(kFields), std::end(kFields),
                          [&](const Field& each) { return each.type == type && each.name == one; }) == 1);
    }
  }
  return found;
}

}  // namespace

TEST_CASE("every floating-point field of every external message is in the table of this test") {
  size_t found = 0;
#define ODO_ROW(number, message, plain, min_size)                                    \
  if (number != ODO_TYPE_POSE && number != ODO_TYPE_CORRECTION) /* the host's own */ \
    found += check_listed(number, #message);
  ODO_FOR_EACH_MESSAGE(ODO_ROW)
#undef ODO_ROW
  CHECK(found == std::size(kFields));
}

TEST_CASE("a non-finite number in a valid field of any message is rejected") {
  for (const uint32_t type : judged_types()) CHECK(message_fault(good(type).header()) == "");
  for (const Field& field : kFields)
    for (size_t i = 0; i < field.count(); ++i)
      for (const double wild : {kNan, kInfinity, -kInfinity}) {
        CAPTURE(field.type);
        CAPTURE(field.name);
        CAPTURE(i);
        const std::string fault = fault_with(field, i, wild);
        const bool named = fault.find(field.name) == 0 || field.type == ODO_TYPE_IMU_NOISE;
        CHECK(((field.rule == Rule::any) ? fault.empty() : !fault.empty() && named));
        if (field.flag != 0) CHECK(fault_with(field, i, wild, field.flag) == "");
      }
}

TEST_CASE("numbers are accepted at the ends of their range and rejected beyond") {
  const double half_pi = std::acos(0.0);
  for (const Field& field : kFields) {
    CAPTURE(field.type);
    CAPTURE(field.name);
    const auto good_with = [&](double value) { return fault_with(field, 0, value).empty(); };
    switch (field.rule) {
      case Rule::finite:
        CHECK(good_with(-1e6));
        CHECK(good_with(0));
        CHECK(good_with(1e9));
        CHECK_FALSE(good_with(-1.001e9));
        CHECK_FALSE(good_with(1e300));
        break;
      case Rule::sensed:  // implausible sensor values are detected by the gate
        CHECK((good_with(-1e300) && good_with(1e300)));
        break;
      case Rule::place:
        CHECK((good_with(-2e7) && good_with(2e7)));
        CHECK_FALSE(good_with(2.001e7));
        break;
      case Rule::height:
        CHECK((good_with(-12e3) && good_with(100e3)));
        CHECK_FALSE((good_with(-12.1e3) || good_with(101e3)));
        break;
      case Rule::lon:
        CHECK((good_with(-2 * std::acos(-1.0)) && good_with(2 * std::acos(-1.0))));
        CHECK_FALSE((good_with(6.3) || good_with(11.575)));
        break;
      case Rule::matrix: {
        CHECK(good_with(1e15));
        CHECK_FALSE((good_with(-1e-9) || good_with(1.1e15)));
        CHECK_FALSE(fault_with(field, 1, 0.1).empty());  // not symmetric
        const bool known = field.type == ODO_TYPE_FIX;   // a known quantity has a variance
        CHECK(good_with(0) == !known);
        CHECK(good_with(1e-12));
        break;
      }
      case Rule::natural:
        CHECK(good_with(0));
        CHECK_FALSE(good_with(-1e-12));
        break;
      case Rule::positive:
        CHECK(good_with(1e-12));
        CHECK_FALSE(good_with(0));
        CHECK_FALSE(good_with(-1));
        break;
      case Rule::share:
        CHECK((good_with(0) && good_with(1)));
        CHECK_FALSE(good_with(-1e-9));
        CHECK_FALSE(good_with(1 + 1e-9));
        break;
      case Rule::lat:
        for (const double sign : {-1, 1}) {
          CHECK(good_with(sign * half_pi));
          CHECK_FALSE(good_with(sign * (half_pi + 1e-9)));
        }
        break;
      case Rule::unit:  // 1e-3 of the norm: one of the four halves is changed
        for (size_t i = 0; i < 4; ++i) {
          CHECK(fault_with(field, i, 0.5 + 1.9e-3).empty());
          CHECK_FALSE(fault_with(field, i, 0.5 + 2.1e-3).empty());
          CHECK(fault_with(field, i, 0.5 - 1.9e-3).empty());
          CHECK_FALSE(fault_with(field, i, 0.5 - 2.1e-3).empty());
          CHECK(fault_with(field, i, -0.5).empty());
        }
        break;
      default: break;
    }
  }
}

TEST_CASE("the quality and the time of every message are checked, the time up to 2^62") {
  for (const uint32_t type : judged_types())
    for (const int sign : {-1, 1}) {
      AnyMessage m = good(type);
      if (type == ODO_TYPE_VO_MOTION) reinterpret_cast<odo_vo_motion&>(m.header()).t_from_ns = INT64_MIN;
      if (type == ODO_TYPE_RELATIVE_POSE) reinterpret_cast<odo_relative_pose&>(m.header()).t_from_ns = INT64_MIN;
      m.header().t_ns = sign * (int64_t(1) << 62);
      CHECK(message_fault(m.header()) == "");
      m.header().t_ns += sign;
      CHECK(message_fault(m.header()).find("t_ns") == 0);
      m = good(type);
      m.header().quality = static_cast<float>(kNan);
      CHECK(message_is_good(m.header()));  // it is not flagged valid
      m.header().flags |= ODO_FLAG_QUALITY;
      m.header().quality = static_cast<float>(sign * kInfinity);
      CHECK(message_fault(m.header()).find("quality") == 0);
      m.header().quality = static_cast<float>(kNan);
      CHECK_FALSE(message_is_good(m.header()));
    }
}

TEST_CASE("integers of calibrations and frames are accepted within their limits only") {
  struct Limit {
    uint32_t type;
    size_t offset;
    std::vector<uint32_t> good, bad;
  };
  const std::vector<uint32_t> size = {1, 2, 16383, 16384}, no_size = {0, 16385, UINT32_MAX};
  const Limit limits[] = {
      {ODO_TYPE_FRAME, offsetof(odo_frame, width), size, no_size},
      {ODO_TYPE_FRAME, offsetof(odo_frame, height), size, no_size},
      {ODO_TYPE_FRAME,
       offsetof(odo_frame, format),
       {1, 2, 3, 4, 5, 6, 7, 8, UINT32_MAX},
       {0}},  // newer ones are passed on
      {ODO_TYPE_FRAME, offsetof(odo_frame, plane_count), {0, 1, 2, 3, 4}, {5, UINT32_MAX}},
      {ODO_TYPE_CALIBRATION, offsetof(odo_calibration, width), size, no_size},
      {ODO_TYPE_CALIBRATION, offsetof(odo_calibration, height), size, no_size},
      {ODO_TYPE_CALIBRATION, offsetof(odo_calibration, model), {1, 2, 3, UINT32_MAX}, {0}},
      {ODO_TYPE_CALIBRATION, offsetof(odo_calibration, distortion_count), {0, 4, 5, 8}, {1, 2, 3, 6, 7, 9}},
  };
  for (const Limit& limit : limits) {
    const auto fault = [&](uint32_t value) {
      AnyMessage m = good(limit.type);
      std::memcpy(reinterpret_cast<unsigned char*>(&m.header()) + limit.offset, &value, sizeof value);
      return message_fault(m.header());
    };
    CAPTURE(limit.offset);
    for (const uint32_t value : limit.good) CHECK(fault(value) == "");
    for (const uint32_t value : limit.bad) CHECK(fault(value) != "");
  }
}

TEST_CASE("a frame needs the planes of its format, and a mask if it is flagged") {
  const std::map<uint32_t, int> planes = {{ODO_FORMAT_GREY8, 1}, {ODO_FORMAT_NV12, 2},  {ODO_FORMAT_NV21, 2},
                                          {ODO_FORMAT_RGB8, 1},  {ODO_FORMAT_RGBA8, 1}, {ODO_FORMAT_YUV420, 3},
                                          {ODO_FORMAT_BGRA8, 1}};
  for (const auto& [format, count] : planes)
    for (int missing = 0; missing < 5; ++missing) {
      AnyMessage any = good(ODO_TYPE_FRAME);
      auto& m = reinterpret_cast<odo_frame&>(any.header());
      m.format = format;
      (missing < 4 ? m.planes[missing] : m.mask).data = nullptr;
      CAPTURE(m.format);
      CAPTURE(missing);
      CHECK(message_is_good(m.header) == (missing >= count && missing < 4));
      m.header.flags &= ~ODO_FRAME_MASK;
      CHECK(message_is_good(m.header) == (missing >= count));
    }
}

TEST_CASE("a motion and a step have a duration of at least a nanosecond") {
  AnyMessage any = good(ODO_TYPE_VO_MOTION);
  auto& motion = reinterpret_cast<odo_vo_motion&>(any.header());
  for (const int64_t from : {999, 1000, 1001}) {
    motion.t_from_ns = from;
    CHECK(message_is_good(motion.header) == (from < 1000));
  }
  AnyMessage other = good(ODO_TYPE_STEP);
  auto& step = reinterpret_cast<odo_step&>(other.header());
  step.t_start_ns = 500;
  for (const int64_t end : {499, 500, 501}) {
    step.t_end_ns = end;
    CHECK(message_is_good(step.header) == (end > 500));
  }
}

TEST_SUITE_END();
