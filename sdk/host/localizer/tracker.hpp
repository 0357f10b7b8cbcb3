// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/localizer/inertial_track.hpp"
#include "sdk/host/localizer/attitude_log.hpp"
#include "sdk/host/localizer/coverage.hpp"
#include "sdk/host/localizer/gyro_attitude_filter.hpp"
#include "sdk/host/localizer/heading_update.hpp"
#include "sdk/host/localizer/height_update.hpp"
#include "sdk/host/localizer/localizer.hpp"
#include "sdk/host/localizer/measurement.hpp"
#include "sdk/host/localizer/track.hpp"

namespace odograph {

/// What all sources of motion share: the track in o and the filter of T_n_o, which go on together, and what turns o
/// where no camera does. One thread at a time.
class Tracker {
 public:
  struct Parameters {
    double unseen_s = 1.0;      ///< s without a displacement until steps carry; they are told 0.4 s late
    double impossible = 5;      ///< times coupling.fastest: what a sensor or a scale got wrong; by hand
    double farthest_m = 100e3;  ///< m that it is unseen by at most; as far as n reaches
  };
  enum class Velocity { none, mean, now };

  Tracker(const CouplingConfig& config, const StartPose& start) : config_(config), start_(start) {}
  void reset();

  // The start.
  bool started() const { return !track_.empty(); }
  /// o has these axes, and the start of n lies where the config has it.
  void start(int64_t t_ns, const Eigen::Quaterniond& q_o_b);
  /// Level by the specific force, or by a camera that is taken to look level.
  void start_without_attitude(int64_t t_ns, const Eigen::Quaterniond& q_b_c);
  /// An attitude has come; true for the first.
  bool add_attitude(const odo_attitude& attitude);
  /// The start is the camera's: its position is the config's.
  void start_camera_at(int64_t t_ns, const Eigen::Quaterniond& q_o_b, const Eigen::Vector3d& lever_b);

  // Time and motion.
  /// What drifts with time has drifted until then.
  void go_on(int64_t t_ns);
  /// The track has moved in o by d_o, m, which the filter has been told; variances of the drift, m^2 and rad^2.
  void push(int64_t t_ns, const Eigen::Quaterniond& q_o_b, const Eigen::Vector3d& d_o,
            const Eigen::Vector3d& drift_m2 = Eigen::Vector3d::Zero(), double heading_drift_rad2 = 0);
  /// Steps move it from now on: o turns with the attitude source. False where it did already.
  void rotate_with_attitude();
  void rotate_with_camera() { rotates_with_attitude_ = false; }
  bool rotates_with_attitude() const { return rotates_with_attitude_; }
  /// What was not seen until then is in the filter's covariance from now on: a displacement begins, or a fix comes.
  void add_gap(int64_t until_ns);
  /// Nothing was measured at all until then; `placed`: a position had been given that one may hold against it.
  void pause(int64_t until_ns, bool placed);
  /// What the body may have moved by until a time while the camera leads and has seen no displacement, m, one sigma.
  double unseen_m(int64_t t_ns) const;
  bool is_impossible(double moved_m, double dt_s) const { return moved_m > p_.impossible * config_.fastest_mps * dt_s; }
  void set_velocity(const Eigen::Vector3d& v_o, Velocity kind) { v_o_ = v_o, velocity_ = kind; }

  // Questions.
  /// The body in o: of the past, or ahead of the newest pose by rotation and velocity. Nothing before what is kept.
  std::optional<TrackPoint> at(int64_t t_ns) const;
  const Track& track() const { return track_; }
  const TrackPoint& newest() const { return track_.newest(); }
  /// Of the newest measurement.
  int64_t now_ns() const { return std::max(t_ns_, track_.newest().t_ns); }
  /// The inertial samples as far as that time; nothing where they end before.
  std::optional<InertialTrack::Point> inertial_point(int64_t t_ns) const;
  /// The body's displacement in o by the samples of an interval, at whose end it has this orientation and velocity:
  /// p(T) - p(0) = v T - int t a dt. Nothing where samples lack.
  std::optional<Eigen::Vector3d> moved_until(int64_t from_ns, int64_t to_ns, const Eigen::Quaterniond& q_o_b,
                                             const Eigen::Vector3d& v_o, const Eigen::Vector3d& accel_bias_b) const;
  /// The body's rotation by the gyroscope, where there are samples.
  std::optional<Eigen::Quaterniond> gyro_rotation(int64_t from_ns, int64_t to_ns) const;
  /// Its orientation as the attitude source has it, since the two were compared.
  std::optional<Eigen::Quaterniond> by_attitude(int64_t t_ns) const;
  Eigen::Vector3d velocity_o() const { return v_o_; }
  Velocity velocity() const { return velocity_; }
  const CouplingConfig& config() const { return config_; }
  const StartPose& start_pose() const { return start_; }
  bool paper() const { return config_.type == CouplingType::paper; }
  double tilt_variance() const { return tilt_variance_; }
  const Parameters& parameters() const { return p_; }
  /// Of the phone, as the gyroscope\'s filter has it.
  const GyroAttitudeFilter::Parameters& gyroscope() const { return gyroscope_; }

  Localizer localizer;
  Coverage coverage;
  HeadingUpdate heading;
  HeightUpdate height;
  AttitudeLog attitudes;
  InertialTrack inertia;

 private:
  double unseen_m_in(double unseen_s) const;

  Parameters p_;
  GyroAttitudeFilter::Parameters gyroscope_;
  CouplingConfig config_;
  StartPose start_;
  Track track_;
  Eigen::Quaterniond q_o_a_ = Eigen::Quaterniond::Identity();  // the attitude source's frame, as last compared
  Eigen::Vector3d v_o_ = Eigen::Vector3d::Zero();
  Velocity velocity_ = Velocity::none;
  bool rotates_with_attitude_ = true;
  double tilt_variance_ = 0;  // rad^2, as the attitude source states it
  int64_t t_ns_ = INT64_MIN;
  int64_t gap_ns_ = INT64_MIN;  // until when what was not seen is in the covariance
};

}  // namespace odograph
