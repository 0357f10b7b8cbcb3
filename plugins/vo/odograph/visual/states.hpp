// SPDX-License-Identifier: Apache-2.0
//
// What a visual odometry is about, as types: each holds what means something in that state alone.
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
  Eigen::Vector2d at;  ///< normalized, as the middle row's time would have seen it had the camera only rotated
};

/// The corners of a frame.
struct SeenCorners {
  std::vector<SeenCorner> corners;  ///< in the order of the tracker's
  CameraModel lens;                 ///< of the picture in which they were
};

/// What is known of a frame's motion before looking at it.
struct Prediction {
  double step_s = 0;                                            ///< since the frame before
  std::optional<GyroRotation> gyro;                             ///< over that time
  Eigen::Quaterniond q_c0_c1 = Eigen::Quaterniond::Identity();  ///< the same, or what the frame before did
};

/// No frame has come.
struct AwaitingFrame {};

/// A reference frame and no map: so far the camera has only rotated.
struct Initialising {
  int64_t reference_ns = 0;
  size_t corners_at_reference = 0;
};

/// Where the camera was well placed last, to be found again from there.
struct RelocalisationKeyframe {
  CornerTracker tracker;
  SeenCorners seen;
};

/// The map places the camera.
struct MapTracking {
  size_t corners_at_keyframe = 0, located_at_keyframe = 0;  ///< located: with a depth
  size_t corners_before = 0;                                ///< in the frame before
  int doubts = 0;                                           ///< frames in a row that say that the map is a false one
  std::optional<RelocalisationKeyframe> keyframe;
};

/// Something stands before the camera, or it is dark, or it rotated too fast: for a while the camera is looked for from
/// where it was last well placed.
struct Relocalising {
  int64_t since_ns = 0;
  MapTracking map;
};

using State = std::variant<AwaitingFrame, Initialising, MapTracking, Relocalising>;

/// Where the camera is, and how it moved last.
struct CameraTrack {
  Eigen::Isometry3d T_w_c = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_k_c = Eigen::Isometry3d::Identity();      ///< in the newest keyframe, which an adjustment moves
  Eigen::Isometry3d last_step = Eigen::Isometry3d::Identity();  ///< from the frame before
  double last_step_s = 0;
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  ///< of the pose, as of FittedPose
};

}  // namespace odograph::vo
