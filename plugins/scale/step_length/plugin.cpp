// SPDX-License-Identifier: Apache-2.0
#include "plugins/scale/step_length/step_scale.hpp"
#include "plugins/shared/horizontal_scale.hpp"

namespace {

/// Scale of each frame's displacement from pedestrian step lengths: Antigny et al. 2019, eq. (5) to (7).
class StepLength {
 public:
  double hold = 1.6;

  static constexpr odo::Description description{"scale/step_length", "1.0.0",
                                                "Scale from step lengths (Antigny et al. 2019, eq. (5)-(7))",
                                                ODO_INTERFACE_SCALE_SOURCE};
  static std::vector<odo::Parameter<StepLength>> parameters() {
    return {odo::real(
        "hold", "", 1, 5, &StepLength::hold,
        "number of step durations without a new step after which the walker stands; covers the detection delay")};
  }
  void configured() { steps_ = odograph::step_scale::StepInterpolation(hold); }

  void on(const odo_step& step, odo::Output&) {
    steps_.add_step(step.t_start_ns, step.t_end_ns, step.length_m, step.sigma_m);
  }
  void on(const odo_motion_mode& mode, odo::Output&) {
    if (mode.mode == ODO_MODE_STATIC) steps_.stand(mode.header.t_ns);
  }
  void on(const odo_vo_motion& motion, odo::Output& output) {
    if (!odograph::scalable(motion)) return;
    if (const auto d = steps_.between(motion.t_from_ns, motion.header.t_ns))
      odograph::emit_scale(motion, d->metres, d->relative_sigma, output);
  }

 private:
  odograph::step_scale::StepInterpolation steps_{hold};
};

}  // namespace

ODO_PLUGIN(StepLength)
