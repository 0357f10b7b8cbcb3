// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "plugins/shared/step_plugin.hpp"

namespace {

/// step = K (mean |a|)^(1/3) (Kim, Jang, Hwang & Park, Journal of Global Positioning Systems 3, 2004).
class Kim2004 : public odograph::StepPlugin<Kim2004> {
 public:
  double k = 0.55, relative_sigma = 0.10;

  static constexpr odo::Description description{
      "step/kim2004", "1.0.0", "Steps of length K (mean |a|)^(1/3) (Kim et al. 2004)", ODO_INTERFACE_STEP_ESTIMATOR};

  static std::vector<odo::Parameter<Kim2004>> parameters() {
    using P = Kim2004;
    return {odo::real("k", "", 0.05, 2, &P::k, "K, for the smoothed norm of the specific force; see the README"),
            odo::real("relative_sigma", "", 0.001, 1, &P::relative_sigma, "relative standard deviation of a length"),
            forward_axis_parameter()};
  }

  double length_m(const odograph::gait::Step& step) const {
    return k * std::cbrt(std::max(0.0, step.detected.mean_abs_mps2));
  }
  double sigma_m(double length) const { return relative_sigma * length; }
};

}  // namespace

ODO_PLUGIN(Kim2004)
