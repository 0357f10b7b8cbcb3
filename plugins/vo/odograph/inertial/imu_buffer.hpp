// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "plugins/shared/ring.hpp"

namespace odograph::vio {

struct ImuSample {
  int64_t t_ns = 0;
  Eigen::Vector3d gyro_b = Eigen::Vector3d::Zero();   ///< rad/s
  Eigen::Vector3d accel_b = Eigen::Vector3d::Zero();  ///< specific force, m/s^2
};

/// The latest inertial samples, about ten seconds of them. No allocation.
class ImuBuffer {
 public:
  /// Between samples: over a longer one nothing is integrated. Six samples of a phone's slowest rate; by hand.
  static constexpr int64_t kLongestGap_ns = 60'000'000;

  void add(const ImuSample& sample);
  void clear() { samples_.clear(); }
  bool empty() const { return samples_.empty(); }
  int64_t oldest_ns() const { return samples_.back(samples_.size() - 1).t_ns; }
  int64_t newest_ns() const { return samples_.back(0).t_ns; }

  /// Interpolated; the nearest sample's beyond the ends. The buffer must not be empty.
  ImuSample at(int64_t t_ns) const;

  /// Calls `visit(from, to)` for each stretch between neighbouring samples of [from_ns, to_ns], the ends interpolated.
  /// False where a gap is longer than `longest_gap_ns`, or samples lack at either end by more than that.
  template <class Visit>
  bool for_each(int64_t from_ns, int64_t to_ns, int64_t longest_gap_ns, Visit visit) const {
    if (empty() || from_ns + longest_gap_ns < oldest_ns() || to_ns - longest_gap_ns > newest_ns()) return false;
    size_t i = first_after(from_ns);
    ImuSample before = at(from_ns);
    bool whole = true;
    for (; i > 0 && samples_.back(i - 1).t_ns < to_ns; --i) {
      const ImuSample& next = samples_.back(i - 1);
      whole = whole && next.t_ns - before.t_ns <= longest_gap_ns;
      visit(before, next);
      before = next;
    }
    if (to_ns > before.t_ns) {
      whole = whole && to_ns - before.t_ns <= longest_gap_ns;
      visit(before, at(to_ns));
    }
    return whole;
  }

 private:
  size_t first_after(int64_t t_ns) const;  ///< how many samples are later

  plugin::Ring<ImuSample, 4096> samples_;
};

}  // namespace odograph::vio
