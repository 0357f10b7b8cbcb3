// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "sdk/host/fusion/pose_filter.hpp"
#include "sdk/math/ring.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

/// Detects that a walker who takes no step moves vertically: in a lift (fast) or on an escalator (slow and steady).
/// Only the air pressure shows it: between start and stop, a lift is as still as a floor. No allocation.
class LiftDetector {
 public:
  struct Parameters {
    double gust_s = 2;                     ///< s, correlation time of the pressure noise; judgement
    double max_silence_s = 10;             ///< s without a reading, after which the history is discarded
    int64_t min_interval_ns = 40'000'000;  ///< faster readings are skipped, so that 256 span ten seconds
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

  /// Takes a reading. `stepped`: end of the last step. False if it follows the previous one too soon to count.
  bool add(int64_t t_ns, double pressure_pa, Instant stepped);
  /// A step ends a ride.
  void step(int64_t t_ns) {
    if (riding_) stop(t_ns);
  }
  bool riding() const { return riding_; }
  /// Earliest start of the current ride or of the state after it.
  Instant since() const { return since_; }

 private:
  struct Sample {
    int64_t t_ns;
    double up_m;
  };
  struct Slope {
    double mps, sigma_mps;
    int64_t from_ns;  ///< time of the oldest height used
  };
  std::optional<Slope> slope(double window_s, double min_span_s, size_t min_samples) const;
  void stop(int64_t t_ns) { riding_ = false, since_ = std::max(Instant(t_ns), since_); }

  Parameters p_;
  Ring<Sample, 256> heights_;
  bool riding_ = false;
  Instant since_;
};

/// Barometric height with a drifting offset.
class Height {
 public:
  struct Parameters {
    double sigma_m = 0.5;       ///< m: 4 Pa of wind and 3 of noise
    double correlation_s = 10;  ///< s, correlation time of its error; judgement
    double walk = 0.02;         ///< m/sqrt(s), offset random walk: 20 Pa in an hour, doors
    double lift_mps = 3;        ///< m/s, one sigma, of a lift: in high buildings 2 to 6
    double max_delay_s = 6;     ///< s, maximum detection delay of a ride, during which the body has moved
  };

  void propagate(PoseFilter& filter, double dt_s) const;
  /// `down_m`: of the body at the barometer's time. `steps`: steps move the track, so no reading waits for another.
  UpdateResult use(PoseFilter& filter, const odo_barometer& barometer, double down_m, bool steps);
  /// A step ends a ride in a lift or on an escalator.
  void step(int64_t t_ns) { lift_.step(t_ns), ride(lift_.riding()); }
  /// Looks for a ride with a reading of a walker; `stepped`: end of the last step. True if one begins or ends.
  bool detect_ride(const odo_barometer& barometer, Instant stepped);
  /// A lift or an escalator moves the body vertically.
  bool riding() const { return riding_; }
  /// Adds the vertical motion of a ride until a reading as process noise: only the barometer observes it.
  void add_ride_noise(PoseFilter& filter, int64_t t_ns);

 private:
  void ride(bool rides);

  Parameters p_;
  LiftDetector lift_;
  Instant used_;
  int64_t ride_until_ns_ = 0;
  bool riding_ = false;
};

}  // namespace odograph
