// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>

#include "plugins/shared/camera/frame_view.hpp"
#include "plugins/shared/camera/points_event.hpp"
#include "plugins/vo/antigny2019/odometry.hpp"

namespace {

using namespace odograph::antigny2019;

/// The visual odometry of Antigny et al. 2019, section 3.2.
class Antigny2019 {
 public:
  std::string features = "surf";
  int64_t max_features = 1500;
  double ratio = 0.6, inlier_threshold = 1.5, rate = 0;

  static constexpr odo::Description description{
      "vo/antigny2019", "1.0.0",
      "Visual odometry without a map: SURF, SSD, MSAC, triangulation, PnP (Antigny et al. 2019)",
      ODO_INTERFACE_VO_FRONTEND};
  static constexpr uint32_t extra_outputs[] = {ODO_TYPE_POINTS};
  static std::vector<odo::Parameter<Antigny2019>> parameters() {
    return {odo::choice("features", "surf|sift|orb|akaze", &Antigny2019::features,
                        "detector and descriptor; the paper uses SURF"),
            odo::integer("max_features", 100, 10000, &Antigny2019::max_features,
                         "maximum per picture, before the sparse selection"),
            odo::real("ratio", "", 0.1, 1, &Antigny2019::ratio,
                      "largest ratio of a match's squared difference to that of the second best"),
            odo::real("inlier_threshold", "px", 0.1, 10, &Antigny2019::inlier_threshold,
                      "largest distance of an inlier to the epipolar line; twice that for PnP"),
            odo::real("rate", "Hz", 0, 1000, &Antigny2019::rate,
                      "pictures used a second, those between are passed over; 0: all; the paper uses 10 of 60")};
  }

  void on(const odo_calibration& c, odo::Output&) {
    if (!camera_.take(c)) return;  // the lens comes with each frame
    Odometry::Parameters p;
    p.features = features, p.most = static_cast<int>(max_features), p.ratio = ratio, p.inlier_px = inlier_threshold;
    vo_.emplace(p, odograph::camera_of(c), camera_.size());
    previous_ns_ = INT64_MIN;
  }

  /// A known object gives the whole pose: the odometry starts again from there (section 3.5).
  void on(const odo_fix& fix, odo::Output&) {
    constexpr uint32_t pose = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_DOWN | ODO_FIX_ORIENTATION;
    if (vo_ && (fix.header.flags & pose) == pose) vo_->restart();
  }

  void on(const odo_frame& frame, odo::Output& output) {
    const odograph::CameraModel lens = camera_.lens_of(frame);
    if (frame.header.t_ns <= previous_ns_)
      throw odo::Error(ODO_E_DISCARD, "t_ns is not after that of the frame before");
    if (!is_due(frame.header.t_ns)) return;
    vo_->change_lens(lens);
    const cv::Mat grey = odograph::grey_of(frame, converted_);
    const Motion motion = vo_->process(grey, odograph::mask_of(frame));
    const int64_t from_ns = std::exchange(previous_ns_, frame.header.t_ns);
    if (from_ns == INT64_MIN) return;
    auto event = odograph::motion_event(frame, from_ns, motion.rotation_valid, motion.translation_valid, motion.matches,
                                        motion.inliers);
    odograph::put_motion(Eigen::Quaterniond(motion.T_c0_c1.linear()).normalized(), motion.T_c0_c1.translation(),
                         motion.rotation_sigma_rad, motion.position_sigma, event);
    if (motion.outcome == Outcome::tracking)
      odograph::put_state(odograph::Tracking::tracking, odograph::FailureReason::none, event);
    else if (motion.outcome == Outcome::lost)
      odograph::put_state(odograph::Tracking::lost,
                          cv::mean(grey)[0] < Odometry::Parameters().dark_grey ? odograph::FailureReason::too_dark
                                                                               : odograph::FailureReason::few_features,
                          event);
    else
      odograph::put_state(odograph::Tracking::degraded, odograph::FailureReason::no_parallax, event);
    event.scale_group = motion.scale_group;
    points_.emit(event, vo_->corners(), vo_->corner_sigma_rad(), lens, camera_.size(), output);
    output.emit(event);
  }

 private:
  /// Whether a picture belongs to the next period; early ones do by a quarter of a period, so that the mean rate holds
  /// whatever the jitter of their times.
  bool is_due(int64_t t_ns) {
    if (rate <= 0) return true;
    const auto period_ns = static_cast<int64_t>(1e9 / rate);
    if (previous_ns_ == INT64_MIN) due_ns_ = t_ns;
    if (t_ns < due_ns_ - period_ns / 4) return false;
    due_ns_ = std::max(due_ns_, t_ns - period_ns) + period_ns;
    return true;
  }

  std::optional<Odometry> vo_;
  odograph::PointsEvent points_;
  cv::Mat converted_;
  odograph::CalibratedCamera camera_;
  int64_t previous_ns_ = INT64_MIN, due_ns_ = INT64_MIN;
};

}  // namespace

ODO_PLUGIN(Antigny2019)
