// SPDX-License-Identifier: Apache-2.0
#include "plugins/attitude/magyq/magyq.hpp"
#include "plugins/shared/attitude_plugin.hpp"

namespace {

class MagyqPlugin {
 public:
  bool magnetometer = true;
  std::array<double, 3> forward_axis{0.0, 1.0, -1.0};

  static constexpr odo::Description description{
      "attitude/magyq", "1.0.0",
      "Orientation with bias estimation from quasi-static magnetic phases after Renaudin & Combettes 2014 (MAGYQ)",
      ODO_INTERFACE_ATTITUDE};

  static std::vector<odo::Parameter<MagyqPlugin>> parameters() {
    return {odo::boolean("magnetometer", &MagyqPlugin::magnetometer,
                         "use the magnetic field; without it the heading is relative to the start"),
            odo::reals("forward_axis", "", -1, 1, &MagyqPlugin::forward_axis,
                       "body axis that initially faces north without a magnetometer; the default suits a phone held "
                       "upright or flat")};
  }

  void configured() { source_ = {odograph::magyq::Filter({}), magnetometer, forward_axis}; }

  void on(const odo_imu& imu, odo::Output& output) { source_.on(imu, output); }
  void on(const odo_magnetometer& sample, odo::Output&) { source_.on(sample); }

 private:
  odograph::AttitudeSource<odograph::magyq::Filter> source_;
};

}  // namespace

ODO_PLUGIN(MagyqPlugin)
