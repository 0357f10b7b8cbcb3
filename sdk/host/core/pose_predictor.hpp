// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <optional>

#include <odograph/types.h>

#include "sdk/math/ring.hpp"
#include "sdk/host/localizer/inertial_track.hpp"
#include "sdk/host/core/smooth_pose.hpp"

namespace odograph {

/// Poses ahead of the pipeline: the newest pose carried on with the inertial samples as they are pushed, which is
/// before they have waited for slower sensors. Orientation follows the gyroscope, position the velocity and the
/// accelerometer without gravity. Where the pose is old (no camera, steps alone) the orientation is the attitude's.
/// Thread-safe: each call holds a lock for less than a microsecond and allocates nothing.
class PosePredictor {
 public:
  struct Parameters {
    double ahead_s = 0.1;             ///< beyond the newest sample with constant rate and force (judgement)
    double longest_s = 0.5;           ///< beyond the newest of all there is no answer (odograph.h)
    double position_for_s = 0.5;      ///< after the newest pose the position is told, then orientation alone
    double attitude_after_s = 0.25;   ///< an older pose's orientation follows the attitude instead of the gyroscope
    double velocity_window_s = 0.35;  ///< of poses that a velocity is fitted to: more than half a step (judgement)
    size_t velocity_poses = 3;        ///< fewer tell none
    double level_m = 0.001;    ///< positions that differ by less in height: the pipeline moves horizontally alone
    double force_tau_s = 3.0;  ///< for what the force errs by in n (inclination, bias) with fitted velocities
    double largest_force_mps2 = 1.0;  ///< of that error: 6 degrees of inclination
    double jump_m = 0.15;             ///< further from where it was predicted the track has jumped (judgement)
    double gravity_mps2 = 9.80665;    ///< standard gravity; elsewhere 0.03 off at most
    double velocity_sigma_mps = 0.1;  ///< of a known velocity: how the position's covariance grows (judgement)
    double unknown_sigma_mps = 1.5;   ///< without one: a walk
  };

  /// What the pipeline knows best: a pose and the body's state at its time, which is that of the newest pose that it
  /// has published, or later where its estimate has gone on with inertial samples.
  struct Base {
    odo_pose pose{};  ///< of the camera, or of the body without one
    Eigen::Quaterniond q_n_b = Eigen::Quaterniond::Identity();
    Eigen::Vector3d p_n_b = Eigen::Vector3d::Zero();  ///< m
    /// Velocity at the pose's time, m/s, where the pipeline has one; a mean over the last frames is none.
    std::optional<Eigen::Vector3d> v_n_b;
  };

  PosePredictor() : PosePredictor(Parameters(), SmoothPose::Parameters()) {}
  PosePredictor(const Parameters& parameters, const SmoothPose::Parameters& smooth);

  /// A sample as it was pushed. [any]
  void add_imu(const odo_imu& imu);
  /// Subtracted from the samples to come, rad/s and m/s^2. [process]
  void set_biases(const Eigen::Vector3d& gyro_b, const Eigen::Vector3d& accel_b);
  void add_attitude(const odo_attitude& attitude);
  /// A pose of this time has been published, or published anew because it was corrected. [process]
  void add_pose(int64_t published_ns, const Base& base);
  /// What was at x in the old n is at q * x + p in the new one; the corrected pose follows. [process]
  void correct(const Eigen::Quaterniond& q, const Eigen::Vector3d& p);
  /// The pipeline's state from now on. [process]
  void set_state(uint32_t state, uint32_t reason);

  /// Time of the newest published pose; INT64_MIN before the first.
  int64_t published_ns() const;
  /// The pose at t, after the newest published one; INT64_MIN: at the newest sample. ODO_NOT_READY without pose and
  /// attitude, ODO_E_NOT_FOUND beyond longest_s. Flags say what is known; `smooth`: corrections blended in. [any]
  int32_t at(int64_t t_ns, bool smooth, odo_pose& out) const;
  /// Blends corrections into a pose of the past. [any]
  void smoothen(odo_pose& pose) const;
  void clear();

 private:
  struct Body {
    Eigen::Quaterniond q_n_b = Eigen::Quaterniond::Identity();
    Eigen::Vector3d p_n_b = Eigen::Vector3d::Zero(), v_n_b = Eigen::Vector3d::Zero(), rate_b = Eigen::Vector3d::Zero();
  };
  /// A pose that a velocity is fitted to.
  struct Support {
    int64_t t_ns = INT64_MIN;
    Eigen::Vector3d p_n_b = Eigen::Vector3d::Zero();
    InertialTrack::Point point;
  };
  struct Attitude {
    int64_t t_ns = INT64_MIN;
    Eigen::Quaterniond q_n_b = Eigen::Quaterniond::Identity();
  };
  enum class Velocity { none, mean, now };

  int64_t newest_ns() const;
  bool has_pose() const { return base_.pose.header.t_ns != INT64_MIN; }
  bool position_known(int64_t t_ns) const;
  Eigen::Quaterniond orientation_at(int64_t t_ns, Eigen::Vector3d& rate_b) const;
  Body body_at(int64_t t_ns) const;
  SmoothPose::Pose pose_of(const Body& body) const;
  void align_attitude();
  void choose_velocity(const std::optional<Eigen::Vector3d>& foreseen);
  bool fit_velocity();

  Parameters parameters_;
  mutable std::mutex mutex_;
  InertialTrack track_;
  int64_t published_ns_ = INT64_MIN;
  Base base_;
  Eigen::Quaterniond q_b_c_ = Eigen::Quaterniond::Identity();  // of the base's pose against its body
  Eigen::Vector3d p_b_c_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_n_b_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_b_ = Eigen::Vector3d::Zero();   // between the last two poses, where the gyroscope says nothing
  Eigen::Vector3d force_n_ = Eigen::Vector3d::Zero();  // m/s^2, added to force and gravity
  bool level_ = false;                                 // the pipeline moves horizontally alone
  Velocity velocity_ = Velocity::none;
  std::optional<InertialTrack::Point> base_point_;
  Attitude attitude_;
  Eigen::Quaterniond q_align_ = Eigen::Quaterniond::Identity();  // attitude's n to the pose's
  Ring<Support, 32> supports_;
  uint32_t state_ = ODO_LOST, reason_ = ODO_REASON_INITIALISING;
  SmoothPose smooth_;
  mutable int64_t asked_ns_ = INT64_MIN;  // up to here smooth poses have been given: what was seen stays where it was
};

}  // namespace odograph
