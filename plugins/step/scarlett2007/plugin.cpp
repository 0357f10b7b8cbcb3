// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "plugins/shared/step_plugin.hpp"

namespace {

/// step = K (mean |a| - a_min) / (a_max - a_min) (Scarlett, Analog Devices AN-900, 2007), a counted from a_min.
class Scarlett2007 : public odograph::StepPlugin<Scarlett2007> {
 public:
  double k = 1.62, relative_sigma = 0.10;

  static constexpr odo::Description description{"step/scarlett2007", "1.0.0",
                                                "Steps of length K (mean(a) - a_min) / (a_max - a_min) (Scarlett 2007)",
                                                ODO_INTERFACE_STEP_ESTIMATOR};

  static std::vector<odo::Parameter<Scarlett2007>> parameters() {
    using P = Scarlett2007;
    return {odo::real("k", "m", 0.05, 10, &P::k, "K; see the README for its source"),
            odo::real("relative_sigma", "", 0.001, 1, &P::relative_sigma, "relative standard deviation of a length"),
            forward_axis_parameter()};
  }

  double length_m(const odograph::gait::Step& step) const {
    // Relative to the smallest value, as in the note, so that gravity cancels.
    const double low = step.detected.peak_mps2 - step.detected.swing_mps2, swing = step.detected.swing_mps2;
    return swing > 0 ? k * std::max(0.0, step.detected.mean_mps2 - low) / swing : 0.0;
  }
  double sigma_m(double length) const { return relative_sigma * length; }
};

}  // namespace

ODO_PLUGIN(Scarlett2007)
