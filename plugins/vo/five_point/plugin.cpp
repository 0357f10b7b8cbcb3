// SPDX-License-Identifier: Apache-2.0
#include <optional>

#include "plugins/shared/camera/frame_view.hpp"
#include "plugins/shared/camera/points_event.hpp"
#include "plugins/vo/five_point/visual_odometry.hpp"

namespace {

using namespace odograph::five_point;

class FivePoint {
 public:
  int64_t corners = 500;
  double inlier_threshold = 1.5;

  static constexpr odo::Description description{
      "vo/five_point", "1.0.0", "Basic visual odometry: KLT, five-point start, PnP on triangulated points",
      ODO_INTERFACE_VO_FRONTEND};
  static constexpr uint32_t extra_outputs[] = {ODO_TYPE_POINTS};
  static std::vector<odo::Parameter<FivePoint>> parameters() {
    return {odo::integer("corners", 50, 5000, &FivePoint::corners, "maximum number of tracked corners"),
            odo::real("inlier_threshold", "px", 0.1, 10, &FivePoint::inlier_threshold,
                      "largest reprojection error of an inlier")};
  }

  void on(const odo_calibration& c, odo::Output&) {
    if (!camera_.take(c)) return;  // the lens comes with each frame
    VisualOdometry::Parameters p;
    p.corners.max_corners = static_cast<int>(corners);
    p.inlier_px = inlier_threshold;
    vo_.emplace(p, odograph::camera_of(c));
    previous_ns_ = INT64_MIN;
  }

  void on(const odo_frame& frame, odo::Output& output) {
    const odograph::CameraModel lens = camera_.lens_of(frame);
    if (frame.header.t_ns <= previous_ns_)
      throw odo::Error(ODO_E_DISCARD, "t_ns is not after that of the frame before");
    vo_->change_lens(lens);
    const Motion motion = vo_->process(odograph::grey_of(frame, converted_), odograph::mask_of(frame));
    const int64_t from_ns = std::exchange(previous_ns_, frame.header.t_ns);
    if (from_ns == INT64_MIN) return;
    const odo_vo_motion event = event_of(motion, from_ns, frame);
    points_.emit(event, vo_->corners(), vo_->corner_sigma_rad(), lens, camera_.size(), output);
    output.emit(event);
  }

 private:
  static odo_vo_motion event_of(const Motion& motion, int64_t from_ns, const odo_frame& frame) {
    auto event = odograph::motion_event(frame, from_ns, motion.rotation_valid, motion.translation_valid, motion.tracked,
                                        motion.inliers);
    odograph::put_motion(motion.q_c0_c1, motion.p_c0_c1, motion.rotation_sigma_rad, motion.position_sigma, event);
    odograph::put_state(motion.state, motion.failure, event);
    event.scale_group = motion.scale_group;
    return event;
  }

  std::optional<VisualOdometry> vo_;
  odograph::PointsEvent points_;
  cv::Mat converted_;
  odograph::CalibratedCamera camera_;
  int64_t previous_ns_ = INT64_MIN;
};

}  // namespace

ODO_PLUGIN(FivePoint)
