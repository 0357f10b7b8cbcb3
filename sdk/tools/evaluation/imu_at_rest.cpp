// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/evaluation/imu_at_rest.hpp"

#include <cmath>

#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/simulation/sensors.hpp"

namespace odograph {

std::vector<AllanPoint> imu_at_rest(const Scenario::Imu& imu, bool gyroscope, double hours, uint64_t seed) {
  const auto errors =
      gyroscope
          ? SimTriad::Errors{imu.gyro_bias, imu.gyro_walk, imu.gyro_noise, 0, 0, imu.gyro_range, imu.gyro_step}
          : SimTriad::Errors{imu.accel_bias, imu.accel_walk, imu.accel_noise, 0, 0, imu.accel_range, imu.accel_step};
  SimTriad triad(Random(seed, 2), errors, imu.rate_hz);
  std::vector<double> axis[3];
  for (auto n = static_cast<size_t>(hours * 3600 * imu.rate_hz); n > 0; --n) {
    const Eigen::Vector3d m = triad.measure(Eigen::Vector3d::Zero());
    for (int k = 0; k < 3; ++k) axis[k].push_back(m[k]);
  }
  std::vector<AllanPoint> points;
  for (double tau_s = 0.02; tau_s < hours * 3600 / 20; tau_s *= std::sqrt(10)) {
    double mean = 0;
    for (const auto& x : axis) mean += allan_deviation(x, imu.rate_hz, tau_s) / 3;
    points.push_back({tau_s, mean, errors.allan_deviation(imu.rate_hz, tau_s)});
  }
  return points;
}

}  // namespace odograph
