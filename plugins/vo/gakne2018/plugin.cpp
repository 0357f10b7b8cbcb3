// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "plugins/shared/camera/frame_view.hpp"
#include "plugins/shared/camera/points_event.hpp"
#include "plugins/vo/gakne2018/sky_odometry.hpp"
#include "sdk/math/rotation.hpp"

namespace {

using namespace odograph::gakne2018;

/// The visual odometry of Gakne & O'Keefe 2018, for a camera that looks up. The attitude aligns the pictures with
/// gravity and, with `rotation: attitude`, gives the rotation; without one the camera is assumed to look straight up.
class Gakne2018 {
 public:
  int64_t features = 1000;
  double inlier_threshold = 2.5;
  std::string rotation = "attitude";

  static constexpr odo::Description description{
      "vo/gakne2018", "1.0.0",
      "Visual odometry of a sky-pointing camera: ORB, RANSAC, rigid motion (Gakne & O'Keefe 2018)",
      ODO_INTERFACE_VO_FRONTEND};
  static constexpr uint32_t extra_outputs[] = {ODO_TYPE_POINTS};
  static std::vector<odo::Parameter<Gakne2018>> parameters() {
    return {odo::integer("features", 100, 10000, &Gakne2018::features, "maximum ORB features per picture"),
            odo::real("inlier_threshold", "px", 0.1, 50, &Gakne2018::inlier_threshold,
                      "largest distance of an inlier, near the zenith"),
            odo::choice("rotation", "attitude|vision", &Gakne2018::rotation,
                        "the attitude's, which is then needed, or that of eq. (1); the attitude aligns with gravity "
                        "either way")};
  }

  void on(const odo_calibration& c, odo::Output&) {
    q_b_c_ = odograph::rear_camera_mount();
    if (c.header.flags & ODO_CALIBRATION_EXTRINSICS) q_b_c_ = odograph::raw_quaternion(c.q_b_c);
    if (!camera_.take(c)) return;  // the lens comes with each frame
    p_.features = static_cast<int>(features);
    const auto camera = odograph::camera_of(c);
    p_.inlier_rad = inlier_threshold / camera.focal();
    vo_.emplace(p_, camera);
    previous_ns_ = INT64_MIN;
  }

  void on(const odo_attitude& attitude, odo::Output&) { q_n_b_ = odograph::raw_quaternion(attitude.q_n_b); }

  void on(const odo_frame& frame, odo::Output& output) {
    const odograph::CameraModel lens = camera_.lens_of(frame);
    if (frame.header.t_ns <= previous_ns_)
      throw odo::Error(ODO_E_DISCARD, "t_ns is not after that of the frame before");
    vo_->change_lens(lens);
    const Motion motion = vo_->process(odograph::grey_of(frame, converted_), odograph::mask_of(frame), on_plane(),
                                       turned_by_attitude() ? p_.known_rotation_rad : p_.unknown_rotation_rad);
    const int64_t from_ns = std::exchange(previous_ns_, frame.header.t_ns);
    if (from_ns == INT64_MIN) return;
    auto event = odograph::motion_event(frame, from_ns, motion.valid, motion.valid, motion.matches, motion.inliers);
    odograph::put_motion(motion.q_c0_c1, motion.p_c0_c1, motion.rotation_sigma_rad, motion.position_sigma, event);
    odograph::put_state(motion.valid ? odograph::Tracking::tracking : odograph::Tracking::lost,
                        motion.valid ? odograph::FailureReason::none : odograph::FailureReason::few_features, event);
    emit_points(frame, event.scale_group, output);
    output.emit(event);
  }

 private:
  bool turned_by_attitude() const { return q_n_b_ && rotation == "attitude"; }
  /// Rotation from c to a gravity-aligned frame: n if the attitude gives the heading too.
  Eigen::Quaterniond on_plane() const {
    if (!q_n_b_) return {0, 1, 0, 0};
    const Eigen::Quaterniond q_n_c = (*q_n_b_ * q_b_c_).normalized();
    return turned_by_attitude() ? q_n_c : levelled(q_n_c.conjugate() * -Eigen::Vector3d::UnitZ());
  }

  void emit_points(const odo_frame& frame, uint32_t scale_group, odo::Output& output) {
    if (!takes_points_) return;
    points_.begin(frame.header.t_ns, frame.header.source, scale_group, false);
    for (const SkyPoint& point : vo_->points()) points_.add(odograph::element_of(tracked(point)));
    takes_points_ = output.emit(points_);  // a host of 1.0 does not
  }

  static odograph::TrackedPoint tracked(const SkyPoint& point) {
    odograph::TrackedPoint out;
    out.id = point.id, out.age = point.age, out.used = true;
    out.p_c = point.p_c, out.pixel = {point.pixel.x, point.pixel.y};
    const Eigen::Vector3d u = point.p_c.normalized();
    const double across = std::pow(point.ray_sigma_rad, 2), along = std::pow(point.relative_sigma, 2);
    out.covariance =
        point.p_c.squaredNorm() * (across * Eigen::Matrix3d::Identity() + (along - across) * u * u.transpose());
    return out;
  }

  SkyOdometry::Parameters p_;
  std::optional<SkyOdometry> vo_;
  std::optional<Eigen::Quaterniond> q_n_b_;
  Eigen::Quaterniond q_b_c_ = Eigen::Quaterniond::Identity();
  cv::Mat converted_;
  odograph::CalibratedCamera camera_;
  int64_t previous_ns_ = INT64_MIN;
  odo::PointsWriter points_;
  bool takes_points_ = true;
};

}  // namespace

ODO_PLUGIN(Gakne2018)
