// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "sdk/math/ring.hpp"

namespace odograph::steps {

/// Detects stairs from pressure and steps. The slope of the height over the last ten seconds gives a climb if it
/// exceeds the scatter of the pressure. A street of 17 % lifts a brisk walker as fast as stairs do, but with steps of
/// the usual length. On stairs the steps, if they were as long as their motion suggests, would imply a slope steeper
/// than any ramp. Does not allocate.
class StairDetector {
 public:
  struct Parameters {
    double metres_per_pascal = 0.0843;  ///< at sea level, 15 degrees: R T / (M g p)
    double window_s = 10;               ///< duration of the slope estimate: a flight of stairs
    double min_span_s = 8;              ///< min time span of the samples; set with the window
    size_t min_samples = 6;             ///< min number; empirical
    double begin_mps = 0.22;            ///< vertical: stairs lift by 0.25 and more, usual ramps by less
    double end_mps = 0.10;              ///< vertical, below which climbing ends; empirical
    double clear_sigmas = 5;            ///< of the slope, to begin; set on simulated walkers (README)
    double gust_s = 2;                  ///< correlation time of the pressure scatter; empirical
    double steepest_ramp = 0.25;        ///< height over length: ramps have 6 to 10 %, the steepest streets 20 to 25 %
    double still_steep = 0.20;          ///< the same to continue; empirical
    double learn_speed = 0.4;           ///< weight of the newest step in the speed; empirical, 0.3 to 0.5
    double pause_s = 2;                 ///< interval of two steps after which the speed is re-initialised; empirical
    double tread_m = 0.285;             ///< one foot per tread: 0.28 (IBC) to 0.29 m (DIN 18065)
    double tread_sigma_m = 0.03;        ///< among stairs; empirical
    int64_t min_interval_ns = 40'000'000;  ///< samples at shorter intervals are skipped: 256 must cover the window
  };
  StairDetector() : StairDetector(Parameters{}) {}
  explicit StairDetector(const Parameters& parameters) : p_(parameters) {}

  void add(int64_t t_ns, double pressure_pa);
  /// A step, with the length that it would have on level ground or a ramp. Without steps the pressure alone decides.
  void add_step(int64_t t_start_ns, int64_t t_end_ns, double length_m);
  bool on_stairs() const { return on_stairs_; }
  /// Start of the stairs, or of walking elsewhere: the middle of the window that showed it, or the start of the step.
  int64_t since_ns() const { return since_ns_; }
  const Parameters& parameters() const { return p_; }
  void reset() { *this = StairDetector(p_); }

 private:
  struct Height {
    int64_t t_ns;
    double m;
  };
  void update_state(int64_t since_ns);

  Parameters p_;
  Ring<Height, 256> heights_;
  bool ascends_ = false, on_stairs_ = false;  ///< climbing up or down, by the pressure alone
  double climb_mps_ = 0, speed_mps_ = 0;
  int64_t step_ns_ = INT64_MIN / 2;
  int64_t since_ns_ = 0;
};

}  // namespace odograph::steps
