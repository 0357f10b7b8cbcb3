// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace odograph::vqf {

/// Symbols, defaults and meaning after Laidig & Seel, "VQF: Highly accurate IMU orientation estimation with bias
/// estimation and magnetic disturbance rejection", Information Fusion 91 (2023).
struct Parameters {
  double tau_acc_s = 3.0;                     ///< time constant of the inclination correction, tau_acc
  double tau_mag_s = 9.0;                     ///< time constant of the heading correction, tau_mag
  double bias_sigma_init_radps = 0.00873;     ///< standard deviation of the initial bias (0.5 deg/s)
  double bias_forgetting_s = 100.0;           ///< time in which the bias uncertainty grows by 0.1 deg/s
  double bias_clip_radps = 0.0349;            ///< limit of the bias estimate (2 deg/s)
  double bias_sigma_motion_radps = 0.001745;  ///< converged uncertainty while moving (0.1 deg/s)
  double bias_vertical_forgetting = 1e-4;     ///< weight of the zero measurement of the vertical bias while moving
  double bias_sigma_rest_radps = 0.000524;    ///< converged uncertainty at rest (0.03 deg/s)
  double rest_min_s = 1.5;                    ///< time without movement that counts as rest
  double rest_filter_tau_s = 0.5;             ///< time constant of the signals for rest detection
  double rest_gyro_radps = 0.0349;            ///< deviation of the gyroscope allowed at rest (2 deg/s)
  double rest_accel_mps2 = 0.5;               ///< deviation of the accelerometer allowed at rest
  double rest_sway_radps = 0.0026;       ///< slow sway of the gyroscope allowed at rest (0.15 deg/s); not in the paper:
                                         ///< a standing hand sways more slowly than the paper's test detects
  double rest_sway_tau_s = 3.0;          ///< time constant of the sway
  double saturation_gyro_radps = 30.0;   ///< beyond these a phone's sensors saturate; not in the paper: afterwards the
  double saturation_accel_mps2 = 60.0;   ///< inclination and its average are re-initialised
  double mag_ref_tau_s = 20.0;           ///< adaptation of the reference norm and dip
  double mag_norm_tolerance = 0.1;       ///< max relative deviation of the norm of an undisturbed field
  double mag_dip_tolerance_rad = 0.175;  ///< max deviation of the dip of an undisturbed field (10 deg)
  double mag_new_s = 20.0;               ///< a field steady for this long becomes the new reference
};

/// Orientation from gyroscope and accelerometer, optionally magnetometer, with gyro bias estimation at rest and in
/// motion. Supports any and irregular sample rates: two cascaded first-order filters of half the time constant (the
/// same mean delay) replace the paper's Butterworth filters, whose coefficients depend on the rate. Earth frame:
/// East-North-Up, as in the paper. Does not allocate.
class Filter {
 public:
  explicit Filter(const Parameters& parameters) : p_(parameters) {}

  /// gyro rad/s, accel m/s^2 in body axes; dt_s > 0 since the last sample.
  void update(const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel, double dt_s);
  /// field in body axes, any unit; dt_s since the last magnetometer sample.
  void update_magnetometer(const Eigen::Vector3d& field, double dt_s);

  bool ready() const { return started_; }
  /// Body to Earth (ENU). Heading is relative to the start until the first magnetometer sample.
  Eigen::Quaterniond orientation() const;
  /// Gyro bias in rad/s, to be subtracted.
  const Eigen::Vector3d& bias() const { return bias_; }
  /// Standard deviation of the bias, rad/s, largest axis.
  double bias_sigma() const;
  bool at_rest() const { return rest_time_s_ >= p_.rest_min_s; }
  bool has_heading() const { return has_heading_; }
  bool mag_disturbed() const { return mag_disturbed_; }
  /// Standard deviations of heading and inclination, rad.
  double heading_sigma() const { return heading_sigma_; }
  double inclination_sigma() const;

 private:
  /// Two first-order low-pass filters in cascade.
  template <class T>
  struct LowPass {
    T first = T::Zero(), second = T::Zero();
    bool started = false;
    const T& update(const T& x, double tau_s, double dt_s) {
      if (!started) {
        first = second = x;
        started = true;
        return second;
      }
      const double k = 1.0 - std::exp(-dt_s / (0.5 * tau_s));
      first += k * (x - first);
      second += k * (first - second);
      return second;
    }
  };

  void update_rest(const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel, double dt_s);
  void update_bias(const Eigen::Vector3d& accel_earth, double dt_s);

  Parameters p_;
  bool started_ = false;
  Eigen::Quaterniond q_gyro_ = Eigen::Quaterniond::Identity();   // body to the strapdown's own frame
  Eigen::Quaterniond q_accel_ = Eigen::Quaterniond::Identity();  // from there to an Earth frame of arbitrary heading
  double delta_rad_ = 0.0;                                       // heading of that frame
  LowPass<Eigen::Vector3d> accel_low_;
  Eigen::Vector3d bias_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d bias_covariance_ = Eigen::Matrix3d::Zero();
  LowPass<Eigen::Matrix3d> rotation_low_;
  LowPass<Eigen::Vector3d> bias_low_;
  LowPass<Eigen::Vector3d> rest_gyro_low_, rest_accel_low_, rest_gyro_slow_;
  double rest_sway_variance_ = 0.0;
  double rest_time_s_ = 0.0;
  double time_s_ = 0.0;
  bool saturated_ = false;
  double heading_sigma_ = 0.0;

  bool has_heading_ = false;
  bool mag_disturbed_ = false;
  double mag_time_s_ = 0.0;
  double mag_norm_ = 0.0, mag_dip_rad_ = 0.0;
  double mag_candidate_norm_ = 0.0, mag_candidate_dip_rad_ = 0.0, mag_candidate_s_ = 0.0;
};

}  // namespace odograph::vqf
