// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bitset>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "sdk/host/localizer/measurement.hpp"
#include "sdk/host/localizer/retained_poses.hpp"
#include "sdk/host/localizer/track.hpp"
#include "sdk/math/scalar.hpp"

namespace odograph {

/// State of the filter, in this order. Position and heading belong to the newest pose of the track; together with the
/// track they define T_n_o.
enum StateIndex : int {
  kNorth,
  kEast,
  kDown,             ///< of the body in n, m
  kHeading,          ///< of o in n, rad: q_n_b = Rz(heading) q_o_b
  kHeadingRate,      ///< its rate, rad/s; 0 unless the orientation is integrated from a gyroscope
  kLogScale,         ///< log of metres per unit of the front-end's displacements
  kLogFactor,        ///< log of the true step length over the stated one
  kStepHeading,      ///< walking direction minus the heading that the steps state, rad
  kAttitudeHeading,  ///< of the attitude source's frame in n, rad: q_n_b = Rz(.) q_attitude
  kBarometer,        ///< barometric height downwards minus down, m
  kClimb,            ///< vertical velocity downwards while steps move the track, m/s
  kStates
};

/// Columns of a retained pose's errors in the filter's state.
inline constexpr int kPose[4] = {kHeading, kNorth, kEast, kDown};

using StateVector = Eigen::Matrix<double, kStates, 1>;
using StateSet = std::bitset<kStates>;

/// Of up to four rows: residual z - h(x), Jacobian of h by the state, and covariance of z.
struct Innovation {
  static constexpr int kMaxRows = 4;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxRows, 1>;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxRows, kMaxRows>;

  explicit Innovation(int rows)
      : residual(Vector::Zero(rows)), H(decltype(H)::Zero(rows, kStates)), noise(Square::Zero(rows, rows)) {}

  Vector residual;
  Eigen::Matrix<double, Eigen::Dynamic, kStates, 0, kMaxRows, kStates> H;
  Square noise;
  /// Process noise that entered the state after the measurement's time; for a late one, eq. (9).
  StateVector since = StateVector::Zero();
};

/// Kalman filter of T_n_o, scale, steps, heading and height (docs/estimator.md). Fixed size; allocates only for
/// retained poses. Not thread-safe.
class Localizer {
 public:
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
  void add_covariance(StateIndex i, StateIndex j, double covariance) { P_(i, j) += covariance, P_(j, i) += covariance; }
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
  /// Shifts the position, and retained poses by their share (n was wrong, not the path), and sets its covariance.
  void shift(const Eigen::Vector3d& by_n, const Eigen::Matrix3d& covariance, double fixed_m, double now_m);
  /// Rotates everything in n about a point: body, retained poses and headings.
  void rotate(double by_rad, const Eigen::Vector3d& about_n);
  /// Adds a common variance to the headings in n, about the body's position.
  void inflate_heading(double sigma_rad);

  /// Retains a pose of the track until it is released. Returns its id, from 1.
  uint64_t retain_pose(const TrackPoint& then, const TrackPoint& now);
  void release_pose(uint64_t id);
  /// False if it is not retained. `tilt_variance` fills the horizontal part of the rotation.
  bool retained_pose(uint64_t id, double tilt_variance, RetainedPose& out) const;
  Eigen::Matrix<double, 6, 6> pose_covariance(double tilt_variance) const;

 private:
  /// Errors of (heading, position), corrected through their correlation with the current state (delayed-state pose),
  /// eq. (11), (12).
  struct DelayedPose {
    uint64_t id = 0;
    double path_m = 0;
    Eigen::Quaterniond q_n_b;
    Eigen::Vector3d p_n;
    Eigen::Matrix<double, 4, kStates> cross;
    Eigen::Matrix4d own;
  };
  StateVector x_ = StateVector::Zero();
  Covariance P_ = Covariance::Zero();
  std::vector<DelayedPose> delayed_poses_;
  uint64_t last_pose_id_ = 0;
};

inline Eigen::Quaterniond about_down(double rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(rad, Eigen::Vector3d::UnitZ()));
}

/// Derivative of a rotated vector by the heading: z x r.
inline Eigen::Vector3d across(const Eigen::Vector3d& r_n) { return {-r_n.y(), r_n.x(), 0.0}; }

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
