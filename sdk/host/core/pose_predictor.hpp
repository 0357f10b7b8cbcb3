// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <odograph/types.h>

#include "sdk/math/ring.hpp"
#include "sdk/host/fusion/inertial_track.hpp"
#include "sdk/host/core/smooth_pose.hpp"

namespace odograph {

/// Predicts poses ahead of the pipeline: propagates the newest pose with the inertial samples as they are pushed,
/// before they wait for slower sensors. Orientation follows the gyroscope; position follows the velocity and the
/// gravity-compensated accelerometer. If the pose is old (no camera, steps only), the orientation is the attitude's.
/// Not thread-safe (see PoseStream); each call takes less than a microsecond and allocates nothing.
class PosePredictor {
 public:
  struct Parameters {
    double ahead_s = 0.1;         ///< extrapolation beyond the newest sample with constant rate and force (judgement)
    double longest_s = 0.5;       ///< maximum extrapolation beyond the newest sample or pose (odograph.h)
    double position_for_s = 0.5;  ///< after the newest pose, the position is given this long, then only the orientation
    /// With an older pose, the orientation follows the attitude instead of the gyroscope.
    double attitude_after_s = 0.25;
    double velocity_window_s = 0.35;  ///< window of poses for the velocity fit: more than half a step (judgement)
    size_t velocity_poses = 3;        ///< minimum number of poses for the fit
    double planar_m = 0.001;   ///< m, height differences below which the pipeline is taken to move only horizontally
    double force_tau_s = 3.0;  ///< s, time constant of the force error in n (inclination, bias) with fitted velocities
    double largest_force_mps2 = 1.0;  ///< clamp of that error: 6 degrees of inclination
    double jump_m = 0.15;             ///< m from the predicted position, beyond which the track has jumped (judgement)
    double gravity_mps2 = 9.80665;    ///< standard gravity; elsewhere 0.03 off at most
    double velocity_sigma_mps = 0.1;  ///< of a known velocity; growth of the position's covariance (judgement)
    double walking_sigma_mps = 0.5;   ///< of a walker's velocity between steps: he may have stopped (Trajectory)
    double unknown_sigma_mps = 1.5;   ///< of an unknown velocity: walking speed
    double step_delay_s = 1.0;        ///< s, from the start of a step to its report: longer without one is no motion
  };

  /// The pipeline's best estimate: a pose and the body's state at its time. That is the newest published pose, or a
  /// later one if the estimator has propagated inertial samples.
  struct Base {
    odo_pose pose{};  ///< of the camera, or of the body without one
    Eigen::Quaterniond q_n_b = Eigen::Quaterniond::Identity();
    Eigen::Vector3d p_n_b = Eigen::Vector3d::Zero();  ///< m
    /// Velocity at the pose's time, m/s, if the pipeline has it; a mean over the last frames does not count.
    std::optional<Eigen::Vector3d> v_n_b;
    /// The pose is the end of a step, and its velocity the walker's until then, when the next step is due. A walker who
    /// takes none has stood since the last one: the predicted pose returns to it.
    std::optional<int64_t> walks_until_ns;
    struct Biases {
      Eigen::Vector3d gyro_b, accel_b;  ///< rad/s, m/s^2
    };
    std::optional<Biases> biases;  ///< subtracted from later samples, if the pipeline has them
  };

  PosePredictor() : PosePredictor(Parameters(), SmoothPose::Parameters()) {}
  PosePredictor(const Parameters& parameters, const SmoothPose::Parameters& smooth);

  void add_imu(const odo_imu& imu) { track_.add(imu); }
  /// Its gyroscope bias counts until a pose brings biases.
  void add_attitude(const odo_attitude& attitude);
  /// Takes the pose published for this time, or its correction.
  void add_pose(int64_t published_ns, const Base& base);
  /// Applies a correction: a point x in the old n is at `correction` * x in the new one; the corrected pose follows.
  void correct(const Rigid& correction);
  /// Sets the pipeline's state.
  void set_state(uint32_t state, uint32_t reason) { state_ = state, reason_ = reason; }

  /// Time of the newest published pose; INT64_MIN before the first.
  int64_t published_ns() const { return published_ns_; }
  /// The pose at t, later than the newest published one; INT64_MIN: at the newest sample. ODO_NOT_READY without pose
  /// and attitude, ODO_E_NOT_FOUND beyond longest_s. Flags mark the valid parts; `smooth`: with corrections blended in.
  int32_t at(int64_t t_ns, bool smooth, odo_pose& out) const;
  /// The smooth pose at the time of the newest published pose.
  Rigid smooth_pose(const odo_pose& published) const;
  void clear();

 private:
  struct Body {
    Eigen::Quaterniond q_n_b = Eigen::Quaterniond::Identity();
    Eigen::Vector3d p_n_b = Eigen::Vector3d::Zero(), v_n_b = Eigen::Vector3d::Zero(), rate_b = Eigen::Vector3d::Zero();
  };
  /// A pose used in the velocity fit.
  struct FitSample {
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
  SmoothPose::Pose smoothed(int64_t t_ns, const SmoothPose::Pose& pose) const;
  void align_attitude();
  void choose_velocity(const std::optional<Eigen::Vector3d>& predicted);
  bool fit_velocity();
  /// Position from the end of the newest step.
  void walk_on(int64_t t_ns, Body& body) const;

  Parameters parameters_;
  InertialTrack track_;
  int64_t published_ns_ = INT64_MIN;
  Base base_;
  Eigen::Quaterniond q_b_c_ = Eigen::Quaterniond::Identity();  // orientation of the base's pose relative to its body
  Eigen::Vector3d p_b_c_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_n_b_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_b_ = Eigen::Vector3d::Zero();   // between the last two poses, used without a gyroscope
  Eigen::Vector3d force_n_ = Eigen::Vector3d::Zero();  // m/s^2, correction added to force and gravity
  bool planar_ = false;                                // the pipeline moves only horizontally
  Velocity velocity_ = Velocity::none;
  std::optional<InertialTrack::Point> base_point_;
  Attitude attitude_;
  bool has_pose_bias_ = false;
  Eigen::Quaterniond q_align_ = Eigen::Quaterniond::Identity();  // from the attitude's n to the pose's n
  Ring<FitSample, 32> fit_samples_;
  uint32_t state_ = ODO_LOST, reason_ = ODO_REASON_INITIALISING;
  CorrectionBlend blend_;  // announced corrections
  SmoothPose smooth_;      // errors of the prediction, and corrections too small to be announced
  // Latest time of a smooth pose returned; what was shown up to here must not change.
  mutable int64_t queried_ns_ = INT64_MIN;
};

}  // namespace odograph
