// SPDX-License-Identifier: Apache-2.0
#include "plugins/shared/horizontal_scale.hpp"

#include "sdk/math/time.hpp"

namespace {

/// The comparison in Antigny et al. 2019, Table 5: one step length by body height and one walking speed whenever the
/// pedestrian walks, zero while standing.
class FixedStep {
 public:
  double walker_height = 1.70, length_by_height = 0.41, cadence = 1.8;

  static constexpr odo::Description description{"scale/fixed_step", "1.0.0",
                                                "Scale from one fixed walking speed (Antigny et al. 2019, Table 5)",
                                                ODO_INTERFACE_SCALE_SOURCE};
  static std::vector<odo::Parameter<FixedStep>> parameters() {
    using P = FixedStep;
    return {odo::real("walker_height", "m", 0.5, 2.5, &P::walker_height, "body height"),
            odo::real("length_by_height", "", 0.1, 1, &P::length_by_height,
                      "step length as a fraction of the body height (pedometers' rule of thumb)"),
            odo::real("cadence", "Hz", 0.5, 4, &P::cadence, "step frequency, typical for adults")};
  }

  void on(const odo_motion_mode& mode, odo::Output&) {
    known_ = true;
    walking_ = mode.mode != ODO_MODE_STATIC && mode.mode != ODO_MODE_UNKNOWN && mode.mode != ODO_MODE_HANDLING;
  }
  void on(const odo_vo_motion& motion, odo::Output& output) {
    if (!known_ || !odograph::scalable(motion)) return;
    const double dt = odograph::seconds(motion.header.t_ns - motion.t_from_ns);
    odograph::emit_scale(motion, walking_ ? walker_height * length_by_height * cadence * dt : 0.0, 0.15, output);
  }

 private:
  bool known_ = false;
  bool walking_ = false;
};

}  // namespace

ODO_PLUGIN(FixedStep)
