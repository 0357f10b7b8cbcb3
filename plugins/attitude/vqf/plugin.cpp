// SPDX-License-Identifier: Apache-2.0
#include "plugins/attitude/vqf/vqf.hpp"
#include "plugins/shared/attitude_plugin.hpp"

namespace {

class VqfPlugin {
 public:
  double tau_acc = 3.0, tau_mag = 9.0;
  bool magnetometer = false;
  std::array<double, 3> forward_axis{0.0, 1.0, -1.0};

  static constexpr odo::Description description{"attitude/vqf", "1.0.0",
                                                "Orientation with bias estimation after Laidig & Seel 2023 (VQF)",
                                                ODO_INTERFACE_ATTITUDE};

  static std::vector<odo::Parameter<VqfPlugin>> parameters() {
    return {odo::real("tau_acc", "s", 0.1, 60, &VqfPlugin::tau_acc,
                      "time constant of the inclination correction (Laidig & Seel 2023)"),
            odo::real("tau_mag", "s", 0.1, 600, &VqfPlugin::tau_mag,
                      "time constant of the heading correction (Laidig & Seel 2023)"),
            odo::boolean("magnetometer", &VqfPlugin::magnetometer, "refer the heading to magnetic north"),
            odo::reals("forward_axis", "", -1, 1, &VqfPlugin::forward_axis,
                       "body axis that initially faces north; the default suits a phone held upright or flat")};
  }

  void configured() {
    odograph::vqf::Parameters p;
    p.tau_acc_s = tau_acc;
    p.tau_mag_s = tau_mag;
    source_ = {odograph::vqf::Filter(p), magnetometer, forward_axis};
  }

  void on(const odo_imu& imu, odo::Output& output) { source_.on(imu, output); }
  void on(const odo_magnetometer& sample, odo::Output&) { source_.on(sample); }

 private:
  odograph::AttitudeSource<odograph::vqf::Filter> source_;
};

}  // namespace

ODO_PLUGIN(VqfPlugin)
