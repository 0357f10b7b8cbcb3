// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "sdk/math/scalar.hpp"
#include "sdk/tools/simulation/random.hpp"

namespace odograph {

using Signal = std::vector<double>;

/// Approximate Gaussian filter of that width: three successive box filters; constant beyond the ends.
inline void smooth(Signal& signal, double sigma_s, double rate_hz) {
  const auto n = static_cast<long>(signal.size());
  const auto half =
      static_cast<long>(std::lround(0.5 * (std::sqrt(4 * sigma_s * sigma_s * rate_hz * rate_hz + 1) - 1)));
  if (half < 1 || n < 2) return;
  const auto at = [n](const Signal& s, long i) { return s[static_cast<size_t>(std::clamp(i, 0L, n - 1))]; };
  for (int pass = 0; pass < 3; ++pass) {
    const Signal before = signal;
    double sum = 0;
    for (long i = -half; i <= half; ++i)
      sum += at(before, i) - before[0];  // relative to the start, to keep precision for large values
    for (long i = 0; i < n; ++i) {
      signal[static_cast<size_t>(i)] = before[0] + sum / static_cast<double>(2 * half + 1);
      sum += at(before, i + half + 1) - at(before, i - half);
    }
  }
}

/// Adds a first-order Gauss-Markov process with that time constant and standard deviation.
inline void add_gauss_markov(Signal& signal, Random random, double constant_s, double sigma, double rate_hz) {
  const double keep = std::exp(-1 / (constant_s * rate_hz)), kick = sigma * std::sqrt(1 - keep * keep);
  double value = sigma * random.normal();
  for (double& s : signal) {
    value = keep * value + kick * random.normal();
    s += value;
  }
}

/// Adds narrow-band noise: a damped oscillator of that frequency and damping, driven by white noise, scaled to the
/// standard deviation.
inline void add_narrow_band(Signal& signal, Random random, double frequency_hz, double damping, double sigma,
                            double rate_hz) {
  const double w = 2 * kPi * frequency_hz, dt = 1 / rate_hz;
  const double drive = sigma * std::sqrt(4 * damping * w * w * w / dt);  // variance of x is q / (4 zeta w^3)
  double x = 0, v = 0;
  for (double& s : signal) {
    v += dt * (drive * random.normal() - w * w * x - 2 * damping * w * v);
    x += dt * v;
    s += x;
  }
}

/// Replaces a motion by that of a mass on a damped spring whose base follows it: a number, or a vector each.
template <class Value>
void follow_by_spring(std::vector<Value>& base, double frequency_hz, double damping, double rate_hz) {
  const double w = 2 * kPi * frequency_hz, dt = 1 / rate_hz;
  Value at = base[0], before = base[0], velocity = 0 * base[0];
  for (Value& target : base) {
    const Value speed = (target - before) / dt;
    before = target;
    velocity += dt * (w * w * (target - at) + 2 * damping * w * (speed - velocity));
    at += dt * velocity;
    target = at;
  }
}

}  // namespace odograph
