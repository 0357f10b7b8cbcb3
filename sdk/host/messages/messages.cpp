// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/messages/messages.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sdk/host/messages/bounds.hpp"
#include "sdk/host/messages/field_check.hpp"

namespace odograph {
namespace {

constexpr MessageInfo kMessages[] = {
#define ODO_ROW(number, type, name, min_size) {number, #name, sizeof(type), min_size},
    ODO_FOR_EACH_MESSAGE(ODO_ROW)
#undef ODO_ROW
};

void check_lens(FieldCheck& check, const odo_frame& m) {
  check.when(ODO_FRAME_INTRINSICS).positive("fx", m.fx).positive("fy", m.fy).finite("cx", m.cx).finite("cy", m.cy);
}

void check_frame(FieldCheck& check, const odo_frame& m) {
  const auto plane = [&](int i) {
    check.require(m.planes[i].data != nullptr, ("planes[" + std::to_string(i) + "].data").c_str(), 0, "pixels");
  };
  const bool native_only = m.planes[0].data == nullptr && m.loan.native != nullptr;
  check.require(m.width > 0 && m.width <= 16384, "width", m.width, "1 to 16384")
      .require(m.height > 0 && m.height <= 16384, "height", m.height, "1 to 16384")
      .require(uint64_t(m.width) * m.height <= bounds::kMaxPixels, "width * height", double(m.width) * m.height,
               "at most 2^24 pixels; a smaller picture is as informative")
      .require(m.format != 0, "format", m.format, "one of ODO_FORMAT_*")
      .require(m.plane_count <= 4, "plane_count", m.plane_count, "0 to 4");
  if (!native_only) plane(0);
  for (uint32_t i = 1; !native_only && i < std::min(m.plane_count, 4u); ++i) plane(static_cast<int>(i));
  if (native_only) {
  } else if (m.format == ODO_FORMAT_NV12 || m.format == ODO_FORMAT_NV21 || m.format == ODO_FORMAT_YUV420) {
    plane(1);
    if (m.format == ODO_FORMAT_YUV420) plane(2);
  }
  check.when(ODO_FRAME_MASK).require(m.mask.data != nullptr, "mask.data", 0, "pixels");
  check_lens(check, m);
}

void check_calibration(FieldCheck& check, const odo_calibration& m) {
  check.positive("fx", m.fx)
      .positive("fy", m.fy)
      .finite("cx", m.cx)
      .finite("cy", m.cy)
      .finite("distortion", m.distortion, 8);
  check.require(m.width > 0 && m.width <= 16384, "width", m.width, "1 to 16384")
      .require(m.height > 0 && m.height <= 16384, "height", m.height, "1 to 16384");
  const uint32_t n = m.distortion_count;
  if (m.model == ODO_CAMERA_PINHOLE)
    check.require(n == 0 || n == 4 || n == 5 || n == 8, "distortion_count", n, "0, 4, 5 or 8");
  if (m.model == ODO_CAMERA_KANNALA_BRANDT) check.require(n == 0 || n == 4, "distortion_count", n, "0 or 4");
  check.require(m.model != 0, "model", m.model, "one of ODO_CAMERA_*");
  check.when(ODO_CALIBRATION_EXTRINSICS).unit("q_b_c", m.q_b_c).finite("p_b_c", m.p_b_c, 3);
}

void check_vo_motion(FieldCheck& check, const odo_vo_motion& m) {
  check.require(m.header.t_ns > m.t_from_ns, "t_from_ns", static_cast<double>(m.t_from_ns), "before header.t_ns");
  check.when(ODO_VO_ROTATION).unit("q_c0_c1", m.q_c0_c1);
  check.when(ODO_VO_TRANSLATION).finite("p_c0_c1", m.p_c0_c1, 3);
  check.when(ODO_VO_COVARIANCE).covariance("covariance", m.covariance, 6);
  check.when(ODO_VO_METRIC | ODO_VO_INERTIAL).not_negative("scale_sigma", m.scale_sigma);
  check.when(ODO_VO_INERTIAL).finite("velocity_c1", m.velocity_c1, 3);
  check.unit3("gravity_c1", m.gravity_c1).finite("gyro_bias_b", m.gyro_bias_b, 3);
  check.finite("accel_bias_b", m.accel_bias_b, 3);
}

void check_fix(FieldCheck& check, const odo_fix& m) {
  const uint32_t flags = m.header.flags;
  check.when(ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_DOWN | ODO_FIX_GEODETIC)
      .require(flags & ODO_FIX_COVARIANCE, "flags", flags, "ODO_FIX_COVARIANCE with a position")
      .within("p_n", m.p_n, 3, bounds::kPosition_m);
  check.when(ODO_FIX_COVARIANCE).covariance("covariance_n", m.covariance_n, 3);
  check.when(ODO_FIX_NORTH | ODO_FIX_GEODETIC).known("covariance_n[0]", m.covariance_n[0]);
  check.when(ODO_FIX_EAST | ODO_FIX_GEODETIC).known("covariance_n[4]", m.covariance_n[4]);
  check.when(ODO_FIX_DOWN).known("covariance_n[8]", m.covariance_n[8]);
  check.when(ODO_FIX_INTEGRITY).fraction("integrity", m.integrity);
  check.when(ODO_FIX_LEVER).finite("lever_b", m.lever_b, 3);
  check.when(ODO_FIX_ORIENTATION)
      .require(flags & ODO_FIX_ORIENTATION_COVARIANCE, "flags", flags,
               "ODO_FIX_ORIENTATION_COVARIANCE with an orientation")
      .unit("q_n_b", m.q_n_b)
      .covariance("orientation_cov_n", m.orientation_cov_n, 3)
      .known("orientation_cov_n[0]", m.orientation_cov_n[0])
      .known("orientation_cov_n[4]", m.orientation_cov_n[4])
      .known("orientation_cov_n[8]", m.orientation_cov_n[8]);
  check.when(ODO_FIX_CROSS_COVARIANCE).finite("cross_covariance_n", m.cross_covariance_n, 9);
  check.when(ODO_FIX_SLANT_SIGMA).positive("slant_sigma_m", m.slant_sigma_m);
  check.when(ODO_FIX_SLANT)
      .within("landmark_n", m.landmark_n, 3, bounds::kPosition_m)
      .not_negative("slant_distance_m", m.slant_distance_m);
  check.when(ODO_FIX_YAW)
      .finite("yaw_rad", m.yaw_rad)
      .positive("yaw_sigma_rad", m.yaw_sigma_rad)
      .unit3("yaw_axis_b", m.yaw_axis_b);
  check.when(ODO_FIX_GEODETIC)
      .within("latitude_rad", m.latitude_rad, bounds::kLatitude_rad)
      .within("longitude_rad", m.longitude_rad, bounds::kLongitude_rad)
      .within("height_m", m.height_m, bounds::kHeight_m);
}

void check_gnss(FieldCheck& check, const odo_gnss& m) {
  check.when(ODO_GNSS_POSITION)
      .within("latitude_rad", m.latitude_rad, bounds::kLatitude_rad)
      .within("longitude_rad", m.longitude_rad, bounds::kLongitude_rad);
  check.when(ODO_GNSS_HEIGHT).within("height_m", m.height_m, bounds::kHeight_m);
  check.when(ODO_GNSS_COVARIANCE).covariance("covariance_n", m.covariance_n, 3);
  check.when(ODO_GNSS_VELOCITY).finite("velocity_n", m.velocity_n, 3);
  check.when(ODO_GNSS_LEVER).finite("lever_b", m.lever_b, 3);
}

void check_input_fields(FieldCheck& check, const odo_header& header) {
  switch (header.type) {
    case ODO_TYPE_IMU: {
      const auto& m = as<odo_imu>(header);
      check.when(ODO_IMU_GYRO).sensed("gyro_b", m.gyro_b, 3);
      check.when(ODO_IMU_ACCEL).sensed("accel_b", m.accel_b, 3);
      break;
    }
    case ODO_TYPE_MAGNETOMETER:
      check.sensed("field_b", as<odo_magnetometer>(header).field_b, 3);
      check.when(ODO_MAGNETOMETER_SIGMA).not_negative("sigma_t", as<odo_magnetometer>(header).sigma_t);
      break;
    case ODO_TYPE_BAROMETER:
      check.sensed("pressure_pa", &as<odo_barometer>(header).pressure_pa, 1);
      check.when(ODO_BAROMETER_SIGMA).not_negative("sigma_pa", as<odo_barometer>(header).sigma_pa);
      break;
    case ODO_TYPE_GNSS: check_gnss(check, as<odo_gnss>(header)); break;
    case ODO_TYPE_FRAME: check_frame(check, as<odo_frame>(header)); break;
    case ODO_TYPE_CALIBRATION: check_calibration(check, as<odo_calibration>(header)); break;
    case ODO_TYPE_IMU_NOISE:
      for (const double* density = &as<odo_imu_noise>(header).gyro_noise;
           density <= &as<odo_imu_noise>(header).accel_walk; ++density)
        check.not_negative("gyro_noise and what follows", *density);
      break;
    case ODO_TYPE_WAYPOINT:
      check.within("p_n", as<odo_waypoint>(header).p_n, 3, bounds::kPosition_m)
          .not_negative("sigma_m", as<odo_waypoint>(header).sigma_m);
      check.when(ODO_WAYPOINT_LEVER).finite("lever_b", as<odo_waypoint>(header).lever_b, 3);
      break;
    case ODO_TYPE_EARTH_FIELD: {
      const auto& m = as<odo_earth_field>(header);
      check.when(ODO_EARTH_FIELD_DECLINATION).finite("declination_rad", m.declination_rad);
      check.when(ODO_EARTH_FIELD_INCLINATION).finite("inclination_rad", m.inclination_rad);
      check.when(ODO_EARTH_FIELD_INTENSITY).positive("intensity_t", m.intensity_t);
      break;
    }
    case ODO_TYPE_PLATFORM_POSE: {
      const auto& m = as<odo_platform_pose>(header);
      check.unit("q_w", m.q_w).finite("p_w", m.p_w, 3);
      check.when(ODO_PLATFORM_POSE_COVARIANCE).covariance("covariance", m.covariance, 6);
      break;
    }
    case ODO_TYPE_RANGE: {
      const auto& m = as<odo_range>(header);
      check.not_negative("range_m", m.range_m).positive("sigma_m", m.sigma_m);
      check.when(ODO_RANGE_TRANSMITTER)
          .within("p_n", m.p_n, 3, bounds::kPosition_m)
          .not_negative("transmitter_sigma_m", m.transmitter_sigma_m);
      check.when(ODO_RANGE_LEVER).finite("lever_b", m.lever_b, 3);
      break;
    }
    case ODO_TYPE_SYSTEM_STEP:
      check.when(ODO_SYSTEM_STEP_DISTANCE).not_negative("distance_m", as<odo_system_step>(header).distance_m);
      break;
    default: break;
  }
}

void check_points(FieldCheck& check, const odo_points& m) {
  const uint64_t end = uint64_t(m.offset) + uint64_t(m.count) * m.stride;
  check.require(m.count <= ODO_MOST_POINTS, "count", m.count, "at most 1000")
      .require(m.total >= m.count, "total", m.total, "at least `count`")
      .require(m.stride >= ODO_POINT_SIZE_MIN && m.stride % 8 == 0, "stride", m.stride, "a multiple of 8, at least 64")
      .require(m.offset >= ODO_POINTS_SIZE_MIN && m.offset % 8 == 0, "offset", m.offset, "a multiple of 8, at least 56")
      .require(end <= m.header.struct_size, "count", m.count, "elements within struct_size");
  if (!check.fault.empty()) return;
  const auto finite = [](const float* values, size_t count) {
    return std::all_of(values, values + count, [](float x) { return std::isfinite(x); });
  };
  for (uint32_t i = 0; i < m.count && check.fault.empty(); ++i) {
    const odo_point& point = *ODO_POINTS_AT(&m, i);
    const float *variances = point.covariance, least = std::min({variances[0], variances[3], variances[5]});
    check.require(finite(point.p_c, 3), "p_c of an element", i, "finite numbers")
        .require(finite(variances, 6) && least >= 0, "covariance of an element", i,
                 "finite numbers, variances 0 or more")
        .require(finite(point.pixel, 2), "pixel of an element", i, "finite numbers");
  }
}

void check_surface(FieldCheck& check, const odo_surface& m) {
  const bool present = m.state == ODO_SURFACE_PRESENT;
  const uint64_t end = uint64_t(m.offset) + uint64_t(m.count) * m.stride;
  check.unit("q_n", m.q_n)
      .within("p_n", m.p_n, 3, bounds::kPosition_m)
      .positive("id", static_cast<double>(m.id))
      .not_negative("sigma_m", m.sigma_m)
      .not_negative("tilt_sigma_rad", m.tilt_sigma_rad)
      .require(!present || (m.sigma_m > 0 && m.tilt_sigma_rad > 0), "sigma_m, tilt_sigma_rad", m.sigma_m, "above 0")
      .require(m.state >= ODO_SURFACE_PRESENT && m.state <= ODO_SURFACE_WITHDRAWN, "state", m.state, "1 to 3")
      .require(m.kind != 0, "kind", m.kind, "one of ODO_SURFACE_FLOOR, HORIZONTAL, VERTICAL, OTHER")
      .require(present ? m.count >= 3 && m.count <= ODO_MOST_VERTICES : m.count == 0, "count", m.count,
               present ? "3 to 32" : "0, as the surface exists no more")
      .require((m.merged_into != 0) == (m.state == ODO_SURFACE_MERGED), "merged_into", double(m.merged_into),
               "an id with MERGED alone")
      .require(m.stride >= ODO_VERTEX_SIZE_MIN && m.stride % 8 == 0, "stride", m.stride, "a multiple of 8, at least 8")
      .require(m.offset >= ODO_SURFACE_SIZE_MIN && m.offset % 8 == 0, "offset", m.offset, "a multiple of 8 from 144 on")
      .require(end <= m.header.struct_size, "count", m.count, "vertices within struct_size");
  for (uint32_t i = 0; check.fault.empty() && i < m.count; ++i)
    for (const float x : ODO_VERTEX_AT(&m, i)->p) check.within("p of a vertex", double(x), bounds::kPosition_m);
}

void check_map_pose(FieldCheck& check, const odo_map_pose& m) {
  check.require(m.map != 0, "map", 0, "not 0")
      .unit("q_m_b", m.q_m_b)
      .within("p_m_b", m.p_m_b, 3, bounds::kPosition_m)
      .covariance("covariance", m.covariance, 6)
      .not_negative("map_sigma_m", m.map_sigma_m)
      .not_negative("map_sigma_rad", m.map_sigma_rad);
}

void check_event_fields(FieldCheck& check, const odo_header& header) {
  switch (header.type) {
    case ODO_TYPE_ATTITUDE: {
      const auto& m = as<odo_attitude>(header);
      check.unit("q_n_b", m.q_n_b);
      check.when(ODO_ATTITUDE_COVARIANCE).covariance("covariance_n", m.covariance_n, 3);
      check.when(ODO_ATTITUDE_GYRO_BIAS).finite("gyro_bias_b", m.gyro_bias_b, 3);
      break;
    }
    case ODO_TYPE_STEP: {
      const auto& m = as<odo_step>(header);
      check.not_negative("length_m", m.length_m)
          .not_negative("sigma_m", m.sigma_m)
          .finite("frequency_hz", m.frequency_hz);
      check.when(ODO_STEP_HEADING).finite("heading_rad", m.heading_rad);
      check.when(ODO_STEP_HEADING_SIGMA).positive("heading_sigma_rad", m.heading_sigma_rad).always();
      check.require(m.t_end_ns > m.t_start_ns, "t_end_ns", static_cast<double>(m.t_end_ns), "after t_start_ns");
      break;
    }
    case ODO_TYPE_VO_MOTION: check_vo_motion(check, as<odo_vo_motion>(header)); break;
    case ODO_TYPE_SCALE: {
      const auto& m = as<odo_scale>(header);
      check.not_negative("scale", m.scale).not_negative("sigma", m.sigma);
      check.finite("displacement_m", m.displacement_m);
      break;
    }
    case ODO_TYPE_FIX: check_fix(check, as<odo_fix>(header)); break;
    case ODO_TYPE_POINTS: check_points(check, as<odo_points>(header)); break;
    case ODO_TYPE_SURFACE: check_surface(check, as<odo_surface>(header)); break;
    case ODO_TYPE_RELATIVE_POSE: {
      const auto& m = as<odo_relative_pose>(header);
      check.require(m.header.t_ns > m.t_from_ns, "t_from_ns", static_cast<double>(m.t_from_ns), "before header.t_ns");
      check.covariance("covariance", m.covariance, 6);
      check.when(ODO_RELATIVE_POSE_ROTATION).unit("q_b0_b1", m.q_b0_b1);
      check.when(ODO_RELATIVE_POSE_TRANSLATION).finite("p_b0_b1", m.p_b0_b1, 3);
      break;
    }
    case ODO_TYPE_KEY_FRAME: check.require(as<odo_key_frame>(header).id != 0, "id", 0, "not 0"); break;
    case ODO_TYPE_MAP_POSE: check_map_pose(check, as<odo_map_pose>(header)); break;
    case ODO_TYPE_REFINED: {
      const auto& m = as<odo_refined>(header);
      check.positive("fx", m.fx).positive("fy", m.fy).finite("cx", m.cx).finite("cy", m.cy);
      check.finite("distortion", m.distortion, 8);
      check.when(ODO_REFINED_EXTRINSICS).unit("q_b_c", m.q_b_c).finite("p_b_c", m.p_b_c, 3);
      break;
    }
    default: break;
  }
}

}  // namespace

const MessageInfo* message_info(uint32_t type) {
  for (const MessageInfo& info : kMessages)
    if (info.type == type) return &info;
  return nullptr;
}

std::string message_name(uint32_t type) {
  if (const MessageInfo* info = message_info(type)) return info->name;
  char text[24];
  std::snprintf(text, sizeof text, "type 0x%X", type);
  return text;
}

std::string message_fault(const odo_header& header) {
  if (!is_plausible_time(header.t_ns))
    return "t_ns = " + std::to_string(header.t_ns) + "; expected at most 2^62 from the clock's zero";
  FieldCheck check(header);
  (ODO_IS_EVENT(header.type) ? check_event_fields : check_input_fields)(check, header);
  return std::move(check.fault);
}

std::string recorded_fault(const odo_header& header) {
  if (header.type != ODO_TYPE_FRAME) return ODO_IS_EVENT(header.type) ? "" : message_fault(header);
  FieldCheck check(header);
  check_lens(check, as<odo_frame>(header));
  return std::move(check.fault);
}

size_t min_size(uint32_t type) {
  if (const MessageInfo* info = message_info(type)) return info->min_size;
  return ODO_IS_BORROWED(type) ? sizeof(odo_borrowed) : sizeof(odo_header);
}

bool AnyMessage::assign(const odo_header& message) {
  const MessageInfo* info = message_info(message.type);
  const size_t size = message.struct_size;
  if (size < min_size(message.type) || size > ODO_LARGEST_MESSAGE) return false;
  capacity_ = std::max(size, info ? info->size : size_t(0));
  if (capacity_ > kInside)
    outside_.resize((capacity_ + 7) / 8);
  else
    outside_.clear();
  std::memcpy(data(), &message, size);
  std::memset(data() + size, 0, capacity_ - size);
  return true;
}

}  // namespace odograph
