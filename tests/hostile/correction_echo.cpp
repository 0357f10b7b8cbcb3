// SPDX-License-Identifier: Apache-2.0
// A fixer that requests corrections: emits a fix 5 m beside the pose after some seconds, and each correction it
// receives as a fix that nobody may use.
#include <odograph/plugin.hpp>

struct CorrectionEcho {
  static constexpr odo::Description description{"test/correction_echo", "1.0.0", "For a test.",
                                                ODO_INTERFACE_ABSOLUTE_FIXER};
  static std::vector<odo::Parameter<CorrectionEcho>> parameters() { return {}; }
  static constexpr uint32_t extra_inputs[] = {ODO_TYPE_CORRECTION};
  static void emit(int64_t t_ns, const double* p_n, double beside_m, double integrity, odo::Output& output) {
    auto fix = odo::make<odo_fix>(t_ns);
    fix.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE | ODO_FIX_INTEGRITY;
    for (int k = 0; k < 3; ++k) fix.p_n[k] = p_n[k], fix.covariance_n[4 * k] = 1;
    fix.p_n[0] += beside_m, fix.integrity = integrity;
    output.emit(fix);
  }
  void on(const odo_correction& correction, odo::Output& output) {
    emit(correction.header.t_ns, correction.p_n, 0, 1, output);
  }
  void on(const odo_pose& pose, odo::Output& output) {
    if (++poses == 20) emit(pose.header.t_ns, pose.p_n, 5, 0.01, output);
  }
  int poses = 0;
};

ODO_PLUGIN(CorrectionEcho)
