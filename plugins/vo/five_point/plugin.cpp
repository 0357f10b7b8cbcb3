// SPDX-License-Identifier: Apache-2.0
#include <optional>

#include "plugins/camera/frame_view.hpp"
#include "plugins/vo/five_point/visual_odometry.hpp"

namespace {

using namespace odograph::five_point;

uint32_t reason(Trouble trouble) {
  switch (trouble) {
    case Trouble::none: return ODO_REASON_NONE;
    case Trouble::too_dark: return ODO_REASON_TOO_DARK;
    case Trouble::few_features: return ODO_REASON_FEW_FEATURES;
    case Trouble::no_parallax: return ODO_REASON_NO_PARALLAX;
    default: return ODO_REASON_INITIALISING;
  }
}

class FivePoint {
 public:
  int64_t corners = 500;
  double inlier_threshold = 1.5;

  static constexpr odo::Description description{
      "vo/five_point", "1.0.0", "Plain visual odometry: KLT, five-point start, PnP on triangulated points",
      ODO_INTERFACE_VO_FRONTEND};
  static std::vector<odo::Parameter<FivePoint>> parameters() {
    return {odo::integer("corners", 50, 5000, &FivePoint::corners, "most corners followed"),
            odo::real("inlier_threshold", "px", 0.1, 10, &FivePoint::inlier_threshold,
                      "largest reprojection error of an inlier")};
  }

  void on(const odo_calibration& c, odo::Output&) {
    VisualOdometry::Parameters p;
    p.corners.most = static_cast<int>(corners);
    p.inlier_px = inlier_threshold;
    calibration_ = c.id;
    size_ = {static_cast<int>(c.width), static_cast<int>(c.height)};
    vo_.emplace(p, odograph::camera_of(c));
    previous_ns_ = INT64_MIN;
  }

  void on(const odo_frame& frame, odo::Output& output) {
    odograph::check_frame(frame, vo_ ? calibration_ : frame.calibration + 1, size_);
    const Motion motion = vo_->process(odograph::grey_of(frame, converted_), odograph::mask_of(frame));
    const int64_t from_ns = std::exchange(previous_ns_, frame.header.t_ns);
    if (from_ns == INT64_MIN) return;
    output.emit(event_of(motion, from_ns, frame));
  }

 private:
  static odo_vo_motion event_of(const Motion& motion, int64_t from_ns, const odo_frame& frame) {
    auto event = odo::make<odo_vo_motion>(frame.header.t_ns);
    event.t_from_ns = from_ns;
    odograph::put_motion(motion.q_c0_c1, motion.p_c0_c1, motion.rotation_sigma_rad, motion.position_sigma, event);
    if (motion.rotation_valid) event.header.flags |= ODO_VO_ROTATION;
    if (motion.translation_valid) event.header.flags |= ODO_VO_TRANSLATION | ODO_VO_COVARIANCE;
    event.camera = frame.calibration;
    event.state = motion.state == Tracking::tracking   ? ODO_TRACKING
                  : motion.state == Tracking::degraded ? ODO_DEGRADED
                                                       : ODO_LOST;
    event.reason = reason(motion.trouble);
    event.scale_group = motion.scale_group;
    event.tracked = motion.tracked;
    event.inliers = motion.inliers;
    event.header.quality =
        motion.tracked ? static_cast<float>(motion.inliers) / static_cast<float>(motion.tracked) : 0.0f;
    return event;
  }

  std::optional<VisualOdometry> vo_;
  cv::Mat converted_;
  cv::Size size_;
  uint32_t calibration_ = 0;
  int64_t previous_ns_ = INT64_MIN;
};

}  // namespace

ODO_PLUGIN(FivePoint)
