// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/validator/test_input.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/scalar.hpp"
#include "sdk/math/atmosphere.hpp"
#include "sdk/math/gravity.hpp"

namespace odograph {
TestInput::TestInput(double seconds) {
  auto calibration = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  calibration.header.flags = ODO_CALIBRATION_EXTRINSICS;
  calibration.model = ODO_CAMERA_PINHOLE;
  calibration.width = kWidth, calibration.height = kHeight;
  calibration.fx = calibration.fy = 60, calibration.cx = 31.5, calibration.cy = 23.5;
  calibration.q_b_c[0] = 1;
  add(calibration);
  auto noise = make_message<odo_imu_noise>(ODO_TYPE_IMU_NOISE, 0);
  noise.gyro_noise = 2e-4, noise.gyro_walk = 2e-6, noise.accel_noise = 2e-3, noise.accel_walk = 3e-5;
  add(noise);
  for (int i = 0; i < static_cast<int>(seconds * 100); ++i) {
    const double t = i * 0.01;
    const int64_t t_ns = kStart_ns + i * 10'000'000LL;
    auto imu = make_message<odo_imu>(ODO_TYPE_IMU, t_ns);
    imu.header.flags = ODO_IMU_GYRO | ODO_IMU_ACCEL;
    imu.gyro_b[2] = 0.1 * std::sin(t);
    imu.accel_b[2] = kRoundedGravity_mps2 + 2.0 * std::sin(4 * kPi * t);  // two steps a second
    add(imu);
    auto attitude = make_message<odo_attitude>(ODO_TYPE_ATTITUDE, t_ns);
    attitude.header.flags = ODO_ATTITUDE_COVARIANCE | ODO_ATTITUDE_GYRO_BIAS;
    attitude.q_n_b[1] = 1.0;  // screen up: rotated by 180 degrees about north
    for (int k = 0; k < 3; ++k) attitude.covariance_n[4 * k] = 1e-4;
    add(attitude);
    if (i % 50 == 0 && i > 0) {
      auto step = make_message<odo_step>(ODO_TYPE_STEP, t_ns);
      step.header.flags = ODO_STEP_HEADING;
      step.t_start_ns = t_ns - 500'000'000, step.t_end_ns = t_ns;
      step.length_m = kSpeed_mps / 2, step.sigma_m = 0.05, step.frequency_hz = 2.0;
      step.mode = ODO_MODE_WALKING_TEXTING, step.index = static_cast<uint32_t>(i / 50 - 1);
      add(step);
    }
    if (i % 10 == 0) add_camera(i / 10, t_ns);
    add_slow(i, t, t_ns);
  }
}

void TestInput::add_slow(int i, double t, int64_t t_ns) {
  if (i % 20 == 10) {
    auto range = make_message<odo_range>(ODO_TYPE_RANGE, t_ns);
    range.header.flags = ODO_RANGE_TRANSMITTER;
    range.transmitter = 1;
    range.p_n[0] = 100, range.p_n[2] = -20;
    range.range_m = std::hypot(100 - kSpeed_mps * t, 20.0);
    range.sigma_m = 0.1, range.transmitter_sigma_m = 0.01;
    add(range);
  }
  if (i % 2 == 0) {
    auto field = make_message<odo_magnetometer>(ODO_TYPE_MAGNETOMETER, t_ns);
    field.field_b[0] = 2e-5, field.field_b[2] = -4e-5;
    add(field);
  }
  if (i % 10 == 0) {
    auto pressure = make_message<odo_barometer>(ODO_TYPE_BAROMETER, t_ns);
    pressure.pressure_pa = kSeaLevel_pa;
    add(pressure);
  }
  if (i % 100 != 0) return;
  auto gnss = make_message<odo_gnss>(ODO_TYPE_GNSS, t_ns);
  gnss.header.flags = ODO_GNSS_POSITION | ODO_GNSS_HEIGHT | ODO_GNSS_COVARIANCE;
  gnss.latitude_rad = 0.8 + kSpeed_mps * t / 6'371'000;
  for (int k = 0; k < 3; ++k) gnss.covariance_n[4 * k] = 9;
  add(gnss);
  auto waypoint = make_message<odo_waypoint>(ODO_TYPE_WAYPOINT, t_ns);
  waypoint.p_n[0] = kSpeed_mps * t;
  waypoint.sigma_m = 0.1;
  add(waypoint);
  auto fix = make_message<odo_fix>(ODO_TYPE_FIX, t_ns);
  fix.header.flags =
      ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_DOWN | ODO_FIX_COVARIANCE | ODO_FIX_SLANT | ODO_FLAG_ACCEPTED;
  fix.p_n[0] = kSpeed_mps * t;
  for (int k = 0; k < 3; ++k) fix.covariance_n[4 * k] = 1;
  fix.landmark_n[0] = 100, fix.landmark_n[2] = -20;
  fix.slant_distance_m = std::hypot(100 - kSpeed_mps * t, 20.0);
  add(fix);
  auto pose = make_message<odo_pose>(ODO_TYPE_POSE, t_ns);
  pose.header.flags = ODO_POSE_ORIENTATION | ODO_POSE_POSITION | ODO_POSE_METRIC | ODO_POSE_COVARIANCE;
  pose.q_n[1] = 1.0;
  pose.p_n[0] = kSpeed_mps * t;
  pose.state = ODO_TRACKING;
  for (int k = 0; k < 6; ++k) pose.covariance[7 * k] = k < 3 ? 1e-3 : 1.0;
  add(pose);
}

void TestInput::add_camera(int k, int64_t t_ns) {
  auto& pixels = *pixels_.emplace_back(std::make_unique<std::vector<uint8_t>>(kWidth * kHeight));
  for (uint32_t y = 0; y < kHeight; ++y)
    for (uint32_t x = 0; x < kWidth; ++x)
      pixels[y * kWidth + x] = static_cast<uint8_t>((((x + static_cast<uint32_t>(k) / 4) / 8 + y / 8) % 2) * 180 + 30 +
                                                    (x * 7 + y * 13) % 20);
  auto frame = make_message<odo_frame>(ODO_TYPE_FRAME, t_ns);
  frame.format = ODO_FORMAT_GREY8;
  frame.width = kWidth, frame.height = kHeight;
  frame.planes[0] = {pixels.data(), kWidth, 1, 0};
  add(frame);
  auto platform = make_message<odo_platform_pose>(ODO_TYPE_PLATFORM_POSE, t_ns);
  platform.header.flags = ODO_PLATFORM_POSE_CAMERA;
  platform.q_w[0] = 1.0;
  platform.p_w[0] = 0.1 * kSpeed_mps * k;
  platform.state = ODO_TRACKING;
  add(platform);
  if (k == 0) return;
  auto motion = make_message<odo_vo_motion>(ODO_TYPE_VO_MOTION, t_ns);
  motion.header.flags = ODO_VO_ROTATION | ODO_VO_TRANSLATION | ODO_VO_COVARIANCE | ODO_FLAG_NAVIGATION;
  motion.t_from_ns = t_ns - 100'000'000;
  motion.q_c0_c1[0] = motion.q_n_c0[0] = 1.0;
  motion.p_c0_c1[0] = 0.1 * kUnit_mps;
  for (int i = 0; i < 6; ++i) motion.covariance[7 * i] = 1e-4;
  motion.state = ODO_TRACKING;
  motion.scale_group = 3;
  motion.tracked = 100, motion.inliers = 90;
  add(motion);
}

std::vector<AnyMessage> TestInput::of(const std::vector<uint32_t>& types) const {
  std::vector<AnyMessage> some;
  for (const AnyMessage& message : messages)
    if (std::find(types.begin(), types.end(), message.header().type) != types.end()) some.push_back(message);
  return some;
}

void shift(AnyMessage& message, int64_t by_ns) {
  message.header().t_ns += by_ns;
  if (message.header().type == ODO_TYPE_VO_MOTION)
    reinterpret_cast<odo_vo_motion&>(message.header()).t_from_ns += by_ns;
  if (message.header().type != ODO_TYPE_STEP) return;
  reinterpret_cast<odo_step&>(message.header()).t_start_ns += by_ns;
  reinterpret_cast<odo_step&>(message.header()).t_end_ns += by_ns;
}

}  // namespace odograph
