// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

namespace odograph::gait {

/// Carrying mode, after Susi, Renaudin & Lachapelle (Sensors 2013): from energy and variance of both sensors.
enum class Carrying { unknown, still, texting, swinging };

/// The scalar signal for step detection: the smoothed norm of the specific force minus its slow mean; and the energy of
/// both sensors, which is for the specific force the variance of its norm. Any sample rate, also irregular. Does not
/// allocate.
class GaitSignal {
 public:
  struct Parameters {
    double smooth_tau_s = 0.09;  ///< mean delay of the smoothing
    double mean_tau_s = 1.2;     ///< of the subtracted mean
    /// Of the energies: a fifth of a step, so that they fade within half a second of the last one.
    double energy_tau_s = 0.1;
    double still_accel_mps2 = 0.45;  ///< root of the accelerometer's energy below which nobody walks
    double swing_tau_s = 0.6;        ///< of the gyroscope's energy that tells swinging from texting
    double swing_gyro_radps = 1.8;   ///< its root above which the arm swings
  };

  explicit GaitSignal(const Parameters& parameters) : p_(parameters) {}

  void update(int64_t t_ns, const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel);

  int64_t time_ns() const { return t_ns_ - delay_ns_; }  ///< the time that value() refers to
  double value() const { return smooth_[1] - mean_; }    ///< m/s^2
  /// Whether the accelerometer has the energy of a walk.
  bool moves() const { return accel_energy_ > p_.still_accel_mps2 * p_.still_accel_mps2; }
  bool swings() const { return swing_energy_ > p_.swing_gyro_radps * p_.swing_gyro_radps; }
  bool settled() const { return time_s_ >= 0.3; }
  /// Whether the norm of the angular rate has had a peak above its rms since the last call of next_step().
  bool gyro_peaked() const { return gyro_peaked_; }
  void next_step() { gyro_peaked_ = false; }

 private:
  Parameters p_;
  bool started_ = false;
  int64_t t_ns_ = 0;
  int64_t delay_ns_ = 0;
  std::array<double, 2> smooth_{};
  double mean_ = 0.0;
  double gyro_smooth_ = 0.0;
  bool gyro_rises_ = false, gyro_peaked_ = false;
  double accel_energy_ = 0.0, swing_energy_ = 0.0;
  double time_s_ = 0.0;
};

}  // namespace odograph::gait
