// SPDX-License-Identifier: Apache-2.0
#include "plugins/step/gait/step_frequency.hpp"

#include <algorithm>
#include <cmath>

namespace odograph::gait {
namespace {
constexpr double kPi = 3.14159265358979323846;
constexpr int64_t kSpacing_ns = 12'000'000;  // 256 samples cover the window at any rate; gait ends far below 40 Hz
}  // namespace

void StepFrequency::add(int64_t t_ns, double value) {
  if (last_kept_ns_ != INT64_MIN && t_ns - last_kept_ns_ < kSpacing_ns) return;
  last_kept_ns_ = t_ns;
  samples_[count_++ % samples_.size()] = {t_ns, value};
}

double StepFrequency::power(double frequency_hz, int64_t now_ns) const {
  double re = 0, im = 0;
  const size_t kept = std::min(count_, samples_.size());
  for (size_t i = 0; i < kept; ++i) {
    const Sample& s = samples_[i];
    const double age = static_cast<double>(now_ns - s.t_ns) * 1e-9;
    if (age > kWindow_s) continue;
    const double window = 0.5 - 0.5 * std::cos(2 * kPi * age / kWindow_s);
    const double phase = 2 * kPi * frequency_hz * age;
    re += window * s.value * std::cos(phase);
    im += window * s.value * std::sin(phase);
  }
  return re * re + im * im;
}

double StepFrequency::estimate(double expected_hz) const {
  if (count_ < 50) return expected_hz;
  const int64_t now = samples_[(count_ - 1) % samples_.size()].t_ns;
  const double low = std::max(kLowest_hz, expected_hz / 1.35), high = std::min(kHighest_hz, expected_hz * 1.35);
  double best = 0, best_power = 0, left = 0, right = 0, previous = power(low - kGrid_hz, now);
  double here = power(low, now);
  for (double f = low; f <= high; f += kGrid_hz) {
    const double next = power(f + kGrid_hz, now);
    if (here > best_power && here >= previous && here >= next)
      best = f, best_power = here, left = previous, right = next;
    previous = here;
    here = next;
  }
  if (best == 0) return expected_hz;
  const double bend = left - 2 * best_power + right;
  return bend < 0 ? best + 0.5 * kGrid_hz * (left - right) / bend : best;
}

}  // namespace odograph::gait
