// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "plugins/shared/step_plugin.hpp"

namespace {

/// step = K h sqrt(f) (Tian, Salcic, Wang & Pan, IEEE Sensors Journal 16, 2016).
class Tian2016 : public odograph::StepPlugin<Tian2016> {
 public:
  double walker_height = 1.70, k = 0.2975, relative_sigma = 0.10;

  static constexpr odo::Description description{
      "step/tian2016", "1.0.0", "Steps of length K h sqrt(f) from step frequency and body height (Tian et al. 2016)",
      ODO_INTERFACE_STEP_ESTIMATOR};

  static std::vector<odo::Parameter<Tian2016>> parameters() {
    using P = Tian2016;
    return {odo::real("walker_height", "m", 0.5, 2.5, &P::walker_height, "body height h"),
            odo::real("k", "s^(1/2)", 0.05, 2, &P::k, "K, for both sexes; see the README"),
            odo::real("relative_sigma", "", 0.001, 1, &P::relative_sigma, "relative standard deviation of a length"),
            forward_axis_parameter()};
  }

  double length_m(const odograph::gait::Step& step) const {
    return k * walker_height * std::sqrt(std::max(0.0, step.frequency_hz));
  }
  double sigma_m(double length) const { return relative_sigma * length; }
};

}  // namespace

ODO_PLUGIN(Tian2016)
