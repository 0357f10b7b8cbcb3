// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "sdk/host/fusion/gyro_attitude.hpp"
#include "sdk/host/fusion/fusion_state.hpp"

namespace odograph {

/// `coupling.orientation: gyroscope`: the camera's orientation in o, integrated from the gyroscope; gravity and fixes
/// correct its inclination, the pose filter estimates its heading drift. Otherwise inactive.
class GyroOrientation {
 public:
  explicit GyroOrientation(FusionState& state) : state_(state) {}
  /// Starts from the newest orientation of the track.
  void start(const Eigen::Quaterniond& q_b_c);
  /// Orientation of the body at the end of a motion; nothing if inactive or samples are missing. Continues from the
  /// track's orientation afterwards.
  std::optional<Eigen::Quaterniond> rotate(const odo_vo_motion& motion, double rotation_sigma_rad);
  /// Updates with a fix of the body's orientation, if it has one, at an earlier time.
  void update_inclination(const odo_fix& fix, const TrackPoint& then);

 private:
  Eigen::Matrix3d tilt_covariance() const;
  bool is_enabled() const { return state_.config.orientation == Orientation::gyroscope; }

  FusionState& state_;
  Eigen::Quaterniond q_b_c_ = Eigen::Quaterniond::Identity();
  GyroAttitude filter_;
  bool gap_ = false;  // samples were missing for the newest motion
};

}  // namespace odograph
