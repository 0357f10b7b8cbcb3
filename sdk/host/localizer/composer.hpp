// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/localizer/fix_update.hpp"
#include "sdk/host/localizer/floor_estimator.hpp"
#include "sdk/host/localizer/front_end.hpp"
#include "sdk/host/localizer/retained_poses.hpp"
#include "sdk/host/localizer/lift_detector.hpp"
#include "sdk/host/localizer/motion_source.hpp"
#include "sdk/host/localizer/pose_output.hpp"
#include "sdk/host/localizer/tracker.hpp"
#include "sdk/host/localizer/walker.hpp"

namespace odograph {

/// Fuses all inputs into one pose: a motion source moves the track in o, absolute measurements move T_n_o
/// (docs/estimator.md). `coupling: paper` follows the papers: each frame's displacement is multiplied by that frame's
/// scale (Antigny et al. 2019, eq. (5) to (8)), and fixes move the position, not the path. Inputs arrive in the
/// pipeline's processing order, IMU samples in time order. Not thread-safe. The output depends only on the inputs and
/// the config.
class Composer : public RetainedPoses {
 public:
  Composer(const CouplingConfig& config, const StartPose& start, LocalizerInputs inputs);
  Composer(const Composer&) = delete;
  Composer& operator=(const Composer&) = delete;
  /// Restarts, for a sensor clock that was set back. The calibration is retained.
  void reset();
  /// No sensor delivered data until then: the velocity becomes unknown, and the position uncertainty grows.
  void pause(int64_t until_ns);

  void on_calibration(const odo_calibration& calibration) { front_end_.on_calibration(calibration); }
  /// Takes a complete sample, gyroscope and accelerometer.
  void add_imu(const odo_imu& imu) { tracker_.inertia.add(imu); }
  UpdateResult update(const Measurement& measurement);
  /// Writes the orientation at the earlier frame into a motion (ODO_FLAG_NAVIGATION), for scale sources.
  void prepare(odo_vo_motion& motion) const;

  /// The pose at t, or the newest for INT64_MIN. At most 0.5 s beyond the newest pose, flagged as extrapolated.
  /// ODO_NOT_READY before the first pose, ODO_E_NOT_FOUND outside the stored track.
  int32_t at(int64_t t_ns, Estimate& out) const;
  /// Returns each pose to publish once, for a frame, a step or the first attitude; false if there is none.
  bool take_pose(odo_pose& pose) { return output_.take_pose(pose); }
  /// Returns each jump of the track once, with the corrected latest pose; false if there is none.
  bool take_correction(Correction& correction, odo_pose& pose) { return output_.take_correction(correction, pose); }
  /// Returns a metric displacement reference for the step estimator, as a position fix; false if there is none.
  bool take_step_reference(odo_fix& reference) { return output_.take_step_reference(reference); }
  /// Returns each message for the user once.
  Notice take_notice();
  uint64_t retain_pose(int64_t t_ns) override;
  void release_pose(uint64_t id) override { tracker_.localizer.release_pose(id); }
  bool retained_pose(uint64_t id, RetainedPose& out) const override;
  bool pose_now(RetainedPose& out) const override;
  bool is_placed() const override { return (fixes_.placed() & FixUpdate::kHorizontal) == FixUpdate::kHorizontal; }
  ScaleKnowledge scale_knowledge() const { return front_end_.scale().knowledge(tracker_.localizer); }
  double distance_m() const { return output_.distance_m(); }
  const MotionSource& source() const { return source_; }
  /// Floor of the building from the barometer, relative to the start of the track; probability 0 without a barometer.
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
  void update_lift(const odo_barometer& barometer);
  void update_floor(int64_t t_ns);
  void begin_camera(int64_t t_ns);
  /// Records a displacement by steps, in n.
  void record_steps(const Eigen::Vector3d& moved_n, int64_t now_ns);
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
  int32_t reported_floor_ = 0;          ///< last reported floor
  std::array<char, 80> floor_text_{};   ///< text of that report
  MotionSource source_;
  bool shown_ = false;    ///< positions are published
  bool strays_ = false;   ///< since the newest motion in metres, the camera was blind or moved without a scale
  bool stepped_ = false;  // steps or a lift moved the track during the current measurement
  Notice notice_;
};

}  // namespace odograph
