// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "sdk/host/localizer/gyro_attitude_filter.hpp"
#include "sdk/host/localizer/tracker.hpp"

namespace odograph {

/// `coupling.orientation: gyroscope`: the camera's orientation in o composed of the gyroscope's rotations, its
/// inclination corrected by gravity and by fixes; the heading's drift is the localizer's. Does nothing otherwise.
class GyroOrientation {
 public:
  explicit GyroOrientation(Tracker& tracker) : tracker_(tracker) {}
  /// From the track's newest orientation on.
  void start(const Eigen::Quaterniond& q_b_c);
  /// The body at the end of a motion; nothing where it is not asked for, or samples lack.
  std::optional<Eigen::Quaterniond> rotate(const odo_vo_motion& motion, double rotation_sigma_rad);
  /// A fix's orientation of the body in o, at an earlier time, with its covariance, rad^2.
  void see_inclination(const Eigen::Quaterniond& q_o_b, const TrackPoint& then, const Eigen::Matrix3d& covariance_o);

 private:
  bool wanted() const { return tracker_.config().orientation == Orientation::gyroscope; }

  Tracker& tracker_;
  Eigen::Quaterniond q_b_c_ = Eigen::Quaterniond::Identity();
  GyroAttitudeFilter filter_;
};

}  // namespace odograph
