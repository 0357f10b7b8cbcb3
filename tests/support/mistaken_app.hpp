// SPDX-License-Identifier: Apache-2.0
//
// An app that pushes a phone's motion and pictures, with a mistake.
#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/session_app.hpp"

namespace odograph {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr int64_t kStart_ns = 5'000'000'000;

const Vector3d kNoSurge = Vector3d::Zero();

/// A hand that walks, looks around, or rests.
struct Motion {
  double swing_rad = 0.6, bounce_mps2 = 2.5;
  Vector3d surge_n = Vector3d::Zero();  ///< m/s^2, amplitude at 0.2 Hz: a bus that starts and brakes
  double yaw_radps = 0;                 ///< about down, without a hand's motion: a roundabout

  Quaterniond q_n_b(double t) const {
    const auto swing = [&](double hz, double phase) { return swing_rad * std::sin(2 * EIGEN_PI * hz * t + phase); };
    const Quaterniond upright(0.5, -0.5, -0.5, 0.5);  // held up, display towards the walker, who looks north
    return Quaterniond(Eigen::AngleAxisd(yaw_radps * t + swing(0.21, 0), Vector3d::UnitZ())) * upright *
           Quaterniond(Eigen::AngleAxisd(swing(0.17, 1), Vector3d::UnitX())) *
           Quaterniond(Eigen::AngleAxisd(0.5 * swing(0.29, 2), Vector3d::UnitZ()));
  }
  Vector3d rate_b(double t) const {
    constexpr double kStep_s = 1e-4;
    return log_rotation(q_n_b(t - kStep_s).conjugate() * q_n_b(t + kStep_s)) / (2 * kStep_s);
  }
  Vector3d force_b(double t) const {
    const Vector3d a_n(0.6 * bounce_mps2 * std::sin(2 * EIGEN_PI * 1.8 * t), 0,
                       bounce_mps2 * std::sin(2 * EIGEN_PI * 3.6 * t));
    const Vector3d surge = surge_n * std::sin(2 * EIGEN_PI * 0.2 * t);
    const Vector3d noise_b = 0.04 * Vector3d(std::sin(9973 * t), std::sin(8887 * t), std::sin(7901 * t));
    return q_n_b(t).conjugate() * (a_n + surge - Vector3d(0, 0, 9.81)) + noise_b;
  }
};

/// What a camera in the middle of a distant world sees.
class Pictures {
 public:
  static constexpr int kWidth = 160, kHeight = 120;
  static constexpr double kFocal_px = 130;

  std::vector<uint8_t> at(const Quaterniond& q_n_c) const {
    std::vector<uint8_t> out(size_t(kWidth) * kHeight);
    for (int v = 0; v < kHeight; ++v)
      for (int u = 0; u < kWidth; ++u) {
        const Vector3d d = q_n_c * Vector3d((u - 80) / kFocal_px, (v - 60) / kFocal_px, 1).normalized();
        const double azimuth = std::atan2(d.y(), d.x()), height = std::asin(d.z());
        double value = 128;  // walls, storeys, and what is neither
        for (int k = 0; k < 4; ++k)
          value += 14 * std::sin((9 + 7 * k) * azimuth + k) + 14 * std::sin((8 + 9 * k) * height + k);
        value += 14 * std::sin(30 * azimuth + 20 * height);
        out[size_t(v) * kWidth + size_t(u)] = static_cast<uint8_t>(std::clamp(value, 0.0, 255.0));
      }
    return out;
  }
};

/// An app with its mistakes.
struct Input {
  Motion motion;
  double hz = 200, seconds = 12;
  bool camera = false;
  std::function<void(odo_imu&)> imu = [](odo_imu&) {};
  std::function<void(odo_calibration&)> calibration = [](odo_calibration&) {};
  std::function<void(std::vector<uint8_t>&, odo_frame&)> frame = [](std::vector<uint8_t>&, odo_frame&) {};
  std::function<void(App&, int64_t t_ns)> further = [](App&, int64_t) {};  ///< ten times a second
  std::function<int64_t(int64_t)> time = [](int64_t t_ns) { return t_ns; };
};

/// Runs it. Returns the keys of warnings with their texts and the first second of each.
struct Outcome {
  std::map<std::string, std::string> warnings, notes;
  double tracking_s = 0;
  bool tracks_at_end = false;
};

inline Outcome run(const Input& input) {
  RunningApp app(
      "odograph: 1\nattitude:\n  plugin: attitude/vqf\nstep_estimator:\n  plugin: step/odograph\n"
      "coupling:\n  type: localizer\n");
  const Pictures pictures;
  const Quaterniond q_b_c = rear_camera_mount();
  if (input.camera) {
    auto c = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, input.time(kStart_ns));
    c.header.flags = ODO_CALIBRATION_EXTRINSICS;
    c.model = ODO_CAMERA_PINHOLE, c.width = Pictures::kWidth, c.height = Pictures::kHeight;
    c.fx = c.fy = Pictures::kFocal_px, c.cx = 79.5, c.cy = 59.5;
    put_quaternion(q_b_c, c.q_b_c);
    input.calibration(c);
    app.push(c);
  }
  const int samples = static_cast<int>(input.seconds * input.hz), every = static_cast<int>(input.hz / 10);
  for (int i = 0; i < samples; ++i) {
    const double t = i / input.hz;
    const int64_t t_ns = kStart_ns + static_cast<int64_t>(t * 1e9);
    auto imu = imu_at(input.time(t_ns), input.motion.rate_b(t), input.motion.force_b(t));
    input.imu(imu);
    app.push(imu);
    if (every == 0 || i % every != 0) continue;
    input.further(app, t_ns);
    if (!input.camera) continue;
    auto pixels = pictures.at(input.motion.q_n_b(t) * q_b_c);
    auto frame = make_message<odo_frame>(ODO_TYPE_FRAME, input.time(t_ns));
    frame.format = ODO_FORMAT_GREY8, frame.width = Pictures::kWidth, frame.height = Pictures::kHeight;
    input.frame(pixels, frame);
    frame.planes[0] = {pixels.data(), frame.width, 1, 0};
    app.push(frame);
  }
  app.flush();
  Outcome out;
  for (const odo_report& report : app.reports)
    (report.severity >= ODO_SEVERITY_WARNING ? out.warnings : out.notes).emplace(report.key, report.text);
  out.tracking_s = app.statistics().tracking_s;
  const auto states = app.all<odo_state>(ODO_TYPE_STATE);
  out.tracks_at_end = !states.empty() && states.back().state == ODO_TRACKING;
  return out;
}

}  // namespace odograph
