// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace odograph {

/// Whether the metre of a front-end that was blind for a while still agrees with the walker's steps. It may put all
/// that it sees afterwards at twice its distance, be certain of it, and need a minute to find back. Who has seen all
/// the time is believed: steps are no judge of that, since people shuffle, and their steps are then told three times
/// too long. How long this walker's steps are is learnt from what the front-end saw before.
class MetreCheck {
 public:
  struct Parameters {
    size_t steps = 12;           ///< over which it is looked at: six seconds; by hand
    double walker_sigma = 0.2;   ///< of a walker's log factor at first: 0.10 of those who walk briskly, more of others
    double window_sigma = 0.08;  ///< of that many steps of a walker who is known: of ways of walking
    double walk = 0.02;          ///< of the log factor, from window to window
    double max_sigmas = 3;       ///< beyond them the metre is doubted,
    double min_log = 0.35;       ///< but never for less; three walks through cities, and hybrid walks as the other side
    double trust_log = 0.15;     ///< below it twice in a row the front-end has found back; by hand
    double blind_s = 0.5;        ///< without tracking, s; a velocity that is known to 0.3 m/s is then off by a tenth
    size_t probation = 36;       ///< steps after that, over which steps judge it: three windows; by hand
  };

  MetreCheck() : variance_(p_.walker_sigma * p_.walker_sigma) {}

  /// Another scale: what is known of the walker stays.
  void restart() { count_ = 0, doubted_ = false; }
  /// A motion of the front-end over dt_s. It counts as blind from its first metric one on, also where it has begun anew
  /// since and has no metre yet, and where it was silent for so long.
  void add_motion(double dt_s, bool tracking, bool metric) {
    was_metric_ = was_metric_ || metric;
    if (!was_metric_) return;
    blind_s_ = tracking && dt_s < p_.blind_s ? 0 : blind_s_ + dt_s;
    if (blind_s_ >= p_.blind_s) probation_ = p_.probation;
  }
  /// A step's length as its estimator tells it, and as the front-end has it, m. True where the judgement has changed.
  bool add(double told_m, double seen_m) {
    told_[count_ % kMax] = told_m, seen_[count_ % kMax] = seen_m;
    ++count_;
    const bool before = doubted_, judged = probation_ > 0;
    if (!doubted_) probation_ -= std::min<size_t>(probation_, 1);
    const double noise = p_.window_sigma * p_.window_sigma;
    if (!doubted_ && count_ >= p_.steps) {
      const double most = std::max(p_.min_log, p_.max_sigmas * std::sqrt(variance_ + noise));
      const bool agrees = std::abs(off(0)) <= most;
      doubted_ = judged && !agrees;
      if (agrees && !judged && count_ % p_.steps == 0) learn(log_ratio(0) - factor_, noise);
    } else if (doubted_ && count_ >= 2 * p_.steps) {
      doubted_ = std::max(std::abs(off(0)), std::abs(off(p_.steps))) > p_.trust_log;
    }
    if (doubted_ != before) count_ = 0;
    return doubted_ != before;
  }
  bool doubted() const { return doubted_; }
  /// The walker's log factor as it was learnt while both agreed, and the variance of a window by it.
  double log_factor() const { return factor_; }
  double variance() const { return variance_ + p_.window_sigma * p_.window_sigma; }

 private:
  /// What the logarithm of seen over told differs by from the walker's factor. A step estimator may have been taught
  /// that factor meanwhile, in part or whole: what lies between it and none is no contradiction.
  double off(size_t back) const {
    const double ratio = log_ratio(back);
    return ratio - std::clamp(ratio, std::min(factor_, 0.0), std::max(factor_, 0.0));
  }
  /// The logarithm of seen over told, over steps in a row of which the newest is `back` before the newest of all.
  double log_ratio(size_t back) const {
    double told = 1e-9, seen = 1e-9;
    for (size_t i = back; i < back + p_.steps; ++i) {
      const size_t k = (count_ - 1 - i) % kMax;
      told += told_[k], seen += seen_[k];
    }
    return std::log(seen / told);
  }
  void learn(double off, double noise) {
    variance_ += p_.walk * p_.walk;
    const double gain = variance_ / (variance_ + noise);
    factor_ += gain * off;
    variance_ *= 1 - gain;
  }

  static constexpr size_t kMax = 32;
  Parameters p_;
  std::array<double, kMax> told_{}, seen_{};
  size_t count_ = 0, probation_ = 0;
  double blind_s_ = 0, factor_ = 0, variance_;
  bool was_metric_ = false;
  bool doubted_ = false;
};

}  // namespace odograph
