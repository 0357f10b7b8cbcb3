// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "sdk/math/ring.hpp"

namespace odograph::magyq {

/// After Renaudin & Combettes, "Magnetic, Acceleration Fields and Gyroscope Quaternion (MAGYQ)-Based Attitude
/// Estimation with Smartphone Sensors for Indoor Pedestrian Navigation", Sensors 14 (2014). The sensitivity to each
/// value is not recorded; the README has the performance as a whole.
struct Parameters {
  double gyro_noise = 1e-3;         ///< rad/s/sqrt(Hz); a phone's, scale errors and misalignment included
  double gyro_walk = 1e-5;          ///< rad/s^2/sqrt(Hz), of the bias
  double bias_sigma_radps = 0.006;  ///< initial sigma of the bias
  double window_s = 1.0;            ///< averaging time of the acceleration: removes the swing of a stride
  double accel_sigma_mps2 = 0.35;   ///< of that average: change of velocity within the window
  double rest_gyro_radps = 0.02, rest_accel_mps2 = 0.15;  ///< max spread of rate and acceleration in the window at rest
  double rest_sway_radps = 0.0026;                        ///< min sigma of the mean rate at rest
  double saturation_gyro_radps = 30.0;                    ///< beyond these a phone's sensors saturate,
  double saturation_accel_mps2 = 60.0;                    ///< and the inclination is re-initialised
  double field_window_s = 1.0;             ///< both halves of which must have a field of the same strength
  double field_change = 0.006;             ///< max relative difference of the halves in a quasi-static field
  double calm_accel_mps2 = 0.6;            ///< max spread of the acceleration without walking
  double field_heading_sigma_rad = 0.008;  ///< of the heading by the field: noise and tilt
  double field_off_sigma_rad = 0.18;       ///< deviation of the field from north by local disturbances
  double field_off_s = 5;                  ///< its time constant while walking
  double street_off_sigma_rad = 0.18;      ///< the same for disturbances of the extent of a street
  double street_off_s = 60;                ///< its time constant while walking
  double field_random_walk = 0.002;        ///< rad/sqrt(s): random walk of the deviation in quasi-static phases
  double hard_iron_sigma = 0.06;           ///< hard iron, relative to the Earth's field
  // Empirical, never varied:
  double min_start_accel_mps2 = 1;       ///< min first sample: below it free fall or a defective sensor
  double start_s = 0.1;                  ///< averaging time of the first inclination
  double start_tilt_rad = 0.1;           ///< its sigma
  double saturation_tilt_rad = 1;        ///< of the rotation after saturation
  double rest_accel_factor = 0.1;        ///< on accel_sigma_mps2 at rest
  double gate_sigma = 5;                 ///< for a vertical, or a rate at rest
  double min_window_samples = 4;         ///< min samples in the field's window
  double between_field_updates_s = 0.2;  ///< consecutive field samples have correlated errors
  double strength_tau_s = 60;            ///< time constant of the mean field strength
  double unusual_strength = 0.1;         ///< relative deviation from the mean strength above which a field is disturbed
  double inflation_gate =
      4;  ///< innovation squared over its variance above which the field's variance is increased to match
  double min_horizontal = 0.05;  ///< horizontal part of the field: below it the field gives no heading
};

/// Orientation from the gyroscope, corrected by gravity and the magnetic field. The acceleration averaged over a stride
/// gives the vertical. Disturbances deflect the magnetic field from north. The deflection changes with the position,
/// but slowly while the field's strength is quasi-static: over a second or two the field therefore observes the
/// gyroscope's error (the paper's magnetic angular rate update), and over a minute it observes north. Error-state
/// Kalman filter with eleven states: rotation (in the Earth frame), gyro bias, local and street-wide deflection of the
/// field, and hard iron (in the body frame). Earth frame: East-North-Up. Does not allocate.
class Filter {
 public:
  explicit Filter(const Parameters& parameters) : p_(parameters) {}

  /// gyro rad/s, accel m/s^2 in body axes; dt_s > 0 since the last sample.
  void update(const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel, double dt_s);
  /// Field in body axes, any unit; dt_s since the last magnetometer sample.
  void update_magnetometer(const Eigen::Vector3d& field, double dt_s);

  bool ready() const { return started_; }
  /// Body to Earth (ENU). Heading is relative to the start until the first magnetometer sample.
  const Eigen::Quaterniond& orientation() const { return q_; }
  /// Gyro bias in rad/s, to be subtracted.
  const Eigen::Vector3d& bias() const { return bias_; }
  bool at_rest() const { return at_rest_; }
  bool has_heading() const { return has_heading_; }
  /// The field strength deviates strongly from its mean.
  bool mag_disturbed() const { return disturbed_; }
  double heading_sigma() const;
  double inclination_sigma() const;

 private:
  static constexpr int kStates = 11, kHeading = 2, kFieldOff = 6, kIron = 7, kStreetOff = 10;
  using Matrix = Eigen::Matrix<double, kStates, kStates>;
  using Row = Eigen::Matrix<double, 1, kStates>;

  void predict(const Eigen::Vector3d& gyro, double dt_s);
  void align_with_gravity();
  void reset_window();
  void update_bias_at_rest(const Eigen::Vector3d& rate, double sigma_radps);
  bool is_quasi_static(double dt_s) const;
  void apply_gauss_markov(int state, double& value_rad, double times, double sigma_rad);
  void update_field_heading(const Eigen::Vector3d& field_earth);
  void correct(const Row& H, double innovation, double variance, double gate_sigma);

  Parameters p_;
  bool started_ = false;
  Eigen::Quaterniond q_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d bias_ = Eigen::Vector3d::Zero();
  Matrix P_ = Matrix::Zero();

  // Window for acceleration and rest detection.
  double window_s_ = 0;
  size_t window_count_ = 0;
  Eigen::Vector3d accel_sum_ = Eigen::Vector3d::Zero(), rate_sum_ = Eigen::Vector3d::Zero();
  double accel_squares_ = 0, rate_squares_ = 0;
  bool at_rest_ = false, settled_ = false, saturated_ = false;

  // The magnetic field.
  static constexpr size_t kNorms = 256;
  Ring<double, kNorms> norms_;
  double since_update_s_ = 0, seen_s_ = 0;
  Eigen::Vector3d field_sum_ = Eigen::Vector3d::Zero();  // in the Earth frame
  double field_off_rad_ = 0, street_off_rad_ = 0;
  Eigen::Vector3d iron_ = Eigen::Vector3d::Zero();  // in body axes, relative to the field strength
  double strength_ = 0;                             // mean field strength
  bool calm_ = false, quasi_static_ = false, disturbed_ = false, has_heading_ = false;
};

}  // namespace odograph::magyq
