// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

namespace odograph::steps {

/// A sample at a constant rate.
struct WalkSample {
  int64_t t_ns = 0;
  double vertical = 0;                                     ///< up, without gravity, m/s^2
  double level = 0;                                        ///< norm of the horizontal acceleration, m/s^2
  double gyro = 0;                                         ///< norm of the rotation rate, rad/s
  Eigen::Vector2d horizontal_n = Eigen::Vector2d::Zero();  ///< acceleration, m/s^2
  Eigen::Vector2d tilting_n = Eigen::Vector2d::Zero();     ///< rotation rate about horizontal axes, rad/s
  double yaw_radps = 0;                                    ///< about the vertical

  /// Adds `weight` times the value interpolated between `a` and `b` at the fraction `x`.
  void add(double weight, const WalkSample& a, const WalkSample& b, double x) {
    vertical += weight * (a.vertical + (b.vertical - a.vertical) * x);
    level += weight * (a.level + (b.level - a.level) * x);
    gyro += weight * (a.gyro + (b.gyro - a.gyro) * x);
    horizontal_n += weight * (a.horizontal_n + (b.horizontal_n - a.horizontal_n) * x);
    tilting_n += weight * (a.tilting_n + (b.tilting_n - a.tilting_n) * x);
    yaw_radps += weight * (a.yaw_radps + (b.yaw_radps - a.yaw_radps) * x);
  }
};

/// Resamples any, also irregular, rate to a constant 50 Hz: the mean of the linear interpolation over each cell of 20
/// ms. Restarts after a gap of more than a quarter of a second. Does not allocate.
class Resampler {
 public:
  static constexpr int64_t kCell_ns = 20'000'000;
  static constexpr int64_t kGap_ns = 250'000'000;

  /// Calls take(const WalkSample&) for each completed cell, and gap() at an interruption.
  template <class Take, class Gap>
  void push(const WalkSample& s, Take&& take, Gap&& gap) {
    if (!started_ || s.t_ns - last_.t_ns > kGap_ns) {
      if (started_) gap();
      started_ = true;
      last_ = s;
      cell_ns_ = s.t_ns - s.t_ns % kCell_ns + kCell_ns;  // the first whole cell
      sum_ = {};
      return;
    }
    if (s.t_ns <= last_.t_ns) return;
    int64_t from = last_.t_ns;
    const double span = static_cast<double>(s.t_ns - last_.t_ns);
    while (from < s.t_ns) {
      const int64_t edge = from < cell_ns_ ? cell_ns_ : cell_ns_ + kCell_ns;
      const int64_t to = edge < s.t_ns ? edge : s.t_ns;
      if (from >= cell_ns_) {
        const double weight = static_cast<double>(to - from) / static_cast<double>(kCell_ns);
        const int64_t middle = from + (to - from) / 2;
        sum_.add(weight, last_, s, static_cast<double>(middle - last_.t_ns) / span);
        if (to == cell_ns_ + kCell_ns) {
          sum_.t_ns = cell_ns_ + kCell_ns / 2;
          take(sum_);
          cell_ns_ += kCell_ns;
          sum_ = {};
        }
      }
      from = to;
    }
    last_ = s;
  }

 private:
  bool started_ = false;
  WalkSample last_;
  int64_t cell_ns_ = 0;
  WalkSample sum_;
};

/// The last seconds of the resampled signal, and the vertical acceleration with zero-phase smoothing: a Gaussian
/// centred half its length ago, minus the mean of the last two and a half seconds. Does not allocate.
class WalkSignal {
 public:
  static constexpr double kRate_hz = 50.0;
  static constexpr size_t kMaxHalf = 20;
  static constexpr size_t kKept = 256;  ///< a power of two; five seconds
  static constexpr size_t kMean = 125;  ///< samples of the mean

  /// `sigma_s` of the Gaussian, with `half` samples on either side of its centre, at most kMaxHalf. A tapered mean
  /// (Hann) does not ripple while a vivid walk leaves its window; it lags by half the window.
  explicit WalkSignal(double sigma_s = 0.06, size_t half = 10, bool tapered = false);
  void add(const WalkSample& sample);
  void reset() { *this = WalkSignal(sigma_s_, half_, tapered_); }
  size_t half() const { return half_; }
  /// Gain of the Gaussian at a frequency.
  double gain(double frequency_hz) const;

  /// Number of smoothed values so far; the newest has index smooth_count() - 1.
  size_t smooth_count() const { return smooth_count_; }
  double smooth(size_t i) const { return smooth_[i % kKept]; }
  int64_t smooth_ns(size_t i) const { return raw_[i % kKept].t_ns; }
  /// Over the last `seconds` of the input of add().
  double spread(double seconds) const;     ///< standard deviation of the vertical, m/s^2
  double gyro_norm(double seconds) const;  ///< mean norm, rad/s
  /// Vertical part of the acceleration's power over the last `seconds`: 0 to 1; a third if isotropic.
  double vertical_part(double seconds) const;
  /// The same between two smoothed values.
  double gyro_between(size_t from, size_t to) const;
  /// Rms of the smoothed angular rate about horizontal axes over the last `seconds`, mean removed: tilting to and fro
  /// of a hand, independent of its turning. rad/s.
  double tilting(double seconds) const;
  /// Vertical part of the power of the alternating acceleration over the last `seconds`: 0 to 1. Unlike vertical_part()
  /// it is independent of an inclination error.
  double alternating_part(double seconds) const;
  /// The same between two smoothed values: within one step neither starting nor a bend of the path has an effect.
  double vertical_part_between(size_t from, size_t to) const;
  /// Displacement range from the vertical acceleration between two smoothed values, one period: integrated twice, with
  /// the means of acceleration and velocity removed; maximum minus minimum, m.
  double rise_between(size_t from, size_t to) const;
  /// Component of the horizontal acceleration between two smoothed values, one period, at that phase lead over the
  /// vertical one, divided by the vertical amplitude.
  Eigen::Vector2d surge_between(size_t from, size_t to, double lead_rad) const;
  /// Rate at which the path bends: size of the mean rate about the vertical over the last `seconds`, in which the sway
  /// of strides cancels, rad/s.
  double turning(double seconds) const;
  /// Shape of the vertical acceleration between two values, a stride: the second harmonic of its steps in phase with
  /// the first, relative to it, before smoothing. Positive for a sharp push with a long rest, zero or negative for two
  /// humps per step.
  double second_harmonic_between(size_t from, size_t to) const;
  /// Autocorrelation of the smoothed signal at `lag` samples over the last `window` ones: -1 to 1.
  double regularity(size_t lag, size_t window) const;
  /// The same for all three axes together, each with its mean removed: regularity of a walk from stride to stride,
  /// wherever the phone is.
  double repetition(size_t lag, size_t window) const;

 private:
  size_t smoothed_within(double seconds) const;

  double sigma_s_;
  size_t half_;
  bool tapered_;
  std::array<double, 2 * kMaxHalf + 1> weights_{};
  std::array<double, kMean> mean_weights_{};  // oldest first
  std::array<WalkSample, kKept> raw_{};
  std::array<double, kKept> smooth_{};
  std::array<Eigen::Vector2d, kKept> smooth_horizontal_{}, smooth_tilting_{};
  size_t count_ = 0, smooth_count_ = 0;
};

}  // namespace odograph::steps
