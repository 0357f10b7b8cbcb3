// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <odograph/types.h>

#include "sdk/math/rotation.hpp"

namespace odograph {

/// Converts headings from magnetic to true north, and records whether any measurement has observed the heading against
/// true north.
class NorthReference {
 public:
  // For an attitude without a covariance: such filters are seldom better than 3 degrees in tilt while walking, and
  // their compass is within 30 degrees (docs/accuracy/pose.md).
  struct Parameters {
    double tilt_sigma_rad = 0.05;    ///< rad
    double heading_sigma_rad = 0.5;  ///< rad
  };

  /// `declination_rad`: of magnetic from true north, positive to the east. `start_is_true`: the config gives a heading.
  NorthReference(std::optional<double> declination_rad, bool start_is_true)
      : declination_rad_(declination_rad), start_is_true_(start_is_true), is_true_(start_is_true) {}
  void reset() { is_true_ = start_is_true_; }

  void add(const odo_earth_field& field) {
    if (field.header.flags & ODO_EARTH_FIELD_DECLINATION) declination_rad_ = field.declination_rad;
  }
  void observe(const odo_attitude& attitude) { is_true_ |= (attitude.header.flags & ODO_ATTITUDE_TRUE_NORTH) != 0; }
  /// Notes a fix that was used.
  void observe(const odo_fix& fix) { is_true_ |= (fix.header.flags & (ODO_FIX_YAW | ODO_FIX_ORIENTATION)) != 0; }
  bool is_true() const { return is_true_; }

  /// Converts magnetic to true north if the declination is known, and fills in a missing covariance with uninformed
  /// sigmas.
  void complete(odo_attitude& attitude) const {
    uint32_t& flags = attitude.header.flags;
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> covariance(attitude.covariance_n);
    if (!(flags & ODO_ATTITUDE_COVARIANCE)) {
      const Eigen::Vector3d sigmas(p_.tilt_sigma_rad, p_.tilt_sigma_rad, p_.heading_sigma_rad);
      covariance = sigmas.cwiseAbs2().asDiagonal();
      flags |= ODO_ATTITUDE_COVARIANCE;
    }
    if (!declination_rad_ || !(flags & ODO_ATTITUDE_MAGNETIC_NORTH)) return;
    const Eigen::Quaterniond rotation(Eigen::AngleAxisd(*declination_rad_, Eigen::Vector3d::UnitZ()));
    put_quaternion(rotation * quaternion(attitude.q_n_b), attitude.q_n_b);
    const Eigen::Matrix3d R = rotation.toRotationMatrix();
    covariance = (R * covariance * R.transpose()).eval();
    flags = (flags & ~ODO_ATTITUDE_MAGNETIC_NORTH) | ODO_ATTITUDE_TRUE_NORTH;
  }

 private:
  Parameters p_;
  std::optional<double> declination_rad_;
  bool start_is_true_, is_true_;
};

}  // namespace odograph
