// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "sdk/host/fusion/kept_states.hpp"
#include "sdk/host/fusion/outputs.hpp"
#include "sdk/host/fusion/trajectory.hpp"
#include "sdk/math/scalar.hpp"

namespace odograph {

/// Of up to four rows: residual z - h(x), Jacobian of h by the state and by kept poses, and covariance of z.
struct Innovation {
  static constexpr int kMaxRows = 4;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxRows, 1>;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxRows, kMaxRows>;

  explicit Innovation(int rows)
      : residual(Vector::Zero(rows)), H(decltype(H)::Zero(rows, kStates)), noise(Square::Zero(rows, rows)) {}

  Vector residual;
  Eigen::Matrix<double, Eigen::Dynamic, kStates, 0, kMaxRows, kStates> H;
  Square noise;
  /// Drift of the track at the measurement's time and now: the noise between them entered the state after a late
  /// measurement of the state alone, eq. (9).
  StateVector drift_then = StateVector::Zero(), drift_now = StateVector::Zero();
  /// Jacobian by (heading, position) of kept poses; id 0: unused.
  struct OfKept {
    uint64_t id = 0;
    Eigen::Matrix<double, Eigen::Dynamic, 4, 0, kMaxRows, 4> H;
  } kept[2];
};

/// Kalman filter of T_n_o, scale, steps, heading and height, and of kept poses of the past (docs/estimator.md). Only
/// its functions change the covariance, and each leaves it positive semidefinite. Fixed size; allocates only to keep
/// poses. Not thread-safe.
class PoseFilter {
 public:
  static constexpr int kMostKept = KeptStates::kMost;
  using Covariance = Eigen::Matrix<double, kStates, kStates>;

  const StateVector& x() const { return x_; }
  const Covariance& P() const { return P_; }
  Eigen::Vector3d p_n() const { return x_.head<3>(); }
  Eigen::Quaterniond q_n_o() const {
    return Eigen::Quaterniond(Eigen::AngleAxisd(x_[kHeading], Eigen::Vector3d::UnitZ()));
  }
  double sigma(StateIndex i) const { return std::sqrt(std::max(0.0, P_(i, i))); }

  /// Moves the body by d_n, m. `by`: the states whose errors it depends on, with its derivative by each; plus own
  /// noise, m^2. Eq. (3).
  void move(const Eigen::Vector3d& d_n, std::initializer_list<std::pair<StateIndex, Eigen::Vector3d>> by,
            const Eigen::Matrix3d& noise);
  /// x[to] += factor * x[from], eq. (4).
  void add_multiple(StateIndex to, StateIndex from, double factor);
  void add_variance(StateIndex i, double variance) { P_(i, i) += variance; }
  /// Adds one error that two states have in common.
  void add_variance(StateIndex i, StateIndex j, double variance) {
    P_(i, i) += variance, P_(j, j) += variance, P_(i, j) += variance, P_(j, i) += variance;
  }
  /// Sets a state and keeps its error.
  void set_value(StateIndex i, double value) { x_[i] = value; }
  void set_position(const Eigen::Vector3d& p_n) { x_.head<3>() = p_n; }
  /// Propagates a Gauss-Markov state: its distance from `mean` is multiplied by `keep`, and a variance is added.
  void decay(StateIndex i, double mean, double keep, double variance);
  /// Re-initialises a state, uncorrelated with all others.
  void set(StateIndex i, double value, double variance);
  /// Sets the variance of a state and scales its correlations accordingly.
  void set_variance(StateIndex i, double variance);
  /// Makes the error of one state identical to that of another.
  void copy_error(StateIndex to, StateIndex from);

  /// Kalman update with a gate on the normalised innovation squared (0: none), eq. (6) to (8). Considered states
  /// (Schmidt 1966) contribute their covariance but are not changed.
  UpdateResult update(const Innovation& innovation, double max_nis, StateSet considered = {});
  /// Covariance of what a measurement measures, without its noise.
  Innovation::Square covariance_of(const Innovation& innovation) const;
  /// A new position along some axes (1, otherwise 0), by_n m from the old one, and the covariance of its error, m^2.
  struct Position {
    Eigen::Vector3d by_n, axes;
    Eigen::Matrix3d covariance;
    std::optional<double> fixed_m;  ///< path length of the last position on these axes; nothing: there was none
  };
  /// Gives it to a pose of the track. The first one: n's origin was unknown, so that pose has the new error alone, and
  /// all others keep theirs relative to it. A further one: the track was wrong, and kept poses take their share of an
  /// error that grew along the path since. The barometer's offset moves with it.
  void place(const Position& position, const TrackPoint& then, const TrackPoint& now);
  /// Rotates everything in n about a point: body, kept poses and headings.
  void rotate(double by_rad, const Eigen::Vector3d& about_n);
  /// Adds a common variance to the headings in n, about the body's position.
  void inflate_heading(double sigma_rad);

  /// Keeps a pose of the track as a state until it is released, eq. (11), (12). Returns its id, from 1; 0 if kMostKept
  /// are kept.
  uint64_t keep_pose(const TrackPoint& then, const TrackPoint& now);
  /// Keeps a frame, level like n, that was seen from a pose of the track: its pose in the axes of the body, and the
  /// covariance of (heading, position) of that, in n. It is never given up for others.
  uint64_t keep_frame(const TrackPoint& then, const TrackPoint& now, const Rigid& T_b_x, const Eigen::Matrix4d& noise);
  /// Keeps n itself as such a frame.
  uint64_t keep_origin();
  /// Adds variances to the (heading, position) of a kept pose or frame.
  void inflate_kept(uint64_t id, const Eigen::Vector4d& variance) { kept_.inflate(id, variance); }
  void release_pose(uint64_t id) { kept_.release(id); }
  /// The kept pose with the least error between it and a pose of the track, if its sigmas are at most these.
  Attachment nearest_kept(const TrackPoint& then, const TrackPoint& now, double sigma_m, double sigma_rad) const;
  /// If there is no room: the two kept poses with the least error between them, of which the first can be given up.
  std::optional<HandOver> crowded() const { return kept_.crowded(); }
  /// False if it is not kept. `tilt_variance` fills the horizontal part of the rotation.
  bool kept_pose(uint64_t id, double tilt_variance, KeptPose& out) const;
  /// Covariance of (heading, position) of one kept pose with another.
  Eigen::Matrix4d covariance_of(uint64_t one, uint64_t other) const;
  Eigen::Matrix<double, 6, 6> pose_covariance(double tilt_variance) const;
  /// The current state alone, to try an update on.
  PoseFilter without_kept_poses() const;
  /// Covariance of the state and of (heading, position) of all kept poses.
  Eigen::MatrixXd whole_covariance() const;

 private:
  using Matrix4X = Eigen::Matrix<double, 4, kStates>;
  /// A pose of the track as a function of the state, with its derivative H, the noise since, and its covariances.
  struct PastPose {
    Eigen::Quaterniond q_n_b;
    Eigen::Vector3d p_n_b;
    Matrix4X H, with_state;
    StateVector since;
    Eigen::Matrix4d own;
  };

  PastPose past_pose(const TrackPoint& then, const TrackPoint& now) const;
  template <int rows>
  using UpTo4 = Eigen::Matrix<double, rows, Eigen::Dynamic, 0, rows, Innovation::kMaxRows>;
  using KeptGain =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 4 * KeptStates::kMost, Innovation::kMaxRows>;
  KeptGain kept_with(const UpTo4<kStates>& Ht, const StateVector& drift_then, const StateVector& noise) const;
  void rotate_errors(const Eigen::Vector3d& moved_n);
  StateVector noise_between(const StateVector& drift_then, const StateVector& drift_now) const;

  StateVector x_ = StateVector::Zero();
  Covariance P_ = Covariance::Zero();
  KeptStates kept_;
};

/// Drift of a point of the track, as variances of the state.
inline StateVector drift_of(const TrackPoint& point) {
  StateVector drift = StateVector::Zero();
  drift.head<3>() = point.drift_m2;
  drift[kHeading] = point.heading_drift_rad2;
  return drift;
}

inline Eigen::Quaterniond about_down(double rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(rad, Eigen::Vector3d::UnitZ()));
}

/// All states but these: for the considered states of a measurement.
inline StateSet all_but(std::initializer_list<StateIndex> states) {
  StateSet out;
  out.set();
  for (const StateIndex i : states) out.reset(static_cast<size_t>(i));
  return out;
}
inline StateSet only(std::initializer_list<StateIndex> states) { return ~all_but(states); }

/// Gate on the normalised innovation squared, by degrees of freedom: 99.9 % of good measurements pass (chi-square).
inline constexpr double kGate[] = {0, 10.83, 13.82, 16.27, 18.47};

/// Sigma of an unknown heading, rad: uniform over the circle, pi / sqrt(3).
inline constexpr double kUnknownHeading_rad = 1.8;

}  // namespace odograph
