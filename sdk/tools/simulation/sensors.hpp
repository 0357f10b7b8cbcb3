// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "sdk/tools/simulation/motion.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "sdk/tools/simulation/scenario.hpp"

namespace odograph {

/// One triad of an inertial sensor: scale and misalignment, constant bias and its random walk, white noise as an Allan
/// deviation separates them, saturation, quantisation.
class SimTriad {
 public:
  struct Errors {
    double bias, walk, noise, scale, misalignment, range, step;
    /// Of such a sensor at rest, averaged over `tau_s`: white noise, the bias's walk, and rounding, which is white
    /// noise of variance step^2 / 12 on each sample.
    double allan_deviation(double rate_hz, double tau_s) const;
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

/// What a phone's gyroscope feels besides rotation: its own warming (by 10 K, time constant 5 min) and force.
class SimGyroErrors {
 public:
  SimGyroErrors(const Scenario::Imu& imu, uint64_t seed);
  /// rad/s, to be added to the bias.
  Eigen::Vector3d at(double t_s, const Eigen::Vector3d& specific_force_b) const;

 private:
  Eigen::Vector3d per_kelvin_;
  Eigen::Matrix3d per_force_;  // rad/s for each m/s^2
};

/// The time stamps that an app's callback gives to inertial samples: jitter, and now and then a stall after which the
/// samples that were due come all at once. They never go back.
class SimStamps {
 public:
  SimStamps(const Scenario::Imu& imu, uint64_t seed);
  double of(double t_s);  ///< in the order of time; the true time itself where there is neither jitter nor gap

 private:
  Scenario::Imu c_;
  Random random_;
  double last_s_ = -1e9, stall_s_, stall_end_s_ = -1e9;
};

/// Wild samples: now and then one far outside the sensor's range, or a spike within it, in turn.
class SimWildSamples {
 public:
  SimWildSamples(const Scenario::Imu& imu, uint64_t seed);
  /// Spoils the measurements where it is time to.
  void spoil(double t_s, Eigen::Vector3d& gyro_b, Eigen::Vector3d& accel_b);

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

/// A receiver among houses: its error grows and correlates where the sky is narrow, and whole stretches have no fix.
class SimGnss {
 public:
  SimGnss(const Scenario& scenario, uint64_t seed);
  struct Fix {
    bool available;
    Eigen::Vector3d p_n;
    double sigma_m;  ///< as the receiver states it: too small, as they do
  };
  Fix measure(const Eigen::Vector3d& p_n);  ///< once a second

 private:
  Scenario::Gnss c_;
  bool indoors_;
  Random random_;
  Eigen::Vector3d error_;  ///< of unit variance
  double narrow_ = 0;      ///< of unit variance; how much of the sky is hidden
  bool available_ = true;
};

}  // namespace odograph
