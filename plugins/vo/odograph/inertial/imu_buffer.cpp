// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/inertial/imu_buffer.hpp"

namespace odograph::vio {

void ImuBuffer::add(const ImuSample& sample) {
  if (!empty() && sample.t_ns <= newest_ns()) return;
  samples_.push(sample);
}

size_t ImuBuffer::first_after(int64_t t_ns) const {
  size_t low = 0, high = samples_.size();  // samples [0, low) are later
  while (low < high) {
    const size_t middle = (low + high) / 2;
    if (samples_.back(middle).t_ns > t_ns)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

ImuSample ImuBuffer::at(int64_t t_ns) const {
  const size_t later = first_after(t_ns);
  ImuSample result = later == 0                 ? samples_.back(0)
                     : later == samples_.size() ? samples_.back(samples_.size() - 1)
                                                : samples_.back(later);
  if (later > 0 && later < samples_.size()) {
    const ImuSample &a = samples_.back(later), &b = samples_.back(later - 1);
    const double part = static_cast<double>(t_ns - a.t_ns) / static_cast<double>(b.t_ns - a.t_ns);
    result.gyro_b = a.gyro_b + part * (b.gyro_b - a.gyro_b);
    result.accel_b = a.accel_b + part * (b.accel_b - a.accel_b);
  }
  result.t_ns = t_ns;
  return result;
}

}  // namespace odograph::vio
