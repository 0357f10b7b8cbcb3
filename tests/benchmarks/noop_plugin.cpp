// SPDX-License-Identifier: Apache-2.0
//
// Does almost nothing, so that the benchmark measures the passage through the ABI.
#include <odograph/plugin.hpp>

struct Noop {
  double sum = 0;
  static constexpr odo::Description description{"bench/noop", "1.0.0", "Adds one number.", ODO_INTERFACE_ATTITUDE};
  static std::vector<odo::Parameter<Noop>> parameters() { return {}; }
  void on(const odo_imu& imu, odo::Output&) { sum += imu.gyro_b[0]; }
};

ODO_PLUGIN(Noop)
