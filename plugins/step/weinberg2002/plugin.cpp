// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "plugins/shared/step_plugin.hpp"

namespace {

/// step = K (a_max - a_min)^(1/4) (Weinberg, Analog Devices AN-602, 2002).
class Weinberg2002 : public odograph::StepPlugin<Weinberg2002> {
 public:
  double k = 0.42, relative_sigma = 0.10;

  static constexpr odo::Description description{"step/weinberg2002", "1.0.0",
                                                "Steps of length K (a_max - a_min)^(1/4) (Weinberg 2002)",
                                                ODO_INTERFACE_STEP_ESTIMATOR};

  static std::vector<odo::Parameter<Weinberg2002>> parameters() {
    using P = Weinberg2002;
    return {odo::real("k", "", 0.05, 2, &P::k,
                      "K, for the smoothed norm of the specific force; see the README for its source"),
            odo::real("relative_sigma", "", 0.001, 1, &P::relative_sigma, "relative standard deviation of a length"),
            forward_axis_parameter()};
  }

  double length_m(const odograph::gait::Step& step) const {
    return k * std::pow(std::max(0.0, step.detected.swing_mps2), 0.25);
  }
  double sigma_m(double length) const { return relative_sigma * length; }
};

}  // namespace

ODO_PLUGIN(Weinberg2002)
