// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/map/agreement.hpp"

#include <cmath>

#include <Eigen/Cholesky>

#include "sdk/math/rotation.hpp"

namespace odograph::place_map {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

namespace {

/// Covariance of (rotation, position) after a rotation of the axes and of the point to `arm` from it.
Matrix6d carried(const Matrix6d& covariance, const Matrix3d& R, const Vector3d& arm) {
  Matrix6d J = Matrix6d::Zero();
  J.topLeftCorner<3, 3>() = R;
  J.bottomLeftCorner<3, 3>() = -skew(arm) * R;
  J.bottomRightCorner<3, 3>() = R;
  return J * covariance * J.transpose();
}

}  // namespace

Agreement agree(const Recognition& a, const Rigid& T_m_ka, const Recognition& b, const Rigid& T_m_kb,
                const Rigid& T_ca_cb, const Matrix6d& covariance, const AgreementParameters& p) {
  const Rigid T_m_ca = T_m_ka * a.T_k_c, predicted = T_m_ca * T_ca_cb, seen = T_m_kb * b.T_k_c;
  Eigen::Matrix<double, 6, 1> error;
  error << log_rotation(seen.q * predicted.q.conjugate()), seen.p - predicted.p;
  if (!error.allFinite() || error.head<3>().norm() > p.largest_rad || error.tail<3>().norm() > p.longest_m)
    return Agreement::no;
  const Matrix3d R_m_ca = T_m_ca.q.toRotationMatrix();
  Matrix6d sum = carried(a.covariance, T_m_ka.q.toRotationMatrix(), R_m_ca * T_ca_cb.p) +
                 carried(covariance, R_m_ca, Vector3d::Zero()) +
                 carried(b.covariance, T_m_kb.q.toRotationMatrix(), Vector3d::Zero());
  const double between_m = (T_m_ka.p - T_m_kb.p).norm();
  sum.diagonal().head<3>().array() += std::pow(p.drift_rad_per_m * between_m, 2);
  sum.diagonal().tail<3>().array() += std::pow(p.drift * between_m, 2);
  const Eigen::LDLT<Matrix6d> solver(sum);
  const double squared = error.dot(solver.solve(error));
  if (solver.info() != Eigen::Success || !(squared >= 0 && squared < p.gate)) return Agreement::no;
  const bool apart = std::abs(static_cast<double>(b.t_ns - a.t_ns)) >= 1e9 * p.apart_s ||
                     T_ca_cb.p.norm() >= p.apart_m ||
                     T_ca_cb.q.angularDistance(Eigen::Quaterniond::Identity()) >= p.apart_rad;
  return apart ? Agreement::yes : Agreement::not_apart;
}

}  // namespace odograph::place_map
