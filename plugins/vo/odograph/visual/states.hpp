// SPDX-License-Identifier: Apache-2.0
//
// States of the visual odometry as types, each with the data that is valid in that state alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include <Eigen/Geometry>

#include "plugins/shared/camera/camera_model.hpp"
#include "plugins/shared/camera/corner_tracker.hpp"
#include "plugins/vo/odograph/visual/gyroscope.hpp"

namespace odograph::vo {

struct SeenCorner {
  uint64_t track;
  Eigen::Vector2d
      at;  ///< normalized, rolling-shutter compensated: as at the time of the middle row under pure rotation
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
};

/// The corners of a frame.
struct SeenCorners {
  std::vector<SeenCorner> corners;  ///< in the tracker's order
  CameraModel lens;                 ///< of this picture
};

/// Motion prediction of a frame.
struct Prediction {
  double step_s = 0;                                            ///< since the previous frame
  std::optional<GyroRotation> gyro;                             ///< over that time
  Eigen::Quaterniond q_c0_c1 = Eigen::Quaterniond::Identity();  ///< the same, or the rotation of the previous frame
};

/// Before the first frame.
struct AwaitingFrame {};

/// A reference frame but no map: pure rotation so far.
struct Initialising {
  int64_t reference_ns = 0;
  size_t corners_at_reference = 0;
};

/// The last frame with a good pose, to relocalise from.
struct RelocalisationKeyframe {
  CornerTracker tracker;
  SeenCorners seen;
};

/// Tracking by the map.
struct MapTracking {
  size_t corners_at_keyframe = 0, triangulated_at_keyframe = 0;  ///< triangulated: triangulated
  size_t corners_before = 0;                                     ///< in the previous frame
  int suspect_frames = 0;                                        ///< consecutive frames that indicate a wrong map
  std::optional<RelocalisationKeyframe> keyframe;
};

/// The view is occluded or dark, or the rotation was too fast: for a while the odometry relocalises from the last frame
/// with a good pose.
struct Relocalising {
  int64_t since_ns = 0;
  MapTracking map;
};

using State = std::variant<AwaitingFrame, Initialising, MapTracking, Relocalising>;

/// Pose of the camera and its last motion.
struct CameraTrack {
  Eigen::Isometry3d T_w_c = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_k_c = Eigen::Isometry3d::Identity();  ///< in the newest keyframe, which an adjustment may move
  Eigen::Isometry3d last_step = Eigen::Isometry3d::Identity();  ///< from the previous frame
  double last_step_s = 0;
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  ///< of the pose, as FittedPose
};

}  // namespace odograph::vo
