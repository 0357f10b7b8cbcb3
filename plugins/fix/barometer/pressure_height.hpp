// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

namespace odograph::barometer {

/// Heights from pressure, carried on from a height that was known. The atmosphere is the ISA's troposphere; what the
/// weather does meanwhile is a random walk and a trend that nobody knows. Heights are n's down coordinates, m. No
/// allocation.
class PressureHeight {
 public:
  struct Parameters {
    double noise_m = 0.5;            ///< of a reading: 4 Pa of wind and 3 of noise (8.4 cm a pascal)
    double noise_correlation_s = 4;  ///< of gusts
    double walk_m = 0.03;            ///< m/sqrt(s): 20 Pa in an hour, doors and ventilation
    double trend_mps = 7e-4;         ///< 1 hPa in three hours, as weather reports have it on ordinary days
    double average_s = 2;            ///< readings are averaged over so long
    double longest_gap_s = 30;       ///< without readings: doors, lifts, another pocket; chosen by hand, not tuned
    double alike_s = 60;             ///< for so long what is common to heights counts as one error
  };
  struct Height {
    int64_t t_ns;  ///< the middle of the readings averaged
    double down_m;
    double error_variance_m2;  ///< of this height by itself
    double fix_variance_m2;    ///< with which independent fixes, average_s apart, would tell as much
  };
  explicit PressureHeight(const Parameters& parameters) : p_(parameters) {}

  /// The height at t is known: down, m, with its variance. It holds for the readings around t.
  void refer(int64_t t_ns, double down_m, double variance_m2);
  /// A reading in Pa; a height when an average is complete and there is a reference. Pressures outside of 300 to
  /// 1200 hPa are no readings.
  std::optional<Height> add(int64_t t_ns, double pressure_pa);
  bool has_reference() const { return reference_.has_value(); }

  /// The ISA's height over mean sea level, downwards, m.
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
  std::optional<Reference> reference_, waiting_;  // the second until an average is there
};

}  // namespace odograph::barometer
