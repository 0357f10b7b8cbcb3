// SPDX-License-Identifier: Apache-2.0
#include "plugins/shared/gait/step_frequency.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "sdk/math/time.hpp"

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

double StepFrequency::estimate(double expected_hz) const {
  if (count_ < 50) return expected_hz;
  const int64_t now = samples_[(count_ - 1) % samples_.size()].t_ns;
  const double low = std::max(kLowest_hz, expected_hz / 1.35), high = std::min(kHighest_hz, expected_hz * 1.35);
  // Advances each sample's phasor from one grid frequency to the next: two sines per sample instead of one per term.
  struct Phasor {
    std::complex<double> value, phase;
  };
  std::array<Phasor, kSamples> phasors;
  size_t used = 0;
  for (size_t i = 0; i < std::min(count_, kSamples); ++i) {
    const double age = seconds(now - samples_[i].t_ns);
    if (age > kWindow_s) continue;
    const double window = 0.5 - 0.5 * std::cos(2 * kPi * age / kWindow_s);
    phasors[used++] = {std::polar(window, 2 * kPi * (low - kGrid_hz) * age) * samples_[i].value,
                       std::polar(1.0, 2 * kPi * kGrid_hz * age)};
  }
  const auto next_power = [&] {
    std::complex<double> sum = 0;
    for (size_t i = 0; i < used; ++i) {
      Phasor& p = phasors[i];
      sum += p.value;
      p.value = {p.value.real() * p.phase.real() - p.value.imag() * p.phase.imag(),
                 p.value.real() * p.phase.imag() + p.value.imag() * p.phase.real()};
    }
    return std::norm(sum);
  };
  double best = 0, best_power = 0, left = 0, right = 0, previous = next_power(), here = next_power();
  const int steps = static_cast<int>((high - low) / kGrid_hz);
  for (int i = 0; i <= steps; ++i) {
    const double next = next_power();
    if (here > best_power && here >= previous && here >= next) {
      best = low + i * kGrid_hz, best_power = here, left = previous, right = next;
    }
    previous = here;
    here = next;
  }
  if (best == 0) return expected_hz;
  const double bend = left - 2 * best_power + right;
  return bend < 0 ? best + 0.5 * kGrid_hz * (left - right) / bend : best;
}

}  // namespace odograph::gait
