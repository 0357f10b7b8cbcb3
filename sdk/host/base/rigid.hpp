// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace odograph {

/// A rigid transform: orientation and position of one frame in another.
struct Rigid {
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();  ///< m

  Rigid operator*(const Rigid& inner) const { return {(q * inner.q).normalized(), p + q * inner.p}; }
  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return p + q * point; }
  Rigid inverse() const { return {q.conjugate(), -(q.conjugate() * p)}; }
};

}  // namespace odograph
