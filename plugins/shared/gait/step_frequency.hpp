// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace odograph::gait {

/// Step frequency by a short-time Fourier transform of the gait signal, independent of the step detector, as proposed
/// by Renaudin, Susi & Lachapelle (Sensors 2012). A Hann window covers the last seconds; the transform is evaluated on
/// a frequency grid and does not need equally spaced samples. Does not allocate.
class StepFrequency {
 public:
  static constexpr double kWindow_s = 3.0;  ///< a few of the slowest steps; empirical
  /// From a stroll to a run, empirical; the grid is an eighth of the window's resolution.
  static constexpr double kLowest_hz = 1.0, kHighest_hz = 3.4, kGrid_hz = 0.04;

  void add(int64_t t_ns, double value);

  /// Dominant frequency in Hz near `expected_hz` (within a factor of 1.35, to exclude the half frequency of a limp and
  /// a double bounce); `expected_hz` itself if there is no clear peak or too little signal.
  double estimate(double expected_hz) const;

 private:
  static constexpr size_t kSamples = 256;

  struct Sample {
    int64_t t_ns;
    double value;
  };
  std::array<Sample, kSamples> samples_{};
  size_t count_ = 0;
  int64_t last_kept_ns_ = INT64_MIN;
};

}  // namespace odograph::gait
