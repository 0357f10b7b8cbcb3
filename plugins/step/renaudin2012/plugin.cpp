// SPDX-License-Identifier: Apache-2.0
#include "plugins/shared/step_plugin.hpp"

namespace {

/// step = h (a f + b) + c (Renaudin, Susi & Lachapelle 2012; Antigny et al. 2019, eq. (1)).
class Renaudin2012 : public odograph::StepPlugin<Renaudin2012> {
 public:
  double walker_height = 1.70, a = 0.1297, b = 0.1388, c = 0.0508, relative_sigma = 0.08;

  static constexpr odo::Description description{
      "step/renaudin2012", "1.0.0",
      "Steps of length h (a f + b) + c from step frequency and body height (Renaudin et al. 2012)",
      ODO_INTERFACE_STEP_ESTIMATOR};

  static std::vector<odo::Parameter<Renaudin2012>> parameters() {
    using P = Renaudin2012;
    return {odo::real("walker_height", "m", 0.5, 2.5, &P::walker_height, "body height h"),
            odo::real("a", "s", -1, 1, &P::a,
                      "slope over the step frequency; universal value, see the README for its source"),
            odo::real("b", "", -2, 2, &P::b, "part proportional to the height; universal value"),
            odo::real("c", "m", -2, 2, &P::c, "constant part; universal value"),
            odo::real("relative_sigma", "", 0.001, 1, &P::relative_sigma, "relative standard deviation of a length"),
            forward_axis_parameter()};
  }

  double length_m(const odograph::gait::Step& step) const {
    return std::max(0.0, walker_height * (a * step.frequency_hz + b) + c);
  }
  double sigma_m(double length) const { return relative_sigma * length; }
};

}  // namespace

ODO_PLUGIN(Renaudin2012)
