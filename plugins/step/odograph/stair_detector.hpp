// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "sdk/math/ring.hpp"

namespace odograph::steps {

/// Whether a walker goes up or down stairs, by the air's pressure and his own steps. The slope of the height over the
/// last ten seconds says that he climbs, where it stands clear of what the pressure scatters about it; a street of 17 %
/// lifts a brisk walker as fast as stairs do, but there he makes his usual steps. Stairs are what would be steeper than
/// any ramp if these steps were as long as their movement says. No allocation.
class StairDetector {
 public:
  struct Parameters {
    double metres_per_pascal = 0.0843;  ///< at sea level, 15 degrees: R T / (M g p)
    double window_s = 10;               ///< over which the slope is taken: a flight of stairs
    double min_span_s = 8;              ///< of the samples in it; set with the window
    size_t min_samples = 6;             ///< in it; judgement
    double begin_mps = 0.22;            ///< vertical: stairs lift by 0.25 and more, usual ramps by less
    double end_mps = 0.10;              ///< vertical, below which climbing ends; judgement
    double clear_sigmas = 5;            ///< of the slope, to begin; set on simulated walkers (README)
    double gust_s = 2;                  ///< what the pressure scatters by lasts that long; judgement
    double steepest_ramp = 0.25;        ///< height over length: ramps have 6 to 10 %, the steepest streets 20 to 25 %
    double still_steep = 0.20;          ///< the same to go on; judgement
    double learn_speed = 0.4;           ///< weight of the newest step in the speed; judgement, 0.3 to 0.5
    double pause_s = 2;                 ///< between two steps, after which a walk has a speed of its own; judgement
    double tread_m = 0.285;             ///< one foot on each: 0.28 (IBC) to 0.29 m (DIN 18065)
    double tread_sigma_m = 0.03;        ///< between stairs; judgement
    int64_t min_interval_ns = 40'000'000;  ///< quicker samples are passed over: 256 shall last for the window
  };
  StairDetector() : StairDetector(Parameters{}) {}
  explicit StairDetector(const Parameters& parameters) : p_(parameters) {}

  void add(int64_t t_ns, double pressure_pa);
  /// A step, with the length that it would have on level ground or a ramp. Without any the pressure decides alone.
  void add_step(int64_t t_start_ns, int64_t t_end_ns, double length_m);
  bool on_stairs() const { return on_stairs_; }
  /// When the climbing of stairs, or the walking elsewhere, began: the middle of the window that showed it, or the
  /// start of the step.
  int64_t since_ns() const { return since_ns_; }
  const Parameters& parameters() const { return p_; }
  void reset() { *this = StairDetector(p_); }

 private:
  struct Height {
    int64_t t_ns;
    double m;
  };
  void judge(int64_t since_ns);

  Parameters p_;
  Ring<Height, 256> heights_;
  bool ascends_ = false, on_stairs_ = false;  ///< the former up or down, by the pressure alone
  double climb_mps_ = 0, speed_mps_ = 0;
  int64_t step_ns_ = INT64_MIN / 2;
  int64_t since_ns_ = 0;
};

}  // namespace odograph::steps
