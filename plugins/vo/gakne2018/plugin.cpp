// SPDX-License-Identifier: Apache-2.0
#include <optional>

#include "plugins/shared/camera/frame_view.hpp"
#include "plugins/vo/gakne2018/sky_odometry.hpp"
#include "sdk/math/rotation.hpp"

namespace {

using namespace odograph::gakne2018;

/// The visual odometry of Gakne & O'Keefe 2018, for a camera that looks up. The attitude replaces their vanishing
/// points as the source of roll, pitch and heading; without an attitude the camera is assumed to look straight up.
class Gakne2018 {
 public:
  int64_t features = 1000;
  double inlier_threshold = 2.5;

  static constexpr odo::Description description{
      "vo/gakne2018", "1.0.0",
      "Visual odometry of a sky-pointing camera: ORB, RANSAC, rigid motion (Gakne & O'Keefe 2018)",
      ODO_INTERFACE_VO_FRONTEND};
  static std::vector<odo::Parameter<Gakne2018>> parameters() {
    return {odo::integer("features", 100, 10000, &Gakne2018::features, "maximum ORB features per picture"),
            odo::real("inlier_threshold", "px", 0.1, 50, &Gakne2018::inlier_threshold,
                      "largest distance of an inlier, near the zenith")};
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
                                       q_n_b_ ? p_.known_rotation_rad : p_.unknown_rotation_rad);
    const int64_t from_ns = std::exchange(previous_ns_, frame.header.t_ns);
    if (from_ns == INT64_MIN) return;
    auto event = odograph::motion_event(frame, from_ns, motion.valid, motion.valid, motion.matches, motion.inliers);
    odograph::put_motion(motion.q_c0_c1, motion.p_c0_c1, motion.rotation_sigma_rad, motion.position_sigma, event);
    odograph::put_state(motion.valid ? odograph::Tracking::tracking : odograph::Tracking::lost,
                        motion.valid ? odograph::FailureReason::none : odograph::FailureReason::few_features, event);
    output.emit(event);
  }

 private:
  /// Rotation from c to a gravity-aligned frame: n if there is an attitude, else the axes of the camera turned over.
  Eigen::Quaterniond on_plane() const {
    return q_n_b_ ? (*q_n_b_ * q_b_c_).normalized() : Eigen::Quaterniond(0, 1, 0, 0);
  }

  SkyOdometry::Parameters p_;
  std::optional<SkyOdometry> vo_;
  std::optional<Eigen::Quaterniond> q_n_b_;
  Eigen::Quaterniond q_b_c_ = Eigen::Quaterniond::Identity();
  cv::Mat converted_;
  odograph::CalibratedCamera camera_;
  int64_t previous_ns_ = INT64_MIN;
};

}  // namespace

ODO_PLUGIN(Gakne2018)
