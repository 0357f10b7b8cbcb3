// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/evaluation/gait_figures.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "sdk/math/scalar.hpp"
#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "sdk/tools/simulation/walker.hpp"

namespace odograph {
namespace {}  // namespace

GaitSeries gait_series(const Recording& recording) {
  GaitSeries series;
  int64_t next = 0;
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  size_t at = 0;
  const auto& attitudes = recording.phone_attitudes;
  for (const auto& m : recording.messages) {
    if (m.message.header().type != ODO_TYPE_IMU) continue;
    const auto& imu = as<odo_imu>(m.message.header());
    if (imu.header.flags & ODO_IMU_ACCEL) a = Eigen::Vector3d::Map(imu.accel_b);
    if (!(imu.header.flags & ODO_IMU_GYRO) || a.norm() == 0) continue;
    if (next == 0) next = imu.header.t_ns;
    for (; next <= imu.header.t_ns; next += static_cast<int64_t>(1e9 / kGaitRate_hz)) {
      series.acceleration.push_back(a.norm());
      series.rotation.push_back(Eigen::Vector3d::Map(imu.gyro_b).norm());
      while (at + 1 < attitudes.size() && attitudes[at + 1].t_ns <= imu.header.t_ns) ++at;
      if (!attitudes.empty()) series.level.push_back((attitudes[at].q * a).head<2>().norm());
    }
  }
  return series;
}

GaitSeries gait_series(const Scenario& scenario, uint64_t seed) {
  const Journey walk = make_walk(scenario, seed);
  Random random(seed, 5);
  GaitSeries series;
  for (double t = walk.steps.front().t_start_s; t < walk.phone.duration_s(); t += 1 / kGaitRate_hz) {
    const auto s = walk.phone.at(t);
    const auto noise = [&](double sigma) {
      const double z = random.normal(), y = random.normal(), x = random.normal();
      return Eigen::Vector3d(sigma * x, sigma * y, sigma * z);
    };
    series.acceleration.push_back(
        (s.specific_force_b() + noise(scenario.imu.accel_noise * std::sqrt(kGaitRate_hz))).norm());
    series.level.push_back((s.T_n_b.linear() * s.specific_force_b()).head<2>().norm());
    series.rotation.push_back((s.angular_velocity_b + noise(scenario.imu.gyro_noise * std::sqrt(kGaitRate_hz))).norm());
  }
  return series;
}

std::vector<double> power_spectrum(const std::vector<double>& signal, double rate_hz) {
  const size_t n = static_cast<size_t>(10 * rate_hz), bins = n / 2;
  std::vector<double> power(bins, 0.0);
  size_t windows = 0;
  for (size_t from = 0; from + n <= signal.size(); from += n / 2, ++windows) {
    double mean = 0;
    for (size_t i = 0; i < n; ++i) mean += signal[from + i] / static_cast<double>(n);
    for (size_t k = 0; k < bins; ++k) {
      std::complex<double> sum = 0;
      const std::complex<double> rotation = std::polar(1.0, -2 * kPi * static_cast<double>(k) / static_cast<double>(n));
      std::complex<double> phase = 1;
      for (size_t i = 0; i < n; ++i, phase *= rotation) {
        const double hann = 0.5 - 0.5 * std::cos(2 * kPi * static_cast<double>(i) / static_cast<double>(n));
        sum += hann * (signal[from + i] - mean) * phase;
      }
      power[k] += 2 * std::norm(sum) / (rate_hz * 0.375 * static_cast<double>(n));
    }
  }
  for (double& p : power) p /= static_cast<double>(std::max<size_t>(1, windows));
  return power;
}

GaitFigures gait_figures(const GaitSeries& s) {
  GaitFigures f{};
  f.spectrum = power_spectrum(s.acceleration, kGaitRate_hz);
  const auto bin = [](double hz) { return static_cast<size_t>(std::lround(10 * hz)); };
  const auto peak = std::max_element(f.spectrum.begin() + static_cast<long>(bin(1.2)),
                                     f.spectrum.begin() + static_cast<long>(bin(3.0)));
  const auto at = static_cast<size_t>(peak - f.spectrum.begin());
  f.frequency_hz = 0.1 * static_cast<double>(at);
  const auto power = [&](size_t from, size_t to) {
    double sum = 0;
    for (size_t k = from; k < std::min(to, f.spectrum.size()); ++k) sum += f.spectrum[k];
    return sum;
  };
  f.stride_part = power(at / 2 - 1, at / 2 + 2) / power(at - 1, at + 2);
  f.shock_part = power(bin(8), f.spectrum.size()) / power(bin(0.3), f.spectrum.size());
  const Statistics a = statistics_of(s.acceleration);
  std::vector<double> deviation;
  for (double x : s.acceleration) deviation.push_back(std::abs(x - a.mean));
  f.acceleration_std = a.std;
  f.acceleration_p95 = percentile(deviation, 0.95);
  f.rotation_rms = statistics_of(s.rotation).rmse;
  f.horizontal_rms = statistics_of(s.level).rmse;
  return f;
}

std::vector<std::pair<double, double>> spectra_percentile(const std::vector<std::vector<double>>& spectra,
                                                          double part) {
  std::vector<std::pair<double, double>> points;
  for (size_t k = 3; k < 240; ++k) {
    std::vector<double> values;
    for (const auto& spectrum : spectra) values.push_back(spectrum[k]);
    points.emplace_back(0.1 * static_cast<double>(k), std::log10(percentile(values, part) + 1e-9));
  }
  return points;
}

}  // namespace odograph
