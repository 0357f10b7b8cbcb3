// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

namespace odograph::gait {

/// Carrying mode, from the spread of both sensors over the last second (after Susi, Renaudin & Lachapelle, Sensors
/// 2013, who use the variances of the same signals).
enum class Carrying { unknown, still, texting, swinging };

/// The scalar signal for step detection: the smoothed norm of the specific force minus its slow mean; and the spread of
/// both sensors. Any sample rate, also irregular. Does not allocate.
class GaitSignal {
 public:
  struct Parameters {
    double smooth_tau_s = 0.09;      ///< mean delay of the smoothing
    double mean_tau_s = 1.2;         ///< of the subtracted mean
    double spread_tau_s = 0.6;       ///< of the spreads
    double still_accel_mps2 = 0.45;  ///< spread of the accelerometer's norm below which the walker stands
    double swing_gyro_radps = 1.6;   ///< mean angular rate above which the arm swings
  };

  explicit GaitSignal(const Parameters& parameters) : p_(parameters) {}

  void update(int64_t t_ns, const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel);

  int64_t time_ns() const { return t_ns_ - delay_ns_; }  ///< the time that value() refers to
  double value() const { return smooth_[1] - mean_; }    ///< m/s^2
  double accel_spread() const;
  double gyro_norm() const { return gyro_norm_; }
  Carrying carrying() const;

 private:
  Parameters p_;
  bool started_ = false;
  int64_t t_ns_ = 0;
  int64_t delay_ns_ = 0;
  std::array<double, 2> smooth_{};
  double mean_ = 0.0;
  double variance_ = 0.0;
  double gyro_norm_ = 0.0;
  double time_s_ = 0.0;
};

}  // namespace odograph::gait
