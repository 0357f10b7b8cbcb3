// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "sdk/tools/recording/recording.hpp"
#include "sdk/tools/simulation/scenario.hpp"

namespace odograph {

constexpr double kGaitRate_hz = 50;  ///< of phones' recordings

/// Samples of a walk at kGaitRate_hz: norms of acceleration and of rotation rate, and the horizontal acceleration.
struct GaitSeries {
  std::vector<double> acceleration, rotation, level;
};

struct GaitFigures {
  double frequency_hz;      ///< of the steps: the spectrum's peak between 1.2 and 3 Hz
  double acceleration_std;  ///< of the norm, m/s^2
  double acceleration_p95;  ///< of the norm's deviation from its mean, m/s^2
  double rotation_rms;      ///< rad/s
  double horizontal_rms;    ///< of the horizontal acceleration, m/s^2, by the phone's own orientation or the true one
  double stride_part;       ///< power around half the step frequency over that around it
  double shock_part;        ///< power above 8 Hz over all power
  std::vector<double> spectrum;  ///< of the acceleration's norm, (m/s^2)^2/Hz at 0.1 Hz steps
};

/// Of a recording's IMU; horizontal by the phone's own orientation where it has one.
GaitSeries gait_series(const Recording& recording);

/// Of a simulated walker, from the first step on, with the IMU's white noise.
GaitSeries gait_series(const Scenario& scenario, uint64_t seed);

/// Welch's mean periodogram at 0.1 Hz steps: Hann windows of ten seconds, half overlapping.
std::vector<double> power_spectrum(const std::vector<double>& signal, double rate_hz);

GaitFigures gait_figures(const GaitSeries& series);

/// Of such spectra at each frequency from 0.3 Hz on a percentile's logarithm (of 10), by Hz.
std::vector<std::pair<double, double>> spectra_percentile(const std::vector<std::vector<double>>& spectra, double part);

}  // namespace odograph
