// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <type_traits>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/fusion/displacement_reference.hpp"
#include "sdk/host/fusion/fixes.hpp"
#include "sdk/host/fusion/floors.hpp"
#include "sdk/host/fusion/fusion_state.hpp"
#include "sdk/host/fusion/odometry.hpp"
#include "sdk/host/fusion/outputs.hpp"
#include "sdk/host/fusion/pose_keeper.hpp"
#include "sdk/host/fusion/steps.hpp"

namespace odograph {

/// Fuses all inputs into one pose: a motion source moves the track in o, absolute measurements move T_n_o
/// (docs/estimator.md). Each input adds what it has to publish to `out`. Messages are borrowed for the call; each has
/// its own time, which may precede the newest IMU sample; they arrive in the pipeline's processing order, IMU samples
/// in time order. Not thread-safe. The output depends only on the inputs and the config.
class Fusion : public PoseKeeper {
 public:
  struct Parameters {
    double announced_jump_m = 0.05;        ///< m: smaller corrections are not reported
    double announced_rotation_rad = 0.01;  ///< rad
    double counted_m = 0.1;                ///< m of path: less may be jitter; empirical
    double reference_scale_sigma = 0.03;   ///< relative: a scale with a larger sigma is no reference for steps
  };

  Fusion(const CouplingConfig& config, const StartPose& start, FusionInputs inputs)
      : Fusion(config, start, inputs, std::type_identity<Odometry>()) {}

  void on_calibration(const odo_calibration& calibration) { odometry_->on_calibration(calibration); }
  /// Takes a complete sample, gyroscope and accelerometer.
  void on_imu(const odo_imu& imu) { state_.track.inertia.add(imu); }
  UpdateResult on_attitude(const odo_attitude& attitude, Outputs& out);
  /// A camera frame was received; the front-end's motion for it follows later.
  void on_frame(int64_t t_ns, Outputs& out);
  /// A front-end's motion with the scale that a scale source gave for it, or null.
  void on_motion(const odo_vo_motion& motion, const odo_scale* scale, Outputs& out);
  /// A scale that arrives without a motion.
  UpdateResult on_scale(const odo_scale& scale, Outputs& out);
  UpdateResult on_step(const odo_step& step, Outputs& out);
  virtual UpdateResult on_barometer(const odo_barometer& barometer, Outputs& out);
  /// With p_n filled in (Geodesy::resolve).
  UpdateResult on_fix(const odo_fix& fix, Outputs& out);
  /// A recognised place, odo_relative_pose or odo_map_pose.
  template <class Place>
  UpdateResult on_place(const Place& place, Outputs& out);
  /// No sensor delivered data until then: the velocity becomes unknown, and the position uncertainty grows.
  void on_pause(int64_t until_ns);

  /// Writes the orientation at the earlier frame into a motion (ODO_FLAG_NAVIGATION), for scale sources.
  void prepare(odo_vo_motion& motion) const;
  bool is_in_metres(const odo_vo_motion& motion) const { return odometry_->is_in_metres(motion); }
  /// The pose at t, or the newest. At most 0.5 s beyond the newest pose, flagged as extrapolated. ODO_NOT_READY before
  /// the first pose, ODO_E_NOT_FOUND outside the stored track.
  int32_t at(Instant t, Estimate& out) const;
  bool pose_now(KeptPose& out) const override;
  bool is_placed() const override { return (fixes_.placed() & Fixes::kHorizontal) == Fixes::kHorizontal; }
  ScaleKnowledge scale_knowledge() const { return odometry_->scale().knowledge(state_.filter); }
  double distance_m() const { return distance_m_; }
  MotionSource source() const { return state_.source(); }
  /// Floor of the building from the barometer, relative to the start of the track; probability 0 without a barometer.
  FloorEstimator::Floor floor() const { return floors_.floor(); }
  const PoseFilter& filter() const { return state_.filter; }

 protected:
  template <class Motions>
  Fusion(const CouplingConfig& config, const StartPose& start, FusionInputs inputs, std::type_identity<Motions>)
      : PoseKeeper(state_),
        inputs_(inputs),
        state_(config, start),
        odometry_(std::make_unique<Motions>(state_, inputs)),
        steps_(state_, *odometry_),
        fixes_(config.fix_gate_sigma, start.given, start.heading_given),
        shown_(!inputs.vo) {}

  /// What the papers' rules do otherwise (PaperFusion).
  virtual void move_by(const odo_step& step, Outputs& out);
  virtual void settle_steps(int64_t now_ns, Outputs& out);
  /// Adds to the distance: by a motion, and by a new pose.
  virtual void count(const Odometry::Motion& motion) { distance_m_ += shown_ ? motion.caught_up_m : 0.0; }
  virtual void count(const odo_pose& pose);
  virtual bool has_position() const { return shown_; }
  virtual bool is_metric() const { return shown_; }
  virtual bool has_scale() const { return odometry_->scale().known(); }

  void record(const Steps::Moved& moved, Outputs& out);

  const FusionInputs inputs_;
  FusionState state_;
  std::unique_ptr<Odometry> odometry_;
  Steps steps_;
  Fixes fixes_;
  bool shown_;  ///< positions are published
  double distance_m_ = 0;
  StateSet kept_by_heading_, kept_by_position_;  ///< states that a fix's heading and its position do not change

 private:
  template <class Apply>
  UpdateResult update(uint32_t reason, bool report_small, Outputs& out, Apply&& apply);
  void correct(const odo_pose& before, const odo_pose& after, uint32_t reason, bool report_small, Outputs& out);
  UpdateResult apply(const odo_attitude& attitude, Outputs& out);
  UpdateResult apply(const odo_barometer& barometer, Outputs& out);
  UpdateResult apply(const odo_fix& fix, Outputs& out);
  UpdateResult ride(const odo_barometer& barometer, Outputs& out);
  /// From the first sign of a camera on, so that one that starts late continues the track.
  bool poses_are_of_camera() const { return odometry_->begun() || (inputs_.vo && odometry_->is_calibrated()); }
  void begin_camera(int64_t t_ns);
  void publish(int64_t t_ns, uint32_t state, uint32_t reason, Outputs& out);
  odo_pose make_pose(const TrackPoint& point) const;

  Parameters p_;
  FloorEstimator floors_;
  DisplacementReference displacement_reference_;
  Instant step_end_;  // of the newest step
  MotionSource reported_source_ = MotionSource::nothing;
  bool unobserved_ = false;  // since the newest motion in metres, the camera was blind or moved without a scale
  bool stepped_ = false;     // steps or a lift moved the track during the current input
  Instant last_;             // the newest published pose, with its state
  uint32_t last_state_ = 0, last_reason_ = 0;
  Eigen::Vector3d counted_from_ = Eigen::Vector3d::Zero();
};

}  // namespace odograph
