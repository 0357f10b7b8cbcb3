// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "sdk/host/localizer/localizer.hpp"
#include "sdk/host/localizer/parameters.hpp"
#include "sdk/host/messages/messages.hpp"

namespace odograph {

/// The barometer's height, against an offset that drifts.
class HeightUpdate {
 public:
  explicit HeightUpdate(const LocalizerParameters& parameters) : p_(parameters) {}
  void reset() { *this = HeightUpdate(p_); }

  /// `down_m`: of the body at the barometer's time. `steps`: they carry the track, and no reading waits for another.
  UpdateResult use(Localizer& localizer, const odo_barometer& barometer, double down_m, bool steps) {
    constexpr double kSeaLevel_pa = 101325, kScaleHeight_m = 44330, kExponent = 0.190263;  // ISA, troposphere
    if (barometer.pressure_pa <= 0) return {};
    const double z_m = -kScaleHeight_m * (1 - std::pow(barometer.pressure_pa / kSeaLevel_pa, kExponent));
    const int64_t t_ns = barometer.header.t_ns;
    if (used_ns_ == INT64_MIN) {
      localizer.set(kBarometer, z_m - down_m, squared(p_.baro_sigma_m));
      localizer.P(kBarometer, kBarometer) += localizer.P(kDown, kDown);
      localizer.P(kBarometer, kDown) = localizer.P(kDown, kBarometer) = -localizer.P(kDown, kDown);
      used_ns_ = t_ns;
      return {true, 0.0, 1};
    }
    // Gusts and doors last for seconds: readings within that time have one error.
    const double since_s = std::clamp(static_cast<double>(t_ns - used_ns_) * kNanoseconds, 0.01, p_.baro_correlation_s);
    used_ns_ = t_ns;
    Innovation<1> height;
    height.residual[0] = z_m - down_m - localizer.x[kBarometer];
    height.H(0, kDown) = height.H(0, kBarometer) = 1;
    height.noise(0, 0) = squared(p_.baro_sigma_m) * (steps ? 1.0 : p_.baro_correlation_s / since_s);
    return localizer.update(height, p_.gate[1], these({kLogScale, kLogFactor, kStepHeading, kHeading}));
  }

 private:
  LocalizerParameters p_;
  int64_t used_ns_ = INT64_MIN;
};

}  // namespace odograph
