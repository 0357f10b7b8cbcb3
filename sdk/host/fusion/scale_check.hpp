// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace odograph {

/// Checks whether the metric scale of a front-end that lost tracking for a while still agrees with the walker's steps.
/// Such a front-end may place everything it sees afterwards at twice its distance, with high confidence, for a minute.
/// A front-end without tracking loss is not checked: people shuffle, and a step estimator then reports three times the
/// true length. The walker's step factor is estimated while the front-end tracks.
class ScaleCheck {
 public:
  struct Parameters {
    size_t steps = 12;           ///< window of the comparison: six seconds; empirical
    double walker_sigma = 0.2;   ///< prior of a walker's log factor: 0.10 for brisk walkers, more for others
    double window_sigma = 0.08;  ///< of the mean over a window for a known walker, whose gait varies
    double walk = 0.02;          ///< random walk of the log factor from window to window
    double max_sigmas = 3;       ///< deviation beyond which the scale is rejected
    /// Log difference below which the scale is never rejected; from three city walks, and hybrid walks as
    /// counterexamples.
    double min_log = 0.35;
    double accept_log = 0.15;   ///< below it twice in a row, the scale is accepted again; empirical
    double min_outage_s = 0.5;  ///< s without tracking; a velocity known to 0.3 m/s is then off by a tenth
    size_t probation = 36;      ///< steps afterwards during which steps judge the scale: three windows; empirical
  };

  ScaleCheck() : variance_(p_.walker_sigma * p_.walker_sigma) {}

  /// Another scale group starts; the walker's factor is retained.
  void restart() { count_ = 0, rejected_ = false; }
  /// Adds a motion of the front-end over dt_s. Tracking losses count from the first metric motion on, including
  /// re-initialisations without metric scale and pauses of that length.
  void add_motion(double dt_s, bool tracking, bool metric) {
    was_metric_ = was_metric_ || metric;
    if (!was_metric_) return;
    outage_s_ = tracking && dt_s < p_.min_outage_s ? 0 : outage_s_ + dt_s;
    if (outage_s_ >= p_.min_outage_s) probation_ = p_.probation;
  }
  /// Adds a step length, m, from the step estimator and from the front-end. True if the verdict changed.
  bool add(double step_m, double odometry_m) {
    step_m_[count_ % kMax] = step_m, odometry_m_[count_ % kMax] = odometry_m;
    ++count_;
    const bool before = rejected_, judged = probation_ > 0;
    if (!rejected_) probation_ -= std::min<size_t>(probation_, 1);
    const double noise = p_.window_sigma * p_.window_sigma;
    if (!rejected_ && count_ >= p_.steps) {
      const double most = std::max(p_.min_log, p_.max_sigmas * std::sqrt(variance_ + noise));
      const bool agrees = std::abs(deviation(0)) <= most;
      rejected_ = judged && !agrees;
      if (agrees && !judged && count_ % p_.steps == 0) update_factor(log_ratio(0) - factor_, noise);
    } else if (rejected_ && count_ >= 2 * p_.steps) {
      rejected_ = std::max(std::abs(deviation(0)), std::abs(deviation(p_.steps))) > p_.accept_log;
    }
    if (rejected_ != before) count_ = 0;
    return rejected_ != before;
  }
  bool rejected() const { return rejected_; }
  /// The walker's log factor, estimated while both agreed, and the variance of a window about it.
  double log_factor() const { return factor_; }
  double variance() const { return variance_ + p_.window_sigma * p_.window_sigma; }

 private:
  /// Deviation of log(odometry / step) from the walker's factor. The step estimator may have learned part or all of
  /// that factor meanwhile, so any value between the factor and zero counts as agreement.
  double deviation(size_t back) const {
    const double ratio = log_ratio(back);
    return ratio - std::clamp(ratio, std::min(factor_, 0.0), std::max(factor_, 0.0));
  }
  /// log(odometry / step) over a window of consecutive steps that ends `back` steps before the newest.
  double log_ratio(size_t back) const {
    double step = 1e-9, odometry = 1e-9;
    for (size_t i = back; i < back + p_.steps; ++i) {
      const size_t k = (count_ - 1 - i) % kMax;
      step += step_m_[k], odometry += odometry_m_[k];
    }
    return std::log(odometry / step);
  }
  void update_factor(double residual, double noise) {
    variance_ += p_.walk * p_.walk;
    const double gain = variance_ / (variance_ + noise);
    factor_ += gain * residual;
    variance_ *= 1 - gain;
  }

  static constexpr size_t kMax = 32;
  Parameters p_;
  std::array<double, kMax> step_m_{}, odometry_m_{};
  size_t count_ = 0, probation_ = 0;
  double outage_s_ = 0, factor_ = 0, variance_;
  bool was_metric_ = false;
  bool rejected_ = false;
};

}  // namespace odograph
