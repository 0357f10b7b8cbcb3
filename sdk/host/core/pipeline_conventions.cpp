// SPDX-License-Identifier: Apache-2.0
//
// What numbers are of: the extent of n, true north, the main camera.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sdk/math/rotation.hpp"
#include "sdk/host/core/pipeline.hpp"

namespace odograph {
namespace {

constexpr Pipeline::Parameters kParameters;

}  // namespace

/// Whether a position lies so far from n's origin that n has no meaning there; reported.
bool Pipeline::is_beyond_frame(const odo_fix& fix) {
  const double north_m = (fix.header.flags & ODO_FIX_NORTH) ? fix.p_n[0] : 0.0;
  const double east_m = (fix.header.flags & ODO_FIX_EAST) ? fix.p_n[1] : 0.0;
  const double distance_m = std::hypot(north_m, east_m);
  if (distance_m <= kParameters.farthest_fix_m) return false;
  char text[160];
  std::snprintf(text, sizeof text,
                "a fix lies %.0f km from the origin of n, at most %.0f km make sense: is navigation.origin right?",
                distance_m / 1e3, kParameters.farthest_fix_m / 1e3);
  host_.report(fix.header.source, ODO_SEVERITY_WARNING, "far_fix", text);
  return true;
}

bool Pipeline::is_of_main_camera(const odo_vo_motion& motion) {
  if (!roster_.has_camera() || camera() == motion.camera) return true;
  host_.report(motion.header.source, ODO_SEVERITY_WARNING, "other_camera",
               "a motion of camera " + std::to_string(motion.camera) + "; expected one of the main camera, " +
                   std::to_string(camera()),
               ODO_E_ARGUMENT);
  return false;
}

/// Turns magnetic north into true north, where the declination is known; an attitude without a covariance is given an
/// uninformed one.
void Pipeline::complete(odo_attitude& attitude) const {
  uint32_t& flags = attitude.header.flags;
  if (!(flags & ODO_ATTITUDE_COVARIANCE)) {
    std::fill(std::begin(attitude.covariance_n), std::end(attitude.covariance_n), 0.0);
    attitude.covariance_n[0] = attitude.covariance_n[4] = kParameters.tilt_sigma_rad * kParameters.tilt_sigma_rad;
    attitude.covariance_n[8] = kParameters.heading_sigma_rad * kParameters.heading_sigma_rad;
    flags |= ODO_ATTITUDE_COVARIANCE;
  }
  if (!declination_rad_ || !(flags & ODO_ATTITUDE_MAGNETIC_NORTH)) return;
  const Eigen::Quaterniond rotation(Eigen::AngleAxisd(*declination_rad_, Eigen::Vector3d::UnitZ()));
  put_quaternion(rotation * quaternion(attitude.q_n_b), attitude.q_n_b);
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> covariance(attitude.covariance_n);
  const Eigen::Matrix3d R = rotation.toRotationMatrix();
  covariance = (R * covariance * R.transpose()).eval();
  flags = (flags & ~ODO_ATTITUDE_MAGNETIC_NORTH) | ODO_ATTITUDE_TRUE_NORTH;
}

}  // namespace odograph
