// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include <Eigen/Core>

namespace odograph::inertial_scale {

/// The inverse scale over one window: the odometry's displacement for each metre.
struct WindowScale {
  double inverse_scale, sigma;
};

/// The regression of one window, axis by axis in n: y(t) = r alpha(t) + c0 + c1 t + c2 t^2 + c3 t^3, y the odometry's
/// positions up to scale, alpha the camera's in metres by the IMU alone. The start's velocity, and what bias and
/// inclination add to the acceleration, as far as it grows linearly with time, are in the c. The odometry is the noisy
/// side: it errs by as much as the gait moves, so it stands on the left. With the sides exchanged r would be pulled to
/// zero by S^2 / (S^2 + N^2), S being the rms of the detrended alpha and N the odometry's error. N is what is left
/// over. No allocation.
class Window {
 public:
  struct Parameters {
    size_t min_frames = 12;      ///< of a window with an answer; by hand
    double correlation_s = 0.5;  ///< over which the odometry's error is one error; judgement, 0.25 to 1
    double min_noise = 5e-4;     ///< N at least, as a share of the odometry's path: the best visual odometry here is
                                 ///< 0.16 % off (docs/accuracy/odometry.md)
  };

  explicit Window(const Parameters& parameters) : p_(parameters) {}

  void clear() { count_ = 0; }
  bool empty() const { return count_ == 0; }
  /// Frames in order of time, s since the first one; what is beyond 128 is passed over.
  void add(double t_s, const Eigen::Vector3d& alpha_n, const Eigen::Vector3d& y_n);
  double last_s() const { return frames_[count_ - 1].t_s; }
  /// Nothing of fewer frames than are needed, or where nothing has moved.
  std::optional<WindowScale> solve() const;

 private:
  struct Frame {
    double t_s;
    Eigen::Vector3d alpha_n, y_n;
  };

  Parameters p_;
  std::array<Frame, 128> frames_;
  size_t count_ = 0;
};

}  // namespace odograph::inertial_scale
