// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/core/inertial_track.hpp"
#include "sdk/host/estimator/displacement_reference.hpp"
#include "sdk/host/estimator/estimator.hpp"
#include "sdk/host/estimator/gyro_attitude_filter.hpp"
#include "sdk/host/estimator/metre_check.hpp"
#include "sdk/host/estimator/timed_positions.hpp"
#include "sdk/host/localizer/attitude_log.hpp"
#include "sdk/host/localizer/coverage.hpp"
#include "sdk/host/localizer/fix_update.hpp"
#include "sdk/host/localizer/heading_update.hpp"
#include "sdk/host/localizer/height_update.hpp"
#include "sdk/host/localizer/localizer.hpp"
#include "sdk/host/localizer/motion_source.hpp"
#include "sdk/host/localizer/parameters.hpp"
#include "sdk/host/localizer/scale_update.hpp"
#include "sdk/host/localizer/step_update.hpp"
#include "sdk/host/localizer/track.hpp"

namespace odograph {

/// How far beyond the newest measurement a pose is given, with its velocity; by hand.
inline constexpr int64_t kMaxExtrapolation_ns = 500'000'000;

/// Composes one pose of everything: a motion source moves the track in o, and all that is absolute moves T_n_o
/// (docs/estimator.md). With `coupling: paper` by the papers' rules: each frame's displacement times that frame's scale
/// (Antigny et al. 2019, eq. (5) to (8)), fixes that move the position alone.
class Composer : public Estimator {
 public:
  Composer(const CouplingConfig& config, const StartPose& start, EstimatorInputs inputs,
           const LocalizerParameters& parameters = {});

  void on_calibration(const odo_calibration& calibration) override;
  void on_imu_noise(const odo_imu_noise&) override {}
  void propagate(const odo_imu& imu) override;
  UpdateResult update(const Measurement& measurement) override;
  void prepare(odo_vo_motion& motion) const override;
  int32_t at(int64_t t_ns, Estimate& out) const override;
  bool take_pose(odo_pose& pose) override;
  bool take_correction(Correction& correction, odo_pose& pose) override;
  bool take_step_reference(odo_fix& reference) override;
  ScaleKnowledge scale_knowledge() const override { return scale_.knowledge(localizer_); }
  Notice take_notice() override { return std::exchange(notice_, {}); }
  double distance_m() const override { return distance_m_; }
  void reset() override;
  uint64_t hold_pose(int64_t t_ns) override;
  void let_go(uint64_t id) override { localizer_.let_go(id); }
  bool held_pose(uint64_t id, HeldPose& out) const override;
  bool pose_now(HeldPose& out) const override;
  bool is_placed() const override { return (fixes_.placed() & FixUpdate::kHorizontal) == FixUpdate::kHorizontal; }

  const Localizer& localizer() const { return localizer_; }

 private:
  UpdateResult apply(const FrameTime& frame);
  UpdateResult apply(const odo_attitude* attitude);
  UpdateResult apply(const RelativeMotion& relative);
  UpdateResult apply(const odo_step* step);
  UpdateResult apply(const odo_scale* scale);
  UpdateResult apply(const odo_fix* fix);
  UpdateResult apply(const odo_barometer* barometer);
  UpdateResult apply(const odo_motion_mode*) { return {}; }

  // Time and the start (composer.cpp).
  void start(int64_t t_ns, const Eigen::Quaterniond& q_o_b);
  void start_without_attitude(int64_t t_ns);
  void set_headings();
  void begin_camera(int64_t t_ns);
  void go_on(int64_t t_ns);
  void push(int64_t t_ns, const Eigen::Quaterniond& q_o_b, const Eigen::Vector3d& d_o);
  std::optional<Eigen::Quaterniond> by_attitude(int64_t t_ns) const;
  std::optional<TrackPoint> point_at(int64_t t_ns) const;

  // The front-end (composer_motion.cpp).
  /// A motion while it is worked on.
  struct Moving {
    const odo_vo_motion& m;
    TrackPoint from;
    Eigen::Quaterniond q_o_c0, q_o_b1;
    double dt_s;
    bool rotates, translates, metric, inertial;
    uint32_t state, reason;
    Eigen::Vector3d d_o = Eigen::Vector3d::Zero();  ///< of the camera, m
    double relative_sigma = 0;
  };
  void begin_group(const odo_vo_motion& motion, bool metric);
  /// The body in o at the motion's end; nothing where it is not known.
  std::optional<Eigen::Quaterniond> turned(const Moving& moving);
  bool turn_by_gyroscope(const odo_vo_motion& motion);
  bool turns_with_gyroscope(const odo_vo_motion& motion) const;
  bool scale(Moving& moving, const odo_scale* scale);
  bool scale_as_in_papers(Moving& moving, const odo_scale* scale);
  void catch_up(const odo_scale* scale, bool horizontal);
  void move_by(const Moving& moving, bool moves, bool turn_known);
  double heading_variance(const Moving& moving, bool turn_known) const;
  void level(Moving& moving);
  void begin_here(const Moving& moving);
  bool walks(int64_t t_ns) const;

  // Steps (composer_steps.cpp).
  bool camera_is_silent(int64_t t_ns) const;
  void settle_steps(int64_t now_ns);
  void carry(const odo_step& step, double share);
  void compare(const odo_step& step);

  // Poses (composer_output.cpp).
  void publish(int64_t t_ns, uint32_t state, uint32_t reason);
  odo_pose make_pose(const TrackPoint& point) const;
  void note_jump(const odo_pose& before, uint32_t reason, double part);
  void set_source(const MotionSource& source);
  bool paper() const { return config_.type == CouplingType::paper; }
  bool shows_metres() const;

  LocalizerParameters p_;
  CouplingConfig config_;
  StartPose start_;
  EstimatorInputs inputs_;
  Eigen::Quaterniond q_b_c_{0.0, 1.0, 0.0, 0.0};
  Eigen::Vector3d p_b_c_ = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_o_a_ = Eigen::Quaterniond::Identity();  ///< the attitude source's frame, when it last was compared

  Localizer localizer_;
  Track track_;
  Coverage coverage_;
  AttitudeLog attitudes_;
  InertialTrack inertia_;
  GyroAttitudeFilter gyro_;
  ScaleUpdate scale_;
  StepUpdate steps_;
  HeadingUpdate heading_;
  HeightUpdate height_;
  FixUpdate fixes_;
  MotionSource source_;
  inertial::MetreCheck metre_check_;
  DisplacementReference reference_;

  /// The front-end's present scale group.
  struct Group {
    uint32_t id = 0;
    bool any = false, metric = false, inertial = false;
    bool walked = false;                                   ///< it has been surer of its scale than walkers differ
    int64_t began_ns = INT64_MIN;
    Eigen::Vector3d y_o = Eigen::Vector3d::Zero();         ///< displacement since it began, up to scale, in o
    Eigen::Vector3d unscaled_o = Eigen::Vector3d::Zero();  ///< of that, what waits for a scale
  } group_;
  inertial::TimedPositions path_;  // y_o
  Ring<odo_step, 16> waiting_;     // steps of a time of which the front-end has not answered yet
  size_t waiting_count_ = 0;
  bool started_ = false, camera_ = false, metric_ = false, carried_ = false, lost_ = false, moves_ = false;
  int64_t t_ns_ = INT64_MIN, first_frame_ns_ = INT64_MIN, translated_ns_ = INT64_MIN, step_ns_ = INT64_MIN,
          leads_since_ns_ = INT64_MIN;
  double tilt_variance_ = 0;  // rad^2, as the attitude source states it
  double blind_sigma_m_ = 0;  // of what the front-end moved since it saw something
  Eigen::Vector3d velocity_o_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d carried_n_ = Eigen::Vector3d::Zero();  // by late steps, in this update: no correction
  enum class Velocity { none, mean, now } velocity_ = Velocity::none;
  Eigen::Vector3d gyro_bias_b_ = Eigen::Vector3d::Zero(), accel_bias_b_ = Eigen::Vector3d::Zero();

  std::optional<odo_pose> pose_, corrected_;
  std::optional<Correction> correction_;
  std::optional<odo_fix> step_reference_;
  Notice notice_;
  int64_t last_pose_ns_ = INT64_MIN;
  uint32_t last_state_ = 0, last_reason_ = 0;
  double distance_m_ = 0;
  Eigen::Vector3d distance_from_ = Eigen::Vector3d::Zero();
};

}  // namespace odograph
