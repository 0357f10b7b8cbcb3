// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/estimator/error_state.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/host/base/rotation.hpp"

namespace odograph::inertial {

static_assert(kLogScale == kVo + 6 && kLogFactor == kLogScale + 1 && kStepHeading == kLogScale + 2,
              "they are held together");

namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Error = Eigen::Matrix<double, kSize, 1>;
using Rows3 = Eigen::Matrix<double, 3, kSize>;

/// Columns of theta, v and p of M F', F being the transition of errors; p first, which needs the old ones.
template <int Rows>
void propagate_columns(Eigen::Matrix<double, Rows, kSize>& M, const ImuTransition& by) {
  using Columns3 = Eigen::Matrix<double, Rows, 3>;
  Columns3 pc = M.template middleCols<3>(kPosition) + by.s * M.template middleCols<3>(kVelocity);
  pc += M.template middleCols<3>(kTheta).lazyProduct(by.p_by_theta.transpose());
  pc += M.template middleCols<3>(kGyroBias).lazyProduct(by.p_by_gyro.transpose());
  pc += M.template middleCols<3>(kAccelBias).lazyProduct(by.p_by_accel.transpose());
  Columns3 vc = M.template middleCols<3>(kVelocity);
  vc += M.template middleCols<3>(kTheta).lazyProduct(by.v_by_theta.transpose());
  vc += M.template middleCols<3>(kGyroBias).lazyProduct(by.v_by_gyro.transpose());
  vc += M.template middleCols<3>(kAccelBias).lazyProduct(by.v_by_accel.transpose());
  M.template middleCols<3>(kTheta) += M.template middleCols<3>(kGyroBias).lazyProduct(by.theta_by_bias.transpose());
  M.template middleCols<3>(kPosition) = pc;
  M.template middleCols<3>(kVelocity) = vc;
}

}  // namespace

std::pair<int, int> held_columns(Hold hold) {
  switch (hold) {
    case Hold::scale_and_factor: return {kLogScale, 2};
    case Hold::scale_and_steps: return {kLogScale, 3};
    case Hold::odometry_and_scale: return {kVo, kMaxHeld};
    default: return {0, 0};
  }
}

void ImuTransition::clear() {
  for (Matrix3d* m : {&theta_by_bias, &v_by_theta, &v_by_gyro, &v_by_accel, &p_by_theta, &p_by_gyro, &p_by_accel})
    m->setZero();
  s = 0;
}

void ImuTransition::add(const Matrix3d& R_n_b, const Vector3d& force_n, double dt_s) {
  const Matrix3d turned = skew(force_n * dt_s), R_dt = R_n_b * dt_s;
  const Matrix3d turned_by_bias = turned * theta_by_bias;
  p_by_theta += dt_s * v_by_theta - 0.5 * dt_s * turned;
  p_by_gyro += dt_s * v_by_gyro - 0.5 * dt_s * turned_by_bias;
  p_by_accel += dt_s * v_by_accel - 0.5 * dt_s * R_dt;
  v_by_theta -= turned;
  v_by_gyro -= turned_by_bias;
  v_by_accel -= R_dt;
  theta_by_bias -= R_dt;
  s += dt_s;
}

void ErrorState::reset() {
  const uint64_t last_held = last_held_;  // whoever asks for what was held before is not to get another
  *this = ErrorState();
  last_held_ = last_held;
}

void ErrorState::propagate(const ImuTransition& by, const ImuNoise& noise) {
  // F P F' with F = I but for the rows of theta, v and p; p first, which needs the old ones.
  Rows3 p = P.middleRows<3>(kPosition) + by.s * P.middleRows<3>(kVelocity);
  p += by.p_by_theta.lazyProduct(P.middleRows<3>(kTheta));
  p += by.p_by_gyro.lazyProduct(P.middleRows<3>(kGyroBias));
  p += by.p_by_accel.lazyProduct(P.middleRows<3>(kAccelBias));
  Rows3 v = P.middleRows<3>(kVelocity);
  v += by.v_by_theta.lazyProduct(P.middleRows<3>(kTheta));
  v += by.v_by_gyro.lazyProduct(P.middleRows<3>(kGyroBias));
  v += by.v_by_accel.lazyProduct(P.middleRows<3>(kAccelBias));
  P.middleRows<3>(kTheta) += by.theta_by_bias.lazyProduct(P.middleRows<3>(kGyroBias));
  P.middleRows<3>(kPosition) = p;
  P.middleRows<3>(kVelocity) = v;
  propagate_columns(P, by);
  for (auto& held : held_) propagate_columns(held.cross, by);

  add_variance(kTheta, 3, noise.gyro * by.s);
  for (int i = 0; i < 3; ++i) {
    const double accel = i < 2 ? noise.accel : noise.accel_down;
    P(kVelocity + i, kVelocity + i) += accel * by.s;
    P(kPosition + i, kPosition + i) += accel * by.s * by.s * by.s / 3;
    P(kPosition + i, kVelocity + i) += accel * by.s * by.s / 2;
    P(kVelocity + i, kPosition + i) += accel * by.s * by.s / 2;
  }
  add_variance(kGyroBias, 3, noise.gyro_walk * by.s);
  add_variance(kAccelBias, 3, noise.accel_walk * by.s);
}

void ErrorState::copy_pose_block(int from, int to) {
  P.middleRows<6>(to) = P.middleRows<6>(from).eval();
  P.middleCols<6>(to) = P.middleCols<6>(from).eval();
  for (auto& held : held_) held.cross.middleCols<6>(to) = held.cross.middleCols<6>(from).eval();
}

void ErrorState::clone(int64_t t_ns) {
  newest_ = (newest_ + 1) % kClones;
  clone_count_ = std::min<size_t>(clone_count_ + 1, kClones);
  clones_[newest_] = {t_ns, x.q_n_b, x.p_n};
  copy_pose_block(kTheta, column_back(0));
}

void ErrorState::attach_vo(const PastPose& at, const Quaterniond& q_b_c, const Vector3d& p_b_c,
                           double position_variance, double rotation_variance) {
  const Vector3d lever_n = at.q_n_b * p_b_c;
  x.q_n_vo = (at.q_n_b * q_b_c).normalized();
  x.p_n_vo = at.p_n + lever_n;
  const Matrix3d by_theta = -skew(lever_n);
  Eigen::Matrix<double, 6, kSize> rows = (1 - at.w) * P.middleRows<6>(at.before) + at.w * P.middleRows<6>(at.after);
  rows.bottomRows<3>() += by_theta.lazyProduct(rows.topRows<3>()).eval();
  Eigen::Matrix<double, 6, 6> own = (1 - at.w) * rows.middleCols<6>(at.before) + at.w * rows.middleCols<6>(at.after);
  own.rightCols<3>() += own.leftCols<3>().lazyProduct(by_theta.transpose()).eval();
  P.middleRows<6>(kVo) = rows;
  P.middleCols<6>(kVo) = rows.transpose();
  P.block<6, 6>(kVo, kVo) = 0.5 * (own + own.transpose());
  add_variance(kVo, 3, rotation_variance);
  add_variance(kVoPosition, 3, position_variance);
  for (auto& held : held_) {
    held.cross.middleCols<6>(kVo) =
        ((1 - at.w) * held.cross.middleCols<6>(at.before) + at.w * held.cross.middleCols<6>(at.after)).eval();
    held.cross.middleCols<3>(kVoPosition) += held.cross.middleCols<3>(kVo).lazyProduct(by_theta.transpose());
  }
}

void ErrorState::move_vo(const Quaterniond& q_c0_c1, const Vector3d& p_c0_c1, const Vector3d& expected_n,
                         double position_variance, double rotation_variance) {
  const Vector3d d_n = std::exp(x.log_scale) * (x.q_n_vo * p_c0_c1);
  const Matrix3d by_theta = -skew(expected_n);
  P.middleRows<3>(kVoPosition) += (expected_n * P.row(kLogScale) + by_theta.lazyProduct(P.middleRows<3>(kVo))).eval();
  P.middleCols<3>(kVoPosition) +=
      (P.col(kLogScale) * expected_n.transpose() + P.middleCols<3>(kVo).lazyProduct(by_theta.transpose())).eval();
  for (auto& held : held_)
    held.cross.middleCols<3>(kVoPosition) += held.cross.col(kLogScale) * expected_n.transpose() +
                                             held.cross.middleCols<3>(kVo).lazyProduct(by_theta.transpose());
  add_variance(kVo, 3, rotation_variance);
  add_variance(kVoPosition, 3, position_variance);
  x.p_n_vo += d_n;
  x.q_n_vo = (x.q_n_vo * q_c0_c1).normalized();
}

void ErrorState::place(const Vector3d& shift_n, const Vector3d& displacement_n, const Vector3d& v_n,
                       double position_variance, double velocity_variance) {
  x.p_n += shift_n;
  x.v_n = v_n;
  for (int i = 0; i < 3; ++i) {
    set_independent(kPosition + i, 0);
    set_independent(kVelocity + i, velocity_variance);
  }
  // Both err by the scale's error, and so with whatever the scale's error goes with.
  const Eigen::Matrix<double, 1, kSize> scale = P.row(kLogScale);
  const double scale_variance = P(kLogScale, kLogScale);
  const auto follows = [&](int at, const Vector3d& by_scale) {
    P.middleRows<3>(at) += by_scale * scale;
    P.middleCols<3>(at) += scale.transpose() * by_scale.transpose();
    for (auto& held : held_) held.cross.middleCols<3>(at) += held.cross.col(kLogScale) * by_scale.transpose();
  };
  follows(kPosition, displacement_n);
  follows(kVelocity, v_n);
  P.block<3, 3>(kPosition, kPosition) += scale_variance * displacement_n * displacement_n.transpose();
  P.block<3, 3>(kVelocity, kVelocity) += scale_variance * v_n * v_n.transpose();
  P.block<3, 3>(kPosition, kVelocity) += scale_variance * displacement_n * v_n.transpose();
  P.block<3, 3>(kVelocity, kPosition) += scale_variance * v_n * displacement_n.transpose();
  loosen_position(Matrix3d::Identity() * position_variance);
}

void ErrorState::set_scale(double log_scale, double variance, double factor_share) {
  x.log_scale = log_scale;
  const double own = std::max(0.0, variance - factor_share * factor_share * P(kLogFactor, kLogFactor));
  P.row(kLogScale) = factor_share * P.row(kLogFactor).eval();
  P.col(kLogScale) = P.row(kLogScale).transpose();
  P(kLogScale, kLogScale) = factor_share * factor_share * P(kLogFactor, kLogFactor) + own;
  for (auto& held : held_) held.cross.col(kLogScale) = factor_share * held.cross.col(kLogFactor).eval();
}

void ErrorState::wander(int at, double decay, double variance) {
  P.row(at) *= decay;
  P.col(at) *= decay;
  P(at, at) += variance;
  for (auto& held : held_) held.cross.col(at) *= decay;
}

void ErrorState::set_independent(int at, double variance) {
  P.row(at).setZero();
  P.col(at).setZero();
  P(at, at) = variance;
  for (auto& held : held_) held.cross.col(at).setZero();
}

void ErrorState::shift(const Vector3d& by_n) {
  x.p_n += by_n;
  x.p_n_vo += by_n;
  for (size_t i = 0; i < clone_count_; ++i) clones_[slot_back(i)].p_n += by_n;
}

namespace {

/// Where the positions of the body, the odometry and the clones stand.
constexpr std::array<int, kClones + 2> position_columns() {
  std::array<int, kClones + 2> columns{kPosition, kVoPosition};
  for (int i = 0; i < kClones; ++i) columns[static_cast<size_t>(i) + 2] = kFirstClone + 6 * i + 3;
  return columns;
}

}  // namespace

void ErrorState::loosen_position(const Matrix3d& covariance) {
  for (const int a : position_columns())
    for (const int b : position_columns()) P.block<3, 3>(a, b) += covariance;
}

void ErrorState::shift_by_step(const Vector3d& by_n, const Vector3d& by_factor, const Vector3d& by_heading,
                               const Matrix3d& noise) {
  shift(by_n);
  const Rows3 rows = by_factor * P.row(kLogFactor) + by_heading * P.row(kStepHeading);
  for (const int a : position_columns()) P.middleRows<3>(a) += rows;
  const Eigen::Matrix<double, kSize, 3> columns =
      P.col(kLogFactor) * by_factor.transpose() + P.col(kStepHeading) * by_heading.transpose();
  for (const int a : position_columns()) P.middleCols<3>(a) += columns;
  for (auto& held : held_) {
    const Eigen::Matrix<double, 6, 3> of_held =
        held.cross.col(kLogFactor) * by_factor.transpose() + held.cross.col(kStepHeading) * by_heading.transpose();
    for (const int a : position_columns()) held.cross.middleCols<3>(a) += of_held;
  }
  loosen_position(noise);
}

void ErrorState::rotate(const Quaterniond& q, const Vector3d& about_n) {
  const Matrix3d R = q.toRotationMatrix();
  const auto turned = [&](const Quaterniond& a) { return (q * a).normalized(); };
  const auto moved = [&](const Vector3d& p) { return Vector3d(about_n + R * (p - about_n)); };
  x.q_n_b = turned(x.q_n_b), x.q_n_vo = turned(x.q_n_vo);
  x.p_n = moved(x.p_n), x.p_n_vo = moved(x.p_n_vo);
  x.v_n = (R * x.v_n).eval();
  for (size_t i = 0; i < clone_count_; ++i) {
    Clone& clone = clones_[slot_back(i)];
    clone.q_n_b = turned(clone.q_n_b), clone.p_n = moved(clone.p_n);
  }
  std::array<int, 2 * kClones + 5> in_n = {kTheta, kPosition, kVelocity, kVo, kVoPosition};
  for (int i = 0; i < 2 * kClones; ++i) in_n[static_cast<size_t>(i) + 5] = kFirstClone + 3 * i;
  for (const int at : in_n) P.middleRows<3>(at) = (R * P.middleRows<3>(at)).eval();
  for (const int at : in_n) P.middleCols<3>(at) = (P.middleCols<3>(at) * R.transpose()).eval();
  for (auto& held : held_) {
    held.q_n_b = turned(held.q_n_b), held.p_n = moved(held.p_n);
    for (const int row : {0, 3}) held.cross.middleRows<3>(row) = (R * held.cross.middleRows<3>(row)).eval();
    for (const int at : in_n) held.cross.middleCols<3>(at) = (held.cross.middleCols<3>(at) * R.transpose()).eval();
    for (const int row : {0, 3}) held.own.middleRows<3>(row) = (R * held.own.middleRows<3>(row)).eval();
    for (const int col : {0, 3}) held.own.middleCols<3>(col) = (held.own.middleCols<3>(col) * R.transpose()).eval();
  }
}

void ErrorState::loosen_heading(double sigma_rad) {
  Error common = Error::Zero();
  const auto turned = [&](const Vector3d& v) { return Vector3d(sigma_rad * Vector3d::UnitZ().cross(v)); };
  common[kTheta + 2] = common[kVo + 2] = sigma_rad;
  common.segment<3>(kVelocity) = turned(x.v_n);
  common.segment<3>(kVoPosition) = turned(x.p_n_vo - x.p_n);
  common[kNorth] = -sigma_rad;  // the attitude source stays
  common[kStepHeading] = sigma_rad;
  for (size_t i = 0; i < clone_count_; ++i) {
    common[column_back(i) + 2] = sigma_rad;
    common.segment<3>(column_back(i) + 3) = turned(clone_back(i).p_n - x.p_n);
  }
  for (int j = 0; j < kSize; ++j)
    if (common[j] != 0) P.col(j) += common * common[j];
  for (auto& held : held_) {
    Eigen::Matrix<double, 6, 1> of_held = Eigen::Matrix<double, 6, 1>::Zero();
    of_held[2] = sigma_rad;
    of_held.tail<3>() = turned(held.p_n - x.p_n);
    held.cross += of_held * common.transpose();
    held.own += of_held * of_held.transpose();
  }
}

void ErrorState::loosen_velocity_since(int64_t t_ns, int64_t now_ns, double sigma_mps) {
  std::array<std::pair<int, double>, kClones + 2> moved;
  size_t count = 0;
  const auto since = [&](int64_t to_ns) { return static_cast<double>(to_ns - t_ns) * 1e-9 * sigma_mps; };
  if (t_ns >= now_ns) return;
  moved[count++] = {kVelocity, sigma_mps};
  moved[count++] = {kPosition, since(now_ns)};
  for (size_t i = 0; i < clone_count_ && clone_back(i).t_ns > t_ns; ++i)
    moved[count++] = {column_back(i) + 3, since(clone_back(i).t_ns)};
  for (size_t a = 0; a < count; ++a)
    for (size_t b = 0; b < count; ++b)
      for (int axis = 0; axis < 2; ++axis)
        P(moved[a].first + axis, moved[b].first + axis) += moved[a].second * moved[b].second;
  for (auto& held : held_) {
    if (held.t_ns <= t_ns) continue;
    const double of_held = since(held.t_ns);
    for (int axis = 0; axis < 2; ++axis) {
      for (size_t b = 0; b < count; ++b) held.cross(3 + axis, moved[b].first + axis) += of_held * moved[b].second;
      held.own(3 + axis, 3 + axis) += of_held * of_held;
    }
  }
}

Eigen::Matrix<double, 6, 6> ErrorState::covariance(const PastPose& at) const {
  const double u = 1 - at.w;
  if (u == 0 || at.before == at.after) return P.block<6, 6>(at.after, at.after);
  const Eigen::Matrix<double, 6, 6> cross = P.block<6, 6>(at.before, at.after);
  return u * u * P.block<6, 6>(at.before, at.before) + at.w * at.w * P.block<6, 6>(at.after, at.after) +
         u * at.w * (cross + cross.transpose());
}

}  // namespace odograph::inertial
