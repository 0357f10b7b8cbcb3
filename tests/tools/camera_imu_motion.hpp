// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "sdk/host/messages/messages.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/tools/calibration/camera_imu.hpp"
#include "sdk/tools/calibration/lens_model.hpp"

namespace odograph {

/// A hand-held camera among static points, without pictures: tracks and gyroscope samples, exact but for the noise. An
/// oracle that shares only the lens model with the calibration.
struct HandHeld {
  double seconds = 20, frames_hz = 15, imu_hz = 200;
  Eigen::Quaterniond q_b_c{0, 1, 0, 0};  ///< of the motion below, whose x points up and z back
  Eigen::Quaterniond mount{1, 0, 0, 0};  ///< from those axes to the IMU's
  double time_offset_s = 0, row_time_s = 0;
  double focal_px = 480, cx = 322, cy = 236, k1 = 0;
  Eigen::Vector3d rotation_rad{0.12, 0.15, 0.10};  ///< amplitudes about the body's axes
  double walk_mps = 1.2;
  double noise_px = 0.2, gyro_noise_rps = 0.01;
  Eigen::Vector3d gyro_bias{0.01, -0.02, 0.005};

  Eigen::Quaterniond q_n_b(double t) const {
    const Eigen::Vector3d v(rotation_rad.x() * (std::sin(5.1 * t) + 0.6 * std::sin(2.3 * t + 1)),
                            rotation_rad.y() * (std::sin(3.7 * t + 2) + 0.5 * std::sin(7.9 * t)),
                            rotation_rad.z() * (std::sin(4.4 * t + 4) + 0.7 * std::sin(1.9 * t)));
    return Eigen::Quaterniond(Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitY())) * exp_rotation(v);
  }
  Eigen::Vector3d p_n(double t) const {
    return {walk_mps * t, 0.05 * walk_mps * std::sin(5.9 * t), 0.04 * walk_mps * std::sin(11.8 * t)};
  }
  Eigen::Vector3d rate_b(double t) const {
    constexpr double h = 1e-4;
    return log_rotation(q_n_b(t - h).conjugate() * q_n_b(t + h)) / (2 * h);
  }

  Eigen::Quaterniond q_b_c_true() const { return mount * q_b_c; }

  CameraImuData data(uint64_t seed) const {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> even(-1, 1);
    CameraImuData data;
    data.given = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
    data.given.model = ODO_CAMERA_PINHOLE;
    data.given.width = 640, data.given.height = 480;
    data.given.fx = data.given.fy = focal_px, data.given.cx = cx, data.given.cy = cy;
    data.given.distortion[0] = k1, data.given.distortion_count = 4;
    data.given_row_time_s = row_time_s;
    constexpr int64_t kFirst_ns = 5'000'000'000;
    for (int i = 0; i < static_cast<int>(seconds * imu_hz); ++i) {
      const double t = i / imu_hz;
      data.gyro.push_back({kFirst_ns + std::llround(t * 1e9),
                           mount * (rate_b(t) + gyro_bias +
                                    gyro_noise_rps * Eigen::Vector3d{normal(random), normal(random), normal(random)})});
    }
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < static_cast<int>(60 * (seconds * walk_mps + 20)); ++i)
      points.push_back({even(random) * 0.5 * (seconds * walk_mps + 40) + 0.5 * (seconds * walk_mps + 20),
                        (2 + 7 * std::abs(even(random))) * (even(random) < 0 ? -1 : 1), 3 * even(random)});
    const double lens[] = {focal_px, focal_px, cx, cy, k1};
    for (int i = 2; i < static_cast<int>((seconds - 0.2) * frames_hz); ++i) {
      const double t = i / frames_hz;
      TrackedFrame frame{.t_ns = kFirst_ns + std::llround((t - time_offset_s) * 1e9), .ids = {}, .pixels = {}};
      for (size_t k = 0; k < points.size(); ++k) {
        double row = 239.5;
        Eigen::Vector2d pixel;
        bool seen = true;
        for (int pass = 0; pass < 6 && seen; ++pass) {
          const double at = t + (row - 239.5) * row_time_s;
          const Eigen::Vector3d p = (q_n_b(at) * q_b_c).conjugate() * (points[k] - p_n(at));
          seen = p.z() > 0.5 && p.norm() < 25 && std::abs(p.x() / p.z()) < 1 && std::abs(p.y() / p.z()) < 1;
          pixel = Eigen::Vector2d(project(Lens::pinhole, lens, 1, p.x() / p.z(), p.y() / p.z()).data());
          row = pixel.y();
        }
        seen = seen && pixel.x() > 3 && pixel.x() < 636 && pixel.y() > 3 && pixel.y() < 476;
        if (!seen) continue;
        frame.ids.push_back(k);
        frame.pixels.push_back({static_cast<float>(pixel.x() + noise_px * normal(random)),
                                static_cast<float>(pixel.y() + noise_px * normal(random))});
      }
      data.frames.push_back(std::move(frame));
    }
    return data;
  }
};

}  // namespace odograph
