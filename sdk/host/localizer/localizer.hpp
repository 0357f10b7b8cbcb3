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
#include "sdk/host/localizer/held_poses.hpp"
#include "sdk/host/localizer/track.hpp"

namespace odograph {

/// What the filter estimates, in this order. Position and heading are those of the newest pose of the track, so that
/// together with the track they are T_n_o.
enum StateIndex : int {
  kNorth,
  kEast,
  kDown,             ///< of the body in n, m
  kHeading,          ///< of o against n, rad: q_n_b = Rz(heading) q_o_b
  kHeadingRate,      ///< its rate, rad/s; 0 unless a gyroscope is chained
  kLogScale,         ///< log of metres per unit of the front-end's displacements
  kLogFactor,        ///< log of the true step length by the stated one
  kStepHeading,      ///< walking direction minus the steps' heading, rad
  kAttitudeHeading,  ///< of the attitude source's frame against n, rad: q_n_b = Rz(.) q_attitude
  kBarometer,        ///< barometer's height downwards minus down, m
  kClimb,            ///< vertical velocity downwards where steps carry, m/s
  kStates
};

using StateVector = Eigen::Matrix<double, kStates, 1>;
using StateSet = std::bitset<kStates>;

/// residual = z - h(x), its derivative by the state, and the covariance of z.
template <int D>
struct Innovation {
  Eigen::Matrix<double, D, 1> residual = Eigen::Matrix<double, D, 1>::Zero();
  Eigen::Matrix<double, D, kStates> H = Eigen::Matrix<double, D, kStates>::Zero();
  Eigen::Matrix<double, D, D> noise = Eigen::Matrix<double, D, D>::Zero();
  /// Process noise that has entered the state since the measurement's time: of a late one, eq. (9).
  StateVector since = StateVector::Zero();
};

/// The Kalman filter of T_n_o, scale, steps, heading and height (docs/estimator.md). Fixed size; allocates for held
/// poses alone. One thread at a time.
class Localizer {
 public:
  StateVector x = StateVector::Zero();
  Eigen::Matrix<double, kStates, kStates> P = Eigen::Matrix<double, kStates, kStates>::Zero();

  Eigen::Vector3d p_n() const { return x.head<3>(); }
  Eigen::Quaterniond q_n_o() const {
    return Eigen::Quaterniond(Eigen::AngleAxisd(x[kHeading], Eigen::Vector3d::UnitZ()));
  }
  double sigma(StateIndex i) const { return std::sqrt(std::max(0.0, P(i, i))); }

  /// The body has moved by d_n, m, which errs by these states as given, and by noise of its own, m^2. Eq. (3).
  void move(const Eigen::Vector3d& d_n, std::initializer_list<std::pair<StateIndex, Eigen::Vector3d>> by,
            const Eigen::Matrix3d& noise);
  /// x[to] += factor * x[from], eq. (4).
  void add_multiple(StateIndex to, StateIndex from, double factor);
  void add_variance(StateIndex i, double variance) { P(i, i) += variance; }
  /// A Gauss-Markov state forgets: its distance from `mean` becomes `keep` of it, and a variance is added.
  void decay(StateIndex i, double mean, double keep, double variance);
  /// Known anew, independently of all else.
  void set(StateIndex i, double value, double variance);
  /// The same error stated anew with another variance: correlations scale with it.
  void restate(StateIndex i, double variance);
  /// Errs by the same as another state from now on.
  void copy_error(StateIndex to, StateIndex from);

  /// Kalman update behind a gate on the normalised innovation squared (0: none), eq. (6) to (8). Considered states
  /// (Schmidt 1966) count with their doubt, but are not moved.
  template <int D>
  UpdateResult update(const Innovation<D>& innovation, double max_nis, StateSet considered = {});
  /// The state moves, held poses with it by `share` each: n was wrong, not the path. Position and its covariance.
  void shift(const Eigen::Vector3d& by_n, const Eigen::Matrix3d& covariance, double fixed_m, double now_m);
  /// All that is in n turns about a place: body, held poses and headings.
  void rotate(double by_rad, const Eigen::Vector3d& about_n);
  /// The headings against n may all be off together by that much, about the body's place.
  void loosen_heading(double sigma_rad);

  /// Keeps a pose of the track as long as somebody wants it. Its number, from 1.
  uint64_t hold(const TrackPoint& then, const TrackPoint& now);
  void let_go(uint64_t id);
  /// False where it is not held. `tilt_variance` fills the rotation's horizontal part.
  bool held(uint64_t id, double tilt_variance, HeldPose& out) const;
  Eigen::Matrix<double, 6, 6> pose_covariance(double tilt_variance) const;

 private:
  /// Errors of (heading, position), moved where those of now are (delayed-state pose), eq. (11), (12).
  struct Held {
    uint64_t id = 0;
    double path_m = 0;
    Eigen::Quaterniond q_n_b;
    Eigen::Vector3d p_n;
    Eigen::Matrix<double, 4, kStates> cross;
    Eigen::Matrix4d own;
  };
  std::vector<Held> held_;
  uint64_t last_held_ = 0;
};

/// Of what a place moves by, by a small heading: z x r.
inline Eigen::Vector3d across(const Eigen::Vector3d& r_n) { return {-r_n.y(), r_n.x(), 0.0}; }

/// All states but those: what a measurement considers.
inline StateSet all_but(std::initializer_list<StateIndex> states) {
  StateSet out;
  out.set();
  for (const StateIndex i : states) out.reset(static_cast<size_t>(i));
  return out;
}
inline StateSet these(std::initializer_list<StateIndex> states) { return ~all_but(states); }

/// Of a normalised innovation squared, by its degrees of freedom: 99.9 % of good measurements pass (chi-square).
inline constexpr double kGate[] = {0, 10.83, 13.82, 16.27, 18.47};

inline double squared(double x) { return x * x; }

/// One sigma of a heading of which nothing is known, rad: uniform over the circle, pi / sqrt(3).
inline constexpr double kAnyHeading_rad = 1.8;

}  // namespace odograph
