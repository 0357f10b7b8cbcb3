// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <odograph/plugin.hpp>

#include "plugins/scale/slant_distance/literal_scale.hpp"
#include "plugins/scale/slant_distance/roof_points.hpp"
#include "plugins/scale/slant_distance/slant_scale.hpp"
#include "plugins/shared/horizontal_scale.hpp"
#include "sdk/math/rotation.hpp"

namespace {

using namespace odograph::slant_scale;
using Eigen::Vector3d;

/// Scale from a city model: Gakne & O'Keefe 2018, eq. (4) to (6), in one of three forms (docs/slant_distance.md).
class SlantDistance {
 public:
  std::string formula = "baseline";
  double window = 15, min_displacement = 8, scale_drift = 0.03, initial_scale = 0;

  static constexpr odo::Description description{"scale/slant_distance", "1.0.0",
                                                "Scale from slant distances to roofs (Gakne & O'Keefe 2018)",
                                                ODO_INTERFACE_SCALE_SOURCE};
  static std::vector<odo::Parameter<SlantDistance>> parameters() {
    return {
        odo::choice("formula", "baseline|gakne2018|points", &SlantDistance::formula,
                    "the line through fixes; eq. (5) literally, which is not a scale; the slant distance over the "
                    "front-end's distance to the same roof"),
        odo::real("window", "s", 1, 3600, &SlantDistance::window, "time span of the fixes used"),
        odo::real("min_displacement", "m", 0.1, 1000, &SlantDistance::min_displacement,
                  "extent of the fixes from which on the line replaces a first scale"),
        odo::real("scale_drift", "", 0, 1, &SlantDistance::scale_drift,
                  "relative change of the odometry's scale within a window"),
        odo::real("initial_scale", "m", 0, 1000, &SlantDistance::initial_scale, "scale until fixes give one; 0: none")};
  }
  void configured() {
    baseline_ = SlantScale(window, min_displacement, scale_drift);
    points_ = RoofPoints(window, scale_drift);
  }

  void on(const odo_calibration& c, odo::Output&) {
    mounts_.erase(c.header.source);
    if (c.header.flags & ODO_CALIBRATION_EXTRINSICS) mounts_[c.header.source] = odograph::raw_quaternion(c.q_b_c);
  }

  /// The first pose: the start, moved by the motions so far.
  void on(const odo_pose& pose, odo::Output&) {
    constexpr uint32_t needed = ODO_POSE_POSITION | ODO_POSE_COVARIANCE;
    if (started_ || (pose.header.flags & ODO_POSE_EXTRAPOLATED) || (pose.header.flags & needed) != needed) return;
    started_ = true;
    const Vector3d start_n = Vector3d(pose.p_n) - moved_n_;
    if (!(start_n.norm() < kMaxDisplacement)) return;
    literal_.start_at(start_n);
    const double variance = std::max(kStartSigma_m * kStartSigma_m, 0.5 * (pose.covariance[21] + pose.covariance[28]));
    if (variance < kMaxStartSigma_m * kMaxStartSigma_m) baseline_.start_at(start_n.head<2>(), variance);
  }

  void on(const odo_points& points, odo::Output&) {
    if (points.header.flags & ODO_POINTS_METRIC) return;
    camera_ = points.camera;
    std::vector<LandmarkPoint> landmarks;
    for (const odo_point& point : odo::Points(points))
      if ((point.flags & (ODO_POINT_LOST | ODO_POINT_UNCERTAIN)) == 0) landmarks.push_back(landmark(point));
    points_.add_points(points.header.t_ns, points.scale_group, std::move(landmarks));
  }

  void on(const odo_fix& fix, odo::Output&) {
    constexpr uint32_t needed = ODO_FIX_SLANT | ODO_FIX_NORTH | ODO_FIX_EAST;
    if ((fix.header.flags & needed) != needed) return;
    const Vector3d place_n(fix.p_n), landmark_n(fix.landmark_n);
    if (!(fix.slant_distance_m > 0) || (landmark_n - place_n).norm() < 1e-6) return;
    if (!(place_n.norm() < kMaxDisplacement && landmark_n.norm() < kMaxDisplacement &&
          fix.slant_distance_m < kMaxDisplacement))
      throw odo::Error(ODO_E_DISCARD, "p_n, landmark_n or slant_distance_m is out of range or not finite");
    literal_.add_position(fix.header.t_ns, place_n, fix.slant_distance_m);
    baseline_.add_position(fix.header.t_ns, place_n.head<2>(),
                           std::max(1e-6, 0.5 * (fix.covariance_n[0] + fix.covariance_n[4])));
    RoofPoints::RoofPoint roof{fix.slant_distance_m * (landmark_n - place_n).normalized(), fix.slant_sigma_m};
    if (const auto mount = mounts_.find(camera_); mount != mounts_.end() && (fix.header.flags & ODO_FIX_ORIENTATION))
      roof.q_n_c = (odograph::raw_quaternion(fix.q_n_b) * mount->second).normalized();
    points_.add_fix(fix.header.t_ns, roof);
  }

  void on(const odo_vo_motion& motion, odo::Output& output) {
    if (!odograph::scalable(motion)) return;
    const Vector3d d_n = odograph::displacement_n(motion);
    if (!(d_n.norm() < kMaxDisplacement))
      throw odo::Error(ODO_E_DISCARD, "p_c0_c1 is out of range for a motion between two frames");
    baseline_.add_motion(motion.t_from_ns, motion.header.t_ns, d_n, motion.scale_group);
    literal_.add_motion(motion.t_from_ns, motion.header.t_ns, d_n, motion.scale_group);
    points_.add_orientation(
        motion.header.t_ns,
        (odograph::raw_quaternion(motion.q_n_c0) * odograph::raw_quaternion(motion.q_c0_c1)).normalized(),
        motion.scale_group);
    const auto found = scale_at(motion.header.t_ns);
    if (!found) return;
    auto scale = odograph::scale_of(motion);
    scale.scale = found->scale, scale.sigma = found->sigma;
    scale.displacement_m = scale.scale * d_n.head<2>().norm();
    scale.header.flags |= ODO_SCALE_NOT_BY_STEPS;
    if (!started_) moved_n_.head<2>() += scale.scale * d_n.head<2>();
    output.emit(scale);
  }

 private:
  static LandmarkPoint landmark(const odo_point& point) {
    const Eigen::Vector3f p(point.p_c), u = p.normalized();
    const float* c = point.covariance;
    Eigen::Matrix3f covariance;
    covariance << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
    return {p, std::sqrt(std::max(0.0f, u.dot(covariance * u)))};
  }

  /// By the formula; where it has none yet, the most certain of the other sources.
  std::optional<Scale> scale_at(int64_t t_ns) const {
    const auto initial =
        initial_scale > 0 ? std::optional(Scale{initial_scale, kInitialSigma * initial_scale}) : std::nullopt;
    if (formula == "gakne2018") {
      if (literal_.corrected() || !initial)
        return Scale{literal_.scale(), (literal_.corrected() ? kLiteralSigma : kUnknownSigma) * literal_.scale()};
      return initial;
    }
    const auto by_points = points_.scale_at(t_ns);
    if (formula == "points" && by_points) return by_points;
    const auto by_fixes = baseline_.scale();
    if (baseline_.known()) return by_fixes;
    const auto relative = [](const Scale& s) { return s.sigma / s.scale; };
    std::optional<Scale> best;
    for (const auto& scale : {by_fixes, by_points, initial})
      if (scale && (!best || relative(*scale) < relative(*best))) best = scale;
    return best;
  }

  /// Metres, or up to scale: larger than for any pedestrian or vehicle, and would stay in the sums forever.
  static constexpr double kMaxDisplacement = 1e9;
  static constexpr double kLiteralSigma = 0.5, kInitialSigma = 0.5;  // relative; the paper gives none
  static constexpr double kUnknownSigma = 1;                         // of Algorithm 1's s = 1
  static constexpr double kStartSigma_m = 1;                         // a start in a config is a place on a map
  static constexpr double kMaxStartSigma_m = 10;  // beyond it, a start says nothing about the first displacements
  LiteralScale literal_;
  SlantScale baseline_{window, min_displacement, scale_drift};
  RoofPoints points_{window, scale_drift};
  std::map<uint32_t, Eigen::Quaterniond> mounts_;
  uint32_t camera_ = 0;
  Vector3d moved_n_ = Vector3d::Zero();  // by the scales emitted before the first pose
  bool started_ = false;
};

}  // namespace

ODO_PLUGIN(SlantDistance)
