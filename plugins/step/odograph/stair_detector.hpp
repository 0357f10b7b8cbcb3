// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "plugins/shared/ring.hpp"

namespace odograph::steps {

/// Whether a walker goes up or down stairs, by the air's pressure: the slope of the height over the last ten seconds,
/// where it stands clear of what the pressure scatters about it. Stairs lift by a quarter of a metre a second and more,
/// ramps by less. No allocation.
class StairDetector {
 public:
  struct Parameters {
    double metres_per_pascal = 0.0843;     ///< at sea level, 15 degrees: R T / (M g p)
    double window_s = 10;                  ///< over which the slope is taken: a flight of stairs
    double min_span_s = 8;                 ///< of the samples in it; set with the window
    size_t min_samples = 6;                ///< in it; judgement
    double begin_mps = 0.22;               ///< vertical: stairs lift by 0.25 and more, ramps by less
    double end_mps = 0.10;                 ///< vertical, below which climbing ends; judgement
    double clear_sigmas = 5;               ///< of the slope, to begin; set on simulated walkers (README)
    double gust_s = 2;                     ///< what the pressure scatters by lasts that long; judgement
    int64_t min_interval_ns = 40'000'000;  ///< quicker samples are passed over: 256 shall last for the window
  };
  StairDetector() : StairDetector(Parameters{}) {}
  explicit StairDetector(const Parameters& parameters) : p_(parameters) {}

  void add(int64_t t_ns, double pressure_pa);
  bool on_stairs() const { return on_stairs_; }
  /// When the climbing, or the walking on level ground, began: the middle of the window that showed it.
  int64_t since_ns() const { return since_ns_; }
  void reset() { *this = StairDetector(p_); }

 private:
  struct Height {
    int64_t t_ns;
    double m;
  };
  Parameters p_;
  plugin::Ring<Height, 256> heights_;
  bool on_stairs_ = false;
  int64_t since_ns_ = 0;
};

}  // namespace odograph::steps
