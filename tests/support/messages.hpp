// SPDX-License-Identifier: Apache-2.0
//
// Messages of the tests, with what most of them need; a test changes the rest.
#pragma once

#include <Eigen/Geometry>

#include "sdk/host/messages/messages.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph {

inline odo_imu imu_at(int64_t t_ns, const Eigen::Vector3d& gyro_b, const Eigen::Vector3d& accel_b,
                      uint32_t flags = ODO_IMU_GYRO | ODO_IMU_ACCEL) {
  auto imu = make_message<odo_imu>(ODO_TYPE_IMU, t_ns);
  imu.header.flags = flags;
  Eigen::Vector3d::Map(imu.gyro_b) = gyro_b, Eigen::Vector3d::Map(imu.accel_b) = accel_b;
  return imu;
}

/// `tilt_variance`: of roll and pitch, rad^2.
inline odo_attitude attitude_at(int64_t t_ns, const Eigen::Quaterniond& q_n_b = Eigen::Quaterniond::Identity(),
                                double tilt_variance = 0) {
  auto attitude = make_message<odo_attitude>(ODO_TYPE_ATTITUDE, t_ns);
  put_quaternion(q_n_b, attitude.q_n_b);
  attitude.covariance_n[0] = attitude.covariance_n[4] = tilt_variance;
  return attitude;
}

inline odo_barometer pressure_at(int64_t t_ns, double pressure_pa) {
  auto barometer = make_message<odo_barometer>(ODO_TYPE_BAROMETER, t_ns);
  barometer.pressure_pa = pressure_pa;
  return barometer;
}

/// With a heading, which is north.
inline odo_step step_between(int64_t from_ns, int64_t to_ns, int64_t t_ns, double length_m, double sigma_m) {
  auto step = make_message<odo_step>(ODO_TYPE_STEP, t_ns);
  step.header.flags = ODO_STEP_HEADING;
  step.t_start_ns = from_ns, step.t_end_ns = to_ns;
  step.length_m = length_m, step.sigma_m = sigma_m;
  return step;
}

/// Tracked, without a rotation.
inline odo_vo_motion motion_between(int64_t from_ns, int64_t to_ns, const Eigen::Vector3d& p_c0_c1,
                                    uint32_t flags = ODO_VO_ROTATION | ODO_VO_TRANSLATION) {
  auto motion = make_message<odo_vo_motion>(ODO_TYPE_VO_MOTION, to_ns);
  motion.header.flags = flags;
  motion.t_from_ns = from_ns, motion.q_c0_c1[0] = 1, motion.state = ODO_TRACKING;
  Eigen::Vector3d::Map(motion.p_c0_c1) = p_c0_c1;
  return motion;
}

inline odo_fix fix_at(int64_t t_ns, const Eigen::Vector3d& p_n, double sigma_m,
                      uint32_t flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE) {
  auto fix = make_message<odo_fix>(ODO_TYPE_FIX, t_ns);
  fix.header.flags = flags;
  Eigen::Vector3d::Map(fix.p_n) = p_n;
  for (const int i : {0, 4, 8}) fix.covariance_n[i] = sigma_m * sigma_m;
  return fix;
}

/// Of the phone's top.
inline odo_fix yaw_fix_at(int64_t t_ns, double yaw_rad, double sigma_rad) {
  auto fix = make_message<odo_fix>(ODO_TYPE_FIX, t_ns);
  fix.header.flags = ODO_FIX_YAW, fix.yaw_axis_b[1] = 1;
  fix.yaw_rad = yaw_rad, fix.yaw_sigma_rad = sigma_rad;
  return fix;
}

/// Rows without gaps.
inline odo_frame grey_frame_at(int64_t t_ns, const uint8_t* pixels, uint32_t width, uint32_t height) {
  auto frame = make_message<odo_frame>(ODO_TYPE_FRAME, t_ns);
  frame.format = ODO_FORMAT_GREY8;
  frame.width = width, frame.height = height;
  frame.planes[0] = {pixels, width, 1, 0};
  return frame;
}

}  // namespace odograph
