// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/inertial/update.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Householder>

#include "sdk/math/rotation.hpp"

namespace odograph::vio {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Residuals and Jacobians of a track by its clones, its point and the camera. Columns: block::clone for each clone,
/// then line time, lens and stabiliser gain.
struct TrackEquations {
  Linearised z;
  MatrixXd by_point;  ///< by x/z, y/z, 1/z in the anchor
};

constexpr int kCameraColumns = 1 + kLensStates + 1;

void add_camera_columns(std::vector<int>& columns) {
  for (int k = 0; k < 1 + kLensStates; ++k) columns.push_back(block::line_time + k);
  columns.push_back(block::gain);
}

Eigen::Matrix<double, 2, kCameraColumns> by_camera(const Observed& o) {
  Eigen::Matrix<double, 2, kCameraColumns> J;
  J << o.by_line_time, o.by_lens, o.by_gain;
  return J;
}

std::optional<TrackEquations> equations(const State& state, const std::vector<Observation>& track,
                                        const Eigen::Vector3d& at) {
  const int rows = 2 * static_cast<int>(track.size());
  const int clones = block::clone * static_cast<int>(track.size()), columns = clones + kCameraColumns;
  TrackEquations out;
  out.z.residual.resize(rows);
  out.z.H = MatrixXd::Zero(rows, columns);
  out.by_point.resize(rows, 3);
  for (const Observation& o : track) {
    const int from = state.clone_at(state.find_clone(o.clone));
    for (int k = 0; k < block::clone; ++k) out.z.columns.push_back(from + k);
  }
  add_camera_columns(out.z.columns);
  const Clone& anchor = state.clones[state.find_clone(track.front().clone)];
  const Matrix3d R = anchor.q_w_c.toRotationMatrix();
  const Eigen::Vector3d p_w = anchor.p_w + R * landmark_ray(at);
  const Matrix3d J_point = R * landmark_jacobian(at);
  for (size_t i = 0; i < track.size(); ++i) {
    const Clone& clone = state.clones[state.find_clone(track[i].clone)];
    const auto o = observe(clone, state.camera, p_w, track[i].row);
    if (!o) return std::nullopt;
    const int row = 2 * static_cast<int>(i);
    out.z.residual.segment<2>(row) = track[i].pixel - o->pixel;
    const int own = block::clone * static_cast<int>(i);
    out.z.H.block<2, block::clone>(row, own) = o->by_clone;
    out.z.H.block<2, 6>(row, 0) -= o->by_clone.leftCols<6>();  // the point moves with its anchor
    out.z.H.block<2, kCameraColumns>(row, clones) = by_camera(*o);
    out.by_point.middleRows<2>(row) = o->by_point * J_point;
  }
  return out;
}

/// Whitens the errors of a track's observations to pixel_sigma each. They consist of white noise and the corner's
/// random walk up to the last observation.
void whiten(const State& state, const std::vector<Observation>& track, const FilterParameters& p, Linearised& z,
            MatrixXd& by_point) {
  const auto n = static_cast<Eigen::Index>(track.size());
  const auto age = [&](const Observation& o) {
    return static_cast<double>(state.clones[state.find_clone(track.back().clone)].frame_ns -
                               state.clones[state.find_clone(o.clone)].frame_ns) *
           1e-9;
  };
  const double walk = p.corner_walk_px / p.pixel_sigma;
  MatrixXd R = MatrixXd::Identity(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double age_s = age(track[static_cast<size_t>(i)]);  // of this observation; the earlier ones are older
    for (Eigen::Index j = 0; j <= i; ++j) R(i, j) += walk * walk * age_s;
  }
  const Eigen::LLT<MatrixXd> factor(R);  // reads the lower triangle
  const auto apply = [&](auto&& M) {
    for (int axis = 0; axis < 2; ++axis) {
      MatrixXd rows = M(Eigen::seqN(axis, n, 2), Eigen::all);
      factor.matrixL().solveInPlace(rows);
      M(Eigen::seqN(axis, n, 2), Eigen::all) = rows;
    }
  };
  apply(z.residual);
  apply(z.H);
  apply(by_point);
}

/// Makes by_point upper triangular by Householder reflections of all rows: those below the third then do not depend on
/// the point. As by Eigen's HouseholderQR, whose block-wise application of three reflections takes long to compile.
void triangularise(TrackEquations& e) {
  const Eigen::Index rows = e.by_point.rows(), columns = e.by_point.cols();
  VectorXd workspace(std::max(e.z.H.cols(), columns));
  for (Eigen::Index k = 0; k < columns; ++k) {
    double tau = 0, beta = 0;
    e.by_point.col(k).tail(rows - k).makeHouseholderInPlace(tau, beta);
    e.by_point(k, k) = beta;
    const auto reflect = [&](Eigen::Ref<MatrixXd> of) {
      of.applyHouseholderOnTheLeft(e.by_point.col(k).tail(rows - k - 1), tau, workspace.data());
    };
    reflect(e.by_point.bottomRightCorner(rows - k, columns - k - 1));
    reflect(e.z.H.bottomRows(rows - k));
    reflect(e.z.residual.tail(rows - k));
  }
}

MatrixXd columns_of(const MatrixXd& P, const std::vector<int>& columns) {
  MatrixXd out(P.rows(), static_cast<Eigen::Index>(columns.size()));
  for (size_t k = 0; k < columns.size(); ++k) out.col(static_cast<Eigen::Index>(k)) = P.col(columns[k]);
  return out;
}

MatrixXd rows_of(const MatrixXd& M, const std::vector<int>& rows) {
  MatrixXd out(static_cast<Eigen::Index>(rows.size()), M.cols());
  for (size_t k = 0; k < rows.size(); ++k) out.row(static_cast<Eigen::Index>(k)) = M.row(rows[k]);
  return out;
}

/// Noise of a corner from a track with residual `rms_px` (FilterParameters::typical_residual_px).
double pixel_sigma(double rms_px, const FilterParameters& p) {
  const double excess = std::max(1.0, rms_px / p.typical_residual_px);
  return p.pixel_sigma * excess * excess;
}

/// Normalised innovation squared with independent noise of sigma.
double nis_of(MatrixXd S, const VectorXd& residual, double sigma) {
  S.diagonal().array() += sigma * sigma;
  return residual.dot(S.ldlt().solve(residual));
}

/// The update; `S` is the innovation covariance. Returns false and changes nothing if S is not positive definite.
bool apply(State& state, const MatrixXd& PH, const MatrixXd& S, const VectorXd& residual) {
  const Eigen::LLT<MatrixXd> factor(S);
  if (factor.info() != Eigen::Success) return false;
  const VectorXd white = factor.matrixL().solve(residual);
  const MatrixXd W = factor.matrixL().solve(PH.transpose());
  state.P.selfadjointView<Eigen::Lower>().rankUpdate(W.transpose(), -1);
  state.P.triangularView<Eigen::StrictlyUpper>() = state.P.transpose();
  state.correct(W.transpose() * white);
  return true;
}

}  // namespace

double chi_square_bound(int dof, double tail) {
  const double z = tail <= 0.002 ? 3.09 : tail <= 0.011 ? 2.326 : 1.645, n = dof;
  const double c = 1 - 2 / (9 * n) + z * std::sqrt(2 / (9 * n));
  return n * c * c * c;
}

Outcome update(State& state, const Linearised& z, double sigma, double gate_sigma, double tail) {
  Outcome out;
  out.dof = static_cast<int>(z.residual.size());
  const MatrixXd PH = columns_of(state.P, z.columns) * z.H.transpose();
  MatrixXd S = z.H * rows_of(PH, z.columns);
  out.nis = nis_of(S, z.residual, gate_sigma);
  if (tail > 0 && !(out.nis < chi_square_bound(out.dof, tail))) return out;
  S.diagonal().array() += sigma * sigma;
  out.accepted = apply(state, PH, S, z.residual);
  return out;
}

Outcome update_with_track(State& state, const std::vector<Observation>& track, const FilterParameters& p) {
  const auto point = triangulate(state, track, p);
  if (!point || point->parallax_rad < p.min_parallax_rad || point->at.z() < 1 / p.farthest_m) return {};
  auto e = equations(state, track, point->at);
  if (!e) return {};
  whiten(state, track, p, e->z, e->by_point);
  triangularise(*e);
  const Eigen::Index rows = e->z.residual.size();
  Linearised z{e->z.residual.tail(rows - 3), e->z.H.bottomRows(rows - 3), std::move(e->z.columns)};
  Outcome out = update(state, z, pixel_sigma(point->rms_px, p), p.gate_sigma, p.gate_tail);
  out.rms_px = point->rms_px;
  return out;
}

Outcome add_landmark(State& state, uint64_t id, const std::vector<Observation>& track, const FilterParameters& p) {
  const auto point = triangulate(state, track, p);
  if (!point) return {};
  auto e = equations(state, track, point->at);
  if (!e) return {};
  whiten(state, track, p, e->z, e->by_point);
  if (point->parallax_rad < 2 * p.min_parallax_rad) {
    const Eigen::Index rows = e->z.residual.size();
    const double weight = p.pixel_sigma / p.inverse_depth_sigma;
    e->z.H.conservativeResize(rows + 1, Eigen::NoChange);
    e->z.H.row(rows).setZero();
    e->by_point.conservativeResize(rows + 1, Eigen::NoChange);
    e->by_point.row(rows) << 0, 0, weight;
    e->z.residual.conservativeResize(rows + 1);
    e->z.residual[rows] = weight * (p.inverse_depth - point->at.z());
  }
  triangularise(*e);
  const Eigen::Index rows = e->z.residual.size();
  const Matrix3d F = e->by_point.topLeftCorner<3, 3>().triangularView<Eigen::Upper>();
  if (std::abs(F(0, 0) * F(1, 1) * F(2, 2)) < 1e-12) return {};
  const std::vector<int> columns = e->z.columns;
  const MatrixXd H1 = e->z.H.topRows<3>();
  const Eigen::Vector3d r1 = e->z.residual.head<3>();
  Outcome out{true, 0, static_cast<int>(rows - 3), point->rms_px};
  // The first three rows initialise the point; the remaining ones then update it too.
  const Matrix3d F_inverse = F.inverse();
  const MatrixXd PH = columns_of(state.P, columns) * H1.transpose();
  const double first_sigma = pixel_sigma(point->rms_px, p);
  const Matrix3d own = H1 * rows_of(PH, columns) + first_sigma * first_sigma * Matrix3d::Identity();
  Linearised rest{e->z.residual.tail(rows - 3), e->z.H.bottomRows(rows - 3), columns};
  {
    // Gates before the state changes.
    const MatrixXd PR = columns_of(state.P, columns) * rest.H.transpose();
    out.nis = nis_of(rest.H * rows_of(PR, columns), rest.residual, p.gate_sigma);
    if (!(out.nis < chi_square_bound(out.dof, p.gate_tail))) return {false, out.nis, out.dof, out.rms_px};
  }
  Landmark landmark{id, track.front().clone, point->at + F_inverse * r1, 0, point->rms_px};
  landmark.at.z() = std::max(landmark.at.z(), 1 / p.farthest_m);
  state.add_landmark(landmark, -F_inverse * PH.transpose(), F_inverse * own * F_inverse.transpose());
  const double sigma = pixel_sigma(point->rms_px, p);
  update(state, rest, sigma, sigma, 0);
  return out;
}

namespace {

/// Nothing if the landmark is behind the camera.
std::optional<Linearised> landmark_equations(const State& state, const SeenLandmark& seen) {
  const Landmark& landmark = state.landmarks[seen.landmark];
  const size_t a = state.find_clone(landmark.anchor), i = state.find_clone(seen.at.clone);
  const auto o = observe(state.clones[i], state.camera, state.point(landmark), seen.at.row);
  if (!o) return std::nullopt;
  Linearised z;
  z.residual = seen.at.pixel - o->pixel;
  constexpr int anchor = block::clone, point = anchor + 6;
  z.H = MatrixXd::Zero(2, point + 3 + kCameraColumns);
  z.H.leftCols<block::clone>() = o->by_clone;
  z.H.middleCols<6>(anchor) = -o->by_clone.leftCols<6>();
  z.H.middleCols<3>(point) = o->by_point * state.clones[a].q_w_c.toRotationMatrix() * landmark_jacobian(landmark.at);
  z.H.rightCols<kCameraColumns>() = by_camera(*o);
  for (int k = 0; k < block::clone; ++k) z.columns.push_back(state.clone_at(i) + k);
  for (int k = 0; k < 6; ++k) z.columns.push_back(state.clone_at(a) + k);
  for (int k = 0; k < 3; ++k) z.columns.push_back(state.landmark_at(seen.landmark) + k);
  add_camera_columns(z.columns);
  return z;
}

}  // namespace

std::vector<Outcome> update_with_landmarks(State& state, const std::vector<SeenLandmark>& seen,
                                           const FilterParameters& p) {
  std::vector<Outcome> outcomes(seen.size());
  for (size_t from = 0; from < seen.size(); from += p.landmarks_together) {
    const size_t until = std::min(seen.size(), from + p.landmarks_together);
    std::vector<Linearised> accepted;
    for (size_t k = from; k < until; ++k) {
      auto z = landmark_equations(state, seen[k]);
      if (!z) continue;
      Outcome& out = outcomes[k];
      out.dof = 2;
      const MatrixXd own = state.P(z->columns, z->columns), HP = z->H * own;
      out.nis = nis_of(HP * z->H.transpose(), z->residual, p.gate_sigma);
      out.accepted = out.nis < chi_square_bound(out.dof, p.gate_tail);
      double& rms_px = state.landmarks[seen[k].landmark].rms_px;
      rms_px = std::sqrt((1 - p.residual_part) * rms_px * rms_px + p.residual_part * z->residual.squaredNorm());
      if (!out.accepted) continue;
      const double weight = 1 / pixel_sigma(rms_px, p);
      z->residual *= weight, z->H *= weight;
      accepted.push_back(std::move(*z));
    }
    if (accepted.empty()) continue;
    const auto rows = 2 * static_cast<Eigen::Index>(accepted.size());
    MatrixXd PH(state.P.rows(), rows), S(rows, rows);
    VectorXd residual(rows);
    for (size_t k = 0; k < accepted.size(); ++k) {
      const auto at = 2 * static_cast<Eigen::Index>(k);
      PH.middleCols<2>(at).noalias() = columns_of(state.P, accepted[k].columns) * accepted[k].H.transpose();
      residual.segment<2>(at) = accepted[k].residual;
    }
    for (size_t k = 0; k < accepted.size(); ++k)
      S.middleRows<2>(2 * static_cast<Eigen::Index>(k)) = accepted[k].H * rows_of(PH, accepted[k].columns);
    S.diagonal().array() += 1;
    if (apply(state, PH, S, residual)) continue;
    for (size_t k = from; k < until; ++k) outcomes[k].accepted = false;
  }
  return outcomes;
}

void disable_stabiliser(State& state) {
  constexpr double sigma_px = 0.01, sigma_gain = 1e-4;  // far below the measurement noise, far above rounding
  Linearised z;
  for (int k = 0; k < 3; ++k) z.columns.push_back(block::shift + k);
  std::vector<double> held = {state.camera.shift_px.x(), state.camera.shift_px.y(), state.camera.gain};
  for (size_t i = 0; i < state.clones.size(); ++i)
    for (int k = 0; k < 2; ++k) {
      z.columns.push_back(state.clone_at(i) + block::clone_shift + k);
      held.push_back(state.clones[i].shift_px[k]);
    }
  const auto n = static_cast<Eigen::Index>(held.size());
  z.H = MatrixXd::Identity(n, n);
  z.H(2, 2) = sigma_px / sigma_gain;
  z.residual = -z.H * Eigen::Map<const VectorXd>(held.data(), n);
  update(state, z, sigma_px, sigma_px, 0);
}

Outcome update_gravity(State& state, const Eigen::Vector3d& force_b, double gravity_mps2, double sigma_mps2) {
  const Matrix3d R_b_w = state.nav.q_w_b.conjugate().toRotationMatrix();
  const Eigen::Vector3d gravity_w(0, 0, gravity_mps2);
  Linearised z;
  z.residual = force_b - (state.nav.accel_bias - R_b_w * gravity_w);
  z.H.resize(3, 6);
  z.H << -R_b_w * skew(gravity_w), Matrix3d::Identity();
  for (int k = 0; k < 3; ++k) z.columns.push_back(block::theta + k);
  for (int k = 0; k < 3; ++k) z.columns.push_back(block::accel_bias + k);
  return update(state, z, sigma_mps2, sigma_mps2, 0);
}

Outcome update_zero_velocity(State& state, double sigma_mps) {
  Linearised z;
  z.residual = -state.nav.v_w;
  z.H.resize(3, 7);
  z.H << -skew(state.nav.v_w), Matrix3d::Identity(), state.nav.v_w;
  z.columns = {0, 1, 2, 3, 4, 5, block::scale};
  return update(state, z, sigma_mps, sigma_mps, 0.001);
}

}  // namespace odograph::vio
