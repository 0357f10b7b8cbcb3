// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "sdk/host/localizer/gyro_attitude_filter.hpp"
#include "sdk/host/localizer/tracker.hpp"

namespace odograph {

/// `coupling.orientation: gyroscope`: the camera's orientation in o, integrated from the gyroscope; gravity and fixes
/// correct its inclination, the localizer estimates its heading drift. Otherwise inactive.
class GyroOrientation {
 public:
  explicit GyroOrientation(Tracker& tracker) : tracker_(tracker) {}
  /// Starts from the newest orientation of the track.
  void start(const Eigen::Quaterniond& q_b_c);
  /// Orientation of the body at the end of a motion; nothing if inactive or samples are missing.
  std::optional<Eigen::Quaterniond> rotate(const odo_vo_motion& motion, double rotation_sigma_rad);
  /// Updates with the orientation of the body in o at an earlier time, from a fix; covariance in rad^2.
  void update_inclination(const Eigen::Quaterniond& q_o_b, const TrackPoint& then, const Eigen::Matrix3d& covariance_o);

 private:
  bool is_enabled() const { return tracker_.config().orientation == Orientation::gyroscope; }

  Tracker& tracker_;
  Eigen::Quaterniond q_b_c_ = Eigen::Quaterniond::Identity();
  GyroAttitudeFilter filter_;
};

}  // namespace odograph
