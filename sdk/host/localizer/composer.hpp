// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/localizer/fix_update.hpp"
#include "sdk/host/localizer/floor_estimator.hpp"
#include "sdk/host/localizer/front_end.hpp"
#include "sdk/host/localizer/held_poses.hpp"
#include "sdk/host/localizer/lift_detector.hpp"
#include "sdk/host/localizer/motion_source.hpp"
#include "sdk/host/localizer/pose_output.hpp"
#include "sdk/host/localizer/tracker.hpp"
#include "sdk/host/localizer/walker.hpp"

namespace odograph {

/// Composes one pose of everything: a motion source moves the track in o, and all that is absolute moves T_n_o
/// (docs/estimator.md). With `coupling: paper` by the papers' rules: each frame's displacement times that frame's scale
/// (Antigny et al. 2019, eq. (5) to (8)), fixes that move the position and not the path. Inputs come in the order in
/// which the pipeline handles them, IMU samples in order of time. One thread at a time. Output depends on the inputs
/// and the config alone.
class Composer : public HeldPoses {
 public:
  Composer(const CouplingConfig& config, const StartPose& start, LocalizerInputs inputs);
  Composer(const Composer&) = delete;
  Composer& operator=(const Composer&) = delete;
  /// As at the start, for a sensor clock that was set back. The calibration stays.
  void reset();
  /// No sensor gave anything until then: the velocity is none, and what is unknown of the position grows.
  void pause(int64_t until_ns);

  void on_calibration(const odo_calibration& calibration) { front_end_.on_calibration(calibration); }
  /// A whole sample, gyroscope and accelerometer.
  void add_imu(const odo_imu& imu) { tracker_.inertia.add(imu); }
  UpdateResult update(const Measurement& measurement);
  /// Writes the earlier frame's orientation into a motion (ODO_FLAG_NAVIGATION), for scale sources.
  void prepare(odo_vo_motion& motion) const;

  /// The pose at t, or the newest for INT64_MIN; ahead of the newest by at most 0.5 s, flagged as extrapolated.
  /// ODO_NOT_READY before the first, ODO_E_NOT_FOUND outside of what is kept.
  int32_t at(int64_t t_ns, Estimate& out) const;
  /// A pose to publish, for a frame, a step or the first attitude: each is given once; false when there is none.
  bool take_pose(odo_pose& pose) { return output_.take_pose(pose); }
  /// A jump of the track, once, with the latest pose anew; false when there is none.
  bool take_correction(Correction& correction, odo_pose& pose) { return output_.take_correction(correction, pose); }
  /// A metric displacement reference for the step estimator, as a position fix; false when there is none.
  bool take_step_reference(odo_fix& reference) { return output_.take_step_reference(reference); }
  /// Something that a person should know, once.
  Notice take_notice();
  uint64_t hold_pose(int64_t t_ns) override;
  void let_go(uint64_t id) override { tracker_.localizer.let_go(id); }
  bool held_pose(uint64_t id, HeldPose& out) const override;
  bool pose_now(HeldPose& out) const override;
  bool is_placed() const override { return (fixes_.placed() & FixUpdate::kHorizontal) == FixUpdate::kHorizontal; }
  ScaleKnowledge scale_knowledge() const { return front_end_.scale().knowledge(tracker_.localizer); }
  double distance_m() const { return output_.distance_m(); }
  const MotionSource& source() const { return source_; }
  /// Of a building, by the barometer, counted from where the track began; probability 0 without one.
  FloorEstimator::Floor floor() const { return floors_.floor(); }
  const Localizer& localizer() const { return tracker_.localizer; }

 private:
  UpdateResult apply_and_correct(const Measurement& measurement);
  UpdateResult apply(const FrameTime& frame);
  UpdateResult apply(const odo_attitude* attitude);
  UpdateResult apply(const RelativeMotion& relative);
  UpdateResult apply(const odo_step* step);
  UpdateResult apply(const odo_scale* scale) { return front_end_.apply(*scale); }
  UpdateResult apply(const odo_fix* fix);
  UpdateResult apply(const odo_barometer* barometer);
  UpdateResult ride(const odo_barometer& barometer);
  void see_lift(const odo_barometer& barometer);
  void see_floor(int64_t t_ns);
  void begin_camera(int64_t t_ns);
  /// What steps have moved by, in n.
  void note_steps(const Eigen::Vector3d& moved_n, int64_t now_ns);
  void publish(int64_t t_ns, uint32_t state, uint32_t reason);
  odo_pose make_pose(const TrackPoint& point) const;
  bool is_metric() const;
  void set_source(const MotionSource& source);

  LocalizerInputs inputs_;
  Tracker tracker_;
  FrontEnd front_end_;
  Walker walker_;
  FixUpdate fixes_;
  PoseOutput output_;
  HeightTrend heights_;
  LiftDetector lift_;
  FloorEstimator floors_;
  int64_t stepped_ns_ = INT64_MIN / 2;  ///< end of the newest step
  int32_t said_floor_ = 0;              ///< by the last report
  std::array<char, 80> floor_text_{};   ///< of it
  MotionSource source_;
  bool shown_ = false;    ///< positions are published
  bool stepped_ = false;  // steps, or a lift, have moved the track by the present measurement
  Notice notice_;
};

}  // namespace odograph
