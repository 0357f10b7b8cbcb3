// SPDX-License-Identifier: Apache-2.0
#include "plugins/step/odograph/walk_signal.hpp"

#include <algorithm>
#include <cmath>

namespace odograph::steps {
namespace {

constexpr double kGaussian_s = 0.06;

std::array<double, 2 * WalkSignal::kHalf + 1> gaussian() {
  std::array<double, 2 * WalkSignal::kHalf + 1> w{};
  double sum = 0;
  for (size_t i = 0; i < w.size(); ++i) {
    const double x = (static_cast<double>(i) - static_cast<double>(WalkSignal::kHalf)) / WalkSignal::kRate_hz;
    sum += w[i] = std::exp(-0.5 * x * x / (kGaussian_s * kGaussian_s));
  }
  for (double& x : w) x /= sum;
  return w;
}

}  // namespace

void WalkSignal::add(const WalkSample& sample) {
  static const auto weights = gaussian();
  raw_[count_++ % kKept] = sample;
  if (count_ < 2 * kHalf + 1) return;
  double value = 0;
  for (size_t i = 0; i < weights.size(); ++i)
    value += weights[i] * raw_[(count_ - weights.size() + i) % kKept].vertical;
  const size_t n = std::min(count_, kMean);
  double mean = 0;
  for (size_t i = count_ - n; i < count_; ++i) mean += raw_[i % kKept].vertical;
  smooth_count_ = count_ - kHalf;
  smooth_[(smooth_count_ - 1) % kKept] = value - mean / static_cast<double>(n);
}

double WalkSignal::spread(double seconds) const {
  const size_t n = std::min({count_, kKept, static_cast<size_t>(seconds * kRate_hz)});
  if (n < 2) return 0;
  double sum = 0, squares = 0;
  for (size_t i = count_ - n; i < count_; ++i) {
    const double x = raw_[i % kKept].vertical;
    sum += x, squares += x * x;
  }
  const double mean = sum / static_cast<double>(n);
  return std::sqrt(std::max(0.0, squares / static_cast<double>(n) - mean * mean));
}

double WalkSignal::gyro_level(double seconds) const {
  const size_t n = std::min({count_, kKept, static_cast<size_t>(seconds * kRate_hz)});
  double sum = 0;
  for (size_t i = count_ - n; i < count_; ++i) sum += raw_[i % kKept].gyro;
  return n > 0 ? sum / static_cast<double>(n) : 0.0;
}

double WalkSignal::vertical_part(double seconds) const {
  const size_t n = std::min({count_, kKept, static_cast<size_t>(seconds * kRate_hz)});
  double level = 0;
  for (size_t i = count_ - n; i < count_; ++i) level += raw_[i % kKept].level * raw_[i % kKept].level;
  const double up = spread(seconds), all = up * up + level / static_cast<double>(std::max<size_t>(n, 1));
  return all > 0 ? up * up / all : 0.0;
}

double WalkSignal::gyro_between(size_t from, size_t to) const {
  double sum = 0;
  for (size_t i = from; i < to; ++i) sum += raw_[i % kKept].gyro;
  return to > from ? sum / static_cast<double>(to - from) : 0.0;
}

double WalkSignal::rise_between(size_t from, size_t to) const {
  constexpr double dt = 1 / kRate_hz;
  const auto n = static_cast<double>(to - from);
  if (to - from < 3 || to - from > kKept / 2) return 0;
  double mean = 0;
  for (size_t i = from; i < to; ++i) mean += smooth(i) / n;
  double velocity = 0, mean_velocity = 0;
  for (size_t i = from; i < to; ++i) mean_velocity += (velocity += (smooth(i) - mean) * dt) / n;
  double place = 0, highest = 0, lowest = 0;
  velocity = -mean_velocity;
  for (size_t i = from; i < to; ++i) {
    place += (velocity += (smooth(i) - mean) * dt) * dt;
    highest = std::max(highest, place), lowest = std::min(lowest, place);
  }
  return highest - lowest;
}

double WalkSignal::regularity(size_t lag, size_t window) const {
  if (smooth_count_ < kHalf + lag + window + 1 || lag + window + kHalf > kKept) return 0;
  double product = 0, now = 0, before = 0;
  for (size_t i = smooth_count_ - window; i < smooth_count_; ++i) {
    const double a = smooth(i), b = smooth(i - lag);
    product += a * b, now += a * a, before += b * b;
  }
  return now > 0 && before > 0 ? product / std::sqrt(now * before) : 0.0;
}

}  // namespace odograph::steps
