// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "sdk/tools/recording/recording.hpp"
#include "sdk/tools/simulation/scenario.hpp"

namespace odograph {

constexpr double kGaitRate_hz = 50;  ///< typical rate of phone recordings

/// Samples of a walk at kGaitRate_hz: norms of acceleration and rotation rate, and horizontal acceleration.
struct GaitSeries {
  std::vector<double> acceleration, rotation, level;
};

struct GaitFigures {
  double frequency_hz;      ///< of the steps: the spectrum's peak between 1.2 and 3 Hz
  double acceleration_std;  ///< of the norm, m/s^2
  double acceleration_p95;  ///< of the norm's deviation from its mean, m/s^2
  double rotation_rms;      ///< rad/s
  double horizontal_rms;    ///< of the horizontal acceleration, m/s^2, using the phone's orientation or the true one
  double stride_part;       ///< power around half the step frequency over that around the step frequency
  double shock_part;        ///< power above 8 Hz over total power
  std::vector<double> spectrum;  ///< of the acceleration's norm, (m/s^2)^2/Hz at 0.1 Hz steps
};

/// From a recording's IMU; horizontal with the phone's own orientation if available.
GaitSeries gait_series(const Recording& recording);

/// From a simulated walker, from the first step on, with the IMU's white noise.
GaitSeries gait_series(const Scenario& scenario, uint64_t seed);

/// Welch's mean periodogram at 0.1 Hz steps: Hann windows of ten seconds, half overlapping.
std::vector<double> power_spectrum(const std::vector<double>& signal, double rate_hz);

GaitFigures gait_figures(const GaitSeries& series);

/// log10 of a percentile of such spectra at each frequency from 0.3 Hz on, by Hz.
std::vector<std::pair<double, double>> spectra_percentile(const std::vector<std::vector<double>>& spectra, double part);

}  // namespace odograph
