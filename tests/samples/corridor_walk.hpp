// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <odograph/odograph.h>

#include "tests/support/session_app.hpp"

namespace odograph {

/// A walk down a winding corridor with a closed-form truth: measurements of the IMU, the platform's tracking and
/// transmitters along the walls. The phone is held upright; its camera looks ahead.
class CorridorWalk {
 public:
  using Vector3d = Eigen::Vector3d;
  using Quaterniond = Eigen::Quaterniond;
  static constexpr double kStart_s = 2, kSpeed_mps = 1.3, kHeight_m = 1.4;

  struct Platform {
    double scale = 1;           ///< of its positions
    double yaw_rate_radps = 0;  ///< drift of its heading
    bool of_body = false;
    double hz = 20;
  };

  /// Distance along the corridor, from a standstill.
  static double along(double t) {
    const double s = std::max(0.0, t - kStart_s), ramp = 2;
    return s < ramp ? kSpeed_mps * s * s * s / ramp / ramp * (1 - s / 2 / ramp) : kSpeed_mps * (s - ramp / 2);
  }
  /// Fraction of the full gait: a smooth constant motion would look like rest to an IMU.
  static double gait(double t) {
    const double s = std::clamp((t - kStart_s) / 2, 0.0, 1.0);
    return s * s * s * (10 - 15 * s + 6 * s * s);
  }
  static Vector3d p_n(double t) {
    const double s = along(t), bob_m = 0.015 * std::sin(4 * EIGEN_PI * t), sway_m = 0.02 * std::sin(2 * EIGEN_PI * t);
    return {s, 3 * (1 - std::cos(0.08 * s)) + gait(t) * sway_m, -kHeight_m + gait(t) * bob_m};
  }
  static Quaterniond q_n_b(double t) {
    const double heading = std::atan(0.24 * std::sin(0.08 * along(t))) + gait(t) * 0.03 * std::sin(2 * EIGEN_PI * t);
    Eigen::Matrix3d upright;  // columns: x to the right, y up, z to the walker
    upright << 0, 0, -1, 1, 0, 0, 0, -1, 0;
    return Quaterniond(Eigen::AngleAxisd(heading, Vector3d::UnitZ())) * Quaterniond(upright);
  }
  static Quaterniond q_b_c() {
    Eigen::Matrix3d R;  // a phone's back camera: columns are its axes in b
    R << 0, -1, 0, -1, 0, 0, 0, 0, -1;
    return Quaterniond(R);
  }
  static Vector3d p_b_c() { return {0.01, 0.06, -0.004}; }
  static int64_t ns(double t) { return static_cast<int64_t>(std::llround(t * 1e9)) + 1'000'000'000; }

  static void imu(const App& app, double t) {
    constexpr double h = 1e-3;
    const Vector3d a_n = (p_n(t + h) - 2 * p_n(t) + p_n(t - h)) / (h * h) - Vector3d(0, 0, 9.81);
    const Eigen::AngleAxisd turned(q_n_b(t - h).conjugate() * q_n_b(t + h));
    const Vector3d accel = q_n_b(t).conjugate() * a_n, gyro = turned.angle() / (2 * h) * turned.axis();
    odo_session_push_imu(app.session, ns(t), gyro.data(), accel.data());
  }

  static void calibration(const App& app) {
    auto c = odograph::calibration(64, 48);
    c.header.t_ns = ns(0);
    c.header.flags = ODO_CALIBRATION_EXTRINSICS;
    const Quaterniond q = q_b_c();
    c.q_b_c[0] = q.w(), c.q_b_c[1] = q.x(), c.q_b_c[2] = q.y(), c.q_b_c[3] = q.z();
    Vector3d::Map(c.p_b_c) = p_b_c();
    CHECK(odo_session_push(app.session, &c.header) == ODO_OK);
  }

  /// The platform's pose with an integrated drift: call it in time order.
  odo_platform_pose platform_pose(double t, const Platform& platform) {
    const Quaterniond mount = platform.of_body ? Quaterniond::Identity() : q_b_c();
    const Vector3d lever = platform.of_body ? Vector3d(0, 0, 0) : p_b_c();
    const auto at = [&](double s) -> Vector3d { return p_n(s) + q_n_b(s) * lever; };
    const Quaterniond drift(Eigen::AngleAxisd(platform.yaw_rate_radps * t, Vector3d::UnitZ()));
    if (begun_) p_w_ += platform.scale * (drift * (at(t) - at(last_s_)));
    begun_ = true, last_s_ = t;
    auto pose = make_message<odo_platform_pose>(ODO_TYPE_PLATFORM_POSE, ns(t));
    pose.header.flags = platform.of_body ? 0 : ODO_PLATFORM_POSE_CAMERA;
    const Quaterniond q = drift * q_n_b(t) * mount;
    pose.q_w[0] = q.w(), pose.q_w[1] = q.x(), pose.q_w[2] = q.y(), pose.q_w[3] = q.z();
    Vector3d::Map(pose.p_w) = p_w_;
    pose.state = ODO_TRACKING, pose.world = 1;
    return pose;
  }

  /// Transmitters on both walls, 12 m apart, at 2 to 3 m of height.
  static Vector3d transmitter(int i) { return {12.0 * i - 6, i % 2 ? -8.0 : 12.0, i % 3 ? -3.0 : -2.0}; }

  struct Ranging {
    double sigma_m = 0.1, outliers = 0.1, reach_m = 25;
    int only = -1;  ///< a single transmitter
  };
  static inline const Vector3d kLever_b{0.02, 0.07, 0.0};

  /// One measurement of each transmitter within range; some are too long because of reflections.
  void ranges(const App& app, double t, const Ranging& ranging) {
    std::normal_distribution<double> noise(0, ranging.sigma_m);
    std::uniform_real_distribution<double> uniform(0, 1);
    const Vector3d antenna = p_n(t) + q_n_b(t) * kLever_b;
    for (int i = 0; i < 40; ++i) {
      const double distance = (antenna - transmitter(i)).norm();
      if (distance > ranging.reach_m || (ranging.only >= 0 && i != ranging.only)) continue;
      auto range = make_message<odo_range>(ODO_TYPE_RANGE, ns(t) + i);
      range.header.source = static_cast<uint32_t>(i);
      range.header.flags = ODO_RANGE_TRANSMITTER | ODO_RANGE_LEVER;
      range.transmitter = static_cast<uint64_t>(i);
      range.range_m = distance + noise(random_) + (uniform(random_) < ranging.outliers ? 2 + 6 * uniform(random_) : 0);
      range.sigma_m = ranging.sigma_m;
      Vector3d::Map(range.p_n) = transmitter(i);
      range.transmitter_sigma_m = 0.02;
      Vector3d::Map(range.lever_b) = kLever_b;
      CHECK(odo_session_push(app.session, &range.header) == ODO_OK);
    }
  }

  /// Horizontal error of the body's pose, m.
  static double error(const App& app, double t) {
    odo_pose pose{};
    pose.header.struct_size = sizeof pose;
    REQUIRE(odo_session_get_pose_of(app.session, ODO_OF_BODY, 0, ns(t), &pose) == ODO_OK);
    return (Vector3d(pose.p_n) - p_n(t)).head<2>().norm();
  }

 private:
  Vector3d p_w_{7, -5, 2};
  double last_s_ = 0;
  bool begun_ = false;
  std::mt19937 random_{5};
};

inline std::string sample_plugins() { return (built("tests/samples")).string(); }

/// The pipeline of both samples; the walk starts at the origin's height, heading north.
inline std::string platform_config(const std::string& rest, const std::string& north = "0 m") {
  return "odograph: 1\nattitude: {plugin: attitude/vqf}\nvo_frontend: {plugin: vo/platform_pose}\ncoupling: {type: "
         "localizer}\nnavigation: {start: {position: [" +
         north + ", 0 m, -1.4 m], heading: 0 rad}}\n" + rest;
}

}  // namespace odograph
