// SPDX-License-Identifier: Apache-2.0
#include "plugins/step/odograph/step_finder.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sdk/math/scalar.hpp"

namespace odograph::steps {

StepFinder::Parameters StepFinder::Parameters::of_gentle_steps() {
  Parameters p;
  p.gentle = true;
  p.min_swing_mps2 = 0.17;
  p.relative_swing = 0.20;
  p.longest_s = 1.4;
  p.min_peaks = 5;
  p.alike = 1.8;
  p.start_regularity = 0.8;
  p.upright = p.still_upright = 0;
  p.regular = 0.3;
  p.swing_per_rate = 0;
  p.max_tilting_radps = 0.21;
  p.swing_per_tilting = 10;
  p.missing = 2.2;
  p.weakest = 0.2;
  p.kept_peaks = 16;
  p.weak = 0.4;
  p.min_alternating_part = 0.05;
  p.min_symmetry = 0.6, p.symmetric_hz = 1.8;  // a car's body rings so quickly, but has no strides
  p.strides.min_peaks = kMaxPeaks + 1;         // never: strides are the task of the other finder
  return p;
}

double StepFinder::interval_s(size_t newer) const { return (peaks_[newer].t_ns - peaks_[newer - 1].t_ns) * 1e-9; }

void StepFinder::update(const WalkSignal& signal) {
  found_count_ = 0;
  const size_t n = signal.smooth_count();
  if (n < signal.half() + 4) return;
  const double before = signal.smooth(n - 3), here = signal.smooth(n - 2), after = signal.smooth(n - 1);
  const auto now_ns = static_cast<double>(signal.smooth_ns(n - 1));
  const double since_peak_s = peak_count_ > 0 ? (now_ns - peaks_[peak_count_ - 1].t_ns) * 1e-9 : 1e9;
  if (walking_ && since_peak_s > longest_s(signal)) {
    walking_ = false;
    since_ns_ = static_cast<int64_t>(peaks_[peak_count_ - 1].t_ns);
    peak_count_ = 0;
  }
  if (here > before && here >= after && here > 0) {
    const double swing = here - std::min(low_, here);
    // Smoothing attenuates quicker steps more.
    const double kept =
        p_.gentle ? std::min(1.0, signal.gain(1 / std::max(since_peak_s, p_.quickest_s)) / signal.gain(p_.gentle_hz))
                  : 1.0;
    const double least = std::max(kept * p_.min_swing_mps2, walking_ ? p_.relative_swing * typical_swing_ : 0.0);
    const double wait = walking_ ? std::max(p_.shortest_s, p_.refractory * typical_s_) : p_.shortest_s;
    if (swing > least && since_peak_s > wait && (!candidate_ || here > best_.value)) {
      const double bend = before - 2 * here + after;
      const double shift = bend < 0 ? 0.5 * (before - after) / bend : 0.0;
      candidate_ = true;
      best_ = {n - 2, static_cast<double>(signal.smooth_ns(n - 2)) + shift * 1e9 / WalkSignal::kRate_hz, here, low_,
               false};
    }
  }
  low_ = std::min(low_, after);
  if (candidate_ && now_ns - best_.t_ns > p_.confirm_s * 1e9) confirm(signal);
}

/// Time after the last contact, at which a walk is over. A swinging arm hides every other contact, while the strides
/// repeat.
double StepFinder::longest_s(const WalkSignal& signal) const {
  const double usual_s = std::min(p_.longest_s, p_.missing * typical_s_);
  if (p_.gentle || stride_repetition(signal, typical_s_, 1) < p_.strides.alike) return usual_s;
  return std::max(usual_s, p_.strides.missed_foot * typical_s_);
}

void StepFinder::confirm(const WalkSignal& signal) {
  candidate_ = false;
  low_ = 1e9;
  for (size_t i = best_.index; i < signal.smooth_count(); ++i) low_ = std::min(low_, signal.smooth(i));
  const double longest = walking_ ? std::max(p_.longest_s, p_.strides.missed_foot * typical_s_) : p_.longest_s;
  if (peak_count_ > 0 && (best_.t_ns - peaks_[peak_count_ - 1].t_ns) * 1e-9 > longest) peak_count_ = 0;
  if (peak_count_ == p_.kept_peaks)
    std::copy(peaks_.begin() + 1, peaks_.begin() + static_cast<long>(peak_count_--), peaks_.begin());
  best_.may_be_foot = p_.gentle ? !hand_moves(signal, best_.value - best_.low, p_.part_over_s)
                                : signal.vertical_part(p_.part_over_s) > 0.4 * p_.upright;
  peaks_[peak_count_++] = best_;
  if (walking_)
    continue_walk(signal);
  else if (peak_count_ >= (p_.gentle ? p_.min_peaks : kResume.peaks)) {
    try_start(signal);
    if (!walking_ && p_.weak > 0) try_start_without_weak(signal);
  }
}

void StepFinder::continue_walk(const WalkSignal& signal) {
  const double swing = std::max(typical_swing_, best_.value - best_.low);
  const bool invalid = p_.gentle
                           ? hand_moves(signal, swing, p_.part_over_s) || hand_moves(signal, swing, p_.gentle_over_s)
                           : signal.vertical_part(p_.part_over_s) < p_.still_upright &&
                                 repetition(signal, typical_s_, 2) < p_.regular &&
                                 stride_repetition(signal, typical_s_, 1) < p_.regular;
  invalid_ = invalid ? invalid_ + 1 : 0;
  if (invalid_ >= p_.max_invalid) {
    walking_ = false;
    since_ns_ = static_cast<int64_t>(best_.t_ns);
    peak_count_ = 0;
    return;
  }
  if (peak_count_ < 2) return;
  const Peak& from = peaks_[peak_count_ - 2];
  const double interval = interval_s(peak_count_ - 1);
  const bool missed = !p_.gentle && interval > p_.strides.both_feet * typical_s_ &&
                      stride_repetition(signal, 0.5 * interval, 1) >= p_.strides.alike;
  const double step_s = missed ? 0.5 * interval : interval;
  typical_s_ += p_.learn_interval * (std::min(step_s, p_.longest_s) - typical_s_);
  typical_swing_ += p_.learn_swing * (best_.value - best_.low - typical_swing_);
  typical_part_ += p_.learn_part * (signal.vertical_part_between(from.index, best_.index) - typical_part_);
  typical_repetition_ += p_.learn_interval * (stride_repetition(signal, typical_s_, 1) - typical_repetition_);
  typical_harmonic_ += p_.learn_interval * (harmonic_before(signal, best_.index) - typical_harmonic_);
  walked_ += missed ? 2 : 1;
  if (invalid) return;
  if (!missed) return emit(signal, from, best_);
  Peak between = best_;
  between.index = (from.index + best_.index) / 2, between.t_ns = 0.5 * (from.t_ns + best_.t_ns);
  emit(signal, from, between);
  emit(signal, between, best_);
}

/// Retries without weak peaks, which may be second harmonics of slow steps.
void StepFinder::try_start_without_weak(const WalkSignal& signal) {
  const auto all = peaks_;
  const size_t count = peak_count_;
  double strongest = 0;
  for (size_t i = count - std::min(count, 2 * p_.min_peaks); i < count; ++i)
    strongest = std::max(strongest, all[i].value - all[i].low);
  peak_count_ = 0;
  double low = 1e9;
  for (size_t i = 0; i < count; ++i) {
    low = std::min(low, all[i].low);
    if (all[i].value - all[i].low < p_.weak * strongest) continue;
    peaks_[peak_count_] = all[i];
    peaks_[peak_count_++].low = std::exchange(low, 1e9);
  }
  if (peak_count_ >= p_.min_peaks) try_start(signal);
  if (!walking_) peaks_ = all, peak_count_ = count;
}

StepFinder::Run StepFinder::run_from(size_t first) const {
  const size_t last = peak_count_ - 1;
  const auto steps = static_cast<double>(last - first);
  Run run{first, (peaks_[last].t_ns - peaks_[first].t_ns) * 1e-9 / steps, 1e9, 0, 1e9, 0, 0};
  for (size_t i = first + 1; i <= last; ++i) {
    const double swing = peaks_[i].value - peaks_[i].low;
    run.shortest_s = std::min(run.shortest_s, interval_s(i)), run.longest_s = std::max(run.longest_s, interval_s(i));
    run.weakest = std::min(run.weakest, swing), run.strongest = std::max(run.strongest, swing);
    run.mean_swing += swing / steps;
  }
  return run;
}

/// Running and stairs: so quick, strong and even that a swinging arm does not matter.
bool StepFinder::quick_gait(const WalkSignal& signal, const Run& run) const {
  return !p_.gentle && run.mean_s * kQuickGait.hz < 1 && run.mean_swing > kQuickGait.swing_mps2 &&
         run.longest_s <= p_.alike * run.shortest_s && run.strongest <= p_.max_swing_ratio * run.weakest &&
         signal.vertical_part_between(peaks_[run.first].index, peaks_[peak_count_ - 1].index) > kQuickGait.part &&
         repetition(signal, run.mean_s, 2) >= kQuickGait.regularity;
}

bool StepFinder::steps_alike(const WalkSignal& signal, const Run& run) const {
  if (run.mean_s * p_.symmetric_hz < 1 && stride_repetition(signal, run.mean_s, 1) < p_.min_symmetry) return false;
  return run.longest_s <= p_.alike * run.shortest_s && run.strongest <= p_.max_swing_ratio * run.weakest &&
         may_be_walk(signal, run.mean_swing, run.first, peak_count_ - 1) &&
         repetition(signal, run.mean_s, 2) >= p_.start_regularity;
}

bool StepFinder::strides_alike(const WalkSignal& signal, const Run& run) const {
  const double rate = signal.gyro_between(peaks_[run.first].index, peaks_[peak_count_ - 1].index);
  if (run.mean_swing < p_.strides.swing_mps2) return false;
  if (rate > p_.strides.rotating_radps && repetition(signal, run.mean_s, 2) > p_.strides.rotating_alike) return false;
  for (size_t i = run.first + 3; i < peak_count_; ++i)
    if (std::abs(interval_s(i) - interval_s(i - 2)) > p_.strides.foot_alike * run.mean_s) return false;
  return stride_repetition(signal, run.mean_s, 2) >= p_.strides.alike;
}

/// Of a sine with that swing and frequency.
bool StepFinder::rises_too_far(const Run& run) const {
  return run.strongest * squared(run.mean_s / (2 * kPi)) > p_.max_rise_m;
}

double StepFinder::standing_s(const Run& run) const {
  return (peaks_[run.first].t_ns - static_cast<double>(since_ns_)) * 1e-9;
}

/// After a recent walk a few similar steps are enough.
bool StepFinder::resembles_last_walk(const WalkSignal& signal, const Run& run) const {
  if (p_.gentle || walked_ < kResume.after_steps || standing_s(run) > kResume.within_s) return false;
  return run.longest_s < kResume.interval * typical_s_ && run.shortest_s > typical_s_ / kResume.interval &&
         run.weakest > kResume.swing * typical_swing_ && run.strongest <= p_.max_swing_ratio * run.weakest &&
         (may_be_walk(signal, run.mean_swing, run.first, peak_count_ - 1) ||
          stride_repetition(signal, typical_s_, 1) >= p_.strides.alike);
}

/// Starts a walk when the last peaks are alike.
void StepFinder::try_start(const WalkSignal& signal) {
  if (peak_count_ >= kResume.peaks)
    if (const Run few = run_from(peak_count_ - kResume.peaks); !rises_too_far(few) && resembles_last_walk(signal, few))
      return start(signal, few, typical_repetition_);  // three peaks are too few for a repetition
  if (peak_count_ < p_.min_peaks) return;
  const Run steps = run_from(peak_count_ - p_.min_peaks);
  if (rises_too_far(steps)) return;
  if (steps_alike(signal, steps) || quick_gait(signal, steps))
    return start(signal, steps, stride_repetition(signal, steps.mean_s, 1));
  if (peak_count_ < p_.strides.min_peaks) return;
  const Run strides = run_from(peak_count_ - p_.strides.min_peaks);
  if (!rises_too_far(strides) && strides_alike(signal, strides))
    start(signal, strides, stride_repetition(signal, strides.mean_s, 1));
}

/// Includes the peaks before the run that were weaker or slower because the walker was starting.
void StepFinder::start(const WalkSignal& signal, const Run& run, double repetition) {
  const size_t last = peak_count_ - 1;
  const double mean_s = run.mean_s;
  walking_ = true;
  invalid_ = 0;
  last_rise_m_ = 0;
  if (standing_s(run) > kResume.within_s) walked_ = 0;
  walked_ += static_cast<double>(last - run.first);
  typical_s_ = mean_s;
  typical_swing_ = run.mean_swing;
  typical_repetition_ = repetition;
  typical_harmonic_ = harmonic_before(signal, peaks_[last].index);
  typical_part_ = 0;
  for (size_t i = run.first + 1; i <= last; ++i)
    typical_part_ +=
        signal.vertical_part_between(peaks_[i - 1].index, peaks_[i].index) / static_cast<double>(last - run.first);
  size_t first = run.first;
  const auto belongs = [&](size_t i) {
    return interval_s(i + 1) < p_.initiation_interval * mean_s && peaks_[i].may_be_foot &&
           peaks_[i].value - peaks_[i].low > p_.weakest * typical_swing_ &&
           peaks_[i].value - peaks_[i].low < p_.max_swing_ratio * typical_swing_;
  };
  while (first > 0 && belongs(first - 1)) --first;
  // The very first peak is the first foot's contact or, if it is weak, the push-off.
  Peak from = peaks_[first];
  const bool push = peaks_[first].value - std::min(peaks_[first].low, 0.0) < p_.push * typical_swing_;
  from.t_ns -= mean_s * 1e9;
  from.index -= std::min(from.index, static_cast<size_t>(std::lround(mean_s * WalkSignal::kRate_hz)));
  since_ns_ = static_cast<int64_t>(push ? peaks_[first].t_ns : from.t_ns);
  if (!push) emit(signal, from, peaks_[first]);
  for (size_t i = first + 1; i <= last; ++i) emit(signal, peaks_[i - 1], peaks_[i]);
}

bool StepFinder::hand_moves(const WalkSignal& signal, double swing_mps2, double seconds) const {
  const double tilting = signal.tilting(seconds);
  return tilting > p_.max_tilting_radps && swing_mps2 < p_.swing_per_tilting * tilting;
}

/// True if the vertical motion may come from a foot rather than from the hand.
bool StepFinder::may_be_walk(const WalkSignal& signal, double swing_mps2, size_t first, size_t last) const {
  if (p_.gentle)
    return !hand_moves(signal, swing_mps2, p_.part_over_s) && !hand_moves(signal, swing_mps2, p_.gentle_over_s) &&
           signal.alternating_part(p_.gentle_over_s) > p_.min_alternating_part;
  const double swing_per_rate =
      swing_mps2 / std::max(signal.gyro_between(peaks_[first].index, peaks_[last].index), 1e-3);
  return swing_per_rate >= p_.swing_per_rate && signal.vertical_part(2 * p_.part_over_s) >= p_.upright;
}

double StepFinder::repetition(const WalkSignal& signal, double interval_s, size_t intervals) const {
  const auto lag = static_cast<size_t>(std::lround(interval_s * WalkSignal::kRate_hz));
  double best = 0;
  for (size_t l = lag - 2; l <= lag + 2; ++l) best = std::max(best, signal.regularity(l, intervals * lag));
  return best;
}

double StepFinder::stride_repetition(const WalkSignal& signal, double interval_s, size_t strides) const {
  const auto lag = static_cast<size_t>(std::lround(2 * interval_s * WalkSignal::kRate_hz));
  double best = 0;
  for (size_t l = lag - 2; l <= lag + 2; ++l) best = std::max(best, signal.repetition(l, strides * lag));
  return best;
}

/// Of the stride that ends there.
double StepFinder::harmonic_before(const WalkSignal& signal, size_t end) const {
  const auto stride = static_cast<size_t>(std::lround(2 * typical_s_ * WalkSignal::kRate_hz));
  return end > stride ? signal.second_harmonic_between(end - stride, end) : 0.0;
}

void StepFinder::emit(const WalkSignal& signal, const Peak& from, const Peak& to) {
  const auto lag = static_cast<int64_t>(p_.arm_lag_s * 1e9);
  FoundStep& step = found_[found_count_++];
  step.t_start_ns = static_cast<int64_t>(from.t_ns) - lag;
  step.t_end_ns = static_cast<int64_t>(to.t_ns) - lag;
  step.swing_mps2 = to.value - to.low;
  step.surge_n = signal.surge_between(from.index, to.index, p_.surge_lead_rad);
  step.gyro_radps = signal.gyro_between(from.index, to.index);
  step.frequency_hz = 1 / typical_s_;
  const double rise_m = signal.rise_between(from.index, to.index) / signal.gain(step.frequency_hz);
  step.rise_m = last_rise_m_ > 0 ? 0.5 * (rise_m + last_rise_m_) : rise_m;
  last_rise_m_ = rise_m;
  step.vertical_part = typical_part_;
  step.repetition = typical_repetition_;
  step.turning_radps = signal.turning(p_.turning_over_s);
  step.second_harmonic = typical_harmonic_;
  step.gentle = p_.gentle;
}

}  // namespace odograph::steps
