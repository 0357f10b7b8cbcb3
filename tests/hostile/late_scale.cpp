// SPDX-License-Identifier: Apache-2.0
// A scale source that answers each motion with a scale for the previous one, and every third time with a valid one.
#include <odograph/plugin.hpp>

struct LateScale {
  static constexpr odo::Description description{"test/late_scale", "1.0.0", "For a test.", ODO_INTERFACE_SCALE_SOURCE};
  static std::vector<odo::Parameter<LateScale>> parameters() { return {}; }
  void on(const odo_vo_motion& motion, odo::Output& output) {
    auto scale = odo::make<odo_scale>(motion.header.t_ns);
    scale.scale = 1, scale.sigma = 0.1;
    scale.scale_group = motion.scale_group;
    scale.valid_to_ns = ++motions % 3 == 0 ? motion.header.t_ns : motion.t_from_ns;
    scale.valid_from_ns = scale.valid_to_ns - 1;
    output.emit(scale);
  }
  uint32_t motions = 0;
};

ODO_PLUGIN(LateScale)
