// SPDX-License-Identifier: Apache-2.0
// A step estimator that always fails.
#include <odograph/plugin.hpp>

struct FailingSteps {
  static constexpr odo::Description description{"test/failing_steps", "1.0.0", "For a test.",
                                                ODO_INTERFACE_STEP_ESTIMATOR};
  static std::vector<odo::Parameter<FailingSteps>> parameters() { return {}; }
  template <class Message>
  void on(const Message&, odo::Output&) {
    throw odo::Error(ODO_E_ERROR, "as always");
  }
};

ODO_PLUGIN(FailingSteps)
