// SPDX-License-Identifier: Apache-2.0
//
// The Kalman update: plain, with parameters that are held, or of few alone.
#include <Eigen/Cholesky>

#include "sdk/host/base/rotation.hpp"
#include "sdk/host/estimator/error_state.hpp"

namespace odograph::inertial {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Error = Eigen::Matrix<double, kSize, 1>;

void ErrorState::apply(const Error& error) {
  const auto rotate = [&](Quaterniond& q, int at) { q = (exp_rotation(error.segment<3>(at)) * q).normalized(); };
  const auto moved = [&](int at, int turned_at) -> Vector3d {
    if (!turning_) return error.segment<3>(at);
    return left_jacobian(error.segment<3>(turned_at)) * error.segment<3>(at);
  };
  rotate(x.q_n_b, kTheta);
  x.p_n += moved(kPosition, kTheta);
  x.v_n += moved(kVelocity, kTheta);
  x.gyro_bias_b += error.segment<3>(kGyroBias);
  x.accel_bias_b += error.segment<3>(kAccelBias);
  rotate(x.q_n_vo, kVo);
  x.p_n_vo += moved(kVoPosition, kVo);
  x.log_scale += error[kLogScale];
  x.log_factor += error[kLogFactor];
  x.step_heading_rad += error[kStepHeading];
  x.north_rad += error[kNorth];
  x.baro_m += error[kBaro];
  for (size_t i = 0; i < clone_count_; ++i) {
    Clone& clone = clones_[slot_back(i)];
    rotate(clone.q_n_b, column_back(i));
    clone.p_n += moved(column_back(i) + 3, column_back(i));
  }
}

/// The gain is that of a filter that knows what is held, so that what errs by it is not moved in its stead: with
/// a = P's columns of that, G = a P_hh^-1 and B = H a,
///   K = (P H' - G B') (S - B P_hh^-1 B')^-1,   P <- P - K N' - N K',   N = K (S - 2 B P_hh^-1 B') / 2 + G B'.
template <int D>
bool ErrorState::update_given(const Innovation<D>& innovation, Hold hold, const Eigen::Matrix<double, kSize, D>& PHt,
                              const Eigen::Matrix<double, D, D>& S) {
  const auto [first, held] = held_columns(hold);
  using MatrixH = Eigen::Matrix<double, kMaxHeld, kMaxHeld>;
  using SquareD = Eigen::Matrix<double, D, D>;
  MatrixH P_hh = MatrixH::Identity();  // what is not held: independent, and without effect
  Eigen::Matrix<double, kMaxHeld, D> Bt = Eigen::Matrix<double, kMaxHeld, D>::Zero();
  P_hh.topLeftCorner(held, held) = P.block(first, first, held, held);
  for (int i = 0; i < held; ++i) Bt.row(i) = PHt.row(first + i);
  const Eigen::LLT<MatrixH> hh(P_hh);
  if (hh.info() != Eigen::Success) return false;
  Gain<D> gain;
  gain.first = first, gain.count = held;
  gain.known = hh.solve(Bt);
  const auto& known = gain.known;
  const SquareD by_held = Bt.transpose() * known;
  const SquareD given = 0.5 * (S + S.transpose()) - by_held;
  const Eigen::LLT<SquareD> llt(given);
  if (llt.info() != Eigen::Success) return false;
  gain.inverse = llt.solve(SquareD(SquareD::Identity()));
  gain.half = 0.5 * (S - 2 * by_held);
  auto &K = gain.K, &N = gain.N;
  Error moved;
  for (int i = 0; i < kSize; ++i) {
    Eigen::Matrix<double, 1, D> GBt = Eigen::Matrix<double, 1, D>::Zero();
    for (int h = 0; h < held; ++h) GBt += P(i, first + h) * known.row(h);
    Eigen::Matrix<double, 1, D> k = (PHt.row(i) - GBt) * gain.inverse;
    if (i >= first && i < first + held) k.setZero();
    K.row(i) = k;
    N.row(i) = k * gain.half + GBt;
    moved[i] = k.dot(innovation.residual);
  }
  for (int j = 0; j < kSize; ++j) {
    for (int d = 0; d < D; ++d) {
      const double n = N(j, d), k = K(j, d);
      P.col(j).tail(kSize - j) -= K.col(d).tail(kSize - j) * n;
      P.col(j).tail(kSize - j) -= N.col(d).tail(kSize - j) * k;
    }
    P.row(j).tail(kSize - j) = P.col(j).tail(kSize - j).transpose();
  }
  // That the body follows an odometry that leads says nothing of where it was long ago.
  update_held(innovation, gain, hold != Hold::odometry_and_scale);
  apply(moved);
  return true;
}

template <int D>
UpdateResult ErrorState::update(const Innovation<D>& innovation, double max_nis, Hold hold) {
  Eigen::Matrix<double, kSize, D> PHt = Eigen::Matrix<double, kSize, D>::Zero();
  Eigen::Matrix<double, D, D> S = innovation.noise;
  for (int i = 0; i < innovation.count; ++i) {
    const auto& part = innovation.parts[static_cast<size_t>(i)];
    for (int c = 0; c < part.width; ++c)
      for (int d = 0; d < D; ++d)
        if (part.by(d, c) != 0) PHt.col(d) += P.col(part.at + c) * part.by(d, c);
  }
  for (int i = 0; i < innovation.count; ++i) {
    const auto& part = innovation.parts[static_cast<size_t>(i)];
    for (int c = 0; c < part.width; ++c) S.noalias() += part.by.col(c) * PHt.row(part.at + c);
  }
  const Eigen::LLT<Eigen::Matrix<double, D, D>> llt(0.5 * (S + S.transpose()));
  if (llt.info() != Eigen::Success) return {false, 0.0, D};
  const double nis = innovation.residual.dot(llt.solve(innovation.residual));
  if (!(nis >= 0) || (max_nis > 0 && nis > max_nis)) return {false, nis, D};

  if (held_columns(hold).second > 0)
    return update_given(innovation, hold, PHt, S) ? UpdateResult{true, nis, D} : UpdateResult{false, nis, D};
  const Error error = PHt.lazyProduct(llt.solve(innovation.residual));
  const Eigen::Matrix<double, D, D> L_inverse = llt.matrixL().solve(Eigen::Matrix<double, D, D>::Identity().eval());
  const Eigen::Matrix<double, kSize, D> W = PHt.lazyProduct(L_inverse.transpose());
  if (hold == Hold::nothing) {
    if (!held_.empty()) {
      Gain<D> gain;
      gain.inverse = llt.solve(Eigen::Matrix<double, D, D>::Identity().eval());
      gain.half = 0.5 * S;
      gain.K = PHt * gain.inverse;
      gain.N = 0.5 * PHt;
      update_held(innovation, gain, true);
    }
    for (int j = 0; j < kSize; ++j) {
      for (int d = 0; d < D; ++d)
        if (W(j, d) != 0) P.col(j).tail(kSize - j) -= W.col(d).tail(kSize - j) * W(j, d);
      P.row(j).tail(kSize - j) = P.col(j).tail(kSize - j).transpose();
    }
    apply(error);
    return {true, nis, D};
  }
  const int first = hold == Hold::all_but_steps ? kLogFactor : kLogScale;
  Error few = Error::Zero();
  for (int j = first; j <= kStepHeading; ++j) {
    for (int d = 0; d < D; ++d) P.col(j) -= W.col(d) * W(j, d);
    few[j] = error[j];
  }
  for (int j = first; j <= kStepHeading; ++j) P.row(j) = P.col(j).transpose();
  for (auto& held : held_) {
    const Eigen::Matrix<double, 6, D> of_held = held.by(innovation) * L_inverse.transpose();
    for (int j = first; j <= kStepHeading; ++j) held.cross.col(j) -= of_held * W.row(j).transpose();
  }
  apply(few);
  return {true, nis, D};
}

UpdateResult ErrorState::update_heading(const Innovation<1>& heading, double max_nis) {
  turning_ = true;
  const UpdateResult result = update(heading, max_nis);
  turning_ = false;
  return result;
}

template UpdateResult ErrorState::update<1>(const Innovation<1>&, double, Hold);
template UpdateResult ErrorState::update<2>(const Innovation<2>&, double, Hold);
template UpdateResult ErrorState::update<3>(const Innovation<3>&, double, Hold);
template UpdateResult ErrorState::update<6>(const Innovation<6>&, double, Hold);

}  // namespace odograph::inertial
