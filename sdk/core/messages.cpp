// SPDX-License-Identifier: Apache-2.0
#include "sdk/core/messages.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace odograph {
namespace {

constexpr MessageInfo kMessages[] = {
    {ODO_TYPE_IMU, "imu", sizeof(odo_imu), true},
    {ODO_TYPE_MAGNETOMETER, "magnetometer", sizeof(odo_magnetometer), true},
    {ODO_TYPE_BAROMETER, "barometer", sizeof(odo_barometer), true},
    {ODO_TYPE_GNSS, "gnss", sizeof(odo_gnss), true},
    {ODO_TYPE_FRAME, "frame", sizeof(odo_frame), true},
    {ODO_TYPE_CALIBRATION, "calibration", sizeof(odo_calibration), true},
    {ODO_TYPE_IMU_NOISE, "imu_noise", sizeof(odo_imu_noise), true},
    {ODO_TYPE_WAYPOINT, "waypoint", sizeof(odo_waypoint), true},
    {ODO_TYPE_ATTITUDE, "attitude", sizeof(odo_attitude), false},
    {ODO_TYPE_STEP, "step", sizeof(odo_step), false},
    {ODO_TYPE_MOTION_MODE, "motion_mode", sizeof(odo_motion_mode), false},
    {ODO_TYPE_VO_MOTION, "vo_motion", sizeof(odo_vo_motion), false},
    {ODO_TYPE_SCALE, "scale", sizeof(odo_scale), false},
    {ODO_TYPE_FIX, "fix", sizeof(odo_fix), false},
    {ODO_TYPE_POSE, "pose", sizeof(odo_pose), false},
    {ODO_TYPE_STATE, "state", sizeof(odo_state), false},
    {ODO_TYPE_CORRECTION, "correction", sizeof(odo_correction), false},
};
static_assert(std::all_of(std::begin(kMessages), std::end(kMessages),
                          [](const MessageInfo& info) { return info.size <= kLargestMessage; }));

bool finite(const double* values, size_t count) {
  return std::all_of(values, values + count, [](double x) { return std::isfinite(x); });
}

bool unit(const double* q) {
  return finite(q, 4) && std::abs(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] - 1.0) < 2e-3;
}

}  // namespace

const MessageInfo* message_info(uint32_t type) {
  for (const MessageInfo& info : kMessages)
    if (info.type == type) return &info;
  return nullptr;
}

bool message_is_finite(const odo_header& header) {
  const uint32_t flags = header.flags;
  const auto when = [flags](uint32_t bit, bool holds) { return (flags & bit) == 0 || holds; };
  if (!std::isfinite(header.quality)) return false;
  switch (header.type) {
    case ODO_TYPE_IMU: {
      const auto& m = as<odo_imu>(header);
      return when(ODO_IMU_GYRO, finite(m.gyro_b, 3)) && when(ODO_IMU_ACCEL, finite(m.accel_b, 3));
    }
    case ODO_TYPE_MAGNETOMETER: return finite(as<odo_magnetometer>(header).field_b, 3);
    case ODO_TYPE_BAROMETER: return finite(&as<odo_barometer>(header).pressure_pa, 1);
    case ODO_TYPE_GNSS: {
      const auto& m = as<odo_gnss>(header);
      return when(ODO_GNSS_POSITION, finite(&m.latitude_rad, 2) && std::abs(m.latitude_rad) <= 1.5707963267948966) &&
             when(ODO_GNSS_HEIGHT, finite(&m.height_m, 1)) && when(ODO_GNSS_COVARIANCE, finite(m.covariance_n, 9)) &&
             when(ODO_GNSS_VELOCITY, finite(m.velocity_n, 3));
    }
    case ODO_TYPE_FRAME: {
      const auto& m = as<odo_frame>(header);
      return m.width > 0 && m.height > 0 && m.width <= 16384 && m.height <= 16384 && m.format >= ODO_FORMAT_GREY8 &&
             m.format <= ODO_FORMAT_RGBA8 && m.planes[0].data != nullptr;
    }
    case ODO_TYPE_CALIBRATION: {
      const auto& m = as<odo_calibration>(header);
      return finite(&m.fx, 4) && m.fx > 0 && m.fy > 0 && finite(m.distortion, 8) && m.width > 0 && m.height > 0 &&
             (m.distortion_count == 0 || m.distortion_count == 4 || m.distortion_count == 5 ||
              m.distortion_count == 8) &&
             (m.model == ODO_CAMERA_PINHOLE || m.model == ODO_CAMERA_KANNALA_BRANDT) &&
             when(ODO_CALIBRATION_EXTRINSICS, unit(m.q_b_c) && finite(m.p_b_c, 3));
    }
    case ODO_TYPE_IMU_NOISE: return finite(&as<odo_imu_noise>(header).gyro_noise, 4);
    case ODO_TYPE_WAYPOINT: return finite(as<odo_waypoint>(header).p_n, 4) && as<odo_waypoint>(header).sigma_m >= 0;
    case ODO_TYPE_ATTITUDE:
      return unit(as<odo_attitude>(header).q_n_b) && finite(as<odo_attitude>(header).covariance_n, 12);
    case ODO_TYPE_STEP: {
      const auto& m = as<odo_step>(header);
      return finite(&m.length_m, 4) && m.length_m >= 0 && m.sigma_m >= 0 && m.t_end_ns > m.t_start_ns;
    }
    case ODO_TYPE_MOTION_MODE: return true;
    case ODO_TYPE_VO_MOTION: {
      const auto& m = as<odo_vo_motion>(header);
      return when(ODO_VO_ROTATION, unit(m.q_c0_c1)) && when(ODO_VO_TRANSLATION, finite(m.p_c0_c1, 3)) &&
             when(ODO_VO_COVARIANCE, finite(m.covariance, 36)) && when(ODO_VO_INERTIAL, finite(&m.scale_sigma, 13)) &&
             header.t_ns > m.t_from_ns;
    }
    case ODO_TYPE_SCALE:
      return finite(&as<odo_scale>(header).metres_per_unit, 3) && as<odo_scale>(header).metres_per_unit >= 0;
    case ODO_TYPE_FIX: {
      const auto& m = as<odo_fix>(header);
      return finite(m.p_n, 3) && finite(m.covariance_n, 9) && when(ODO_FIX_ORIENTATION, unit(m.q_n_b)) &&
             when(ODO_FIX_SLANT, finite(m.landmark_n, 3) && finite(&m.slant_distance_m, 1)) &&
             when(ODO_FIX_YAW, finite(&m.yaw_rad, 2)) && when(ODO_FIX_GEODETIC, finite(&m.latitude_rad, 3)) &&
             finite(&m.integrity, 1);
    }
    default: return true;
  }
}

bool AnyMessage::assign(const odo_header& message) {
  const MessageInfo* info = message_info(message.type);
  if (!info || message.struct_size < info->size) return false;
  std::memset(bytes, 0, info->size);
  std::memcpy(bytes, &message, info->size);
  header().struct_size = static_cast<uint32_t>(info->size);
  return true;
}

}  // namespace odograph
