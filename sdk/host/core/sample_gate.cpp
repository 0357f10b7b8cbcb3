// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/sample_gate.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/host/base/saturating.hpp"
#include "sdk/host/messages/messages.hpp"

namespace odograph {
namespace {

bool within(const double* values, double range) {
  return std::all_of(values, values + 3, [range](double x) { return std::abs(x) <= range; });
}

double squared_distance(const double* a, const double* b) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

}  // namespace

bool SampleGate::within_range(const odo_header& sample) const {
  const Parameters& p = parameters_;
  switch (sample.type) {
    case ODO_TYPE_IMU: {
      const auto& m = as<odo_imu>(sample);
      return ((m.header.flags & ODO_IMU_GYRO) == 0 || within(m.gyro_b, p.gyro_range_radps)) &&
             ((m.header.flags & ODO_IMU_ACCEL) == 0 || within(m.accel_b, p.accel_range_mps2));
    }
    case ODO_TYPE_MAGNETOMETER: return within(as<odo_magnetometer>(sample).field_b, p.field_range_t);
    case ODO_TYPE_BAROMETER: {
      const double pressure = as<odo_barometer>(sample).pressure_pa;
      return pressure >= p.pressure_low_pa && pressure <= p.pressure_high_pa;
    }
    default: return true;
  }
}

bool SampleGate::differs(const odo_imu& a, const odo_imu& b) const {
  const int64_t apart_ns = saturating_difference(b.header.t_ns, a.header.t_ns);
  if (apart_ns <= -parameters_.neighbour_ns || apart_ns >= parameters_.neighbour_ns) return false;
  const auto far = [](const double* x, const double* y, double limit) {
    return squared_distance(x, y) > limit * limit;
  };
  const uint32_t flags = a.header.flags & b.header.flags;
  return ((flags & ODO_IMU_GYRO) && far(a.gyro_b, b.gyro_b, parameters_.gyro_spike_radps)) ||
         ((flags & ODO_IMU_ACCEL) && far(a.accel_b, b.accel_b, parameters_.accel_spike_mps2));
}

}  // namespace odograph
