// SPDX-License-Identifier: Apache-2.0
#include <optional>

#include "plugins/camera/frame_view.hpp"
#include "plugins/vo/odograph/odometry.hpp"

namespace {

using namespace odograph::vo;

class OdographVo {
 public:
  static constexpr odo::Description description{
      "vo/odograph", "1.0.0", "Visual odometry: gyroscope-guided corners, keyframes, sliding-window bundle adjustment",
      ODO_INTERFACE_VO_FRONTEND};
  static std::vector<odo::Parameter<OdographVo>> parameters() { return {}; }

  void on(const odo_calibration& c, odo::Output&) {
    calibration_ = c.id;
    size_ = {static_cast<int>(c.width), static_cast<int>(c.height)};
    vo_.emplace(Odometry::Parameters{}, odograph::camera_of(c));
    q_c_b_ = Eigen::Quaterniond(0, 1, 0, 0);  // a phone's rear camera
    if (c.header.flags & ODO_CALIBRATION_EXTRINSICS)
      q_c_b_ = Eigen::Quaterniond(c.q_b_c[0], c.q_b_c[1], c.q_b_c[2], c.q_b_c[3]).conjugate();
    previous_ns_ = INT64_MIN;
  }

  void on(const odo_imu& imu, odo::Output&) {
    if (vo_) vo_->add_gyroscope(imu.header.t_ns, q_c_b_ * Eigen::Vector3d(imu.gyro_b));
  }

  void on(const odo_frame& frame, odo::Output& output) {
    odograph::check_frame(frame, vo_ ? calibration_ : frame.calibration + 1, size_);
    const Motion motion = vo_->process({odograph::grey_of(frame, converted_), odograph::mask_of(frame),
                                        frame.header.t_ns, static_cast<double>(frame.line_time_ns) * 1e-9});
    const int64_t from_ns = std::exchange(previous_ns_, frame.header.t_ns);
    if (from_ns != INT64_MIN) output.emit(event_of(motion, from_ns, frame));
  }

 private:
  static odo_vo_motion event_of(const Motion& motion, int64_t from_ns, const odo_frame& frame) {
    auto event = odograph::motion_event(frame, from_ns, motion.rotation_valid, motion.translation_valid, motion.tracked,
                                        motion.inliers);
    odograph::put_motion(motion.q_c0_c1, motion.p_c0_c1, 0, 0, event);
    Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>{event.covariance} = motion.covariance;
    odograph::put_state(motion.state, motion.trouble, event);
    event.scale_group = motion.scale_group;
    return event;
  }

  std::optional<Odometry> vo_;
  Eigen::Quaterniond q_c_b_ = Eigen::Quaterniond::Identity();
  cv::Mat converted_;
  cv::Size size_;
  uint32_t calibration_ = 0;
  int64_t previous_ns_ = INT64_MIN;
};

}  // namespace

ODO_PLUGIN(OdographVo)
