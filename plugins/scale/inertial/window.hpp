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
  double path;  ///< the odometry's, up to scale
};

/// The regression of one window, axis by axis in n:
///   y(t) = r alpha(t) + D beta(t) + c0 + c1 t + c2 t^2 + c3 t^3,
/// y the odometry's positions up to scale, alpha the camera's in metres by the IMU alone. The start's velocity, and
/// what bias and inclination add to the acceleration, as far as it changes linearly with time, are in the c: without c3
/// an inclination that sways by a degree in 10 s makes the scale 5 % too large. The odometry is the noisy side: it errs
/// by as much as the gait moves, so it stands on the left. With the sides exchanged r would be pulled to zero by S^2 /
/// (S^2 + N^2), S being the rms of the detrended alpha and N the odometry's error. N is what is left over.
///
/// beta is the part of that error that goes with the gait, as a rolling shutter makes it: an odometry takes rotation
/// for translation across the optical axis, by the rotation that it has seen too much times the depth of the scene, and
/// the gyroscope knows the rotation. beta sums the rotation vectors' difference crossed with the optical axis, in n;
/// the depth D is free. Without it vo/five_point sees a walker's vertical motion 0.6 or 1.5 times too large.
///
/// The sigma of r: an odometry's error lasts, by e^(-t / tau), and N^2 and var(r) depend on tau. With C the
/// correlations of the frames, P the projection that removes the trend and e the residuals,
///   N^2 = e'e / (3 tr(P C) - a'Ca / a'a),   var(r) = N^2 a'Ca / (a'a)^2,   a being the detrended alpha.
/// tau is not known: the one that gives the largest sigma counts. No allocation.
class Window {
 public:
  static constexpr size_t kMaxFrames = 128;

  struct Parameters {
    size_t min_frames = 12;   ///< of a window with an answer; by hand
    double min_noise = 5e-4;  ///< N at least, as a share of the odometry's path: the best visual odometry here is
                              ///< 0.16 % off (docs/accuracy/odometry.md)
    std::array<double, 5> tau_s{1e-3, 0.1, 0.2, 0.4, 0.8};  ///< s: from frame to frame, to a window's slowest motion
                                                            ///< that the trend leaves
  };

  explicit Window(const Parameters& parameters) : p_(parameters) {}

  void clear() { count_ = 0; }
  bool empty() const { return count_ == 0; }
  struct Frame {
    double t_s;  ///< since the first one
    Eigen::Vector3d alpha_n, y_n, beta_n;
  };
  /// In order of time; what is beyond kMaxFrames is passed over.
  void add(const Frame& frame) {
    if (count_ < frames_.size()) frames_[count_++] = frame;
  }
  double last_s() const { return frames_[count_ - 1].t_s; }
  /// Nothing of fewer frames than are needed, or where nothing has moved.
  std::optional<WindowScale> solve() const;

 private:
  using Vectors = std::array<Eigen::Vector3d, kMaxFrames>;
  using Basis = std::array<Eigen::Vector4d, kMaxFrames>;
  Basis basis() const;
  Vectors detrended(const Basis& basis, Eigen::Vector3d Frame::*values) const;
  double product(const Vectors& one, const Vectors& other) const;
  double correlated(const Vectors& values, double tau_s) const;
  double freedom(const Basis& basis, double tau_s) const;

  Parameters p_;
  std::array<Frame, kMaxFrames> frames_;
  size_t count_ = 0;
};

}  // namespace odograph::inertial_scale
