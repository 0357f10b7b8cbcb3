// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <variant>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "sdk/host/localizer/measurement.hpp"
#include "sdk/host/localizer/scale_consistency_check.hpp"
#include "sdk/host/localizer/gyro_orientation.hpp"
#include "sdk/host/localizer/scale_group.hpp"
#include "sdk/host/localizer/scale_update.hpp"
#include "sdk/host/localizer/tracker.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph {

/// Applies a front-end's motions to the track: rotation, scale and displacement, with their uncertainty.
class FrontEnd {
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
    double rewind_s = 1.5;    ///< s before the first metric motion that inertia covers: an inclination error of 5 mrad
                              ///< causes 6 cm; front-ends start in 1.2 s (odograph bench vo)
    double rewind_sigma_mps = 0.1;       ///< m/s, of the velocity used in this back-propagation
    double silent_start_s = 6.0;         ///< s after the first frame of a camera that has never moved
    double unstated_scale_sigma = 0.02;  ///< relative, of a metric front-end that states none; judgement
    /// 1/sqrt(s), random walk of log-scale of a metric front-end: 0.5 % in ten minutes; judgement.
    double metric_scale_walk = 2e-4;
    double scale_walk = 2e-3;            ///< 1/sqrt(m), of any other: 0.9 % between halves of 10 m (odograph bench vo)
    double rejected_scale_walk = 0.015;  ///< 1/sqrt(m), of one whose metric scale contradicts the steps
    double walking_m = 0.5;              ///< m in one second, above which the camera walks: half the slowest walk
  };

  FrontEnd(Tracker& tracker, LocalizerInputs inputs) : tracker_(tracker), inputs_(inputs), gyroscope_(tracker) {}
  void reset();
  /// No sensor delivered data for a while. Discards the displacement that waits for its scale, because it is unknown
  /// how much of that time it covers.
  void pause() { group_.take_unscaled(); }
  void on_calibration(const odo_calibration& calibration);

  /// The camera starts: its first frame or its first motion.
  void begin(int64_t t_ns, bool has_stepped);
  bool begun() const { return first_frame_ns_ != INT64_MIN; }

  struct Outcome {
    uint32_t state, reason;
    bool moved;             ///< the track, by a metric displacement (paper mode: up to scale)
    double moved_m;         ///< by the camera
    double caught_up_m;     ///< of that, by earlier motions that had no scale
    bool metric, inertial;  ///< of the motion
  };
  /// State of the track when a motion arrives.
  struct TrackState {
    bool shown;        ///< positions have been published
    bool placed;       ///< its position in n is known
    bool fixed;        ///< ... from a fix
    bool has_stepped;  ///< steps have been received
  };
  Outcome apply(const RelativeMotion& relative, const TrackState& track);
  GyroOrientation& gyroscope() { return gyroscope_; }
  /// A scale that arrives without a motion.
  UpdateResult apply(const odo_scale& scale);
  /// Compares a step with the metric scale; true if this changes the verdict of the scale check.
  bool check_metric_scale(const odo_step& step, const Eigen::Vector3d& moved_o);

  /// No displacement will arrive any more for the time until now.
  bool is_silent(int64_t now_ns) const;
  bool lost() const { return lost_; }
  bool moves() const { return moves_; }
  /// Time at which it last moved the track; INT64_MIN before that.
  int64_t moved_ns() const { return translated_ns_; }
  const ScaleGroup& group() const { return group_; }
  bool scale_rejected() const { return scale_check_.rejected(); }
  bool is_metric_scale_known() const;  ///< metric scale is known well enough that steps do not update it
  bool has_priority() const;
  int64_t priority_since_ns() const { return priority_since_ns_; }
  bool metric() const { return group_.metric; }
  ScaleUpdate& scale() { return scale_; }
  const ScaleUpdate& scale() const { return scale_; }
  const Eigen::Quaterniond& q_b_c() const { return q_b_c_; }
  const Eigen::Vector3d& p_b_c() const { return p_b_c_; }
  /// Of the camera at its last motion, while the track has a velocity (Tracker::velocity).
  const Eigen::Vector3d& camera_velocity_o() const { return camera_velocity_o_; }
  Eigen::Vector3d gyro_bias_b = Eigen::Vector3d::Zero(), accel_bias_b = Eigen::Vector3d::Zero();

 private:
  /// A motion while it is processed.
  struct MotionUpdate {
    const odo_vo_motion& m;
    TrackPoint from;
    Eigen::Quaterniond q_o_c0, q_o_b1;
    double dt_s;
    bool metric, inertial, rotates, translates, rotation_known;
    uint32_t state, reason;
    Eigen::Vector3d d_o;     ///< of the camera, m
    double caught_up_m = 0;  ///< by earlier motions that waited for the scale
    bool doubtful = false;   ///< unobserved motion makes the track's position uncertain
  };
  MotionUpdate begin_motion(const odo_vo_motion& motion);
  std::optional<Eigen::Quaterniond> rotated(const MotionUpdate& motion);
  bool rotates_with_gyroscope(const odo_vo_motion& motion) const;
  double heading_variance(const MotionUpdate& motion) const;
  void correct_inclination(MotionUpdate& motion) const;
  bool apply_metric_scale(MotionUpdate& motion, const odo_scale* scale);
  bool apply_paper_scale(MotionUpdate& motion, const odo_scale* scale);
  double catch_up(const odo_scale* scale, bool horizontal, bool doubtful);
  bool is_impossible(const MotionUpdate& motion) const;
  void back_propagate_start(const MotionUpdate& motion);
  Eigen::Vector3d lever_velocity_o(const MotionUpdate& motion) const;
  void move(const MotionUpdate& motion, bool moves);
  bool is_walking(int64_t t_ns) const;

  Parameters p_;
  Tracker& tracker_;
  LocalizerInputs inputs_;
  Eigen::Quaterniond q_b_c_ = rear_camera_mount();
  Eigen::Vector3d p_b_c_ = Eigen::Vector3d::Zero();
  ScaleUpdate scale_;
  ScaleConsistencyCheck scale_check_;
  GyroOrientation gyroscope_;

  Eigen::Vector3d camera_velocity_o_ = Eigen::Vector3d::Zero();  // m/s
  ScaleGroup group_;
  bool lost_ = false, moves_ = false;
  int64_t first_frame_ns_ = INT64_MIN, translated_ns_ = INT64_MIN, priority_since_ns_ = INT64_MIN;
  double outage_sigma_m_ = 0;  // of its motion since it last saw landmarks
};

}  // namespace odograph
