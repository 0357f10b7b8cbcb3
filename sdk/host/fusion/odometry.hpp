// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "sdk/host/fusion/fusion_state.hpp"
#include "sdk/host/fusion/gyro_orientation.hpp"
#include "sdk/host/fusion/scale.hpp"
#include "sdk/host/fusion/scale_check.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph {

/// Applies a front-end's motions to the track: rotation, scale and displacement, with their uncertainty.
class Odometry {
 public:
  struct Parameters {
    double drift_per_root_m = 0.01;  ///< m/sqrt(m), horizontal axes, without scale and heading (odograph bench vo)
    /// m/sqrt(m), vertical axis: 0.4 to 1.2 m over 700 m of three simulated walks.
    double height_drift_per_root_m = 0.02;
    double rotation_walk = 1e-3;  ///< rad/sqrt(s), heading random walk: 0.018 deg a frame at 10 Hz (odograph bench vo)
    double inertial_rotation_walk = 1.5e-3;  ///< the same with inertia: 3 to 50 mrad over ten minutes of six real walks
    double start_rate_radps = 0.01;  ///< rad/s, gyroscope bias of a front-end with inertia before it has walked; 4.6 to
                                     ///< 17 mrad/s on four stabilised phones, below 1 without a stabiliser
    /// Of log-scale. Below it, a front-end with inertia has walked and its scale is better known than step lengths vary
    /// between walkers, so steps do not update it.
    double converged_scale_sigma = 0.10;
    double priority_scale_sigma = 0.2;  ///< of log-scale: above it, a front-end with inertia does not outweigh fixes
    double rotation_off_rad = 0.015;   ///< rad between the rotations of front-end and gyroscope, above which the former
                                       ///< is rejected; stabilised lenses differ by 2 to 3 mrad; empirical
    double rotation_off_share = 0.05;  ///< of the rotation, for gyroscope scale factor and rolling shutter; empirical
    double tilt_time_s = 10;  ///< s, time constant with which the attitude corrects the inclination of a front-end
                              ///< without inertia; judgement
    double rewind_s = 1.5;    ///< s before the first metric motion, or the first after a gap, that inertia covers: an
                            ///< inclination error of 5 mrad causes 6 cm; front-ends start in 1.2 s (odograph bench vo)
    double rewind_sigma_mps = 0.1;       ///< m/s, of the velocity used in this back-propagation
    double silent_start_s = 6.0;         ///< s after the first frame of a camera that has never moved
    double unstated_scale_sigma = 0.02;  ///< relative, of a metric front-end that states none; judgement
    /// 1/sqrt(s), random walk of log-scale of a metric front-end: 0.5 % in ten minutes; judgement.
    double metric_scale_walk = 2e-4;
    double scale_walk = 2e-3;            ///< 1/sqrt(m), of any other: 0.9 % between halves of 10 m (odograph bench vo)
    double rejected_scale_walk = 0.015;  ///< 1/sqrt(m), of one whose metric scale contradicts the steps
    double walking_m = 0.5;              ///< m in one second, above which the camera walks: half the slowest walk
  };

  /// A motion while it is processed, and what came of it.
  struct Motion {
    const odo_vo_motion& m;
    TrackPoint from;
    Eigen::Quaterniond q_o_c0, q_o_b1;
    double dt_s;
    bool metric, inertial;
    uint32_t state, reason;
    bool rotates = false, translates = false;  ///< parts that are used
    bool rotation_known = false;
    Eigen::Vector3d d_o = Eigen::Vector3d::Zero();  ///< of the camera, m
    double caught_up_m = 0;                         ///< of earlier motions that waited for their scale
    bool uncertain = false;  ///< the track's position has a covariance that unobserved motion adds to
    bool moves = false;      ///< the track, by a metric displacement (papers: up to scale)
  };

  Odometry(FusionState& state, FusionInputs inputs) : state_(state), inputs_(inputs), gyroscope_(state) {}
  virtual ~Odometry() = default;
  Odometry(const Odometry&) = delete;
  Odometry& operator=(const Odometry&) = delete;

  void on_calibration(const odo_calibration& calibration);
  bool is_calibrated() const { return calibrated_; }
  /// The camera starts: its first frame or its first motion.
  void begin(int64_t t_ns, bool has_stepped, bool was_placed);
  bool begun() const { return first_frame_.has_value(); }
  /// No sensor delivered data for a while. Discards the displacement that waits for its scale, because it is unknown
  /// how much of that time it covers.
  void pause() { group_.take_unscaled(); }
  /// `placed`: positions have been published, or the position in n is known. `fresh`: neither steps, fixes nor motions
  /// have moved the track.
  Motion apply(const odo_vo_motion& motion, const odo_scale* scale, bool placed, bool fresh);
  /// A scale that arrives without a motion.
  virtual UpdateResult apply(const odo_scale& scale);
  /// Compares a step with the metric scale; true if this changes the verdict of the scale check.
  bool check_metric_scale(const odo_step& step, const Eigen::Vector3d& moved_o);
  GyroOrientation& gyroscope() { return gyroscope_; }

  /// No displacement will arrive any more for the time until now.
  bool is_silent(int64_t now_ns) const;
  bool moves() const { return moves_; }
  /// Time at which it last moved the track.
  Instant moved() const { return moved_; }
  const ScaleGroup& group() const { return group_; }
  /// Whether the motion's displacement is in metres that have not proved wrong: it needs no scale.
  bool is_in_metres(const odo_vo_motion& m) const;
  bool scale_rejected() const { return scale_check_.rejected(); }
  bool is_metric_scale_known() const;  ///< metric scale is known well enough that steps do not update it
  bool has_priority() const;
  Instant priority_since() const { return priority_since_; }
  bool metric() const { return group_.metric; }
  Scale& scale() { return scale_; }
  const Scale& scale() const { return scale_; }
  const Eigen::Quaterniond& q_b_c() const { return q_b_c_; }
  const Eigen::Vector3d& p_b_c() const { return p_b_c_; }
  /// Of the camera at its last motion, while the track has a velocity (Trajectory::velocity).
  const Eigen::Vector3d& camera_velocity_o() const { return camera_velocity_o_; }
  Eigen::Vector3d gyro_bias_b = Eigen::Vector3d::Zero(), accel_bias_b = Eigen::Vector3d::Zero();

 protected:
  /// A scale group begins.
  virtual void begin_scale() { scale_.begin_group(state_.filter); }
  /// Decides which parts of the motion are used.
  virtual void select(Motion& motion) const;
  /// Corrects the inclination of q_o_b1.
  virtual void level(Motion& motion) const;
  /// Of the motion's heading, rad^2.
  virtual double heading_variance(const Motion& motion) const;
  /// Scales the displacement to metres; false if the scale is unknown.
  virtual bool to_metres(Motion& motion, const odo_scale* scale);

  void use_own_scale(const Motion& motion);
  double catch_up(bool applies, bool horizontal, bool uncertain);

  FusionState& state_;
  const FusionInputs inputs_;
  bool lost_ = false;

 private:
  Motion begin_motion(const odo_vo_motion& motion);
  std::optional<Eigen::Quaterniond> rotated(const Motion& motion);
  bool rotates_with_gyroscope(const odo_vo_motion& motion) const;
  bool is_impossible(const Motion& motion) const;
  void back_propagate(const Motion& motion, bool fresh);
  Eigen::Vector3d lever_velocity_o(const Motion& motion) const;
  void move(const Motion& motion);
  bool is_walking(int64_t t_ns) const;

  Parameters p_;
  Eigen::Quaterniond q_b_c_ = rear_camera_mount();
  Eigen::Vector3d p_b_c_ = Eigen::Vector3d::Zero();
  Scale scale_;
  ScaleCheck scale_check_;
  GyroOrientation gyroscope_;
  ScaleGroup group_;
  Eigen::Vector3d camera_velocity_o_ = Eigen::Vector3d::Zero();  // m/s
  bool moves_ = false, calibrated_ = false, has_stepped_ = false;
  Instant first_frame_, moved_, priority_since_;
  double outage_sigma_m_ = 0;  // of its motion since it last saw landmarks
};

}  // namespace odograph
