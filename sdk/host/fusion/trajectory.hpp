// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <odograph/types.h>

#include "sdk/host/fusion/inertial_track.hpp"
#include "sdk/host/fusion/outputs.hpp"
#include "sdk/math/time.hpp"
#include "sdk/math/timed_ring.hpp"

namespace odograph {

/// A pose of the body in the odometry frame o, which is gravity-aligned and in which the track never jumps, with the
/// variances accumulated since the track began.
struct TrackPoint {
  int64_t t_ns = INT64_MIN;
  Eigen::Quaterniond q_o_b = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_o_b = Eigen::Vector3d::Zero();  ///< m
  double path_m = 0;                                ///< travelled until then
  Eigen::Vector3d drift_m2 = Eigen::Vector3d::Zero();
  double heading_drift_rad2 = 0;
};

/// The time over which the track contains the displacement: everything up to a time, except for one gap before it.
class TrackedIntervals {
 public:
  void begin(int64_t t_ns) { until_ns_ = gap_from_ns_ = gap_to_ns_ = t_ns; }
  int64_t until_ns() const { return until_ns_; }

  /// The displacement over an interval has been added; a gap may precede it.
  void add(int64_t from_ns, int64_t to_ns) {
    if (from_ns > until_ns_) gap_from_ns_ = until_ns_, gap_to_ns_ = from_ns;
    until_ns_ = std::max(until_ns_, to_ns);
  }
  /// Fraction of an interval that is not covered, 0 to 1.
  double missing(int64_t from_ns, int64_t to_ns) const {
    if (to_ns <= from_ns) return 0;
    const double in_gap = length(std::max(from_ns, gap_from_ns_), std::min(to_ns, gap_to_ns_));
    const double after = length(std::max(from_ns, until_ns_), to_ns);
    return std::min(1.0, (in_gap + after) / static_cast<double>(to_ns - from_ns));
  }
  /// The missing part of an interval has been added.
  void fill(int64_t from_ns, int64_t to_ns) {
    if (to_ns > until_ns_)
      add(std::max(from_ns, until_ns_), to_ns);
    else if (to_ns > gap_from_ns_)
      gap_from_ns_ = std::min(to_ns, gap_to_ns_);
  }

 private:
  static double length(int64_t from_ns, int64_t to_ns) {
    return to_ns > from_ns ? static_cast<double>(to_ns - from_ns) : 0.0;
  }
  int64_t until_ns_ = 0, gap_from_ns_ = 0, gap_to_ns_ = 0;
};

/// What moved the body in o, by time: the track, the attitude source's orientations, and the inertial samples. No
/// allocation. Not thread-safe.
class Trajectory {
 public:
  struct Parameters {
    /// s, longest interval without a gyroscope sample: ten samples at 200 Hz, two or three at 50 Hz.
    double gyro_gap_s = 0.05;
    double attitude_gap_s = 0.25;    ///< s without an attitude, after which its frame may have rotated; empirical
    double walking_sigma_mps = 0.5;  ///< m/s, of a walker's velocity between steps: he may have stopped; RIDI
    double gravity_age_s = 1;        ///< s, maximum age of the sample whose force is taken for gravity; judgement
  };

  bool empty() const { return track_.empty(); }
  const TrackPoint& newest() const { return track_.back(0); }
  /// The pose at a time: interpolated; the newest after its time; nothing before the oldest stored.
  std::optional<TrackPoint> stored(int64_t t_ns) const;
  /// The same, but ahead of the newest pose by rotation and velocity; by the attitude rather than the gyroscope if
  /// `by_attitude_first`.
  std::optional<TrackPoint> at(int64_t t_ns, bool by_attitude_first) const;
  /// Standard deviation of a position ahead of the newest pose by steps, m; 0 elsewhere.
  double walked_sigma_m(int64_t t_ns) const { return Parameters().walking_sigma_mps * walked_s(t_ns); }
  /// Moves the track by d_o, m; variances of the drift, m^2 and rad^2. A time before the newest counts as that.
  void push(int64_t t_ns, const Eigen::Quaterniond& q_o_b, const Eigen::Vector3d& d_o,
            const Eigen::Vector3d& drift_m2 = Eigen::Vector3d::Zero(), double heading_drift_rad2 = 0);
  void add_heading_drift(double variance) { track_.back(0).heading_drift_rad2 += variance; }

  void add_attitude(const odo_attitude& attitude);
  /// The newest orientation of the attitude source, q_a_b, that is not later than t, otherwise the oldest. Nothing
  /// while the source is silent.
  std::optional<Eigen::Quaterniond> attitude(int64_t t_ns) const;
  /// The body's orientation in o from the attitude source, while that is active.
  std::optional<Eigen::Quaterniond> by_attitude(int64_t t_ns) const;
  /// The attitude source's frame in o, as last aligned.
  const Eigen::Quaterniond& q_o_a() const { return q_o_a_; }

  /// The inertial samples integrated to that time; nothing if they end before it.
  std::optional<InertialTrack::Point> inertial_point(int64_t t_ns) const;
  /// The body's rotation from the gyroscope, if there are samples.
  std::optional<Eigen::Quaterniond> gyro_rotation(int64_t from_ns, int64_t to_ns) const;
  /// The body's displacement in o from the samples of an interval, given orientation and velocity at its end: p(T) -
  /// p(0) = v T - int t a dt. Nothing if samples are missing.
  std::optional<Eigen::Vector3d> inertial_displacement(int64_t from_ns, int64_t to_ns, const Eigen::Quaterniond& q_o_b,
                                                       const Eigen::Vector3d& v_o,
                                                       const Eigen::Vector3d& accel_bias_b) const;

  /// Of the body, m/s, known until a time: by steps, when the next is due.
  void set_velocity(const Eigen::Vector3d& v_o, Velocity kind, int64_t until_ns = INT64_MAX) {
    v_o_ = v_o, velocity_ = kind, velocity_until_ns_ = until_ns;
  }
  void clear_velocity() { set_velocity(Eigen::Vector3d::Zero(), Velocity::none); }
  const Eigen::Vector3d& velocity_o() const { return v_o_; }
  Velocity velocity(int64_t t_ns) const { return t_ns <= velocity_until_ns_ ? velocity_ : Velocity::none; }
  int64_t velocity_until_ns() const { return velocity_until_ns_; }

  TrackedIntervals tracked;
  InertialTrack inertia;

 private:
  double walked_s(int64_t t_ns) const;

  struct Attitude {
    int64_t t_ns = 0;
    Eigen::Quaterniond q_a_b;
  };
  TimedRing<TrackPoint, 1024> track_;
  TimedRing<Attitude, 512> attitudes_;  // 2.5 s at 200 Hz
  Eigen::Quaterniond q_o_a_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d v_o_ = Eigen::Vector3d::Zero();
  Velocity velocity_ = Velocity::none;
  int64_t velocity_until_ns_ = INT64_MAX;
};

}  // namespace odograph
