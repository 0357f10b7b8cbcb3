// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "sdk/sim/motion.hpp"
#include "sdk/sim/random.hpp"
#include "sdk/sim/scenario.hpp"

namespace odograph {

/// One triad of an inertial sensor: scale and misalignment, constant bias and its random walk, white noise as an Allan
/// deviation separates them, saturation, quantisation.
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

/// Earth's field, the phone's own iron, and iron along the way.
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
