// SPDX-License-Identifier: Apache-2.0
#include "plugins/step/odograph/walk_signal.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "sdk/math/scalar.hpp"

namespace odograph::steps {

WalkSignal::WalkSignal(double sigma_s, size_t half, bool tapered)
    : sigma_s_(sigma_s), half_(std::min(half, kMaxHalf)), tapered_(tapered) {
  for (size_t i = 0; i < kMean; ++i)
    mean_weights_[i] = tapered ? std::pow(std::sin(kPi * (static_cast<double>(i) + 0.5) / kMean), 2) : 1.0;
  double sum = 0;
  for (size_t i = 0; i < 2 * half_ + 1; ++i) {
    const double x = (static_cast<double>(i) - static_cast<double>(half_)) / kRate_hz;
    sum += weights_[i] = std::exp(-0.5 * x * x / (sigma_s_ * sigma_s_));
  }
  for (double& x : weights_) x /= sum;
}

double WalkSignal::gain(double frequency_hz) const {
  const double phase_rad = 2 * kPi * frequency_hz * sigma_s_;
  return std::exp(-0.5 * phase_rad * phase_rad);
}

void WalkSignal::add(const WalkSample& sample) {
  raw_[count_++ % kKept] = sample;
  const size_t length = 2 * half_ + 1;
  if (count_ < length) return;
  double value = 0;
  Eigen::Vector2d horizontal = Eigen::Vector2d::Zero(), tilting = Eigen::Vector2d::Zero();
  for (size_t i = 0; i < length; ++i) {
    const WalkSample& s = raw_[(count_ - length + i) % kKept];
    value += weights_[i] * s.vertical;
    horizontal += weights_[i] * s.horizontal_n;
    tilting += weights_[i] * s.tilting_n;
  }
  const size_t n = std::min(count_, kMean);
  double mean = 0, weights = 0;
  for (size_t i = 0; i < n; ++i) {
    const double weight = mean_weights_[i + kMean - n];
    mean += weight * raw_[(count_ - n + i) % kKept].vertical;
    weights += weight;
  }
  smooth_count_ = count_ - half_;
  smooth_[(smooth_count_ - 1) % kKept] = value - mean / weights;
  smooth_horizontal_[(smooth_count_ - 1) % kKept] = horizontal;
  smooth_tilting_[(smooth_count_ - 1) % kKept] = tilting;
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

double WalkSignal::gyro_norm(double seconds) const {
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

size_t WalkSignal::smoothed_within(double seconds) const {
  const size_t all = smooth_count_ > half_ ? std::min(smooth_count_ - half_, kKept - 2 * half_) : 0;
  return std::min(all, static_cast<size_t>(seconds * kRate_hz));
}

double WalkSignal::tilting(double seconds) const {
  const size_t n = smoothed_within(seconds);
  if (n < 2) return 0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double squares = 0;
  for (size_t i = smooth_count_ - n; i < smooth_count_; ++i) {
    const Eigen::Vector2d& x = smooth_tilting_[i % kKept];
    sum += x, squares += x.squaredNorm();
  }
  const Eigen::Vector2d mean = sum / static_cast<double>(n);
  return std::sqrt(std::max(0.0, squares / static_cast<double>(n) - mean.squaredNorm()));
}

double WalkSignal::alternating_part(double seconds) const {
  return vertical_part_between(smooth_count_ - smoothed_within(seconds), smooth_count_);
}

double WalkSignal::vertical_part_between(size_t from, size_t to) const {
  if (to < from + 2 || to > from + kKept / 2) return 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), squares = Eigen::Vector3d::Zero();
  for (size_t i = from; i < to; ++i) {
    const Eigen::Vector2d& level = smooth_horizontal_[i % kKept];
    const Eigen::Vector3d x(level.x(), level.y(), smooth_[i % kKept]);
    sum += x, squares += x.cwiseAbs2();
  }
  const auto n = static_cast<double>(to - from);
  const Eigen::Vector3d power = squares / n - (sum / n).cwiseAbs2();
  return power.sum() > 0 ? power.z() / power.sum() : 0.0;
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

Eigen::Vector2d WalkSignal::surge_between(size_t from, size_t to, double lead_rad) const {
  if (to - from < 3 || to - from > kKept / 2) return Eigen::Vector2d::Zero();
  std::complex<double> up = 0, north = 0, east = 0;
  const std::complex<double> rotation = std::polar(1.0, -2 * kPi / static_cast<double>(to - from));
  std::complex<double> phase = 1;
  for (size_t i = from; i < to; ++i, phase *= rotation) {
    up += smooth(i) * phase;
    north += smooth_horizontal_[i % kKept].x() * phase, east += smooth_horizontal_[i % kKept].y() * phase;
  }
  const double power = std::norm(up);
  if (!(power > 0)) return Eigen::Vector2d::Zero();
  const std::complex<double> reference = std::conj(up * std::polar(1.0, lead_rad)) / power;
  return {(north * reference).real(), (east * reference).real()};
}

double WalkSignal::turning(double seconds) const {
  const size_t n = std::min({count_, kKept, static_cast<size_t>(seconds * kRate_hz)});
  double sum = 0;
  for (size_t i = count_ - n; i < count_; ++i) sum += raw_[i % kKept].yaw_radps;
  return n > 0 ? std::abs(sum) / static_cast<double>(n) : 0.0;
}

double WalkSignal::second_harmonic_between(size_t from, size_t to) const {
  if (to - from < 8 || to - from > kKept / 2) return 0;
  std::complex<double> first = 0, second = 0, phase = 1;
  const std::complex<double> rotation = std::polar(1.0, -4 * kPi / static_cast<double>(to - from));
  double mean = 0;
  for (size_t i = from; i < to; ++i) mean += raw_[i % kKept].vertical / static_cast<double>(to - from);
  for (size_t i = from; i < to; ++i, phase *= rotation) {
    const double vertical = raw_[i % kKept].vertical - mean;
    first += vertical * phase, second += vertical * phase * phase;
  }
  const double size = std::abs(first);
  return size > 0 ? (second / (first * first)).real() * size : 0.0;
}

double WalkSignal::regularity(size_t lag, size_t window) const {
  if (smooth_count_ < half_ + lag + window + 1 || lag + window + half_ > kKept) return 0;
  double product = 0, now = 0, before = 0;
  for (size_t i = smooth_count_ - window; i < smooth_count_; ++i) {
    const double a = smooth(i), b = smooth(i - lag);
    product += a * b, now += a * a, before += b * b;
  }
  return now > 0 && before > 0 ? product / std::sqrt(now * before) : 0.0;
}

double WalkSignal::repetition(size_t lag, size_t window) const {
  if (smooth_count_ < half_ + lag + window + 1 || lag + window + half_ > kKept) return 0;
  const auto at = [&](size_t i) {
    const Eigen::Vector2d& level = smooth_horizontal_[i % kKept];
    return Eigen::Vector3d(level.x(), level.y(), smooth(i));
  };
  Eigen::Vector3d now = Eigen::Vector3d::Zero(), before = now, products = now, now_squares = now, before_squares = now;
  for (size_t i = smooth_count_ - window; i < smooth_count_; ++i) {
    const Eigen::Vector3d a = at(i), b = at(i - lag);
    now += a, before += b;
    products += a.cwiseProduct(b), now_squares += a.cwiseAbs2(), before_squares += b.cwiseAbs2();
  }
  const auto n = static_cast<double>(window);
  const double product = products.sum() - now.dot(before) / n;
  const double squares =
      (now_squares.sum() - now.squaredNorm() / n) * (before_squares.sum() - before.squaredNorm() / n);
  return squares > 0 ? product / std::sqrt(squares) : 0.0;
}

}  // namespace odograph::steps
