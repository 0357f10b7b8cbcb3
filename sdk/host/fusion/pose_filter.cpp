// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/fusion/pose_filter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "sdk/math/rotation.hpp"

namespace odograph {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

/// Expands a covariance of (heading, position) to (rotation, position).
Eigen::Matrix<double, 6, 6> spread(const Eigen::Matrix4d& of_pose, double tilt_variance) {
  Eigen::Matrix<double, 6, 6> out = Eigen::Matrix<double, 6, 6>::Zero();
  out.bottomRightCorner<4, 4>() = of_pose;
  out(0, 0) = out(1, 1) = tilt_variance;
  return out;
}

/// Share of a position shift that a kept pose takes: 0 up to the last fixed position, 1 now, linear in path length
/// between, for an error that grew along the path.
double share_of_shift(double path_m, double fixed_m, double now_m) {
  if (path_m >= now_m) return 1.0;
  return path_m <= fixed_m ? 0.0 : (path_m - fixed_m) / (now_m - fixed_m);
}

/// Whether a symmetric matrix is positive semidefinite up to rounding: elimination in place of its lower triangle.
bool is_semidefinite(Eigen::Ref<Eigen::MatrixXd> a) {
  constexpr double kRounding = 1e-9;
  const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kStates + 4 * PoseFilter::kMostKept, 1> scale = a.diagonal();
  const Eigen::Index n = a.rows();
  for (Eigen::Index j = 0; j < n; ++j) {
    if (a(j, j) < -kRounding * scale[j]) return false;
    const bool determined = a(j, j) <= kRounding * scale[j];  // by the preceding rows
    for (Eigen::Index i = j + 1; i < n; ++i) {
      if (!determined)
        a.col(i).tail(n - i) -= a.col(j).tail(n - i) * (a(i, j) / a(j, j));
      else if (std::abs(a(i, j)) > 1e3 * kRounding * std::sqrt(scale[i] * scale[j]))
        return false;
    }
  }
  return true;
}

/// Change of a heading-dependent displacement under a finite rotation: the chord of the arc, not its tangent.
Vector3d along_arc(const Vector3d& tangent, double turned_rad) {
  return left_jacobian(turned_rad * Vector3d::UnitZ()) * tangent;
}

}  // namespace

void PoseFilter::move(const Vector3d& d_n, std::initializer_list<std::pair<StateIndex, Vector3d>> by,
                      const Matrix3d& noise) {
  x_.head<3>() += d_n;
  Eigen::Matrix<double, 3, kStates> F = Eigen::Matrix<double, 3, kStates>::Zero();
  F.leftCols<3>().setIdentity();
  for (const auto& [state, derivative] : by) F.col(state) += derivative;
  const Eigen::Matrix<double, 3, kStates> FP = F.lazyProduct(P_);
  const Matrix3d FPF = FP.lazyProduct(F.transpose());
  P_.topRows<3>() = FP;
  P_.leftCols<3>() = FP.transpose();
  P_.topLeftCorner<3, 3>() = 0.5 * (FPF + FPF.transpose());
  P_.topLeftCorner<3, 3>() += noise;
  if (!kept_.poses.empty()) kept_.with_state.leftCols<3>() = kept_.with_state.lazyProduct(F.transpose()).eval();
}

void PoseFilter::add_multiple(StateIndex to, StateIndex from, double factor) {
  x_[to] += factor * x_[from];
  P_.row(to) += factor * P_.row(from);
  P_.col(to) += factor * P_.col(from);
  kept_.with_state.col(to) += factor * kept_.with_state.col(from);
}

void PoseFilter::decay(StateIndex i, double mean, double keep, double variance) {
  x_[i] = mean + keep * (x_[i] - mean);
  P_.row(i) *= keep;
  P_.col(i) *= keep;
  P_(i, i) += variance;
  kept_.with_state.col(i) *= keep;
}

void PoseFilter::set(StateIndex i, double value, double variance) {
  x_[i] = value;
  decay(i, value, 0, variance);
}

void PoseFilter::set_variance(StateIndex i, double variance) {
  if (P_(i, i) <= 0) return set(i, x_[i], variance);
  decay(i, x_[i], std::sqrt(variance / P_(i, i)), 0);
}

void PoseFilter::copy_error(StateIndex to, StateIndex from) {
  P_.row(to) = P_.row(from);
  P_.col(to) = P_.col(from);
  P_(to, to) = P_(from, from);
  kept_.with_state.col(to) = kept_.with_state.col(from);
}

/// Every position error loses, by its share, that of a point, and takes the new one; the barometer's offset does the
/// opposite.
void PoseFilter::place(const Position& position, const TrackPoint& then, const TrackPoint& now) {
  Eigen::Matrix<double, 3, kStates> with_state = Eigen::Matrix<double, 3, kStates>::Zero();
  Eigen::MatrixXd with_kept = Eigen::MatrixXd::Zero(kept_.with_state.rows(), 3);
  Matrix3d own = position.covariance;  // of the point, and the new one
  if (!position.fixed_m) {
    const PastPose past = past_pose(then, now);
    with_state = past.with_state.bottomRows<3>();
    with_kept = kept_with(past.H.transpose(), drift_of(then), past.since).rightCols(3);
    own += past.own.bottomRightCorner<3, 3>();
  }
  Eigen::Matrix<double, kStates, 3> by = Eigen::Matrix<double, kStates, 3>::Zero();
  by.topRows<3>().diagonal() = -position.axes;
  by(kBarometer, 2) = position.axes.z();
  Eigen::MatrixXd by_kept = Eigen::MatrixXd::Zero(kept_.with_state.rows(), 3);
  for (size_t i = 0; i < kept_.poses.size(); ++i) {
    const double share =
        position.fixed_m ? share_of_shift(kept_.poses[i].point.path_m, *position.fixed_m, now.path_m) : 1.0;
    kept_.poses[i].p_n_b += share * position.by_n;
    by_kept.middleRows<3>(KeptStates::position_row(i)) = share * by.topRows<3>();
  }
  x_.head<3>() += position.by_n, x_[kBarometer] -= position.by_n.z();
  const Covariance lost = by.lazyProduct(with_state);
  P_ += lost + lost.transpose() + by.lazyProduct(own).lazyProduct(by.transpose());
  if (kept_.poses.empty()) return;
  kept_.with_state += by_kept * with_state + with_kept * by.transpose() + by_kept * own * by.transpose();
  kept_.with_kept +=
      by_kept * with_kept.transpose() + with_kept * by_kept.transpose() + by_kept * own * by_kept.transpose();
}

void PoseFilter::rotate(double by_rad, const Vector3d& about_n) {
  const Quaterniond q = about_down(by_rad);
  const Matrix3d R = q.toRotationMatrix();
  x_.head<3>() = about_n + R * (p_n() - about_n);
  x_[kHeading] += by_rad, x_[kAttitudeHeading] += by_rad;
  P_.topRows<3>() = (R * P_.topRows<3>()).eval();
  P_.leftCols<3>() = (P_.leftCols<3>() * R.transpose()).eval();
  kept_.rotate(q, about_n);
}

void PoseFilter::inflate_heading(double sigma_rad) {
  const double variance = sigma_rad * sigma_rad;
  for (const int i : {kHeading, kAttitudeHeading})
    for (const int j : {kHeading, kAttitudeHeading}) P_(i, j) += variance;
  kept_.inflate_heading(variance, p_n());
}

PoseFilter::PastPose PoseFilter::past_pose(const TrackPoint& then, const TrackPoint& now) const {
  const Vector3d since_n = q_n_o() * (now.p_o_b - then.p_o_b);
  PastPose past;
  past.q_n_b = q_n_o() * then.q_o_b, past.p_n_b = p_n() - since_n;
  past.H.setZero();
  for (int i = 0; i < 4; ++i) past.H(i, kPose[i]) = 1;
  past.H.block<3, 1>(1, kHeading) = -across(since_n);
  past.H.block<3, 1>(1, kLogScale) = -since_n;
  past.since = noise_between(drift_of(then), drift_of(now));
  past.with_state = past.H.lazyProduct(P_);
  past.with_state -= past.H * past.since.asDiagonal();
  past.own = past.with_state.lazyProduct(past.H.transpose());
  past.own = (0.5 * (past.own + past.own.transpose())).eval();
  return past;
}

uint64_t PoseFilter::keep_pose(const TrackPoint& then, const TrackPoint& now) {
  if (kept_.is_full()) return 0;
  const PastPose past = past_pose(then, now);
  const KeptGain with_kept = kept_with(past.H.transpose(), drift_of(then), past.since);
  kept_.add({kept_.next_id(), then, past.q_n_b, past.p_n_b}, past.with_state, with_kept, past.own);
  return kept_.poses.back().id;
}

uint64_t PoseFilter::keep_frame(const TrackPoint& then, const TrackPoint& now, const Rigid& T_b_x,
                                const Matrix4d& noise) {
  if (kept_.is_full()) return 0;
  const PastPose past = past_pose(then, now);
  const Vector3d lever_n = past.q_n_b * T_b_x.p;
  const Quaterniond q_n_x = past.q_n_b * T_b_x.q;
  const Quaterniond level = about_down(2 * std::atan2(q_n_x.z(), q_n_x.w()));
  Matrix4d by = Matrix4d::Identity();
  by.block<3, 1>(1, 0) = across(lever_n);
  const KeptGain with_kept = kept_with(past.H.transpose(), drift_of(then), past.since);
  kept_.add({kept_.next_id(), then, level, past.p_n_b + lever_n, true}, by * past.with_state,
            with_kept * by.transpose(), by * past.own * by.transpose() + noise);
  return kept_.poses.back().id;
}

uint64_t PoseFilter::keep_origin() {
  if (kept_.is_full()) return 0;
  kept_.add({kept_.next_id(), {}, Quaterniond::Identity(), Vector3d::Zero(), true}, Matrix4X::Zero(),
            Eigen::MatrixXd::Zero(kept_.with_state.rows(), 4), Matrix4d::Zero());
  return kept_.poses.back().id;
}

Attachment PoseFilter::nearest_kept(const TrackPoint& then, const TrackPoint& now, double sigma_m,
                                    double sigma_rad) const {
  if (kept_.poses.empty()) return {};
  const PastPose past = past_pose(then, now);
  const KeptGain with_kept = kept_.with_state.lazyProduct(past.H.transpose());
  Attachment near;
  double least = squared(sigma_m);
  for (size_t i = 0; i < kept_.poses.size(); ++i) {
    const auto row = 4 * static_cast<Eigen::Index>(i);
    const Matrix4d common = with_kept.middleRows<4>(row);
    const Matrix4d apart = past.own + kept_.with_kept.block<4, 4>(row, row) - common - common.transpose();
    const double variance = apart.diagonal().tail<3>().maxCoeff();
    if (kept_.poses[i].is_frame || variance > least || apart(0, 0) > squared(sigma_rad)) continue;
    least = variance;
    const Rigid T_n_kept{kept_.poses[i].q_n_b, kept_.poses[i].p_n_b};
    Matrix4d turned = Matrix4d::Identity();
    turned.bottomRightCorner<3, 3>() = T_n_kept.q.toRotationMatrix();
    near = {kept_.poses[i].id, T_n_kept.inverse() * Rigid{past.q_n_b, past.p_n_b}, turned.transpose() * apart * turned};
  }
  return near;
}

PoseFilter PoseFilter::without_kept_poses() const {
  PoseFilter out;
  out.x_ = x_, out.P_ = P_;
  return out;
}

Eigen::MatrixXd PoseFilter::whole_covariance() const {
  const Eigen::Index n = kept_.with_state.rows();
  Eigen::MatrixXd whole(kStates + n, kStates + n);
  whole.topLeftCorner<kStates, kStates>() = P_;
  whole.bottomLeftCorner(n, kStates) = kept_.with_state;
  whole.topRightCorner(kStates, n) = kept_.with_state.transpose();
  whole.bottomRightCorner(n, n) = kept_.with_kept;
  return whole;
}

/// Process noise between two times as far as the covariance still contains it, so that it stays positive semidefinite
/// without it: updates since may have removed a part, and a heading that is the attitude source's has no own noise.
StateVector PoseFilter::noise_between(const StateVector& drift_then, const StateVector& drift_now) const {
  StateVector noise = (drift_now - drift_then).cwiseMin(0.5 * P_.diagonal()).cwiseMax(0);
  for (int tries = 0; tries < 6 && !noise.isZero(0); ++tries) {
    Covariance before = P_;
    before.diagonal() -= noise;
    if (is_semidefinite(before)) return noise;
    tries == 0 ? void(noise[kHeading] = 0) : void(noise *= 0.5);
  }
  return StateVector::Zero();
}

Eigen::Matrix<double, 6, 6> PoseFilter::pose_covariance(double tilt_variance) const {
  Eigen::Matrix4d of_pose;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) of_pose(i, j) = P_(kPose[i], kPose[j]);
  return spread(of_pose, tilt_variance);
}

bool PoseFilter::kept_pose(uint64_t id, double tilt_variance, KeptPose& out) const {
  const int row = kept_.row_of(id);
  if (row < 0) return false;
  Eigen::Matrix4d cross;
  for (int j = 0; j < 4; ++j) cross.col(j) = kept_.with_state.block<4, 1>(row, kPose[j]);
  const KeptStates::Kept& pose = kept_.poses[static_cast<size_t>(row / 4)];
  out = {pose.q_n_b, pose.p_n_b, spread(kept_.with_kept.block<4, 4>(row, row), tilt_variance),
         pose_covariance(tilt_variance), spread(cross, 0)};
  return true;
}

Eigen::Matrix4d PoseFilter::covariance_of(uint64_t one, uint64_t other) const {
  const int row = kept_.row_of(one), col = kept_.row_of(other);
  return row < 0 || col < 0 ? Eigen::Matrix4d::Zero() : Eigen::Matrix4d(kept_.with_kept.block<4, 4>(row, col));
}

/// Covariance of the kept poses with a linear function Ht of the state without a noise that entered it since. Poses
/// kept meanwhile have a part of the noise. If updates since have left too little of it for that, all have as much in
/// common with it as with the state, which always leaves the whole positive semidefinite.
PoseFilter::KeptGain PoseFilter::kept_with(const UpTo4<kStates>& Ht, const StateVector& drift_then,
                                           const StateVector& noise) const {
  if (kept_.poses.empty() || noise.isZero(0)) return kept_.with_state.lazyProduct(Ht);
  Eigen::MatrixXd before = whole_covariance();
  before.diagonal().head<kStates>() -= noise;
  const auto part = [&](size_t pose, int i) {
    return std::clamp(drift_of(kept_.poses[pose].point)[i] - drift_then[i], 0.0, noise[i]);
  };
  for (int k = 0; k < 4; ++k)
    for (size_t pose = 0; pose < kept_.poses.size(); ++pose) {
      const Eigen::Index row = kStates + 4 * static_cast<Eigen::Index>(pose) + k;
      before(row, kPose[k]) -= part(pose, kPose[k]);
      for (size_t other = 0; other < kept_.poses.size(); ++other)
        before(row, kStates + 4 * static_cast<Eigen::Index>(other) + k) -=
            std::min(part(pose, kPose[k]), part(other, kPose[k]));
    }
  const Eigen::MatrixXd with_state = before.bottomLeftCorner(kept_.with_state.rows(), kStates);
  if (is_semidefinite(before)) return with_state.lazyProduct(Ht);
  const StateVector diagonal = noise;
  const Covariance rest = Covariance::Identity() - P_.ldlt().solve(Covariance(diagonal.asDiagonal()));
  const UpTo4<kStates> by_state = rest.lazyProduct(Ht);
  return kept_.with_state.lazyProduct(by_state);
}

Innovation::Square PoseFilter::covariance_of(const Innovation& innovation) const {
  const auto& H = innovation.H;
  Innovation::Square out = H * P_ * H.transpose();
  for (const auto& [id, by] : innovation.kept) {
    const int row = kept_.row_of(id);
    if (row < 0) continue;
    const Innovation::Square with = by * kept_.with_state.middleRows<4>(row) * H.transpose();
    out += with + with.transpose();
    for (const auto& [other_id, other_by] : innovation.kept)
      if (const int col = kept_.row_of(other_id); col >= 0)
        out += by * kept_.with_kept.block<4, 4>(row, col) * other_by.transpose();
  }
  return out;
}

/// Products coefficient by coefficient: at these sizes Eigen's blocked ones are no faster, and cost seconds to compile.
UpdateResult PoseFilter::update(const Innovation& innovation, double max_nis, StateSet considered) {
  using Gain = UpTo4<kStates>;
  using Square = Innovation::Square;
  const auto& H = innovation.H;
  const int rows = static_cast<int>(H.rows());
  Gain PHt = P_.lazyProduct(H.transpose());
  // Process noise since the measurement is not correlated with it.
  const bool of_kept = innovation.kept[0].id != 0 || innovation.kept[1].id != 0;
  const StateVector since = of_kept ? StateVector::Zero() : noise_between(innovation.drift_then, innovation.drift_now);
  for (int i = 0; i < kStates; ++i) PHt.row(i) -= since[i] * H.col(i).transpose();
  KeptGain kept_PHt = kept_with(H.transpose(), innovation.drift_then, since);
  for (const auto& [id, by] : innovation.kept) {
    const int row = kept_.row_of(id);
    if (id != 0 && row < 0) return {false, 0.0, rows};  // no longer kept
    if (row < 0) continue;
    PHt += kept_.with_state.middleRows<4>(row).transpose().lazyProduct(by.transpose());
    kept_PHt += kept_.with_kept.middleCols<4>(row).lazyProduct(by.transpose());
  }
  Square S = H.lazyProduct(PHt);
  for (const auto& [id, by] : innovation.kept)
    if (const int row = kept_.row_of(id); row >= 0) S += by.lazyProduct(kept_PHt.middleRows<4>(row));
  S += innovation.noise;
  S = (0.5 * (S + S.transpose())).eval();
  const Eigen::LLT<Square> llt(S);
  if (llt.info() != Eigen::Success) return {false, 0.0, rows};
  const Square inverse = llt.solve(Square::Identity(rows, rows));
  const double nis = innovation.residual.dot(inverse.lazyProduct(innovation.residual));
  if (!(nis >= 0) || !std::isfinite(nis) || (max_nis > 0 && nis > max_nis)) return {false, nis, rows};

  Gain K = PHt.lazyProduct(inverse);
  for (int i = 0; i < kStates; ++i)
    if (considered[static_cast<size_t>(i)]) K.row(i).setZero();
  const Gain KS = K.lazyProduct(S);
  const Gain half = PHt - 0.5 * KS;
  KeptGain kept_K = kept_PHt.lazyProduct(inverse);
  for (size_t pose = 0; pose < kept_.poses.size(); ++pose) {
    const auto row = 4 * static_cast<Eigen::Index>(pose);
    for (int i = 0; i < 4; ++i)  // what is considered of the current pose is considered of a kept one
      if (considered[static_cast<size_t>(kPose[i])]) kept_K.row(row + i).setZero();
    const Eigen::Vector4d moved = kept_K.middleRows<4>(row).lazyProduct(innovation.residual);
    kept_.poses[pose].q_n_b = (about_down(moved[0]) * kept_.poses[pose].q_n_b).normalized();
    kept_.poses[pose].moved_n = along_arc(moved.tail<3>(), moved[0]);
    kept_.poses[pose].p_n_b += kept_.poses[pose].moved_n;
  }
  if (!kept_.poses.empty()) {
    const KeptGain kept_half = kept_PHt - 0.5 * kept_K.lazyProduct(S);
    kept_.with_state += kept_K.lazyProduct((KS - PHt).transpose()) - kept_PHt.lazyProduct(K.transpose());
    kept_.with_kept -= kept_K.lazyProduct(kept_half.transpose()) + kept_half.lazyProduct(kept_K.transpose());
  }
  StateVector moved = K.lazyProduct(innovation.residual);
  moved.head<3>() = along_arc(moved.head<3>(), moved[kHeading]);
  x_ += moved;
  P_ -= K.lazyProduct(half.transpose()) + half.lazyProduct(K.transpose());
  if (of_kept) rotate_errors(moved.head<3>());
  return {true, nis, rows};
}

/// What all poses have in common, a rotation of n, moves each by its distance from the centre. A relative measurement
/// does not observe it, also after positions have moved: dp <- dp + moved x psi, as with an invariant error (Barrau and
/// Bonnabel 2017).
void PoseFilter::rotate_errors(const Vector3d& moved_n) {
  P_.topRows<3>() += across(moved_n) * P_.row(kHeading);
  P_.leftCols<3>() += P_.col(kHeading) * across(moved_n).transpose();
  kept_.rotate_errors(moved_n);
}

}  // namespace odograph
