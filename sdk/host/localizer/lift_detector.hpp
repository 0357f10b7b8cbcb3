// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

#include "sdk/host/localizer/height_trend.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

/// Detects that a walker who takes no step moves vertically: in a lift (fast) or on an escalator (slow and steady).
/// Only the air pressure shows it: between start and stop, a lift is as still as a floor. No allocation.
class LiftDetector {
 public:
  struct Parameters {
    /// m/s, vertical, over `lift_s`: lifts of houses run at 0.63 to 1.6 m/s (ISO 8100-1 classes).
    double lift_mps = 0.45;
    double lift_s = 4;           ///< s, half a storey and the acceleration of a lift
    double escalator_mps = 0.2;  ///< vertical speed over `escalator_s`: 0.5 m/s at 30 degrees (EN 115) is 0.25 m/s
    double escalator_s = 10;     ///< s, one storey
    double end_mps = 0.12;       ///< over `lift_s`, below which a ride ends; judgement
    double clear_sigmas = 4;     ///< significance of the slope at the start of a ride; judgement, stairs need five
    double stands_s = 1.5;       ///< s without a step, after which a ride is possible; judgement
    size_t min_samples = 4;      ///< in the short window: one reading a second
  };
  LiftDetector() : LiftDetector(Parameters{}) {}
  explicit LiftDetector(const Parameters& parameters) : p_(parameters) {}

  /// Processes a reading. `stepped_ns`: end of the last step.
  void update(const HeightTrend& trend, int64_t stepped_ns) {
    const int64_t now_ns = trend.newest_ns();
    const auto quick = trend.slope(p_.lift_s, 0.7 * p_.lift_s, p_.min_samples),
               slow = trend.slope(p_.escalator_s, 0.8 * p_.escalator_s, 2 * p_.min_samples);
    const auto stands = [&](int64_t from_ns) {
      return seconds(now_ns - stepped_ns) > p_.stands_s && from_ns >= stepped_ns - nanoseconds(p_.stands_s);
    };
    const auto rises = [&](const std::optional<HeightTrend::Slope>& slope, double min_mps) {
      return slope && stands(slope->from_ns) &&
             std::abs(slope->mps) > std::max(min_mps, p_.clear_sigmas * slope->sigma_mps);
    };
    if (riding_) {
      if (!quick || std::abs(quick->mps) < p_.end_mps) stop(now_ns - nanoseconds(0.5 * p_.lift_s));
      return;
    }
    const bool lift = rises(quick, p_.lift_mps);
    if (!lift && !rises(slow, p_.escalator_mps)) return;
    riding_ = true;
    since_ns_ = std::max(stepped_ns, (lift ? quick : slow)->from_ns);
  }
  /// A step ends a ride.
  void step(int64_t t_ns) {
    if (riding_) stop(t_ns);
  }
  bool riding() const { return riding_; }
  /// Earliest start of the current ride or of the state after it.
  int64_t since_ns() const { return since_ns_; }
  void reset() { *this = LiftDetector(p_); }

 private:
  void stop(int64_t t_ns) { riding_ = false, since_ns_ = std::max(t_ns, since_ns_); }

  Parameters p_;
  bool riding_ = false;
  int64_t since_ns_ = INT64_MIN / 2;
};

}  // namespace odograph
