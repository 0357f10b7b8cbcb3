// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/inertial/imu_buffer.hpp"

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

}  // namespace odograph::vio
