// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "plugins/shared/camera/camera_model.hpp"
#include "plugins/shared/camera/corner_tracker.hpp"
#include "plugins/shared/camera/point_tracks.hpp"
#include "plugins/shared/camera/tracking.hpp"
#include "plugins/vo/odograph/visual/gyroscope.hpp"
#include "plugins/vo/odograph/visual/parameters.hpp"
#include "plugins/vo/odograph/visual/pose_fit.hpp"
#include "plugins/vo/odograph/visual/states.hpp"
#include "plugins/vo/odograph/visual/window.hpp"

namespace odograph::vo {

/// Motion from the previous frame to this one.
struct Motion {
  Eigen::Quaterniond q_c0_c1 = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_c0_c1 = Eigen::Vector3d::Zero();                             ///< in the scale of the scale group
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  ///< of (rotation, position) in c0
  bool rotation_valid = false, translation_valid = false;
  Tracking state = Tracking::lost;
  FailureReason failure = FailureReason::initialising;
  unsigned scale_group = 0;
  unsigned tracked = 0, inliers = 0;
};

/// Input frame.
struct Frame {
  cv::Mat grey;  ///< 8 bit, borrowed for the call
  cv::Mat mask;  ///< 0 = do not use; may be empty
  int64_t t_ns = 0;
  double line_time_s = 0;  ///< rolling shutter: time per row; the time stamp is the middle row's
};

/// Monocular visual odometry over a sliding window of keyframes. A gyroscope, if there is one, predicts the positions
/// of the corners, compensates the rolling shutter and constrains the rotations in the window. process() consists of
/// these steps: predict, track, undistort, then the action of the present state (states.hpp): start a map, estimate the
/// pose, or relocalise. Not thread-safe; deterministic.
class Odometry {
 public:
  using Parameters = OdometryParameters;

  Odometry(const Parameters& parameters, const CameraModel& camera);

  /// Rate in the camera's axes, rad/s.
  void add_gyroscope(int64_t t_ns, const Eigen::Vector3d& rate_c) { gyroscope_.add(t_ns, rate_c); }
  /// Processes the next frame. The result of the first one is undefined.
  Motion process(const Frame& frame);

  /// Sets the lens of the frames to come (refocused or shifted). The map holds no pixels and stays valid.
  void change_lens(const CameraModel& camera) { camera_ = camera; }

  /// The corners of the latest frame.
  std::vector<TrackedCorner> corners() const;
  /// Their noise.
  double corner_sigma_rad() const { return sigma(); }

  /// Gyro bias estimated by the window, rad/s.
  const Eigen::Vector3d& gyro_bias_c() const { return bias_c_; }

 private:
  /// Result of a frame: its motion and the next state.
  struct Outcome {
    Motion motion;
    State next;
  };
  /// Corners of the reference frame that are still tracked, in both frames.
  struct Matches {
    std::vector<cv::Point2d> first, second;
    std::vector<size_t> which;  ///< index in seen_.corners
  };
  /// Second view of a new map; the reference is the first.
  struct SecondView {
    Eigen::Isometry3d T_w_c;  ///< scaled to a median depth of one
    std::vector<char> inliers;
    int count;
    double parallax_rad;
  };

  // Action in each state.
  Outcome advance(AwaitingFrame state, const Frame& frame, const Prediction& predicted);
  Outcome advance(Initialising state, const Frame& frame, const Prediction& predicted);
  Outcome advance(MapTracking map, const Frame& frame, const Prediction& predicted);
  Outcome advance(Relocalising state, const Frame& frame, const Prediction& predicted);

  // Steps common to all states.
  Prediction predict(int64_t t_ns) const;
  Eigen::Isometry3d pose_before() const { return window_.keyframes().back().T_w_c * track_.T_k_c; }
  Eigen::Isometry3d expected_pose(const Prediction& predicted) const;
  Eigen::Vector2d expected_at(const SeenCorner& corner, const Eigen::Isometry3d& T_expected,
                              const Eigen::Quaterniond& q_c0_c1) const;
  void follow(const Frame& frame, const Eigen::Isometry3d& T_expected, const Eigen::Quaterniond& q_c0_c1);
  SeenCorners undistort(const Frame& frame) const;
  Motion rotation_by_gyroscope(const Prediction& predicted) const;

  // Starting a map (start.cpp).
  Initialising begin(const Frame& frame);
  Initialising begin_group(const Frame& frame);
  Matches matches_with_reference() const;
  void update_bias(const Initialising& state, const Prediction& predicted, const Eigen::Quaterniond& seen_rotation,
                   double sigma_rad);
  std::optional<SecondView> find_second_view(const Matches& matches, const Eigen::Quaterniond& rotation_alone);
  Motion begin_map(const SecondView& view, const Matches& matches, const Initialising& state,
                   const Prediction& predicted);

  // Pose estimation (odometry.cpp) and mapping (mapping.cpp).
  std::vector<PointSeen> points_seen(std::vector<uint64_t>& tracks) const;
  std::optional<FittedPose> fit(const std::vector<PointSeen>& points, const Eigen::Isometry3d& T_expected,
                                const Prediction& predicted, double unseen_s);
  std::optional<FittedPose> fit_by_ransac(const std::vector<PointSeen>& points,
                                          const std::optional<RotationPrior>& prior) const;
  std::optional<FittedPose> estimate_pose(const Eigen::Isometry3d& T_expected, const Prediction& predicted,
                                          double unseen_s, int& suspect_frames);
  void update_noise(const std::vector<PointSeen>& points, const FittedPose& pose);
  Motion move_to(const FittedPose& pose, const Prediction& predicted);
  bool wants_keyframe(const MapTracking& map) const;
  void make_keyframe(const Frame& frame, MapTracking& map);
  void drop_outliers();

  FailureReason dark_or_few_features() const;
  double sigma() const { return noise_px_ / camera_.focal(); }  ///< of a corner, normalized

  Parameters p_;
  CameraModel camera_;
  CornerTracker tracker_;
  PictureContent content_;  // of the latest picture
  Gyroscope gyroscope_;
  Eigen::Vector3d bias_c_ = Eigen::Vector3d::Zero();  ///< rad/s
  double bias_sigma_;                                 ///< rad/s, until the window estimates the bias
  double noise_px_;                                   ///< estimated corner noise
  Window window_;
  SeenCorners seen_;  ///< of the latest frame
  CameraTrack track_;
  State state_;
  int64_t last_ns_ = 0;  ///< of the latest frame
  unsigned group_ = 0;
  cv::Mat smooth_;
};

}  // namespace odograph::vo
