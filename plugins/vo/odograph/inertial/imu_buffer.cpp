// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/inertial/imu_buffer.hpp"

#include <cmath>

#include <algorithm>

namespace odograph::vio {

void ImuBuffer::add(const ImuSample& sample) {
  if (!empty() && sample.t_ns <= newest_ns()) return;
  samples_.push(sample);
}

ImuSample ImuBuffer::between(const ImuSample& before, const ImuSample& after, int64_t t_ns) {
  if (t_ns == after.t_ns) return after;
  ImuSample result = before;
  result.t_ns = t_ns;
  if (after.t_ns == before.t_ns) return result;
  const double part = static_cast<double>(t_ns - before.t_ns) / static_cast<double>(after.t_ns - before.t_ns);
  result.gyro_b += part * (after.gyro_b - before.gyro_b);
  result.accel_b += part * (after.accel_b - before.accel_b);
  return result;
}

ImuSample ImuBuffer::at(int64_t t_ns) const {
  const size_t later = count_after(samples_, t_ns);
  return between(samples_.back(std::min(later, samples_.size() - 1)), samples_.back(later > 0 ? later - 1 : 0), t_ns);
}

ImuBuffer::Roughness ImuBuffer::roughness(int64_t until_ns, double reach_s) const {
  const auto from_ns = until_ns - static_cast<int64_t>(reach_s * 1e9);
  double gyro = 0, accel = 0, dt_s = 0;
  size_t n = 0;
  for (size_t k = 0; k + 2 < samples_.size(); ++k) {
    const ImuSample &a = samples_.back(k + 2), &b = samples_.back(k + 1), &c = samples_.back(k);
    if (c.t_ns > until_ns) continue;
    if (a.t_ns < from_ns) break;
    gyro += (a.gyro_b - 2 * b.gyro_b + c.gyro_b).squaredNorm();
    accel += (a.accel_b - 2 * b.accel_b + c.accel_b).squaredNorm();
    dt_s += 0.5e-9 * static_cast<double>(c.t_ns - a.t_ns);
    ++n;
  }
  if (n < 8) return {};
  // White noise of sigma on each axis has 6 sigma^2 in a second difference.
  const double by = dt_s / static_cast<double>(n) / (18 * static_cast<double>(n));
  return {std::sqrt(gyro * by), std::sqrt(accel * by), static_cast<double>(n) / dt_s};
}

}  // namespace odograph::vio
