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

/// State shared by all motion sources: the track in o and the filter of T_n_o, which advance together, and the attitude
/// that rotates o while no camera does. Not thread-safe.
class Tracker {
 public:
  struct Parameters {
    double unobserved_s = 1.0;  ///< s without a displacement until steps move the track; steps are reported 0.4 s late
    double impossible = 5;      ///< times coupling.fastest: a failure of a sensor or of the scale; empirical
    double farthest_m = 100e3;  ///< m, upper clamp of the unobserved motion sigma; the extent of n
  };
  enum class Velocity { none, mean, now };

  Tracker(const CouplingConfig& config, const StartPose& start) : config_(config), start_(start) {}
  void reset();

  // Start.
  bool started() const { return !track_.empty(); }
  /// Starts o with these axes; n starts at the configured position.
  void start(int64_t t_ns, const Eigen::Quaterniond& q_o_b);
  /// Gravity-aligned by the specific force; without one, assumes a horizontal camera.
  void start_without_attitude(int64_t t_ns, const Eigen::Quaterniond& q_b_c);
  /// Takes an attitude; true for the first.
  bool add_attitude(const odo_attitude& attitude);
  /// Places the camera at the configured start position.
  void start_camera_at(int64_t t_ns, const Eigen::Quaterniond& q_o_b, const Eigen::Vector3d& lever_b);

  // Time and motion.
  /// Propagates the drifting states to that time.
  void propagate(int64_t t_ns);
  /// Moves the track in o by d_o, m, after the filter; variances of the drift, m^2 and rad^2.
  void push(int64_t t_ns, const Eigen::Quaterniond& q_o_b, const Eigen::Vector3d& d_o,
            const Eigen::Vector3d& drift_m2 = Eigen::Vector3d::Zero(), double heading_drift_rad2 = 0);
  /// Steps move the track from now on: o rotates with the attitude source.
  void rotate_with_attitude();
  void rotate_with_camera() { rotates_with_attitude_ = false; }
  bool rotates_with_attitude() const { return rotates_with_attitude_; }
  /// Adds the unobserved motion until then to the covariance: a displacement begins, or a fix arrives.
  void add_gap(int64_t until_ns);
  /// Nothing was measured until then. `placed`: a position estimate exists whose covariance must grow.
  void pause(int64_t until_ns, bool placed);
  /// Sigma of the body's motion, m, until a time while the camera is the motion source but reported no displacement.
  double unobserved_m(int64_t t_ns) const;
  bool is_impossible(double moved_m, double dt_s) const { return moved_m > p_.impossible * config_.fastest_mps * dt_s; }
  /// Of the body, m/s.
  void set_velocity(const Eigen::Vector3d& v_o, Velocity kind) { v_o_ = v_o, velocity_ = kind; }

  // Queries.
  /// The body in o, in the past, or ahead of the newest pose by rotation and velocity. Nothing before the stored track.
  std::optional<TrackPoint> at(int64_t t_ns) const;
  const Track& track() const { return track_; }
  const TrackPoint& newest() const { return track_.newest(); }
  /// Time of the newest measurement.
  int64_t now_ns() const { return std::max(t_ns_, track_.newest().t_ns); }
  /// The inertial samples integrated to that time; nothing if they end before it.
  std::optional<InertialTrack::Point> inertial_point(int64_t t_ns) const;
  /// The body's displacement in o from the samples of an interval, given orientation and velocity at its end: p(T) -
  /// p(0) = v T - int t a dt. Nothing if samples are missing.
  std::optional<Eigen::Vector3d> inertial_displacement(int64_t from_ns, int64_t to_ns, const Eigen::Quaterniond& q_o_b,
                                                       const Eigen::Vector3d& v_o,
                                                       const Eigen::Vector3d& accel_bias_b) const;
  /// The body's rotation from the gyroscope, if there are samples.
  std::optional<Eigen::Quaterniond> gyro_rotation(int64_t from_ns, int64_t to_ns) const;
  /// Its orientation from the attitude source, once aligned with o.
  std::optional<Eigen::Quaterniond> by_attitude(int64_t t_ns) const;
  Eigen::Vector3d velocity_o() const { return v_o_; }
  Velocity velocity() const { return velocity_; }
  const CouplingConfig& config() const { return config_; }
  const StartPose& start_pose() const { return start_; }
  bool paper() const { return config_.type == CouplingType::paper; }
  double tilt_variance() const { return tilt_variance_; }
  const Parameters& parameters() const { return p_; }
  /// Of the gyroscope attitude filter.
  const GyroAttitudeFilter::Parameters& gyroscope() const { return gyroscope_; }

  Localizer localizer;
  Coverage coverage;
  HeadingUpdate heading;
  HeightUpdate height;
  AttitudeLog attitudes;
  InertialTrack inertia;

 private:
  double unobserved_m_in(double unobserved_s) const;

  Parameters p_;
  GyroAttitudeFilter::Parameters gyroscope_;
  CouplingConfig config_;
  StartPose start_;
  Track track_;
  Eigen::Quaterniond q_o_a_ = Eigen::Quaterniond::Identity();  // the attitude source's frame, as last aligned
  Eigen::Vector3d v_o_ = Eigen::Vector3d::Zero();
  Velocity velocity_ = Velocity::none;
  bool rotates_with_attitude_ = true;
  double tilt_variance_ = 0;  // rad^2, as the attitude source states it
  int64_t t_ns_ = INT64_MIN;
  int64_t gap_ns_ = INT64_MIN;  // time up to which the unobserved motion is in the covariance
};

}  // namespace odograph
