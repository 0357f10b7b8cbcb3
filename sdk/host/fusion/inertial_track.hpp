// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <odograph/types.h>

#include "sdk/math/timed_ring.hpp"

namespace odograph {

/// The newest inertial samples, integrated from an arbitrary epoch e, so that the motion between any two of their times
/// is the difference of two points (preintegration, Forster et al. 2017, without its noise terms). Gyroscope and
/// accelerometer samples may arrive separately: points lie at gyroscope times; the accelerometer is interpolated there,
/// and held until its next sample. No allocation. Not thread-safe.
class InertialTrack {
 public:
  static constexpr size_t kCapacity = 1024;  // 5 s at 200 Hz, 2 s at 500 Hz
  static constexpr double kLongestGap_s = 0.1;

  /// Orientation, velocity and position of the body in e, without gravity: dv/dt is the specific force.
  struct Point {
    int64_t t_ns = INT64_MIN;
    Eigen::Quaterniond q_e_b = Eigen::Quaterniond::Identity();
    Eigen::Vector3d v_e = Eigen::Vector3d::Zero();      // m/s
    Eigen::Vector3d p_e = Eigen::Vector3d::Zero();      // m
    Eigen::Vector3d rate_b = Eigen::Vector3d::Zero();   // rad/s, bias subtracted
    Eigen::Vector3d force_b = Eigen::Vector3d::Zero();  // m/s^2
  };

  /// Ignores a sample that is not newer than the newest of its sensor.
  void add(const odo_imu& imu);
  /// Sets the biases subtracted from later samples, rad/s and m/s^2.
  void set_biases(const Eigen::Vector3d& gyro_b, const Eigen::Vector3d& accel_b) {
    gyro_bias_b_ = gyro_b;
    accel_bias_b_ = accel_b;
  }
  /// The point at a time: interpolated between two samples; after the newest, extrapolated with constant rotation rate
  /// and force by at most `ahead_s` (the point's t_ns is the time reached). Nothing before the oldest sample, before a
  /// gap, or without samples.
  std::optional<Point> at(int64_t t_ns, double ahead_s) const;
  /// Whether an accelerometer sample arrived within the longest gap before the newest gyroscope sample.
  bool has_force() const;
  /// The earliest time for which at() has a point; INT64_MAX if there is none.
  int64_t oldest_ns() const {
    const size_t usable = std::min(since_gap_, points_.size());
    return usable == 0 ? INT64_MAX : points_.back(usable - 1).t_ns;
  }
  bool empty() const { return points_.empty(); }
  /// Time of the newest gyroscope sample; INT64_MIN if there is none.
  int64_t newest_ns() const { return points_.empty() ? INT64_MIN : points_.back(0).t_ns; }
  void clear();

 private:
  struct Force {
    int64_t t_ns = INT64_MIN;
    Eigen::Vector3d force_b = Eigen::Vector3d::Zero();
  };

  void add_force(int64_t t_ns, const Eigen::Vector3d& force_b);
  Eigen::Vector3d force_at(int64_t t_ns) const;
  static void integrate(const Point& from, Point& to);

  TimedRing<Point, kCapacity> points_;
  size_t since_gap_ = 0;  // consecutive points without a gap
  Force before_, newest_force_;
  Eigen::Vector3d gyro_bias_b_ = Eigen::Vector3d::Zero(), accel_bias_b_ = Eigen::Vector3d::Zero();
};

}  // namespace odograph
