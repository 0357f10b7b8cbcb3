// SPDX-License-Identifier: Apache-2.0
//
// Cost functions of the window's adjustment, separate from bundle.cpp so that their Jacobians can be tested.
#pragma once

#include <algorithm>
#include <cstddef>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <ceres/manifold.h>
#include <ceres/sized_cost_function.h>

#include "plugins/vo/odograph/visual/gyroscope.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph::vo::bundle {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

/// Seven numbers: quaternion (x, y, z, w) of R_w_c, and position. Perturbed on the right, position in w: an exception
/// in docs/notation.md. Ceres' EigenQuaternionManifold needs derivatives by the four quaternion components; the costs
/// below give them by the tangent.
class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* out) const override {
    Eigen::Map<Quaterniond>{out} = (Eigen::Map<const Quaterniond>(x) * exp_rotation(Vector3d(delta))).normalized();
    Eigen::Map<Vector3d>{out + 4} = Eigen::Map<const Vector3d>(x + 4) + Eigen::Map<const Vector3d>(delta + 3);
    return true;
  }
  /// Selects the first six columns, in which the costs below give derivatives by the tangent.
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>> J(jacobian);
    J.setZero();
    J.topRows<6>().setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* out) const override {
    Eigen::Map<Vector3d>{out} =
        log_rotation(Eigen::Map<const Quaterniond>(x).conjugate() * Eigen::Map<const Quaterniond>(y));
    Eigen::Map<Vector3d>{out + 3} = Eigen::Map<const Vector3d>(y + 4) - Eigen::Map<const Vector3d>(x + 4);
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>> J(jacobian);
    J.setZero();
    J.leftCols<6>().setIdentity();
    return true;
  }
};

using PoseJacobian = Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>>;

/// y = R_j' (R_a ray + rho (p_a - p_j)), observed at y_xy / y_z. A point behind the camera has a constant residual,
/// that of the minimum depth at one focal length: its gradient is zero, and no step is rewarded for moving it there.
class Reprojection final : public ceres::SizedCostFunction<2, 7, 7, 1> {
 public:
  Reprojection(const Eigen::Vector2d& anchor, const Eigen::Vector2d& seen, double sigma, double min_depth)
      : ray_(anchor.x(), anchor.y(), 1), seen_(seen), per_sigma_(1 / sigma), min_depth_(min_depth) {}

  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    const Matrix3d R_a = Eigen::Map<const Quaterniond>(x[0]).toRotationMatrix();
    const Matrix3d R_j_w = Eigen::Map<const Quaterniond>(x[1]).toRotationMatrix().transpose();
    const Vector3d between = Eigen::Map<const Vector3d>(x[0] + 4) - Eigen::Map<const Vector3d>(x[1] + 4);
    const double rho = x[2][0];
    const Vector3d y = R_j_w * (R_a * ray_ + rho * between);
    if (y.z() < min_depth_) return behind(residuals, jacobians);
    Eigen::Map<Eigen::Vector2d>{residuals} = per_sigma_ * (y.head<2>() / y.z() - seen_);
    if (!jacobians) return true;
    Eigen::Matrix<double, 2, 3> P;
    P << 1 / y.z(), 0, -y.x() / (y.z() * y.z()), 0, 1 / y.z(), -y.y() / (y.z() * y.z());
    P *= per_sigma_;
    const Eigen::Matrix<double, 2, 3> PR = P * R_j_w;
    if (jacobians[0]) {
      PoseJacobian J(jacobians[0]);
      J << -PR * R_a * skew(ray_), rho * PR, Eigen::Vector2d::Zero();
    }
    if (jacobians[1]) {
      PoseJacobian J(jacobians[1]);
      J << P * skew(y), -rho * PR, Eigen::Vector2d::Zero();
    }
    if (jacobians[2]) Eigen::Map<Eigen::Vector2d>{jacobians[2]} = PR * between;
    return true;
  }

 private:
  bool behind(double* residuals, double** jacobians) const {
    residuals[0] = per_sigma_ / min_depth_, residuals[1] = 0;
    for (int k = 0; jacobians && k < 3; ++k)
      if (jacobians[k]) std::fill_n(jacobians[k], 2 * parameter_block_sizes()[static_cast<size_t>(k)], 0.0);
    return true;
  }

  Vector3d ray_;
  Eigen::Vector2d seen_;
  double per_sigma_, min_depth_;
};

/// Log(Delta R(bias)' R_i' R_j), Forster et al. 2017, eq. (45), to first order.
class Rotation final : public ceres::SizedCostFunction<3, 7, 7, 3> {
 public:
  Rotation(const GyroRotation& gyro, const Vector3d& bias) : gyro_(gyro), bias_(bias) {}

  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    const Eigen::Map<const Quaterniond> q_i(x[0]), q_j(x[1]);
    const Quaterniond measured =
        gyro_.q_c0_c1 * exp_rotation(gyro_.by_bias * (Eigen::Map<const Vector3d>(x[2]) - bias_));
    const double per_sigma = 1 / gyro_.sigma_rad;
    const Vector3d error = log_rotation(measured.conjugate() * q_i.conjugate() * q_j);
    Eigen::Map<Vector3d>{residuals} = per_sigma * error;
    if (!jacobians) return true;
    using Map37 = Eigen::Map<Eigen::Matrix<double, 3, 7, Eigen::RowMajor>>;
    if (jacobians[0]) {
      Map37 J(jacobians[0]);
      J.setZero();
      J.leftCols<3>() = -per_sigma * (q_j.conjugate() * q_i).toRotationMatrix();
    }
    if (jacobians[1]) {
      Map37 J(jacobians[1]);
      J.setZero();
      J.leftCols<3>() = per_sigma * Matrix3d::Identity();
    }
    if (jacobians[2])
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>{jacobians[2]} =
          -per_sigma * exp_rotation(-error).toRotationMatrix() * gyro_.by_bias;
    return true;
  }

 private:
  GyroRotation gyro_;
  Vector3d bias_;
};

/// Preserves the distance of two poses.
class Length final : public ceres::SizedCostFunction<1, 7, 7> {
 public:
  Length(double length, double relative_sigma) : length_(length), sigma_(relative_sigma) {}
  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    const Vector3d between = Eigen::Map<const Vector3d>(x[1] + 4) - Eigen::Map<const Vector3d>(x[0] + 4);
    const double norm = between.norm(), per_sigma = 1 / (sigma_ * length_);
    residuals[0] = per_sigma * (norm - length_);
    if (!jacobians) return true;
    for (int k = 0; k < 2; ++k)
      if (jacobians[k]) {
        Eigen::Map<Eigen::Matrix<double, 1, 7>> J(jacobians[k]);
        J.setZero();
        J.segment<3>(3) = (k == 0 ? -per_sigma : per_sigma) / norm * between.transpose();
      }
    return true;
  }

 private:
  double length_, sigma_;
};

class BiasPrior final : public ceres::SizedCostFunction<3, 3> {
 public:
  BiasPrior(const Vector3d& bias, double sigma_radps) : bias_(bias), sigma_radps_(sigma_radps) {}
  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    Eigen::Map<Vector3d>{residuals} = (Eigen::Map<const Vector3d>(x[0]) - bias_) / sigma_radps_;
    if (jacobians && jacobians[0]) Eigen::Map<Matrix3d>{jacobians[0]} = Matrix3d::Identity() / sigma_radps_;
    return true;
  }

 private:
  Vector3d bias_;
  double sigma_radps_;
};

}  // namespace odograph::vo::bundle
