// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "sdk/math/ring.hpp"
#include "sdk/math/sample_intervals.hpp"

namespace odograph::vio {

struct ImuSample {
  int64_t t_ns = 0;
  Eigen::Vector3d gyro_b = Eigen::Vector3d::Zero();   ///< rad/s
  Eigen::Vector3d accel_b = Eigen::Vector3d::Zero();  ///< specific force, m/s^2
};

/// Ring buffer of the latest inertial samples, about ten seconds. Does not allocate.
class ImuBuffer {
 public:
  /// Longest gap between samples that is integrated. Six samples at a phone's slowest rate; empirical.
  static constexpr int64_t kLongestGap_ns = 60'000'000;

  void add(const ImuSample& sample);
  void clear() { samples_.clear(); }
  bool empty() const { return samples_.empty(); }
  int64_t oldest_ns() const { return samples_.back(samples_.size() - 1).t_ns; }
  int64_t newest_ns() const { return samples_.back(0).t_ns; }

  /// Interpolated; the nearest sample beyond the ends. The buffer must not be empty.
  ImuSample at(int64_t t_ns) const;

  /// Noise densities equivalent to the second differences of the samples in the last `reach_s` before a time, assuming
  /// white noise: rad/s/sqrt(Hz) and m/s^2/sqrt(Hz) per axis. Zero with fewer than ten samples.
  struct Roughness {
    double gyro = 0, accel = 0;
    double rate_hz = 0;  ///< of the samples
  };
  Roughness roughness(int64_t until_ns, double reach_s) const;

  /// for_each_interval over [from_ns, to_ns]: calls `visit(from, to)` with the samples at the ends of each interval,
  /// interpolated at the limits.
  template <class Visit>
  bool for_each(int64_t from_ns, int64_t to_ns, int64_t longest_gap_ns, Visit visit) const {
    return for_each_interval(samples_, from_ns, to_ns, longest_gap_ns,
                             [&](const ImuSample& before, const ImuSample& after, int64_t t0_ns, int64_t t1_ns) {
                               visit(between(before, after, t0_ns), between(before, after, t1_ns));
                             });
  }

 private:
  static ImuSample between(const ImuSample& before, const ImuSample& after, int64_t t_ns);

  Ring<ImuSample, 4096> samples_;
};

}  // namespace odograph::vio
