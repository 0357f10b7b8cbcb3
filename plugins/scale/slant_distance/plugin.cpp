// SPDX-License-Identifier: Apache-2.0
#include <odograph/plugin.hpp>

#include "plugins/scale/slant_distance/slant_scale.hpp"
#include "plugins/shared/horizontal_scale.hpp"

namespace {

/// Scale from slant distances to the roofs of a city model: Gakne & O'Keefe 2018, eq. (4) to (6).
class SlantDistance {
 public:
  std::string formula = "baseline";
  double window = 15, min_displacement = 8, scale_drift = 0.03, initial_scale = 0;

  static constexpr odo::Description description{"scale/slant_distance", "1.0.0",
                                                "Scale from slant distances to roofs (Gakne & O'Keefe 2018)",
                                                ODO_INTERFACE_SCALE_SOURCE};
  static std::vector<odo::Parameter<SlantDistance>> parameters() {
    return {odo::choice("formula", "baseline|gakne2018", &SlantDistance::formula,
                        "the line through fixes, or eq. (5) literally, which is not a scale"),
            odo::real("window", "s", 1, 3600, &SlantDistance::window, "time span of the fixes used"),
            odo::real("min_displacement", "m", 0.1, 1000, &SlantDistance::min_displacement,
                      "smallest extent of the fixes for a scale"),
            odo::real("scale_drift", "", 0, 1, &SlantDistance::scale_drift,
                      "relative change of the odometry's scale within a window"),
            odo::real("initial_scale", "m", 0, 1000, &SlantDistance::initial_scale,
                      "scale until slant distances give one; 0: none")};
  }
  void configured() { scale_ = odograph::slant_scale::SlantScale(window, min_displacement, scale_drift); }

  void on(const odo_fix& fix, odo::Output&) {
    constexpr uint32_t needed = ODO_FIX_SLANT | ODO_FIX_NORTH | ODO_FIX_EAST;
    if ((fix.header.flags & needed) != needed) return;
    const Eigen::Vector3d to_landmark = Eigen::Vector3d(fix.landmark_n) - Eigen::Vector3d(fix.p_n);
    if (!(fix.slant_distance_m > 0) || to_landmark.norm() < 1e-6) return;
    // P_3DBM: from the roof point back by the slant distance.
    const Eigen::Vector3d place = Eigen::Vector3d(fix.landmark_n) - fix.slant_distance_m * to_landmark.normalized();
    if (!(place.norm() < kMaxDisplacement))
      throw odo::Error(ODO_E_DISCARD, "landmark_n or slant_distance_m is out of range or not finite");
    literal_.add_position(place, fix.slant_distance_m);
    scale_.add_position(fix.header.t_ns, place.head<2>(),
                        std::max(1e-6, 0.5 * (fix.covariance_n[0] + fix.covariance_n[4])));
  }

  void on(const odo_vo_motion& motion, odo::Output& output) {
    if (!odograph::scalable(motion)) return;
    const Eigen::Vector3d d_n = odograph::displacement_n(motion);
    if (!(d_n.norm() < kMaxDisplacement))
      throw odo::Error(ODO_E_DISCARD, "p_c0_c1 is out of range for a motion between two frames");
    scale_.add_motion(motion.t_from_ns, motion.header.t_ns, d_n, motion.scale_group);
    literal_.add_motion(d_n, motion.scale_group);
    auto scale = odograph::scale_of(motion);
    if (formula == "gakne2018" && literal_.scale()) {
      scale.scale = *literal_.scale(), scale.sigma = kLiteralSigma * *literal_.scale();
    } else if (formula == "baseline" && scale_.scale()) {
      scale.scale = scale_.scale()->scale, scale.sigma = scale_.scale()->sigma;
    } else if (initial_scale > 0) {
      scale.scale = initial_scale, scale.sigma = 0.5 * initial_scale;
    } else {
      return;
    }
    scale.displacement_m = scale.scale * d_n.head<2>().norm();
    scale.header.flags |= ODO_SCALE_NOT_BY_STEPS;
    output.emit(scale);
  }

 private:
  /// Metres, or up to scale: larger than for any pedestrian or vehicle, and would stay in the sums forever.
  static constexpr double kMaxDisplacement = 1e9;
  static constexpr double kLiteralSigma = 0.5;  // relative; the paper gives none
  odograph::slant_scale::LiteralScale literal_;
  odograph::slant_scale::SlantScale scale_{window, min_displacement, scale_drift};
};

}  // namespace

ODO_PLUGIN(SlantDistance)
