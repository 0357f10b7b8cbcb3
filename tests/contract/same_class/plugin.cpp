// SPDX-License-Identifier: Apache-2.0
//
// Built several times: plugins with different ids and the same class name.
#include <odograph/plugin.hpp>

#if defined(ODO_STATIC)
namespace {
#endif

struct SameName {
  double gain = SAME_GAIN;
  static constexpr odo::Description description{SAME_ID, "1.0.0", "One of several.", ODO_INTERFACE_ATTITUDE};
  static std::vector<odo::Parameter<SameName>> parameters() {
    return {odo::real("gain", "", 0, 10, &SameName::gain, "Differs.")};
  }
  void on(const odo_imu&, odo::Output& output) {
    static int calls = 0;
    output.report(ODO_SEVERITY_INFO, "same", std::string(SAME_ID) + " " + std::to_string(++calls));
  }
};

#if defined(ODO_STATIC)
}  // namespace
#endif

ODO_PLUGIN(SameName)
