// SPDX-License-Identifier: Apache-2.0
// A well-behaved fixer that emits a fix for each pose.
#include <odograph/plugin.hpp>

struct FixOnPose {
  static constexpr odo::Description description{"test/fix_on_pose", "1.0.0", "For a test.",
                                                ODO_INTERFACE_ABSOLUTE_FIXER};
  static std::vector<odo::Parameter<FixOnPose>> parameters() { return {}; }
  void on(const odo_pose& pose, odo::Output& output) {
    auto fix = odo::make<odo_fix>(pose.header.t_ns);
    fix.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE;
    fix.header.quality = 0.25f;
    for (int k = 0; k < 3; ++k) fix.p_n[k] = pose.p_n[k], fix.covariance_n[4 * k] = 1;
    output.emit(fix);
  }
};

ODO_PLUGIN(FixOnPose)
