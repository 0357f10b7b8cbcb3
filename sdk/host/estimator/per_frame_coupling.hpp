// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "sdk/host/base/ring.hpp"
#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/estimator/estimator.hpp"
#include "sdk/host/estimator/gyro_attitude_filter.hpp"
#include "sdk/host/estimator/pose_history.hpp"

namespace odograph {

/// The coupling of Antigny et al. 2019, section 3.4: each frame's displacement, rotated into n, is multiplied by that
/// frame's scale (eq. (7), computed by the scale source) and added to the horizontal position; rotation is chained from
/// frame to frame. Without a camera, and where the camera sees nothing, steps carry the position (dead reckoning).
/// Fixes correct the position by a gated Kalman update, and start it.
///
/// The position's covariance is P0 + (errors that are common to the whole path since the last fix): a relative scale
/// error along the displacement g since then, a heading error across it, and the fastest speed times the time in which
/// the motion had no length.
class PerFrameCoupling {
 public:
  /// "by hand": a choice that was never varied.
  struct Parameters {
    double impossible = 5;             ///< times the fastest: a motion that the picture or the scale got wrong; by hand
    double angle_random_walk = 0.003;  ///< rad/sqrt(s): composed motions drift by this more than they say; by hand
    double heading_unknown_rad = 0.2;  ///< rad, of a start without a compass; by hand
    double any_heading_rad = 1.8;      ///< rad, uniform over the circle: pi / sqrt(3)
    double uninformed_sigma_m = 1e4;   ///< m: how little a position means before the first fix
    int max_consecutive_rejections = 5;  ///< of fixes: so many say that it is the track that is wrong; by hand
  };

  PerFrameCoupling(const CouplingConfig& config, const StartPose& start, EstimatorInputs inputs);

  void on_calibration(const odo_calibration& calibration);
  /// A whole sample, gyroscope and accelerometer.
  void on_imu(const odo_imu& imu) { gyro_attitude_.add_imu(imu); }
  void on_attitude(const odo_attitude& attitude);

  /// The camera starts at this frame: its pose is the first of the track.
  odo_pose on_first_frame(int64_t t_ns);
  /// Writes the earlier frame's orientation into a motion, for scale sources.
  void prepare(odo_vo_motion& motion) const;
  /// `scale` may be null. Returns the pose at the later frame.
  odo_pose on_vo_motion(const odo_vo_motion& motion, const odo_scale* scale);
  /// The pose at the step's end where steps carry the position, otherwise nothing.
  std::optional<odo_pose> on_step(const odo_step& step);
  /// The first pose of a track without a camera, as soon as there is an orientation.
  std::optional<odo_pose> start_without_camera();
  /// A fix whose p_n is filled in, at its own time.
  UpdateResult on_fix(const odo_fix& fix);

  /// The latest pose anew, once after a fix that moved it.
  std::optional<odo_pose> take_correction();
  /// What the latest motion added because its scale also holds for what came before, m in n; once.
  std::optional<Eigen::Vector3d> take_caught_up() { return std::exchange(caught_up_n_, std::nullopt); }

  /// PoseHistory::at. [any]
  int32_t pose_at(int64_t t_ns, odo_pose& out) const { return history_.at(t_ns, out); }

  double distance_m() const { return distance_m_; }
  /// INT64_MIN before the first.
  int64_t last_pose_ns() const { return last_pose_ns_; }
  const Eigen::Quaterniond& q_b_c() const { return q_b_c_; }
  /// Position and orientation as they were at the start; the geodetic origin stays.
  void reset();

 private:
  struct Scale {
    double scale = 0.0;
    double sigma = 0.0;
  };

  std::optional<odo_attitude> attitude_at(int64_t t_ns) const;
  Eigen::Quaterniond orientation_from(const odo_attitude& attitude) const;
  Eigen::Quaterniond initial_camera_orientation(int64_t t_ns) const;
  Eigen::Matrix3d position_covariance() const;
  void move(const Eigen::Vector3d& d_n, double relative_sigma, double dt_s);
  void wait_for_scale(const odo_vo_motion& motion, const Eigen::Vector3d& d_n);
  Eigen::Vector3d catch_up(const odo_scale& scale);
  void drift(const odo_vo_motion& motion, const Eigen::Quaterniond& q_n_c0, double dt_s, bool lost_metres);
  void update_orientation(const odo_vo_motion& motion, const std::optional<odo_attitude>& before,
                          const std::optional<odo_attitude>& after);
  bool rotate_with_gyroscope(const odo_vo_motion& motion);
  std::optional<odo_pose> pose_then(int64_t t_ns) const;
  void note_correction(const Eigen::Quaterniond& q_before, const Eigen::Vector3d& from_n);
  bool update_heading(const odo_fix& fix, const Eigen::Quaterniond& q_then);
  bool correct_gyro_attitude(const Eigen::Vector3d& off_n, const odo_fix& fix);
  void share_rotation_covariance();
  odo_pose publish(int64_t t_ns, uint32_t state, uint32_t reason);
  /// Positions are in metres, and nothing waits for a scale.
  bool metre_known() const { return !inputs_.vo || metric_by_vo_ || (inputs_.scale && scale_.scale > 0 && !unscaled_); }
  bool metric() const { return inputs_.scale || !inputs_.vo || metric_by_vo_; }

  Parameters p_;
  CouplingConfig config_;
  StartPose start_;
  EstimatorInputs inputs_;
  PoseHistory history_;
  /// What a fix did to the latest pose, and to what lies before it: poses in history_ are as they were published.
  struct Corrected {
    int64_t t_ns = INT64_MIN;
    Eigen::Quaterniond turned = Eigen::Quaterniond::Identity();
    Eigen::Vector3d from_n = Eigen::Vector3d::Zero(), to_n = Eigen::Vector3d::Zero();
  };
  Ring<Corrected, 16> corrections_;
  Ring<odo_attitude, 128> attitudes_;

  // A phone's rear camera: x right as the body's, y down and z forward against the body's up and out of the screen.
  Eigen::Quaterniond q_b_c_{0.0, 1.0, 0.0, 0.0};
  Eigen::Quaterniond q_n_ = Eigen::Quaterniond::Identity();  // of the camera, or of the body without one
  Eigen::Vector3d p_n_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_n_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d rotation_covariance_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d independent_covariance_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d since_fix_n_ = Eigen::Vector3d::Zero();
  double relative_sigma_ = 0.0;
  double heading_offset_rad_ = 0.0;
  double heading_variance_ = 0.0, tilt_variance_ = 0.0;  // rad^2, of q_n_, where fixes correct it
  bool turned_by_fixes_ = false;
  GyroAttitudeFilter gyro_attitude_;  // q_n_ where the config says so
  double unobserved_sigma_m_ = 0.0;   // what may have been moved, since the last fix, without a scale or a picture
  Scale scale_;
  double distance_m_ = 0.0;
  int64_t last_pose_ns_ = INT64_MIN;
  int64_t last_tracked_ns_ = INT64_MIN;
  uint32_t last_state_ = 0;
  uint32_t last_reason_ = 0;
  bool camera_ = false;
  bool carried_by_steps_ = false;
  bool corrected_ = false;
  bool metric_by_vo_ = false;
  bool velocity_known_ = false;
  std::optional<Eigen::Vector3d> caught_up_n_;
  struct Unscaled {                                 // what a scale group has moved before its scale is known
    Eigen::Vector3d d_n = Eigen::Vector3d::Zero();  // up to scale
    uint32_t group = 0;
    double sigma_before_m = 0;
  };
  std::optional<Unscaled> unscaled_;
  bool placed_ = false;  // by a fix or by the config
  int rejected_in_a_row_ = 0;
};

}  // namespace odograph
