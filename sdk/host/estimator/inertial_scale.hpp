// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "sdk/host/estimator/inertial_parameters.hpp"
#include "sdk/host/estimator/timed_positions.hpp"

namespace odograph::inertial {

/// What inertia says of the scale over one window.
struct WindowScale {
  double inverse_scale;  ///< the odometry's displacement for each metre
  double sigma;          ///< of it
  double signal_m;       ///< S: rms of the detrended motion
  double noise_m;        ///< N: rms of what the odometry differs by
};

/// The scale from inertia: over a window of some seconds the odometry's positions are regressed on the doubly
/// integrated accelerometer, y(t) = r alpha(t) + c0 + c1 t + c2 t^2, by axis in n, where start velocity, bias and
/// inclination are in the c. The odometry is the noisy side (F1 of the findings: it errs by as much as the gait moves),
/// so it stands on the left: regressing the other way round would pull the scale to zero by S^2 / (S^2 + N^2). N comes
/// from what is left over, not from the odometry's covariance, which therefore does not matter. No allocation.
class InertialScale {
 public:
  explicit InertialScale(const Parameters& parameters) : p_(parameters) {}

  void restart();
  /// Acceleration in n without gravity, m/s^2, over the interval that ends at t.
  void add_imu(int64_t t_ns, double dt_s, const Eigen::Vector3d& accel_n);
  /// The odometry's position, up to scale, in n, and the camera's place against the body, m in n; frames in order of
  /// time. An answer when a window is full.
  std::optional<WindowScale> add_frame(int64_t t_ns, const Eigen::Vector3d& lever_n, const Eigen::Vector3d& y_n,
                                       double window_s);

 private:
  struct Frame {
    double t_s;
    Eigen::Vector3d alpha_n, y_n;
  };
  std::optional<WindowScale> solve() const;

  Parameters p_;
  TimedPositions path_;  // alpha
  Eigen::Vector3d alpha_n_ = Eigen::Vector3d::Zero(), rate_n_ = Eigen::Vector3d::Zero();
  std::array<Frame, 96> frames_{};
  size_t frame_count_ = 0;
  int64_t first_ns_ = 0;
};

}  // namespace odograph::inertial
