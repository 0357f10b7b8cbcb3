// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "sdk/host/estimator/estimator.hpp"
#include "sdk/host/estimator/held_poses.hpp"

namespace odograph::inertial {

/// Where each part of the error stands. Rotations err on the left: R_true = Exp(theta) R, theta in n; all others add.
/// A pose block is theta and position one after the other, of the body now, of the odometry and of each clone.
constexpr int kTheta = 0, kPosition = 3, kVelocity = 6, kGyroBias = 9, kAccelBias = 12;
constexpr int kVo = 15, kVoPosition = 18, kLogScale = 21, kLogFactor = 22, kStepHeading = 23, kNorth = 24, kBaro = 25;
constexpr int kFirstClone = 26, kClones = 12, kSize = kFirstClone + 6 * kClones;

using Covariance = Eigen::Matrix<double, kSize, kSize>;

/// The state that the errors are of.
struct State {
  Eigen::Quaterniond q_n_b = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_n = Eigen::Vector3d::Zero();               ///< m, of the body
  Eigen::Vector3d v_n = Eigen::Vector3d::Zero();               ///< m/s
  Eigen::Vector3d gyro_bias_b = Eigen::Vector3d::Zero();       ///< rad/s
  Eigen::Vector3d accel_bias_b = Eigen::Vector3d::Zero();      ///< m/s^2
  Eigen::Quaterniond q_n_vo = Eigen::Quaterniond::Identity();  ///< of the camera, as the odometry's map has it
  Eigen::Vector3d p_n_vo = Eigen::Vector3d::Zero();            ///< m
  double log_scale = 0;                                        ///< of the odometry's displacements, to metres
  double log_factor = 0;                                       ///< true step length by the step estimator's
  double step_heading_rad = 0;                                 ///< to be added to the steps' heading
  double north_rad = 0;  ///< heading of the attitude source minus the heading here
  double baro_m = 0;     ///< barometer's height downwards minus p_n.z
};

struct Clone {
  int64_t t_ns = INT64_MIN;
  Eigen::Quaterniond q_n_b = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_n = Eigen::Vector3d::Zero();
};

/// A pose between two clones, or between the newest clone and now: its error is (1 - w) times the one at `before` and
/// w times the one at `after` (columns of pose blocks).
struct PastPose {
  Eigen::Quaterniond q_n_b;
  Eigen::Vector3d p_n;
  int before, after;
  double w;
};

/// What an update leaves where it is (steps: log-factor and heading of the steps; odometry: its pose). Up to
/// odometry_and_scale what is held is taken as known by the gain, and what errs by it is not moved in its stead; with
/// "all but" the gain is the usual one.
enum class Hold {
  nothing,
  scale_and_factor,
  scale_and_steps,
  odometry_and_scale,
  all_but_steps,
  all_but_scale_and_steps,
};
/// The columns that it leaves where they are: from there, that many; of the first four.
std::pair<int, int> held_columns(Hold hold);
constexpr int kMaxHeld = 8;  // pose of the odometry, log-scale and log-factor

/// residual = z - h(x), its derivative by the error in blocks of three columns, and the covariance of z.
template <int D>
struct Innovation {
  using Vector = Eigen::Matrix<double, D, 1>;
  using Block = Eigen::Matrix<double, D, 3>;
  Vector residual = Vector::Zero();
  Eigen::Matrix<double, D, D> noise = Eigen::Matrix<double, D, D>::Zero();
  struct Part {
    int at, width;
    Block by;
  };
  std::array<Part, 12> parts;
  int count = 0;

  void by(int at, const Block& derivative) { parts[static_cast<size_t>(count++)] = {at, 3, derivative}; }
  void by_one(int at, const Vector& derivative) {
    Part& part = parts[static_cast<size_t>(count++)];
    part = {at, 1, Block::Zero()};
    part.by.col(0) = derivative;
  }
  void by_pose(const PastPose& pose, const Block& by_theta, const Block& by_position) {
    for (const auto& [at, weight] : {std::pair{pose.before, 1 - pose.w}, std::pair{pose.after, pose.w}}) {
      if (weight == 0) continue;
      if (!by_theta.isZero(0)) by(at, weight * by_theta);
      if (!by_position.isZero(0)) by(at + 3, weight * by_position);
    }
  }
};

/// How errors at the start of an interval become errors at its end (accumulated over IMU samples).
struct ImuTransition {
  Eigen::Matrix3d theta_by_bias, v_by_theta, v_by_gyro, v_by_accel, p_by_theta, p_by_gyro, p_by_accel;
  double s = 0;  ///< duration
  ImuTransition() { clear(); }
  void clear();
  /// Adds a sample: R_n_b at its middle, specific force in n, m/s^2.
  void add(const Eigen::Matrix3d& R_n_b, const Eigen::Vector3d& force_n, double dt_s);
};

/// Spectral densities over an interval, squared.
struct ImuNoise {
  double gyro, gyro_walk, accel, accel_walk, accel_down;
};

/// State, covariance and clones of the error-state Kalman filter (Sola 2017, with global angular errors; clones after
/// Roumeliotis & Burdick 2002). Fixed size, no allocation but for held poses.
class ErrorState {
 public:
  State x;
  Covariance P = Covariance::Zero();

  void reset();

  void propagate(const ImuTransition& by, const ImuNoise& noise);
  /// The pose now becomes a clone; the oldest goes.
  void clone(int64_t t_ns);
  void forget_clones() { clone_count_ = 0; }
  /// 0 is the newest.
  const Clone& clone_back(size_t i) const { return clones_[slot_back(i)]; }
  size_t clone_count() const { return clone_count_; }
  /// Column of its pose block.
  int column_back(size_t i) const { return kFirstClone + 6 * static_cast<int>(slot_back(i)); }

  /// The odometry's pose is set to the camera's there, whose errors it shares, and noise added, squared.
  void attach_vo(const PastPose& at, const Eigen::Quaterniond& q_b_c, const Eigen::Vector3d& p_b_c,
                 double position_variance, double rotation_variance);
  /// The odometry goes on: rotation, displacement in its own axes and scale. `expected_n` is the same displacement, m,
  /// as it was expected: the derivative by the scale is taken there, since the odometry's own noise in it would pull
  /// the scale, and all that depends on it, towards zero.
  void move_vo(const Eigen::Quaterniond& q_c0_c1, const Eigen::Vector3d& p_c0_c1, const Eigen::Vector3d& expected_n,
               double position_variance, double rotation_variance);

  /// The body is shifted to where the scale, just known, says that a displacement led; clones are to be forgotten. What
  /// position and velocity err by is the scale's error (its variance) along them and variances of their own.
  void place(const Eigen::Vector3d& shift_n, const Eigen::Vector3d& displacement_n, const Eigen::Vector3d& v_n,
             double position_variance, double velocity_variance);
  /// The log-scale is known anew; a share of its error is the walker's log-factor's.
  void set_scale(double log_scale, double variance, double factor_share);

  /// A scalar part is known anew, and independently of the others.
  void set_independent(int at, double variance);
  void add_variance(int at, int count, double variance) { P.diagonal().segment(at, count).array() += variance; }
  /// A scalar part forgets: its error becomes `keep` of it, and a variance is added.
  void wander(int at, double decay, double variance);
  /// Everything is moved together, but not what is held.
  void shift(const Eigen::Vector3d& by_n);
  /// What is held follows a shift of everything, whose covariance is given, by its share: share_of_correction.
  void shift_held(const Eigen::Vector3d& by_n, const Eigen::Matrix3d& covariance, double fixed_m, double now_m);
  /// Everything is moved by a step whose derivatives by log-factor and steps' heading and whose noise are given.
  void shift_by_step(const Eigen::Vector3d& by_n, const Eigen::Vector3d& by_factor, const Eigen::Vector3d& by_heading,
                     const Eigen::Matrix3d& noise);
  /// Everything but what is held may have been moved together by that much, m.
  void loosen_position(const Eigen::Matrix3d& covariance);
  /// n itself is turned about a place: everything that is in n, and what is held.
  void rotate(const Eigen::Quaterniond& q, const Eigen::Vector3d& about_n);
  /// Everything may have been turned together about down, through the body's place, rad.
  void loosen_heading(double sigma_rad);

  /// The horizontal velocity may have changed then by that much in each axis, and what followed with it.
  void loosen_velocity_since(int64_t t_ns, int64_t now_ns, double sigma_mps);

  /// Of a pose's rotation in n and position.
  Eigen::Matrix<double, 6, 6> covariance(const PastPose& at) const;

  /// Keeps a pose of the past as long as somebody wants it (error_state_held.cpp). Its number, from 1.
  uint64_t hold(const PastPose& at, int64_t t_ns, double path_m);
  void let_go(uint64_t id) { held_.remove(id); }
  /// False where it is not held.
  bool held(uint64_t id, HeldPose& out) const;

  /// Kalman update behind a gate on the normalised innovation squared (0: none). What is held are considered parameters
  /// (Schmidt 1966): their doubt counts, but this measurement does not move them.
  template <int D>
  UpdateResult update(const Innovation<D>& innovation, double max_nis, Hold hold = Hold::nothing);
  /// The same for a heading that is off by more than a small angle: positions and velocities move along arcs, each
  /// about the place that its correlation with the heading says, not along their tangents.
  UpdateResult update_heading(const Innovation<1>& heading, double max_nis);

 private:
  size_t slot_back(size_t i) const { return (newest_ + kClones - i) % kClones; }
  void apply(const Eigen::Matrix<double, kSize, 1>& error);
  void copy_pose_block(int from, int to);
  /// What an update did to the errors, for those that are not among them: gain K, its counterpart N (see update_given),
  /// and what made them.
  template <int D>
  struct Gain {
    using SquareD = Eigen::Matrix<double, D, D>;
    int first = 0, count = 0;  ///< columns that were held
    Eigen::Matrix<double, kMaxHeld, D> known = Eigen::Matrix<double, kMaxHeld, D>::Zero();
    SquareD inverse, half;
    Eigen::Matrix<double, kSize, D> K, N;
  };
  template <int D>
  void update_held(const Innovation<D>& innovation, const Gain<D>& gain, bool moves);
  template <int D>
  bool update_given(const Innovation<D>& innovation, Hold hold, const Eigen::Matrix<double, kSize, D>& PHt,
                    const Eigen::Matrix<double, D, D>& S);

  std::array<Clone, kClones> clones_;
  size_t clone_count_ = 0, newest_ = 0;
  HeldPoses<kSize> held_;
  uint64_t last_held_ = 0;
  bool turning_ = false;
};

}  // namespace odograph::inertial
