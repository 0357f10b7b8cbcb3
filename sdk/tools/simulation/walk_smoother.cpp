// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/walk_smoother.hpp"

#include <Eigen/Cholesky>

#include "sdk/math/gravity.hpp"
#include "sdk/math/rotation_integral.hpp"

namespace odograph {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector15 = Eigen::Matrix<double, 15, 1>;
using Matrix15 = Eigen::Matrix<double, 15, 15>;

enum ErrorIndex { kTheta = 0, kPosition = 3, kVelocity = 6, kGyroBias = 9, kAccelBias = 12 };

double squared(double x) { return x * x; }

/// One filter step, stored for the backward pass.
struct Step {
  Matrix15 transition, covariance,
      predicted_covariance;  // to the next sample; here; there before its pseudo-measurements
  Vector15 error, predicted_error;
};

Vector15 difference(const WalkState& a, const WalkState& b) {
  Vector15 d;
  d << log_rotation(a.q_n_b * b.q_n_b.conjugate()), a.p_n - b.p_n, a.v_n - b.v_n, a.gyro_bias_b - b.gyro_bias_b,
      a.accel_bias_b - b.accel_bias_b;
  return d;
}

void correct(WalkState& x, const Vector15& error) {
  x.q_n_b = (exp_rotation(error.segment<3>(kTheta)) * x.q_n_b).normalized();
  x.p_n += error.segment<3>(kPosition);
  x.v_n += error.segment<3>(kVelocity);
  x.gyro_bias_b += error.segment<3>(kGyroBias);
  x.accel_bias_b += error.segment<3>(kAccelBias);
}

/// Propagates the state from a to b by inertia, with its Jacobian.
WalkState move(const WalkState& x, const InertialSample& a, const InertialSample& b, Matrix15& F) {
  const double dt = b.t_s - a.t_s;
  const Vector3d rotation = (0.5 * (a.gyro_b + b.gyro_b) - x.gyro_bias_b) * dt;
  WalkState next = x;
  const Matrix3d R = rotate_body(next.q_n_b, rotation);
  const Vector3d force_n = R * (0.5 * (a.accel_b + b.accel_b) - x.accel_bias_b);
  const Vector3d accel_n = force_n + Vector3d(0, 0, kStandardGravity_mps2);
  next.p_n += dt * x.v_n + 0.5 * dt * dt * accel_n;
  next.v_n += dt * accel_n;
  F.setIdentity();
  F.block<3, 3>(kTheta, kGyroBias) = -dt * R;
  F.block<3, 3>(kVelocity, kTheta) = -dt * skew(force_n);
  F.block<3, 3>(kVelocity, kAccelBias) = -dt * R;
  F.block<3, 3>(kPosition, kVelocity) = dt * Matrix3d::Identity();
  F.block<3, 3>(kPosition, kTheta) = 0.5 * dt * F.block<3, 3>(kVelocity, kTheta);
  F.block<3, 3>(kPosition, kAccelBias) = 0.5 * dt * F.block<3, 3>(kVelocity, kAccelBias);
  return next;
}

Vector15 noise(const SmootherParameters& p, double dt) {
  Vector15 q;
  q << Vector3d::Constant(squared(p.gyro_noise) * dt), Vector3d::Constant(squared(p.accel_noise) * dt * dt * dt / 3),
      Vector3d::Constant(squared(p.accel_noise) * dt), Vector3d::Constant(squared(p.gyro_walk) * dt),
      Vector3d::Constant(squared(p.accel_walk) * dt);
  return q;
}

/// Updates with a measurement `hint` of three components of the state, `nominal`.
void see(Vector15& error, Matrix15& P, ErrorIndex column, const Vector3d& nominal,
         const PseudoMeasurement::Vector& hint) {
  const Matrix3d S = P.block<3, 3>(column, column) + Matrix3d(hint.sigma.cwiseAbs2().asDiagonal());
  const Eigen::Matrix<double, 15, 3> PH = P.middleCols<3>(column);
  const Eigen::Matrix<double, 15, 3> K = S.llt().solve(PH.transpose()).transpose();
  error += K * (hint.value_n - nominal - error.segment<3>(column));
  P -= K * PH.transpose();
  P = (0.5 * (P + P.transpose())).eval();
}

}  // namespace

std::vector<WalkState> smooth_walk(const std::vector<InertialSample>& samples,
                                   const std::vector<PseudoMeasurement>& measurements, std::vector<WalkState> walk,
                                   const SmootherParameters& p) {
  if (samples.empty()) return walk;
  const WalkState first = walk.front();
  std::vector<Step> steps(samples.size());
  for (int iteration = 0; iteration < p.iterations; ++iteration) {
    Vector15 error = difference(first, walk.front());
    Vector15 sigma;
    sigma << Vector3d(p.tilt_rad, p.tilt_rad, p.heading_rad), Vector3d::Constant(p.start_m),
        Vector3d::Constant(p.start_mps), Vector3d::Constant(p.gyro_bias), Vector3d::Constant(p.accel_bias);
    Matrix15 P = sigma.cwiseAbs2().asDiagonal();
    size_t next_hint = 0;
    for (size_t i = 0; i < samples.size(); ++i) {
      for (; next_hint < measurements.size() && measurements[next_hint].sample <= i; ++next_hint) {
        const PseudoMeasurement& hint = measurements[next_hint];
        if (hint.position) see(error, P, kPosition, walk[i].p_n, *hint.position);
        if (hint.velocity) see(error, P, kVelocity, walk[i].v_n, *hint.velocity);
      }
      Step& step = steps[i];
      step.error = error, step.covariance = P;
      if (i + 1 == samples.size()) break;
      const WalkState moved = move(walk[i], samples[i], samples[i + 1], step.transition);
      error = step.transition * error + difference(moved, walk[i + 1]);
      const Matrix15 moved_P = step.transition * P;
      P = moved_P * step.transition.transpose();
      P.diagonal() += noise(p, samples[i + 1].t_s - samples[i].t_s);
      step.predicted_error = error, step.predicted_covariance = P;
    }
    correct(walk.back(), error);
    for (size_t i = samples.size() - 1; i-- > 0;) {
      const Step& step = steps[i];
      const Vector15 news = step.predicted_covariance.ldlt().solve(error - step.predicted_error);
      error = step.error + step.covariance * step.transition.transpose() * news;
      correct(walk[i], error);
    }
  }
  return walk;
}

}  // namespace odograph
