// SPDX-License-Identifier: Apache-2.0
//
// Validity flags: a field without its flag has no meaning, so that its value must not change what a plugin emits.
#include <cstddef>
#include <cstring>

#include <odograph/vo_frontend.h>

#include "sdk/tools/validator/case_fixture.hpp"
#include "sdk/tools/validator/child.hpp"

namespace odograph {
namespace {

/// 8-byte numbers within a message: doubles, or durations in ns.
struct Numbers {
  size_t offset = 0, count = 0;
  bool whole = false;
};

/// Fields that are valid with a flag, or with any of several.
struct Optional {
  uint32_t type, flag;
  const char* name;
  Numbers fields[5];
  uint32_t needed_by = 0;  ///< the host refuses a message with one of these flags but without `flag`
};

#define FIELD(message, member) \
  { offsetof(message, member), sizeof(message::member) / 8, false }
#define DURATION(message, member) \
  { offsetof(message, member), 1, true }
#define ELEMENT(message, member, i) \
  { offsetof(message, member) + 8 * (i), 1, false }
#define WITH(flag) flag, #flag

constexpr uint32_t kPlace = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_DOWN | ODO_FIX_GEODETIC;

const Optional kOptional[] = {
    {ODO_TYPE_IMU, WITH(ODO_IMU_ACCEL), {FIELD(odo_imu, accel_b)}},
    {ODO_TYPE_MAGNETOMETER, WITH(ODO_MAGNETOMETER_SIGMA), {FIELD(odo_magnetometer, sigma_t)}},
    {ODO_TYPE_BAROMETER, WITH(ODO_BAROMETER_SIGMA), {FIELD(odo_barometer, sigma_pa)}},
    {ODO_TYPE_GNSS, WITH(ODO_GNSS_POSITION), {FIELD(odo_gnss, latitude_rad), FIELD(odo_gnss, longitude_rad)}},
    {ODO_TYPE_GNSS, WITH(ODO_GNSS_HEIGHT), {FIELD(odo_gnss, height_m)}},
    {ODO_TYPE_GNSS, WITH(ODO_GNSS_COVARIANCE), {FIELD(odo_gnss, covariance_n)}},
    {ODO_TYPE_GNSS, WITH(ODO_GNSS_VELOCITY), {FIELD(odo_gnss, velocity_n)}},
    {ODO_TYPE_GNSS, WITH(ODO_GNSS_LEVER), {FIELD(odo_gnss, lever_b)}},
    {ODO_TYPE_FRAME, WITH(ODO_FRAME_EXPOSURE), {DURATION(odo_frame, exposure_ns)}},
    {ODO_TYPE_FRAME, WITH(ODO_FRAME_LINE_TIME), {DURATION(odo_frame, line_time_ns)}},
    {ODO_TYPE_FRAME,
     WITH(ODO_FRAME_INTRINSICS),
     {FIELD(odo_frame, fx), FIELD(odo_frame, fy), FIELD(odo_frame, cx), FIELD(odo_frame, cy)}},
    {ODO_TYPE_CALIBRATION,
     WITH(ODO_CALIBRATION_EXTRINSICS),
     {FIELD(odo_calibration, q_b_c), FIELD(odo_calibration, p_b_c)}},
    {ODO_TYPE_CALIBRATION, WITH(ODO_CALIBRATION_TIME_OFFSET), {DURATION(odo_calibration, time_offset_ns)}},
    {ODO_TYPE_CALIBRATION, WITH(ODO_CALIBRATION_LINE_TIME), {DURATION(odo_calibration, line_time_ns)}},
    {ODO_TYPE_WAYPOINT, WITH(ODO_WAYPOINT_VERTICAL), {ELEMENT(odo_waypoint, p_n, 2)}},
    {ODO_TYPE_WAYPOINT, WITH(ODO_WAYPOINT_LEVER), {FIELD(odo_waypoint, lever_b)}},
    {ODO_TYPE_PLATFORM_POSE, WITH(ODO_PLATFORM_POSE_COVARIANCE), {FIELD(odo_platform_pose, covariance)}},
    {ODO_TYPE_RANGE, WITH(ODO_RANGE_TRANSMITTER), {FIELD(odo_range, p_n), FIELD(odo_range, transmitter_sigma_m)}},
    {ODO_TYPE_RANGE, WITH(ODO_RANGE_LEVER), {FIELD(odo_range, lever_b)}},
    {ODO_TYPE_ATTITUDE, WITH(ODO_ATTITUDE_COVARIANCE), {FIELD(odo_attitude, covariance_n)}},
    {ODO_TYPE_ATTITUDE, WITH(ODO_ATTITUDE_GYRO_BIAS), {FIELD(odo_attitude, gyro_bias_b)}},
    {ODO_TYPE_STEP, WITH(ODO_STEP_HEADING), {FIELD(odo_step, heading_rad)}},
    {ODO_TYPE_STEP, WITH(ODO_STEP_HEADING_SIGMA), {FIELD(odo_step, heading_sigma_rad)}},
    {ODO_TYPE_VO_MOTION, WITH(ODO_VO_ROTATION), {FIELD(odo_vo_motion, q_c0_c1)}},
    {ODO_TYPE_VO_MOTION, WITH(ODO_VO_TRANSLATION), {FIELD(odo_vo_motion, p_c0_c1)}},
    {ODO_TYPE_VO_MOTION, WITH(ODO_VO_COVARIANCE), {FIELD(odo_vo_motion, covariance)}},
    {ODO_TYPE_VO_MOTION, WITH(ODO_FLAG_NAVIGATION), {FIELD(odo_vo_motion, q_n_c0)}},
    {ODO_TYPE_VO_MOTION, ODO_VO_METRIC | ODO_VO_INERTIAL, "ODO_VO_METRIC", {FIELD(odo_vo_motion, scale_sigma)}},
    {ODO_TYPE_VO_MOTION,
     WITH(ODO_VO_INERTIAL),
     {FIELD(odo_vo_motion, velocity_c1), FIELD(odo_vo_motion, gravity_c1), FIELD(odo_vo_motion, gyro_bias_b),
      FIELD(odo_vo_motion, accel_bias_b)}},
    {ODO_TYPE_FIX, WITH(ODO_FIX_NORTH), {ELEMENT(odo_fix, p_n, 0)}},
    {ODO_TYPE_FIX, WITH(ODO_FIX_EAST), {ELEMENT(odo_fix, p_n, 1)}},
    {ODO_TYPE_FIX, WITH(ODO_FIX_DOWN), {ELEMENT(odo_fix, p_n, 2)}},
    {ODO_TYPE_FIX, WITH(ODO_FIX_COVARIANCE), {FIELD(odo_fix, covariance_n)}, kPlace},
    {ODO_TYPE_FIX, WITH(ODO_FIX_ORIENTATION), {FIELD(odo_fix, q_n_b), FIELD(odo_fix, orientation_cov_n)}},
    {ODO_TYPE_FIX,
     WITH(ODO_FIX_YAW),
     {FIELD(odo_fix, yaw_rad), FIELD(odo_fix, yaw_sigma_rad), FIELD(odo_fix, yaw_axis_b)}},
    {ODO_TYPE_FIX,
     WITH(ODO_FIX_GEODETIC),
     {FIELD(odo_fix, latitude_rad), FIELD(odo_fix, longitude_rad), FIELD(odo_fix, height_m)}},
    {ODO_TYPE_FIX, WITH(ODO_FIX_SLANT), {FIELD(odo_fix, landmark_n), FIELD(odo_fix, slant_distance_m)}},
    {ODO_TYPE_FIX, WITH(ODO_FIX_SLANT_SIGMA), {FIELD(odo_fix, slant_sigma_m)}},
    {ODO_TYPE_FIX, WITH(ODO_FIX_INTEGRITY), {FIELD(odo_fix, integrity)}},
    {ODO_TYPE_FIX, WITH(ODO_FIX_LEVER), {FIELD(odo_fix, lever_b)}},
    {ODO_TYPE_FIX, WITH(ODO_FIX_CROSS_COVARIANCE), {FIELD(odo_fix, cross_covariance_n)}},
    {ODO_TYPE_POSE, WITH(ODO_POSE_ORIENTATION), {FIELD(odo_pose, q_n)}},
    {ODO_TYPE_POSE, WITH(ODO_POSE_POSITION), {FIELD(odo_pose, p_n)}},
    {ODO_TYPE_POSE, WITH(ODO_POSE_VELOCITY), {FIELD(odo_pose, velocity_n)}},
    {ODO_TYPE_POSE, WITH(ODO_POSE_COVARIANCE), {FIELD(odo_pose, covariance)}},
    {ODO_TYPE_POSE, WITH(ODO_POSE_ANGULAR_VELOCITY), {FIELD(odo_pose, angular_velocity)}},
    {ODO_TYPE_POSE, WITH(ODO_POSE_VELOCITY_COVARIANCE), {FIELD(odo_pose, velocity_covariance)}},
    {ODO_TYPE_POSE, WITH(ODO_POSE_FLOOR), {FIELD(odo_pose, floor_probability)}},
};

#undef FIELD
#undef DURATION
#undef ELEMENT
#undef WITH

/// A number of the same order of magnitude: a plugin that uses it emits another plausible event.
void change(unsigned char* at, bool whole) {
  if (whole) {
    int64_t value = 0;
    std::memcpy(&value, at, sizeof value);
    value += 1'000'000;  // 1 ms
    std::memcpy(at, &value, sizeof value);
    return;
  }
  double value = 0;
  std::memcpy(&value, at, sizeof value);
  value = 2 * value + 0.25;
  std::memcpy(at, &value, sizeof value);
}

/// Calls `with` for each number of the row's fields.
template <class With>
void each_number(const Optional& row, unsigned char* message, With&& with) {
  for (const Numbers& field : row.fields)
    for (size_t i = 0; i < field.count; ++i) with(message + field.offset + 8 * i, field.whole);
}

/// Zeroes what an event itself does not state as valid.
void clear_invalid(std::vector<unsigned char>& event) {
  const auto& header = *reinterpret_cast<const odo_header*>(event.data());
  for (const Optional& row : kOptional)
    if (row.type == header.type && (header.flags & row.flag) == 0)
      each_number(row, event.data(), [&](unsigned char* at, bool) {
        if (at + 8 <= event.data() + event.size()) std::memset(at, 0, 8);
      });
}

/// The events if no message has the flag, with the fields as they are or changed.
std::vector<std::vector<unsigned char>> events_without(CaseFixture& fixture, const Optional& row, bool changed) {
  const auto subject = fixture.start_instance();
  MessageLayout layout;
  layout.change = [&](AnyMessage& message) {
    odo_header& header = message.header();
    if (header.type != row.type) return;
    header.flags &= ~(row.flag | row.needed_by);
    if (changed) each_number(row, reinterpret_cast<unsigned char*>(&header), change);
  };
  subject->process(fixture.input, layout);
  auto events = subject->bytes();
  for (auto& event : events) clear_invalid(event);
  return events;
}

Verdict validity_flags(CaseFixture& fixture) {
  size_t asked = 0;
  for (const Optional& row : kOptional) {
    const bool always_valid = row.type == ODO_TYPE_IMU && !fixture.serves(ODO_INTERFACE_VO_FRONTEND);  // vo_frontend.h
    if (!fixture.accepts(row.type) || always_valid) continue;
    ++asked;
    note_phase("", row.name);
    const auto as_is = events_without(fixture, row, false), other = events_without(fixture, row, true);
    if (const std::string found = difference(as_is, other); !found.empty())
      return "it uses what is valid only with " + std::string(row.name) + " without that flag: " + found +
             " when the values change";
  }
  return asked ? Verdict() : not_applicable("it receives nothing that has validity flags");
}

}  // namespace

std::vector<Case> flag_cases() {
  return {{"process.flags", "uses fields only if their flag is set", 120, 4, true, validity_flags}};
}

}  // namespace odograph
