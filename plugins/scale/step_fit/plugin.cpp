// SPDX-License-Identifier: Apache-2.0
#include "plugins/scale/step_fit/step_fit.hpp"
#include "plugins/shared/horizontal_scale.hpp"

namespace {

/// One scale for a whole scale group, from all its steps.
class StepFitPlugin {
 public:
  double drift = 0.004, common = 0.06;

  static constexpr odo::Description description{
      "scale/step_fit", "1.0.0", "Scale from all steps of a scale group, for odometries with a steady scale",
      ODO_INTERFACE_SCALE_SOURCE};
  static std::vector<odo::Parameter<StepFitPlugin>> parameters() {
    return {
        odo::real("drift", "", 0, 1, &StepFitPlugin::drift, "relative drift of the scale from one step to the next"),
        odo::real("common", "", 0, 1, &StepFitPlugin::common, "relative error common to all steps")};
  }
  void configured() { fit_ = odograph::step_fit::StepFit(drift, common); }

  void on(const odo_step& step, odo::Output&) {
    fit_.add_step(step.t_start_ns, step.t_end_ns, step.length_m, step.sigma_m);
  }

  void on(const odo_vo_motion& motion, odo::Output& output) {
    if (!odograph::scalable(motion)) return;
    const Eigen::Quaterniond q_n_c0(motion.q_n_c0[0], motion.q_n_c0[1], motion.q_n_c0[2], motion.q_n_c0[3]);
    const Eigen::Vector3d d_n = q_n_c0 * Eigen::Vector3d(motion.p_c0_c1);
    fit_.add_motion(motion.t_from_ns, motion.header.t_ns, d_n.head<2>(), motion.scale_group);
    const auto found = fit_.scale();
    if (!found) return;
    auto scale = odo::make<odo_scale>(motion.header.t_ns);
    scale.scale = found->scale;
    scale.sigma = found->scale * found->relative_sigma;
    scale.displacement_m = found->scale * d_n.head<2>().norm();
    scale.valid_from_ns = motion.t_from_ns, scale.valid_to_ns = motion.header.t_ns;
    scale.scale_group = motion.scale_group;
    scale.header.flags = ODO_SCALE_HORIZONTAL | ODO_SCALE_STEADY;
    output.emit(scale);
  }

 private:
  odograph::step_fit::StepFit fit_{drift, common};
};

}  // namespace

ODO_PLUGIN(StepFitPlugin)
