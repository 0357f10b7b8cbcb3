// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "sdk/math/ring.hpp"

namespace odograph::magyq {

/// After Renaudin & Combettes, "Magnetic, Acceleration Fields and Gyroscope Quaternion (MAGYQ)-Based Attitude
/// Estimation with Smartphone Sensors for Indoor Pedestrian Navigation", Sensors 14 (2014). How far the values matter
/// is not recorded; README says what the whole was seen to do.
struct Parameters {
  double gyro_noise = 1e-3;         ///< rad/s/sqrt(Hz); a phone's, scale errors and misalignment included
  double gyro_walk = 1e-5;          ///< rad/s^2/sqrt(Hz), of the bias
  double bias_sigma_radps = 0.006;  ///< of the bias at the start
  double window_s = 1.0;            ///< over which the acceleration is averaged: a stride's swing is gone then
  double accel_sigma_mps2 = 0.35;   ///< of that average: speed that changes within the window
  double rest_gyro_radps = 0.02, rest_accel_mps2 = 0.15;  ///< deviations in the window that are no movement
  double rest_sway_radps = 0.0026;                        ///< least doubt about the mean rate at rest
  double violent_gyro_radps = 30.0;                       ///< beyond this a phone's sensors saturate,
  double violent_accel_mps2 = 60.0;                       ///< and the inclination has to be found again
  double field_window_s = 1.0;             ///< of which both halves must show a field of the same strength
  double field_change = 0.006;             ///< within this part of it: a quasi-static field
  double calm_accel_mps2 = 0.6;            ///< spread of the acceleration of somebody who does not walk
  double field_heading_sigma_rad = 0.008;  ///< of a heading that the field shows: noise and tilt
  double field_off_sigma_rad = 0.18;       ///< how far the field points off north, where something disturbs it
  double field_off_s = 5;                  ///< time constant of that, on foot
  double street_off_sigma_rad = 0.18;      ///< the same of what is as long as a street
  double street_off_s = 60;                ///< time constant of that, on foot
  double field_random_walk = 0.002;        ///< rad/sqrt(s): how it wanders in quasi-static phases
  double hard_iron_sigma = 0.06;           ///< the device's own field, in parts of the Earth's
  // What follows was chosen by hand, and never varied.
  double min_start_accel_mps2 = 1;       ///< of the first sample: less is free fall or a dead sensor, and no vertical
  double start_tilt_rad = 0.1;           ///< of the inclination by the first sample
  double violent_tilt_rad = 1;           ///< of the rotation after a violent movement
  double rest_accel_factor = 0.1;        ///< of accel_sigma_mps2, where the device rests
  double gate_sigma = 5;                 ///< beyond which a vertical, or a rate at rest, is not believed
  double min_window_samples = 4;         ///< of the field's window
  double between_field_updates_s = 0.2;  ///< neighbouring samples of a field err alike
  double strength_tau_s = 60;            ///< of the field's long mean
  double unusual_strength = 0.1;         ///< part of it, by which a field that is disturbed differs
  double surprise = 4;  ///< of an innovation squared over its variance: the field's error is as large from here
  double min_horizontal = 0.05;  ///< part of the field: less points straight down and tells no heading
};

/// Orientation by gyroscope, corrected where a field allows it. The acceleration averaged over a stride shows the
/// vertical. The magnetic field's direction in the Earth's axes is off north by what disturbs it, which changes as the
/// walker goes, slowly while its strength is quasi-static: so over a second or two the field shows the gyroscope's
/// error (the paper's magnetic angular rate update) whatever disturbs it, and over a minute it shows north. A Kalman
/// filter of the errors of ten states: rotation (in the Earth's axes), gyroscope bias, how far the field is off
/// north here, and the device's own field (hard iron), which turns with it. Earth frame: East-North-Up. No allocation.
class Filter {
 public:
  explicit Filter(const Parameters& parameters) : p_(parameters) {}

  /// gyro rad/s, accel m/s^2 in body axes; dt_s > 0 since the last sample.
  void update(const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel, double dt_s);
  /// Field in body axes, any unit; dt_s since the last magnetometer sample.
  void update_magnetometer(const Eigen::Vector3d& field, double dt_s);

  bool ready() const { return started_; }
  /// Body to Earth (ENU). Heading is relative to the start until a magnetometer spoke.
  const Eigen::Quaterniond& orientation() const { return q_; }
  /// rad/s, to be subtracted.
  const Eigen::Vector3d& bias() const { return bias_; }
  bool at_rest() const { return at_rest_; }
  bool has_heading() const { return has_heading_; }
  /// The field is much stronger or weaker than it is as a rule.
  bool mag_disturbed() const { return disturbed_; }
  double heading_sigma() const;
  double inclination_sigma() const;

 private:
  static constexpr int kStates = 11, kHeading = 2, kFieldOff = 6, kIron = 7, kStreetOff = 10;
  using Matrix = Eigen::Matrix<double, kStates, kStates>;
  using Row = Eigen::Matrix<double, 1, kStates>;

  void predict(const Eigen::Vector3d& gyro, double dt_s);
  void align_with_gravity();
  void forget_window();
  void rest(const Eigen::Vector3d& rate, double sigma_radps);
  bool is_quasi_static(double dt_s) const;
  void wander(int state, double& value_rad, double times, double sigma_rad);
  void see_field(const Eigen::Vector3d& field_earth);
  void correct(const Row& H, double innovation, double variance, double gate_sigma);

  Parameters p_;
  bool started_ = false;
  Eigen::Quaterniond q_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d bias_ = Eigen::Vector3d::Zero();
  Matrix P_ = Matrix::Zero();

  // The window of the acceleration and of what tells rest.
  double window_s_ = 0;
  size_t window_count_ = 0;
  Eigen::Vector3d accel_sum_ = Eigen::Vector3d::Zero(), rate_sum_ = Eigen::Vector3d::Zero();
  double accel_squares_ = 0, rate_squares_ = 0;
  bool at_rest_ = false, settled_ = false, violent_ = false;

  // The magnetic field.
  static constexpr size_t kNorms = 256;
  Ring<double, kNorms> norms_;
  double since_update_s_ = 0, seen_s_ = 0;
  Eigen::Vector3d field_sum_ = Eigen::Vector3d::Zero();  // in the Earth's axes
  double field_off_rad_ = 0, street_off_rad_ = 0;
  Eigen::Vector3d iron_ = Eigen::Vector3d::Zero();  // in body axes, parts of the field's strength
  double strength_ = 0;                             // the field's long mean
  bool calm_ = false, quasi_static_ = false, disturbed_ = false, has_heading_ = false;
};

}  // namespace odograph::magyq
