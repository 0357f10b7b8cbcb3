// SPDX-License-Identifier: Apache-2.0
//
// A complete plugin: scales each motion to a constant speed of the camera.
#include <cmath>

#include <odograph/plugin.hpp>

namespace {

struct ConstantSpeed {
  double speed = 1.3;

  static constexpr odo::Description description{"example/constant_speed", "1.0.0", "Scale from a known speed",
                                                ODO_INTERFACE_SCALE_SOURCE};

  static std::vector<odo::Parameter<ConstantSpeed>> parameters() {
    return {odo::real("speed", "m/s", 0.0, 50.0, &ConstantSpeed::speed, "speed of the camera")};
  }

  void on(const odo_vo_motion& motion, odo::Output& output) {
    const double* p = motion.p_c0_c1;
    const double units = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    if ((motion.header.flags & ODO_VO_TRANSLATION) == 0 || !(units > 1e-9 && units < 1e9)) return;  // NaN too
    auto scale = odo::make<odo_scale>(motion.header.t_ns);
    scale.scale = speed * 1e-9 * static_cast<double>(motion.header.t_ns - motion.t_from_ns) / units;
    scale.sigma = 0.2 * scale.scale;
    scale.valid_from_ns = motion.t_from_ns;
    scale.valid_to_ns = motion.header.t_ns;
    scale.scale_group = motion.scale_group;
    output.emit(scale);
  }
};

}  // namespace

ODO_PLUGIN(ConstantSpeed)
