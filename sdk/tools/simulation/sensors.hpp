// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "sdk/tools/simulation/motion.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "sdk/tools/simulation/scenario.hpp"

namespace odograph {

/// One triad of an inertial sensor: scale and misalignment, constant bias and bias random walk, white noise as
/// characterised by the Allan deviation, saturation, quantisation.
class SimTriad {
 public:
  struct Errors {
    double bias, walk, noise, scale, misalignment, range, step;
  };
  SimTriad(Random random, const Errors& errors, double rate_hz);
  Eigen::Vector3d measure(const Eigen::Vector3d& truth);
  const Eigen::Vector3d& bias() const { return bias_; }

 private:
  Random random_;
  Errors e_;
  double rate_hz_;
  Eigen::Matrix3d distortion_;
  Eigen::Vector3d bias_;
};

/// Gyroscope bias errors besides rotation: self-heating (10 K, time constant 5 min) and g-sensitivity.
class SimGyroErrors {
 public:
  SimGyroErrors(const Scenario::Imu& imu, uint64_t seed);
  /// rad/s, added to the bias.
  Eigen::Vector3d at(double t_s, const Eigen::Vector3d& specific_force_b) const;

 private:
  Eigen::Vector3d per_kelvin_;
  Eigen::Matrix3d per_force_;  // rad/s per m/s^2
};

/// Time stamps of inertial samples in an app's callback: jitter, and occasional stalls after which the pending samples
/// arrive at once. They never decrease.
class SimStamps {
 public:
  SimStamps(const Scenario::Imu& imu, uint64_t seed);
  double of(double t_s);  ///< in time order; the true time without jitter and gaps

 private:
  Scenario::Imu c_;
  Random random_;
  double last_s_ = -1e9, stall_s_, stall_end_s_ = -1e9;
};

/// Outliers: occasional samples far outside the sensor's range, or spikes within it, alternately.
class SimOutliers {
 public:
  SimOutliers(const Scenario::Imu& imu, uint64_t seed);
  /// Replaces the measurements when an outlier is due.
  void apply(double t_s, Eigen::Vector3d& gyro_b, Eigen::Vector3d& accel_b);

 private:
  void draw_next(double after_s);
  Scenario::Imu c_;
  Random random_;
  double next_s_ = 1e300;
  size_t count_ = 0;
};

/// Earth's field, the phone's own iron, and iron along the path.
class SimMagnetometer {
 public:
  SimMagnetometer(const Scenario::Magnetometer& magnetometer, uint64_t seed);
  Eigen::Vector3d measure(const Eigen::Isometry3d& T_n_b);  ///< T

 private:
  Eigen::Vector3d field_n(const Eigen::Vector3d& p_n) const;
  Scenario::Magnetometer c_;
  Random random_;
  Eigen::Matrix3d soft_;
  Eigen::Vector3d hard_;
  struct Wave {
    Eigen::Vector3d direction, amplitude;
    double phase;
  };
  std::vector<Wave> waves_;
};

class SimBarometer {
 public:
  SimBarometer(const Scenario::Barometer& barometer, uint64_t seed);
  double measure(double up_m);  ///< Pa, once a second

 private:
  Scenario::Barometer c_;
  Random random_;
  double drift_ = 0, wind_ = 0;
};

/// A GNSS receiver among houses: its error and correlation grow where the sky is obstructed, and outages are
/// contiguous.
class SimGnss {
 public:
  SimGnss(const Scenario& scenario, uint64_t seed);
  struct Fix {
    bool available;
    Eigen::Vector3d p_n;
    double sigma_m;  ///< as stated by the receiver: too small, as in practice
  };
  Fix measure(const Eigen::Vector3d& p_n);  ///< once a second

 private:
  Scenario::Gnss c_;
  bool indoors_;
  Random random_;
  Eigen::Vector3d error_;  ///< of unit variance
  double narrow_ = 0;      ///< of unit variance; obstruction of the sky
  bool available_ = true;
};

}  // namespace odograph
