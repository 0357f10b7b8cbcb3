// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "sdk/host/localizer/localizer.hpp"
#include "sdk/math/atmosphere.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

/// Barometric height update with a drifting offset.
class HeightUpdate {
 public:
  struct Parameters {
    double sigma_m = 0.5;       ///< m: 4 Pa of wind and 3 of noise
    double correlation_s = 10;  ///< s, correlation time of its error; judgement
    double walk = 0.02;         ///< m/sqrt(s), offset random walk: 20 Pa in an hour, doors
    double lift_mps = 3;        ///< m/s, one sigma, of a lift: in high buildings 2 to 6
    double max_delay_s = 6;     ///< s, maximum detection delay of a ride, during which the body has moved
  };

  void reset() { *this = {}; }
  void propagate(Localizer& localizer, double dt_s) const {
    localizer.add_variance(kBarometer, squared(p_.walk) * dt_s);
  }

  /// `down_m`: of the body at the barometer's time. `steps`: steps move the track, so no reading waits for another.
  UpdateResult use(Localizer& localizer, const odo_barometer& barometer, double down_m, bool steps) {
    if (barometer.pressure_pa <= 0) return {};
    const double z_m = -pressure_height_m(barometer.pressure_pa);
    const int64_t t_ns = barometer.header.t_ns;
    if (used_ns_ == INT64_MIN) {
      localizer.set(kBarometer, z_m - down_m + localizer.x()[kDown], squared(p_.sigma_m));
      localizer.add_multiple(kBarometer, kDown, -1);
      used_ns_ = t_ns;
      return {true, 0.0, 1};
    }
    // Gusts and doors last for seconds: the error of the readings within that time is correlated.
    const double since_s = std::clamp(seconds(t_ns - used_ns_), 0.01, p_.correlation_s);
    used_ns_ = t_ns;
    Innovation height(1);
    height.residual[0] = z_m - down_m - localizer.x()[kBarometer];
    height.H(0, kDown) = height.H(0, kBarometer) = 1;
    height.noise(0, 0) = squared(p_.sigma_m) * (steps ? 1.0 : p_.correlation_s / since_s);
    return localizer.update(height, riding_ ? 0.0 : kGate[1], only({kLogScale, kLogFactor, kStepHeading, kHeading}));
  }

  /// A lift or an escalator moves the body vertically from that time on, or no longer does.
  void ride(bool rides, int64_t since_ns) {
    if (rides && !riding_) ride_until_ns_ = since_ns;
    riding_ = rides;
  }
  bool riding() const { return riding_; }
  /// Adds the vertical motion of a ride until a reading as process noise: only the barometer observes it.
  void add_ride_noise(Localizer& localizer, int64_t t_ns) {
    const double dt_s = std::clamp(seconds(t_ns - ride_until_ns_), 0.0, p_.max_delay_s);
    ride_until_ns_ = std::max(t_ns, ride_until_ns_);
    localizer.add_variance(kDown, squared(p_.lift_mps * dt_s));
  }

 private:
  Parameters p_;
  int64_t used_ns_ = INT64_MIN, ride_until_ns_ = 0;
  bool riding_ = false;
};

}  // namespace odograph
