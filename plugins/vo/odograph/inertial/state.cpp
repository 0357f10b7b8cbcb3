// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/inertial/state.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/rotation.hpp"

namespace odograph::vio {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kMinInverseDepth = 1e-4;  // 1/m: practically at infinity
constexpr double kMaxLeak = 1.4;           // of the log: a factor of four either side

}  // namespace

Vector3d landmark_ray(const Vector3d& at) { return Vector3d(at.x(), at.y(), 1) / at.z(); }

Matrix3d landmark_jacobian(const Vector3d& at) {
  Matrix3d J = Matrix3d::Zero();
  J(0, 0) = J(1, 1) = 1 / at.z();
  J.col(2) = -Vector3d(at.x(), at.y(), 1) / (at.z() * at.z());
  return J;
}

size_t State::find_clone(uint32_t id) const {
  const auto found = std::find_if(clones.begin(), clones.end(), [id](const Clone& c) { return c.id == id; });
  return static_cast<size_t>(found - clones.begin());
}

Vector3d State::point(const Landmark& landmark) const {
  const Clone& anchor = clones[find_clone(landmark.anchor)];
  return anchor.p_w + anchor.q_w_c * landmark_ray(landmark.at);
}

void State::correct(const Eigen::VectorXd& d) {
  const auto turned = [](const Quaterniond& q, const Vector3d& theta) {
    return (exp_rotation(theta) * q).normalized();
  };
  const Vector3d theta = d.segment<3>(block::theta);
  const Quaterniond rotation = exp_rotation(theta);
  const double scale = std::exp(d[block::scale]);
  nav.q_w_b = turned(nav.q_w_b, theta);
  nav.v_w = scale * (rotation * nav.v_w) + d.segment<3>(block::nu);
  nav.p_w = scale * (rotation * nav.p_w) + d.segment<3>(block::rho);
  nav.gyro_bias += d.segment<3>(block::gyro_bias);
  nav.accel_bias += d.segment<3>(block::accel_bias);
  nav.gyro_axes += Eigen::Map<const Matrix3d>(d.data() + block::gyro_axes);
  nav.accel_axes += Eigen::Map<const Matrix3d>(d.data() + block::accel_axes);
  camera.q_b_c = turned(camera.q_b_c, d.segment<3>(block::extrinsics));
  camera.p_b_c += d.segment<3>(block::lever);
  camera.time_offset_s += d[block::time_offset];
  camera.line_time_s += d[block::line_time];
  vio::correct(camera.lens, d.segment<kLensStates>(block::lens));
  camera.shift_px += d.segment<2>(block::shift);
  camera.gain += d[block::gain];
  camera.focus += d[block::focus];
  camera.leak = std::clamp(camera.leak + d[block::leak], -kMaxLeak, kMaxLeak);
  for (size_t i = 0; i < clones.size(); ++i) {
    Clone& c = clones[i];
    const Vector3d theta_c = d.segment<3>(clone_at(i));
    const Quaterniond rotation_c = exp_rotation(theta_c);
    c.q_w_c = turned(c.q_w_c, theta_c);
    c.p_w = scale * (rotation_c * c.p_w) + d.segment<3>(clone_at(i) + 3);
    c.v_w = scale * (rotation_c * c.v_w);
    c.shift_px += d.segment<2>(clone_at(i) + block::clone_shift);
    c.shift_rate_px_s += d[block::gain] * c.drive_px_s;
    c.focal_px *= std::exp(d[clone_at(i) + block::clone_focal]);
  }
  for (size_t j = 0; j < landmarks.size(); ++j) {
    landmarks[j].at.z() /= scale;
    landmarks[j].at += d.segment<3>(landmark_at(j));
    landmarks[j].at.z() = std::max(landmarks[j].at.z(), kMinInverseDepth);
  }
  // The scale error multiplies the present velocity: nu' = nu - d_nu (1 + s'). Otherwise it would multiply the
  // integrated accelerometer signal with its noise, and the scale would come out too long (errors in variables).
  const Vector3d d_nu = d.segment<3>(block::nu);
  P.middleRows<3>(block::nu) -= (d_nu * P.row(block::scale)).eval();
  const Matrix3d own = P.block<3, 3>(block::nu, block::nu) - P.block<3, 1>(block::nu, block::scale) * d_nu.transpose();
  P.block<3, 3>(block::nu, block::nu) = 0.5 * (own + own.transpose());
  P.middleCols<3>(block::nu) = P.middleRows<3>(block::nu).transpose().eval();
}

// The prior is taken back in part: information P^-1 - a e e^T, with the estimate that has never been drawn to its mean.
// Exact for a variable without a random walk; one that has grown beyond its prior is as uncertain as that.
void State::weaken_prior(int variable, double deviation, double sigma, double factor) {
  const double a = (1 - 1 / (factor * factor)) / std::max(sigma * sigma, P(variable, variable));
  const double left = 1 - a * P(variable, variable);
  const Eigen::VectorXd column = P.col(variable);
  P += a / left * column * column.transpose();
  correct(a / left * deviation * column);
}

void State::add_clone(const Clone& clone, const Eigen::Matrix<double, block::clone, block::fixed>& J,
                      const CloneMatrix& noise) {
  constexpr int k = block::clone;
  const int n = size(), at = clone_at(clones.size());
  const Eigen::MatrixXd cross = J * P.topRows<block::fixed>();
  const CloneMatrix own = cross.leftCols<block::fixed>() * J.transpose() + noise;
  Eigen::MatrixXd grown(n + k, n + k);
  const int after = n - at;
  grown.topLeftCorner(at, at) = P.topLeftCorner(at, at);
  grown.bottomLeftCorner(after, at) = P.bottomLeftCorner(after, at);
  grown.topRightCorner(at, after) = P.topRightCorner(at, after);
  grown.bottomRightCorner(after, after) = P.bottomRightCorner(after, after);
  grown.block(at, 0, k, at) = cross.leftCols(at);
  grown.block(at, at + k, k, after) = cross.rightCols(after);
  grown.block(0, at, at, k) = cross.leftCols(at).transpose();
  grown.block(at + k, at, after, k) = cross.rightCols(after).transpose();
  grown.block<k, k>(at, at) = 0.5 * (own + own.transpose());
  P.swap(grown);
  clones.push_back(clone);
}

void State::add_landmark(const Landmark& landmark, const Eigen::MatrixXd& cross, const Matrix3d& covariance) {
  const int n = size();
  P.conservativeResize(n + 3, n + 3);
  P.block(n, 0, 3, n) = cross;
  P.block(0, n, n, 3) = cross.transpose();
  P.block<3, 3>(n, n) = 0.5 * (covariance + covariance.transpose());
  landmarks.push_back(landmark);
}

void State::remove(int from, int count) {
  const int n = size(), after = n - from - count;
  P.block(from, 0, after, n) = P.block(from + count, 0, after, n).eval();
  P.block(0, from, n, after) = P.block(0, from + count, n, after).eval();
  P.conservativeResize(n - count, n - count);
}

void State::remove_clone(size_t i) {
  remove(clone_at(i), block::clone);
  clones.erase(clones.begin() + static_cast<std::ptrdiff_t>(i));
}

void State::remove_landmark(size_t j) {
  remove(landmark_at(j), 3);
  landmarks.erase(landmarks.begin() + static_cast<std::ptrdiff_t>(j));
}

void State::move_anchor(size_t j, size_t to) {
  Landmark& landmark = landmarks[j];
  const size_t from = find_clone(landmark.anchor);
  if (from == to) return;
  const Clone &a = clones[from], &b = clones[to];
  const Vector3d p = point(landmark);
  const Vector3d y = b.q_w_c.conjugate() * (p - b.p_w);
  // Behind or beside the new anchor: the smallest depth that can be represented.
  const double z = std::max(y.z(), 0.05);
  const Vector3d at(y.x() / z, y.y() / z, 1 / z);
  const Matrix3d R_b_w = b.q_w_c.conjugate().toRotationMatrix();
  const Matrix3d to_at = landmark_jacobian(at).inverse();
  const Matrix3d by_theta = to_at * R_b_w * skew(p);
  const Matrix3d by_rho = to_at * R_b_w;
  const Matrix3d by_own = to_at * R_b_w * a.q_w_c.toRotationMatrix() * landmark_jacobian(landmark.at);
  const int f = landmark_at(j), ca = clone_at(from), cb = clone_at(to);
  // delta = R_b' ( rho_a - rho_b + [p] (theta_b - theta_a) + R_a J delta_a )
  const Eigen::MatrixXd rows = by_theta * (P.middleRows<3>(cb) - P.middleRows<3>(ca)) +
                               by_rho * (P.middleRows<3>(ca + 3) - P.middleRows<3>(cb + 3)) +
                               by_own * P.middleRows<3>(f);
  const Matrix3d own = by_theta * (rows.middleCols<3>(cb) - rows.middleCols<3>(ca)).transpose() +
                       by_rho * (rows.middleCols<3>(ca + 3) - rows.middleCols<3>(cb + 3)).transpose() +
                       by_own * rows.middleCols<3>(f).transpose();
  P.middleRows<3>(f) = rows;
  P.middleCols<3>(f) = rows.transpose();
  P.block<3, 3>(f, f) = 0.5 * (own + own.transpose());
  landmark.at = at;
  landmark.anchor = b.id;
}

}  // namespace odograph::vio
