// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include <Eigen/Core>

namespace odograph::inertial_scale {

/// The inverse scale over one window: displacement of the odometry per metre.
struct WindowScale {
  double inverse_scale, sigma;
  double path;  ///< the odometry's, up to scale
};

/// The regression of one window, per axis in n:
///   y(t) = r alpha(t) + D beta(t) + c0 + c1 t + c2 t^2 + c3 t^3,
/// with y the odometry's positions up to scale and alpha the camera's positions by the IMU alone, in metres. The c
/// absorb the initial velocity and the effect of bias and tilt errors on the acceleration, up to a linear drift in
/// time: without c3 a tilt error that varies by a degree in 10 s makes the scale 5 % too large. The odometry's noise is
/// as large as the motion of the gait, so it is the dependent variable: with the sides exchanged r would be biased
/// towards zero by S^2 / (S^2 + N^2), S being the rms of the detrended alpha and N the odometry's error. N comes from
/// the residuals.
///
/// beta is the part of that error that correlates with the gait, as caused by a rolling shutter: an odometry confuses
/// rotation with translation across the optical axis, by its rotation error times the depth of the scene. The gyroscope
/// gives the rotation error. beta sums the difference of the rotation vectors crossed with the optical axis, in n; the
/// depth D is estimated. Without it vo/five_point sees a walker's vertical motion 0.6 or 1.5 times too large.
///
/// Sigma of r: the odometry's error is correlated in time, by e^(-t / tau), and N^2 and var(r) depend on tau. With C
/// the correlations of the frames, P the projection that removes the trend and e the residuals,
///   N^2 = e'e / (3 tr(P C) - a'Ca / a'a),   var(r) = N^2 a'Ca / (a'a)^2,   a being the detrended alpha.
/// tau is unknown: the one with the largest sigma is used. Does not allocate.
class Window {
 public:
  static constexpr size_t kMaxFrames = 128;

  struct Parameters {
    size_t min_frames = 12;   ///< min frames of a window with a result; empirical
    double min_noise = 5e-4;  ///< lower bound of N, as a share of the odometry's path: the best visual odometry here is
                              ///< 0.16 % off (docs/accuracy/odometry.md)
    std::array<double, 5> tau_s{1e-3, 0.1, 0.2, 0.4, 0.8};  ///< s: from the frame interval to a window's slowest motion
                                                            ///< beyond the trend
  };

  explicit Window(const Parameters& parameters) : p_(parameters) {}

  void clear() { count_ = 0; }
  bool empty() const { return count_ == 0; }
  struct Frame {
    double t_s;  ///< since the first frame
    Eigen::Vector3d alpha_n, y_n, beta_n;
  };
  /// In chronological order; frames beyond kMaxFrames are ignored.
  void add(const Frame& frame) {
    if (count_ < frames_.size()) frames_[count_++] = frame;
  }
  double last_s() const { return frames_[count_ - 1].t_s; }
  /// Nothing with too few frames, or without motion.
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
