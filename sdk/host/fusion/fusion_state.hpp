// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/fusion/gyro_attitude.hpp"
#include "sdk/host/fusion/heading.hpp"
#include "sdk/host/fusion/height.hpp"
#include "sdk/host/fusion/pose_filter.hpp"
#include "sdk/host/fusion/trajectory.hpp"

namespace odograph {

/// What moves the track in o: one source at a time, the best one active. A camera's front-end also rotates it; under
/// all others it rotates with the attitude source.
enum class MotionSource { nothing, steps, lift, camera_not_moving, scaled_camera, metric_camera };

/// For a notice.
const char* describe(MotionSource source);

/// The state that all inputs share: the track in o, the filter of T_n_o, and what moves the track. Not thread-safe.
class FusionState {
 public:
  struct Parameters {
    double unobserved_s = 1.0;  ///< s without a displacement until steps move the track; steps are reported 0.4 s late
    double impossible = 5;      ///< times coupling.fastest: a failure of a sensor or of the scale; empirical
    double farthest_m = 100e3;  ///< m, upper clamp of the unobserved motion sigma; the extent of n
  };

  FusionState(const CouplingConfig& coupling, const StartPose& start) : config(coupling), start_pose(start) {
    heading.reset(start.heading_rad);
  }

  bool started() const { return !track.empty(); }
  /// Starts o with these axes; n starts at the configured position.
  void start(int64_t t_ns, const Eigen::Quaterniond& q_o_b);
  /// Gravity-aligned by the specific force; without one, assumes a horizontal camera.
  void start_without_attitude(int64_t t_ns, const Eigen::Quaterniond& q_b_c);
  /// Takes an attitude; true for the first.
  bool add_attitude(const odo_attitude& attitude);
  /// The camera's front-end rotates the track from now on. Unless the track has moved or was placed before, the camera,
  /// not the body, is at the configured start position.
  void begin_camera(int64_t t_ns, const Eigen::Vector3d& p_b_c, bool has_stepped, bool was_placed);

  /// Propagates the drifting states to that time.
  void propagate(int64_t t_ns);
  /// Adds the unobserved motion until then to the covariance: a displacement begins, or a fix arrives.
  void add_gap(int64_t until_ns);
  /// The position at that time was measured. A measurement that is less certain than the unknown motion until then does
  /// not end it.
  void observe(int64_t t_ns, double sigma_m);
  /// Nothing was measured until then. `placed`: a position estimate exists whose covariance must grow.
  void pause(int64_t until_ns, bool placed);
  /// Sigma of the body's motion, m, until a time while the camera is the motion source but reported no displacement.
  double unobserved_m(int64_t t_ns) const;
  bool is_impossible(double moved_m, double dt_s) const { return moved_m > p.impossible * config.fastest_mps * dt_s; }

  MotionSource source() const { return source_; }
  bool camera_leads() const { return source_ >= MotionSource::camera_not_moving; }
  /// Whether an attitude of this time corrects the camera's heading.
  bool corrects_heading(int64_t t_ns, bool has_moved) const {
    const bool ended = config.compass == Compass::start && heading.north() && has_moved;
    return camera_leads() && heading.due(t_ns) && !ended;
  }
  /// The track was moved by this source.
  void moved_by(MotionSource source);

  /// The body in o, in the past, or ahead of the newest pose by rotation and velocity. Nothing before the stored track.
  std::optional<TrackPoint> at(int64_t t_ns) const { return track.at(t_ns, !camera_leads()); }
  /// Time of the newest measurement.
  int64_t now_ns() const { return std::max(t_ns_, track.newest().t_ns); }
  double tilt_variance() const { return tilt_variance_; }  ///< rad^2, as the attitude source states it

  const Parameters p{};
  const CouplingConfig config;
  const StartPose start_pose;
  PoseFilter filter;
  Trajectory track;
  Heading heading;
  Height height;

 private:
  double unobserved_m_in(double unobserved_s) const;

  MotionSource source_ = MotionSource::nothing;
  double tilt_variance_ = 0;
  int64_t t_ns_ = 0;
  Instant gap_;  // up to which the unobserved motion is in the covariance
};

}  // namespace odograph
