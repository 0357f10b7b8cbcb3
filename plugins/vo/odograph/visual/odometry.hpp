// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "plugins/shared/camera/camera_model.hpp"
#include "plugins/shared/camera/corner_tracker.hpp"
#include "plugins/shared/camera/tracking.hpp"
#include "plugins/vo/odograph/visual/gyroscope.hpp"
#include "plugins/vo/odograph/visual/pose_fit.hpp"
#include "plugins/vo/odograph/visual/window.hpp"

namespace odograph::vo {

/// Motion from the previous frame to this one.
struct Motion {
  Eigen::Quaterniond q_c0_c1 = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_c0_c1 = Eigen::Vector3d::Zero();                             ///< VO units
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  ///< of (rotation, position) in c0
  bool rotation_valid = false, translation_valid = false;
  Tracking state = Tracking::lost;
  FailureReason failure = FailureReason::initialising;
  unsigned scale_group = 0;
  unsigned tracked = 0, inliers = 0;
};

/// A frame as the odometry takes it.
struct Frame {
  cv::Mat grey;  ///< 8 bit, borrowed for the call
  cv::Mat mask;  ///< 0 = do not use; may be empty
  int64_t t_ns = 0;
  double line_time_s = 0;  ///< rolling shutter: the time stamp is the middle row's
};

/// Monocular visual odometry over a sliding window of keyframes; the gyroscope, where there is one, tells corners where
/// to look, rows of a rolling shutter when they saw, and the window how it turned. Steps of process(), in order:
/// predict, follow, undistort, then start (no map yet) or estimate the pose (by the map), then perhaps a
/// keyframe.
class Odometry {
 public:
  struct Parameters {
    CornerTracker::Parameters corners{
        .most = 250, .cell_px = 28, .quality = 0.01, .window_px = 19, .levels = 3, .back_px = 0.7};
    double noise_px = 0.4;  ///< standard deviation of a corner, to begin with: by night it is more
  };

  Odometry(const Parameters& parameters, const CameraModel& camera);

  /// rad/s in the camera's axes.
  void add_gyroscope(int64_t t_ns, const Eigen::Vector3d& rate_c) { gyroscope_.add(t_ns, rate_c); }
  /// The next frame. For the first one the result means nothing.
  Motion process(const Frame& frame);

  /// Of the frames to come: focused or shifted. The map, which has no pixels, stays.
  void change_lens(const CameraModel& camera) { camera_ = camera; }

  /// rad/s, what the window found.
  const Eigen::Vector3d& gyro_bias_c() const { return bias_c_; }
  /// Windows whose adjustment failed since the beginning; each went on unadjusted.
  uint64_t failed_adjustments() const { return failed_adjustments_; }

 private:
  struct Seen {
    uint64_t track;
    Eigen::Vector2d at;  ///< normalized
  };

  /// Where the camera was well placed last, to be found again from there.
  struct RelocalisationKeyframe {
    CornerTracker tracker;
    std::vector<Seen> seen;
    CameraModel lens;
  };

  void predict(const Frame& frame);
  Eigen::Isometry3d pose_before() const { return window_.keyframes().back().T_w_c * T_k_c_; }
  Eigen::Isometry3d expected_pose() const;
  Eigen::Vector2d expected_at(const Seen& seen, const Eigen::Isometry3d& T_expected) const;
  void follow(const Frame& frame, const Eigen::Isometry3d& T_expected);
  void undistort_tracks(const Frame& frame);
  bool start_or_turn(Motion& motion);
  void learn_bias(const Eigen::Quaterniond& seen_rotation, double sigma_rad);
  bool start(Motion& motion, const std::vector<cv::Point2d>& first, const std::vector<cv::Point2d>& second,
             const std::vector<size_t>& which, const Eigen::Quaterniond& turn_alone);
  bool estimate_pose(const Eigen::Isometry3d& T_expected, Motion& motion);
  void relocalise(const Frame& frame, Motion& motion);
  std::optional<FittedPose> fit(const std::vector<PointSeen>& points, const Eigen::Isometry3d& T_expected);
  void report(const FittedPose& pose, Motion& motion);
  bool wants_keyframe() const;
  void make_keyframe(const Frame& frame);
  void drop_outliers();
  void begin(const Frame& frame, bool new_group);
  double sigma() const { return noise_px_ / camera_.focal(); }
  void learn_noise(const std::vector<PointSeen>& points, const FittedPose& pose);

  Parameters p_;
  CameraModel camera_;
  CornerTracker tracker_;
  Gyroscope gyroscope_;
  Eigen::Vector3d bias_c_ = Eigen::Vector3d::Zero();
  double bias_sigma_ = 0.01;  // rad/s, before the window knows better
  Window window_;

  cv::Mat smooth_;
  std::vector<Seen> seen_;
  CameraModel seen_lens_;  // of the picture in which seen_ were
  std::vector<cv::Point2d> straight_;

  int64_t last_ns_ = 0, reference_ns_ = 0;
  std::optional<GyroRotation> turn_;  // from the last frame to this one
  Eigen::Quaterniond expected_turn_;  // the same, or what the frame before did
  Eigen::Isometry3d T_w_c_ = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d last_step_ = Eigen::Isometry3d::Identity();
  double last_step_s_ = 0, step_s_ = 0;
  Eigen::Isometry3d T_k_c_ = Eigen::Isometry3d::Identity();  // the latest frame in the newest keyframe
  Eigen::Matrix<double, 6, 6> last_covariance_ = Eigen::Matrix<double, 6, 6>::Zero();
  bool started_ = false, have_reference_ = false;
  unsigned group_ = 0;
  size_t located_at_keyframe_ = 0, seen_at_keyframe_ = 0, seen_before_ = 0;
  double noise_px_;
  uint64_t failed_adjustments_ = 0;
  int doubts_ = 0;
  std::optional<RelocalisationKeyframe> relocalisation_keyframe_;
  std::optional<int64_t> relocalising_since_ns_;
};

}  // namespace odograph::vo
