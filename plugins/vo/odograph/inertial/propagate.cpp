// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/inertial/propagate.hpp"

#include <cmath>

#include "sdk/math/rotation_integral.hpp"

namespace odograph::vio {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Matrix15d = Eigen::Matrix<double, block::navigation, block::navigation>;

double squared(double x) { return x * x; }

/// One integration step with the mid-point rate and specific force. Returns the mid-point orientation.
Matrix3d step(Navigation& nav, const ImuSample& from, const ImuSample& to, double dt, double gravity) {
  const Vector3d rate = nav.rate(0.5 * (from.gyro_b + to.gyro_b));
  const Vector3d force = nav.force(0.5 * (from.accel_b + to.accel_b));
  const Matrix3d R = rotate_body(nav.q_w_b, dt * rate);
  const Vector3d a = R * force + Vector3d(0, 0, gravity);
  nav.p_w += nav.v_w * dt + 0.5 * dt * dt * a;
  nav.v_w += dt * a;
  return R;
}

/// Propagates a first-order Gauss-Markov state of standard deviation sigma; `stays` = exp(-dt / correlation time).
void apply_gauss_markov(double& value, Eigen::MatrixXd& P, int at, double stays, double sigma) {
  value *= stays;
  P.row(at) *= stays, P.col(at) *= stays;
  P(at, at) += (1 - stays * stays) * sigma * sigma;
}

/// Rate of the shift of a lens that compensates the whole rotation, px/s.
Vector2d drive_of(double focal_px, const Vector3d& rate_c) { return focal_px * Vector2d(rate_c.y(), -rate_c.x()); }

/// Transition over several samples: of the navigation errors by themselves and by the sensor-axis errors, and the
/// noise.
struct Transition {
  Matrix15d Phi = Matrix15d::Identity();
  Eigen::Matrix<double, block::navigation, block::axes> Psi =
      Eigen::Matrix<double, block::navigation, block::axes>::Zero();
  Eigen::Matrix<double, block::navigation, 1> by_scale = Eigen::Matrix<double, block::navigation, 1>::Zero();
  Matrix15d Q = Matrix15d::Zero();
  double gyro_noise = 0, accel_noise = 0;  ///< densities, vibration included

  /// Propagates `nav` from one sample to the next.
  void add(Navigation& nav, const ImuSample& a, const ImuSample& b, const FilterParameters& p) {
    const double dt = seconds(b.t_ns - a.t_ns);
    const Vector3d v = nav.v_w, x = nav.p_w;
    const Matrix3d R = step(nav, a, b, dt, p.gravity_mps2);
    const Matrix3d vR = skew(0.5 * (v + nav.v_w)) * R, xR = skew(0.5 * (x + nav.p_w)) * R;
    Matrix15d F = Matrix15d::Zero();
    Eigen::Matrix<double, 9, 3> by_gyro;
    by_gyro << R, vR, xR;
    const Matrix3d R_accel = R * nav.accel_axes;
    F.block<9, 3>(0, block::gyro_bias) = -by_gyro * nav.gyro_axes;
    F.block<3, 3>(block::nu, block::theta) = skew(Vector3d(0, 0, p.gravity_mps2));
    F.block<3, 3>(block::nu, block::accel_bias) = -R_accel;
    F.block<3, 3>(block::rho, block::nu).setIdentity();
    const Matrix15d A = Matrix15d::Identity() + dt * F + (0.5 * dt * dt) * F * F;
    Phi = A * Phi;
    const Vector3d gyro_b = 0.5 * (a.gyro_b + b.gyro_b) - nav.gyro_bias;
    const Vector3d accel_b = 0.5 * (a.accel_b + b.accel_b) - nav.accel_bias;
    Psi = (A * Psi).eval();
    for (int k = 0; k < 3; ++k) {
      Psi.block<9, 3>(0, 3 * k) += dt * gyro_b[k] * by_gyro;
      Psi.block<3, 3>(block::nu, 9 + 3 * k) += dt * accel_b[k] * R;
      Psi.block<3, 3>(block::rho, 9 + 3 * k) += 0.5 * dt * dt * accel_b[k] * R;
    }
    // Quantities measured in metres do not change with the scale.
    by_scale = (A * by_scale).eval();
    by_scale.segment<3>(block::nu) -= nav.v_w - v;
    by_scale.segment<3>(block::rho) -= 0.5 * dt * (nav.v_w - v);
    const Matrix15d AQ = A * Q;
    Q = AQ * A.transpose();
    const double rate = gyro_b.norm();
    const double acceleration = dt > 0 ? (nav.v_w - v).norm() / dt : 0;
    const double gyro = squared(gyro_noise) + squared(p.noise.gyro_by_rate * rate);
    const double accel = squared(accel_noise) + squared(p.noise.accel_by_motion * acceleration);
    Q.topLeftCorner<9, 9>() += gyro * dt * by_gyro * by_gyro.transpose();
    Q.block<3, 3>(block::nu, block::nu).diagonal().array() += accel * dt;
    Q.block<3, 3>(block::gyro_bias, block::gyro_bias).diagonal().array() += squared(p.noise.gyro_walk) * dt;
    Q.block<3, 3>(block::accel_bias, block::accel_bias).diagonal().array() += squared(p.noise.accel_walk) * dt;
  }
};

}  // namespace

bool integrate(Navigation& nav, int64_t from_ns, int64_t to_ns, const ImuBuffer& imu, double gravity) {
  if (from_ns <= to_ns)
    return imu.for_each(from_ns, to_ns, ImuBuffer::kLongestGap_ns, [&](const ImuSample& a, const ImuSample& b) {
      step(nav, a, b, seconds(b.t_ns - a.t_ns), gravity);
    });
  std::vector<std::pair<ImuSample, ImuSample>> stretches;
  const bool whole = imu.for_each(to_ns, from_ns, ImuBuffer::kLongestGap_ns,
                                  [&](const ImuSample& a, const ImuSample& b) { stretches.emplace_back(a, b); });
  for (auto it = stretches.rbegin(); it != stretches.rend(); ++it)
    step(nav, it->second, it->first, seconds(it->first.t_ns - it->second.t_ns), gravity);
  return whole;
}

/// Propagates the shift of the stabilised lens to `to_ns`, with its covariance.
void shift_lens(State& state, int64_t to_ns, const ImuBuffer& imu, const FilterParameters& p) {
  const StabiliserParameters& s = p.stabiliser;
  Camera& camera = state.camera;
  const Matrix3d R_c_b = camera.q_b_c.conjugate().toRotationMatrix();
  double noise = 0;
  Eigen::Matrix2d keep = Eigen::Matrix2d::Identity();
  Vector2d by_gain = Vector2d::Zero(), by_leak = Vector2d::Zero();
  const double likely = camera.gain * camera.gain + state.P(block::gain, block::gain);
  const double more = std::exp(camera.leak);
  imu.for_each(state.t_ns, to_ns, ImuBuffer::kLongestGap_ns, [&](const ImuSample& a, const ImuSample& b) {
    const double dt = seconds(b.t_ns - a.t_ns), focal = camera.lens.focal();
    const double leak = more * s.leak(camera.shift_px.norm(), focal), decay = 1 / (1 + dt * leak);
    const Vector2d by_shift = more * s.leak_change(camera.shift_px, focal);
    const Vector2d drive = drive_of(focal, R_c_b * state.nav.rate(0.5 * (a.gyro_b + b.gyro_b)));
    camera.shift_px = decay * (camera.shift_px + dt * camera.gain * drive);
    const Eigen::Matrix2d step = decay * (Eigen::Matrix2d::Identity() - dt * camera.shift_px * by_shift.transpose());
    by_gain = step * by_gain + decay * dt * drive;
    by_leak = step * by_leak - decay * dt * leak * camera.shift_px;
    noise = decay * decay * (noise + s.drive_error * s.drive_error * likely * drive.squaredNorm() * s.error_s * dt);
    keep = (step * keep).eval();
  });
  auto& P = state.P;
  const double dt_s = seconds(to_ns - state.t_ns), stays = std::exp(-dt_s / s.leak_change_s);
  P.middleRows<2>(block::shift) =
      (keep * P.middleRows<2>(block::shift) + by_gain * P.row(block::gain) + by_leak * P.row(block::leak)).eval();
  P.middleCols<2>(block::shift) = (P.middleCols<2>(block::shift) * keep.transpose() +
                                   P.col(block::gain) * by_gain.transpose() + P.col(block::leak) * by_leak.transpose())
                                      .eval();
  P.block<2, 2>(block::shift, block::shift).diagonal().array() += noise;
  P(block::gain, block::gain) += s.gain_walk * s.gain_walk * likely * dt_s;
  apply_gauss_markov(camera.leak, P, block::leak, stays, s.leak_sigma);
}

Vector2d predict_lens_shift(const State& state, int64_t to_ns, const ImuBuffer& imu, const FilterParameters& p) {
  State moved;
  moved.t_ns = state.t_ns, moved.nav = state.nav, moved.camera = state.camera;
  moved.P = Eigen::MatrixXd::Zero(block::fixed, block::fixed);
  shift_lens(moved, to_ns, imu, p);
  return moved.camera.shift_px - state.camera.shift_px;
}

bool propagate(State& state, int64_t to_ns, const ImuBuffer& imu, const FilterParameters& p) {
  const ImuBuffer::Roughness rough = imu.roughness(to_ns, p.noise.vibration_s);
  const auto vibration = [&](double seen, double part) {
    return seen * p.noise.part_of_vibration(rough.rate_hz, part);
  };
  Transition transition;
  transition.gyro_noise = std::hypot(p.noise.gyro, vibration(rough.gyro, p.noise.gyro_vibration_part));
  transition.accel_noise = std::hypot(p.noise.accel, vibration(rough.accel, p.noise.accel_vibration_part));
  const bool whole =
      imu.for_each(state.t_ns, to_ns, ImuBuffer::kLongestGap_ns,
                   [&](const ImuSample& from, const ImuSample& to) { transition.add(state.nav, from, to, p); });
  const Matrix15d &Phi = transition.Phi, &Q = transition.Q;
  const auto& Psi = transition.Psi;
  const int n = state.size(), rest = n - block::navigation;
  auto& P = state.P;
  shift_lens(state, to_ns, imu, p);
  const Eigen::MatrixXd moved = Phi * P.topRows<block::navigation>() +
                                Psi * P.middleRows<block::axes>(block::gyro_axes) +
                                transition.by_scale * P.row(block::scale);
  const Matrix15d own = moved.leftCols<block::navigation>() * Phi.transpose() +
                        moved.middleCols<block::axes>(block::gyro_axes) * Psi.transpose() +
                        moved.col(block::scale) * transition.by_scale.transpose() + Q;
  P.topLeftCorner<block::navigation, block::navigation>() = 0.5 * (own + own.transpose());
  P.topRightCorner(block::navigation, rest) = moved.rightCols(rest);
  P.bottomLeftCorner(rest, block::navigation) = moved.rightCols(rest).transpose();
  const double dt = seconds(to_ns - state.t_ns);
  P(block::lens, block::lens) += squared(p.focal_walk) * dt;
  apply_gauss_markov(state.camera.focus, P, block::focus, std::exp(-dt / p.focus_change_s), p.focus_sigma);
  P(block::lens + 1, block::lens + 1) += squared(p.centre_walk_px) * dt;
  P(block::lens + 2, block::lens + 2) += squared(p.centre_walk_px) * dt;
  if (!whole) {
    P.block<3, 3>(block::nu, block::nu).diagonal().array() += squared(p.noise.gap_mps2 * dt);
    P.block<3, 3>(block::rho, block::rho).diagonal().array() += squared(0.5 * p.noise.gap_mps2 * dt * dt);
  }
  state.t_ns = to_ns;
  return whole;
}

void augment(State& state, uint32_t id, int64_t frame_ns, const ImuBuffer& imu, const FilterParameters& p) {
  const Navigation& nav = state.nav;
  const Matrix3d R = nav.q_w_b.toRotationMatrix();
  const auto half_ns = nanoseconds(p.rate_change_s);
  const ImuSample before = imu.at(state.t_ns - half_ns), now = imu.at(state.t_ns), after = imu.at(state.t_ns + half_ns);
  const Vector3d rate = nav.rate(now.gyro_b);
  const Eigen::Quaterniond q_c_b = state.camera.q_b_c.conjugate();
  Clone clone;
  clone.id = id, clone.frame_ns = frame_ns;
  clone.q_w_c = (nav.q_w_b * state.camera.q_b_c).normalized();
  clone.p_w = nav.p_w + R * state.camera.p_b_c;
  clone.rate_c = q_c_b * rate;
  clone.rate_change_c = q_c_b * (nav.gyro_axes * (after.gyro_b - before.gyro_b)) / (2 * p.rate_change_s);
  clone.v_w = nav.v_w + R * rate.cross(state.camera.p_b_c);
  clone.a_w =
      R * nav.force(0.25 * before.accel_b + 0.5 * now.accel_b + 0.25 * after.accel_b) + Vector3d(0, 0, p.gravity_mps2);
  clone.drive_px_s = drive_of(state.camera.lens.focal(), clone.rate_c);
  clone.shift_px = state.camera.shift_px;
  clone.focal_px = state.camera.focal_px();
  clone.shift_rate_px_s = state.camera.gain * clone.drive_px_s -
                          std::exp(state.camera.leak) *
                              p.stabiliser.leak(state.camera.shift_px.norm(), state.camera.lens.focal()) *
                              state.camera.shift_px;
  using Jacobian = Eigen::Matrix<double, block::clone, block::fixed>;
  Jacobian J = Jacobian::Zero();
  const Matrix3d x = skew(clone.p_w);
  J.block<3, 3>(0, block::theta).setIdentity();
  J.block<3, 3>(0, block::extrinsics) = R;
  J.block<3, 1>(0, block::time_offset) = R * rate;
  J.block<3, 3>(3, block::rho).setIdentity();
  J.block<3, 3>(3, block::extrinsics) = x * R;
  J.block<3, 3>(3, block::lever) = R;
  J.block<3, 1>(3, block::scale) = -R * state.camera.p_b_c;  // the lever arm is in metres
  J.block<3, 1>(3, block::time_offset) = clone.v_w + x * R * rate;
  // The jitter rotates the camera in place: theta, and the rho that leaves p = Exp(theta) p_est + rho unchanged.
  Eigen::Matrix<double, 6, 3> by_jitter;
  by_jitter << Matrix3d::Identity(), x;
  J.block<2, 2>(block::clone_shift, block::shift).setIdentity();
  J(block::clone_focal, block::lens) = J(block::clone_focal, block::focus) = 1;
  J.block<2, 1>(block::clone_shift, block::time_offset) = clone.shift_rate_px_s;
  State::CloneMatrix noise = State::CloneMatrix::Zero();
  noise.topLeftCorner<6, 6>() = p.rotation_jitter_rad * p.rotation_jitter_rad * by_jitter * by_jitter.transpose();
  state.add_clone(clone, J, noise);
}

}  // namespace odograph::vio
