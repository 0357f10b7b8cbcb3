// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <mutex>
#include <optional>
#include <utility>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/estimator/error_state.hpp"
#include "sdk/host/estimator/estimator.hpp"
#include "sdk/host/estimator/imu_rewind.hpp"
#include "sdk/host/estimator/inertial_parameters.hpp"
#include "sdk/host/estimator/metre_check.hpp"
#include "sdk/host/estimator/pose_history.hpp"
#include "sdk/host/estimator/pose_track.hpp"
#include "sdk/host/estimator/scale_start.hpp"

namespace odograph {

/// The estimator that joins everything: an error-state Kalman filter of the body's motion, the odometry's pose and
/// scale, the walker's step factor and the headings of steps and compass. docs/estimator.md derives it.
class InertialEstimator : public Estimator {
 public:
  InertialEstimator(const CouplingConfig& config, const StartPose& start, EstimatorInputs inputs,
                    const inertial::Parameters& parameters = {});

  void on_calibration(const odo_calibration& calibration) override;
  void on_imu_noise(const odo_imu_noise& noise) override;
  void propagate(const odo_imu& imu) override;
  UpdateResult update(const Measurement& measurement) override;
  void prepare(odo_vo_motion& motion) const override;
  int32_t at(int64_t t_ns, Estimate& out) const override;
  bool take_pose(odo_pose& pose) override;
  bool take_correction(Correction& correction, odo_pose& pose) override;
  bool take_step_reference(odo_fix& reference) override;
  ScaleKnowledge scale_knowledge() const override;
  Notice take_notice() override { return std::exchange(notice_, {}); }
  double distance_m() const override { return distance_m_; }
  void reset() override;
  uint64_t hold_pose(int64_t t_ns) override;
  void let_go(uint64_t id) override { e_.let_go(id); }
  bool held_pose(uint64_t id, HeldPose& out) const override { return e_.held(id, out); }
  bool pose_now(HeldPose& out) const override;
  bool is_placed() const override { return (placed_ & kHorizontal) == kHorizontal; }

  /// Relative sigma of the metre, and what of its information came from where, for reports and tests.
  struct ScaleReport {
    bool known;
    double log_scale, sigma, log_factor, factor_sigma;
    double inertia, steps;  ///< information gained, 1/variance
    double noise_m;         ///< the odometry's error against its map as the windows have it
  };
  ScaleReport scale_report() const;

 private:
  UpdateResult apply(const FrameTime& frame);
  UpdateResult apply(const odo_attitude* attitude);
  UpdateResult apply(const RelativeMotion& relative);
  UpdateResult apply(const odo_step* step);
  UpdateResult apply(const odo_scale* scale);
  UpdateResult apply(const odo_fix* fix);
  UpdateResult apply(const odo_barometer* barometer);
  UpdateResult apply(const odo_motion_mode* mode);

  // Time (inertial_estimator.cpp).
  void start(int64_t t_ns, const Eigen::Quaterniond& q_n_b, double tilt_sigma, double heading_sigma);
  void start_without_attitude(int64_t t_ns);
  void advance_to(int64_t t_ns);
  void integrate(const Eigen::Vector3d& gyro_b, const Eigen::Vector3d& accel_b, int64_t to_ns);
  void coast(int64_t to_ns);
  void flush(bool gap = false);
  void clone_when_due();
  void watch_quiet(const odo_imu& imu, double dt_s);
  void stand(const odo_imu& imu);
  void remind_of_speed();
  bool due(const odo_attitude& attitude) const;
  bool unaided() const;
  bool led() const;
  inertial::Hold calm() const;
  inertial::Hold follow() const;
  std::optional<inertial::PastPose> past(int64_t t_ns) const;
  Eigen::Quaterniond heading_offset() const;

  // The odometry (inertial_odometry.cpp).
  void watch_metre(const odo_vo_motion& motion);
  void begin_group(const odo_vo_motion& motion, bool metric);
  bool attach(int64_t t_ns);
  void detach();
  Eigen::Vector3d expected_displacement(int64_t t_ns, const Eigen::Vector3d& odometry_n) const;
  UpdateResult tie(inertial::Innovation<3>& seen, double inertial_sigma, double sigma, double dt_s,
                   inertial::Hold hold);
  UpdateResult see_position(int64_t t_ns, double dt_s);
  UpdateResult see_rotation(int64_t t_ns, double dt_s);
  double rotation_variance(const odo_vo_motion& motion, double dt_s) const;
  void use_inertial(const odo_vo_motion& motion);
  void horizontal(const Eigen::Vector3d& gravity_n);
  void rotate_track(const Eigen::Quaterniond& q, const Eigen::Vector3d& about_n);

  // Its scale (inertial_odometry_scale.cpp).
  bool walks(int64_t t_ns) const;
  void use_metric_scale(const odo_vo_motion& motion);
  void begin_here(const odo_vo_motion& motion);
  Eigen::Vector3d shift_since_start(const odo_vo_motion& motion, const inertial::PastPose& at) const;
  void use_window(const inertial::WindowScale& window);
  void try_scale_start(int64_t t_ns);
  void know_scale(double log_scale, double variance, double steps_share, int64_t t_ns);
  void put_in_place(int64_t t_ns);

  // Steps and fixes (inertial_steps.cpp).
  UpdateResult see_step(const odo_step& step, double own_sigma);
  inertial::Hold hold_at_step() const;
  void check_metre(const odo_step& step, const Eigen::Vector3d& moved_n);
  void rest_between(int64_t from_ns, int64_t to_ns);
  void doubt_steps();
  bool outweighs_fixes(int64_t t_ns) const;
  void open_heading();
  void agree(const odo_fix& fix);
  void place_by(inertial::Innovation<6>& seen, uint32_t axes);
  void rotate_n(double by_rad);
  bool tells_first_heading(const odo_fix& fix) const;
  double update_heading(const inertial::Innovation<6>& seen, const inertial::PastPose& at, uint32_t axes);

  // Poses (inertial_poses.cpp).
  void publish(int64_t t_ns, uint32_t state, uint32_t reason);
  odo_pose make_pose(int64_t t_ns, const inertial::PastPose& at) const;
  void snapshot();
  void refer_steps(const odo_pose& pose);
  bool rotates_camera(const odo_attitude& attitude) const;
  void note_jump(const odo_pose& before, uint32_t reason, double part);

  inertial::Parameters p_;
  CouplingConfig config_;
  StartPose start_;
  EstimatorInputs inputs_;
  inertial::ErrorState e_;
  inertial::PoseTrack track_;
  inertial::ImuRewind rewind_;
  PoseHistory history_;

  Eigen::Quaterniond q_b_c_ = Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
  Eigen::Vector3d p_b_c_ = Eigen::Vector3d::Zero();
  double gyro_noise_ = 0, accel_noise_ = 0, gyro_walk_ = 0, accel_walk_ = 0;

  double turned_rad_ = 0;       ///< by which n was turned since the start, when the first fix told the heading
  double north_sigma_rad_ = 0;  // of the attitude source's heading, as it says
  bool started_ = false, started_by_attitude_ = false, camera_ = false, metric_ = false, north_ = false,
       heading_open_ = false;
  int64_t t_ns_ = INT64_MIN, first_imu_ns_ = INT64_MIN, attitude_ns_ = INT64_MIN, informed_ns_ = INT64_MIN,
          reminded_ns_ = INT64_MIN, first_frame_ns_ = INT64_MIN, rested_ns_ = INT64_MIN;
  std::optional<odo_imu> last_imu_;
  inertial::ImuTransition transition_;
  bool inertial_front_end_ = false;

  struct Quiet {
    double accel_mean = 0, accel_variance = 1, gyro = 1, gyro_mean[3] = {0, 0, 0};
  } quiet_;
  static constexpr uint32_t kHorizontal = ODO_FIX_NORTH | ODO_FIX_EAST, kAllAxes = kHorizontal | ODO_FIX_DOWN;
  uint32_t placed_ = 0;  ///< axes whose place against n is known, from the start or by fixes
  bool resting_ = false;
  uint32_t mode_ = 0;
  int64_t stood_ns_ = INT64_MIN;

  struct Odometry {
    bool attached = false, metric = false, known = false, first_group = true, unbroken = true, any = false;
    uint32_t group = 0;
    int64_t t_ns = INT64_MIN, translated_ns = INT64_MIN;
    Eigen::Vector3d y_n = Eigen::Vector3d::Zero();      // position since the group began, up to scale
    Eigen::Vector3d start_n = Eigen::Vector3d::Zero();  // of the camera then, m
    double sigma_m = 0, told_information = 0;
    double rotation_ms = 0;        // rad^2, mean square of what its rotations differ by from the gyroscope's
    int64_t began_ns = INT64_MIN;  // of the group
    bool has_walked = false;       // it has been surer of the metre than walkers differ
    int64_t told_ns = 0, gravity_ns = INT64_MIN;
    double inertia_information = 0, steps_information = 0, own_information = 0;
    int rejected = 0, gravity_rejected = 0;  ///< in a row
  } vo_;
  inertial::InertialScale window_;
  inertial::ScaleStart scale_start_;
  inertial::MetreCheck metre_check_;
  Notice notice_;

  bool stepped_ = false, step_loose_ = false;
  int64_t step_ns_ = INT64_MIN;
  double step_mean_m_ = 0;
  int steps_rejected_ = 0, fixes_rejected_ = 0, fixes_agreed_ = 0;
  int64_t led_since_ns_ = INT64_MIN, baro_ns_ = INT64_MIN;
  bool baro_started_ = false;
  Eigen::Vector3d first_p_n_ = Eigen::Vector3d::Zero();  ///< of the body at the first frame

  std::optional<odo_pose> pose_, corrected_;
  std::optional<Correction> correction_;
  std::optional<odo_fix> reference_;
  double reference_path_m_ = -1;
  Eigen::Vector2d reference_last_ = Eigen::Vector2d::Zero();
  int64_t fixed_ns_ = INT64_MIN, last_pose_ns_ = INT64_MIN;
  uint32_t last_state_ = 0, last_reason_ = 0;
  double distance_m_ = 0;
  double fixed_distance_m_ = -1;  ///< of the path, where the position was known last
  Eigen::Vector3d distance_from_ = Eigen::Vector3d::Zero();

  mutable std::mutex newest_mutex_;
  Estimate newest_;
  Eigen::Vector3d newest_rate_b_ = Eigen::Vector3d::Zero();
  int64_t newest_ns_ = INT64_MIN;
};

}  // namespace odograph
