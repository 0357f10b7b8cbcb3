// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/sample_gate.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sdk/host/base/saturating.hpp"
#include "sdk/host/messages/messages.hpp"

namespace odograph {
namespace {

double largest(const double* values) {
  return std::max({std::abs(values[0]), std::abs(values[1]), std::abs(values[2])});
}

std::string outside(const char* field, double value, const char* range, const char* hint) {
  char text[192];
  std::snprintf(text, sizeof text, "%s = %.6g; outside the range of any such sensor, %s%s", field, value, range, hint);
  return text;
}

/// The unit that a magnetic flux density may be in, by the Earth's 25 to 65 uT.
const char* field_hint(double field) {
  if (field > 1e4) return ": in nT? Multiply by 1e-9";
  if (field > 10) return ": in uT? Multiply by 1e-6";
  return field > 0.15 ? ": in gauss? Multiply by 1e-4" : ": in mT? Multiply by 1e-3";
}

double squared_distance(const double* a, const double* b) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

}  // namespace

std::string SampleGate::range_fault(const odo_header& sample) const {
  const Parameters& p = parameters_;
  switch (sample.type) {
    case ODO_TYPE_IMU: {
      const auto& m = as<odo_imu>(sample);
      const double rate = (m.header.flags & ODO_IMU_GYRO) ? largest(m.gyro_b) : 0;
      const double force = (m.header.flags & ODO_IMU_ACCEL) ? largest(m.accel_b) : 0;
      if (!(rate <= p.gyro_range_radps))
        return outside("gyro_b", rate, "40 rad/s", ": in degrees per second? Multiply by pi/180");
      if (force <= p.accel_range_mps2) return {};
      return outside("accel_b", force, "180 m/s^2", force > 500 ? ": in mg? Multiply by 0.00980665" : "");
    }
    case ODO_TYPE_MAGNETOMETER: {
      const double field = largest(as<odo_magnetometer>(sample).field_b);
      return field <= p.field_range_t ? std::string() : outside("field_b", field, "0.0056 T", field_hint(field));
    }
    case ODO_TYPE_BAROMETER: {
      const double pressure = as<odo_barometer>(sample).pressure_pa;
      if (pressure >= p.pressure_low_pa && pressure <= p.pressure_high_pa) return {};
      const bool hecto = pressure > 250 && pressure<1450, kilo = pressure> 25 && pressure < 145;
      return outside("pressure_pa", pressure, "25,000 to 145,000 Pa",
                     hecto  ? ": in hPa? Multiply by 100"
                     : kilo ? ": in kPa? Multiply by 1000"
                            : "");
    }
    default: return {};
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
