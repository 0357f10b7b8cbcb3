// SPDX-License-Identifier: Apache-2.0
//
// Plugins with the same class name, built from this file: TWIN is 1 to 4. Linked into a program the class is in a
// separate namespace, as required for any two classes of a program.
#include <odograph/plugin.hpp>

#if defined(ODO_STATIC)
namespace {
#endif

struct Twin {
  double gain = TWIN;
  static constexpr const char* ids[] = {"twin/one", "twin/two", "twin/three", "twin/four"};
  static constexpr odo::Description description{ids[TWIN - 1], "1.0.0", "A twin.", ODO_INTERFACE_ATTITUDE};
  static std::vector<odo::Parameter<Twin>> parameters() {
    return {odo::real("gain", "", 0, 10, &Twin::gain, "Its number.")};
  }
  void on(const odo_imu& imu, odo::Output& output) {
    auto attitude = odo::make<odo_attitude>(imu.header.t_ns);
    attitude.gyro_bias_b[0] = gain;
    output.emit(attitude);
  }
};

#if defined(ODO_STATIC)
}  // namespace
#endif

ODO_PLUGIN(Twin)
