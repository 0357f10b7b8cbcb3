// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

namespace odograph::barometer {

/// Heights from pressure, relative to a known height. The atmosphere is the ISA's troposphere; the weather is modelled
/// as a random walk plus an unknown trend. Heights are n's down coordinates, m. Does not allocate.
class PressureHeight {
 public:
  struct Parameters {
    double noise_m = 0.5;            ///< of a reading: 4 Pa of wind and 3 of noise (8.4 cm a pascal)
    double noise_correlation_s = 4;  ///< correlation time of gusts
    double walk_m = 0.03;            ///< m/sqrt(s): 20 Pa in an hour, doors and ventilation
    double trend_mps = 7e-4;         ///< 1 hPa in three hours, as in weather reports on ordinary days
    double average_s = 2;            ///< averaging time
    double longest_gap_s = 30;       ///< without readings: doors, lifts, another pocket; empirical, not tuned
    double alike_s = 60;             ///< correlation time of the error common to the heights
  };
  struct Height {
    int64_t t_ns;  ///< middle of the averaged readings
    double down_m;
    double error_variance_m2;  ///< of this height alone
    double fix_variance_m2;    ///< variance that independent fixes at intervals of average_s need to carry the same
                               ///< information
  };
  explicit PressureHeight(const Parameters& parameters) : p_(parameters) {}

  /// Sets the reference: the height at t, down, m, with its variance. Applies to the readings around t.
  void refer(int64_t t_ns, double down_m, double variance_m2);
  /// Adds a reading in Pa. Returns a height when an average is complete and there is a reference. Ignores pressures
  /// outside 300 to 1200 hPa.
  std::optional<Height> add(int64_t t_ns, double pressure_pa);

  /// ISA height above mean sea level, downwards, m.
  static double down_of(double pressure_pa);

 private:
  struct Mean {
    int64_t first_ns = 0, t_ns = 0;
    double t_s = 0, down_m = 0;  // sums, t from the first
    int n = 0;
  };
  struct Reference {
    int64_t t_ns;
    double down_m, variance_m2, by_pressure_m;
  };
  double noise_variance() const;

  Parameters p_;
  Mean mean_;
  std::optional<double> last_by_pressure_m_;
  int64_t last_ns_ = 0;
  std::optional<Reference> reference_, waiting_;  // `waiting_` until its average is complete
};

}  // namespace odograph::barometer
