// SPDX-License-Identifier: Apache-2.0
// A well-behaved step estimator that emits a step for each fix.
#include <odograph/plugin.hpp>

struct StepOnFix {
  static constexpr odo::Description description{"test/step_on_fix", "1.0.0", "For a test.",
                                                ODO_INTERFACE_STEP_ESTIMATOR};
  static std::vector<odo::Parameter<StepOnFix>> parameters() { return {}; }
  void on(const odo_fix& fix, odo::Output& output) {
    auto step = odo::make<odo_step>(fix.header.t_ns + 1);
    step.t_end_ns = step.header.t_ns, step.t_start_ns = step.t_end_ns - 500000000;
    step.header.flags = ODO_STEP_HEADING;
    step.length_m = 0.7, step.sigma_m = 0.1, step.frequency_hz = 2;
    output.emit(step);
  }
};

ODO_PLUGIN(StepOnFix)
