// SPDX-License-Identifier: Apache-2.0
#include "plugins/step/odograph/step_finder.hpp"

#include <algorithm>
#include <cmath>

namespace odograph::steps {
namespace {

constexpr double kLeastSwing_mps2 = 0.5;                 // a smaller one is no step, even of somebody who shuffles
constexpr double kRelativeSwing = 0.25;                  // of the typical one
constexpr double kConfirm_s = 0.12;                      // a peak must stay the highest for that long
constexpr double kShortest_s = 0.27;                     // 3.7 steps a second, a sprint
constexpr double kLongest_s = 1.1;                       // after that a walk is over
constexpr double kRefractory = 0.55;                     // of the typical interval, within a walk
constexpr double kUpright = 0.60, kStillUpright = 0.40;  // part of the power that is vertical, to begin and to go on
constexpr size_t kToBegin = 4;                           // peaks that are alike
constexpr double kSettingOut = 1.7;                      // times the mean interval, of the first steps of a walk
constexpr double kWeakest = 0.12;                        // part of the typical swing, of the same
constexpr double kPush = 0.55;                           // of the typical swing
constexpr int kStrayToEnd = 3;                           // steps in a row that are not, which end a walk
constexpr double kMissing = 2.0;                         // times the typical interval: a walk is over
constexpr double kSwingPerRate = 3.5;  // m/s^2 for a rad/s, to begin: a hand that moves by itself turns more
constexpr double kSurelyNoHand = 7, kSurelyUpright = 0.75;  // a hand that turns less than that, or moves up and down
constexpr double kRegularToBegin = 0.85, kRegular = 0.5;  // autocorrelation at a step's lag from which a walk may begin
constexpr double kAlike = 1.45;                       // largest over smallest of three intervals, where a walk begins
constexpr double kSameLeg = 1.15, kUnlikeLegs = 2.2;  // the same of two steps of one leg, and of both
constexpr double kPartOver_s = 0.8;
constexpr double kArmLag_s = 0.03;  // the hand follows the trunk by that much

}  // namespace

double StepFinder::interval_s(size_t newer) const { return (peaks_[newer].t_ns - peaks_[newer - 1].t_ns) * 1e-9; }

void StepFinder::update(const WalkSignal& signal) {
  found_count_ = 0;
  const size_t n = signal.smooth_count();
  if (n < WalkSignal::kHalf + 4) return;
  const double before = signal.smooth(n - 3), here = signal.smooth(n - 2), after = signal.smooth(n - 1);
  const auto now_ns = static_cast<double>(signal.smooth_ns(n - 1));
  const double since_peak_s = peak_count_ > 0 ? (now_ns - peaks_[peak_count_ - 1].t_ns) * 1e-9 : 1e9;
  if (walking_ && since_peak_s > std::min(kLongest_s, kMissing * typical_s_)) {
    walking_ = false;
    since_ns_ = static_cast<int64_t>(peaks_[peak_count_ - 1].t_ns);
    peak_count_ = 0;
  }
  if (here > before && here >= after && here > 0) {
    const double swing = here - std::min(low_, here);
    const double least = std::max(kLeastSwing_mps2, walking_ ? kRelativeSwing * typical_swing_ : 0.0);
    const double wait = walking_ ? std::max(kShortest_s, kRefractory * typical_s_) : kShortest_s;
    if (swing > least && since_peak_s > wait && (!candidate_ || here > best_.value)) {
      const double bend = before - 2 * here + after;
      const double shift = bend < 0 ? 0.5 * (before - after) / bend : 0.0;
      candidate_ = true;
      best_ = {n - 2, static_cast<double>(signal.smooth_ns(n - 2)) + shift * 1e9 / WalkSignal::kRate_hz, here, low_, 0};
    }
  }
  low_ = std::min(low_, after);
  if (candidate_ && now_ns - best_.t_ns > kConfirm_s * 1e9) confirm(signal);
}

void StepFinder::confirm(const WalkSignal& signal) {
  candidate_ = false;
  low_ = 1e9;
  for (size_t i = best_.index; i < signal.smooth_count(); ++i) low_ = std::min(low_, signal.smooth(i));
  if (peak_count_ > 0 && (best_.t_ns - peaks_[peak_count_ - 1].t_ns) * 1e-9 > kLongest_s) peak_count_ = 0;
  if (peak_count_ == peaks_.size()) {
    std::copy(peaks_.begin() + 1, peaks_.end(), peaks_.begin());
    --peak_count_;
  }
  best_.upright = signal.vertical_part(kPartOver_s);
  peaks_[peak_count_++] = best_;
  if (walking_)
    go_on(signal);
  else if (peak_count_ >= kToBegin)
    begin(signal);
}

void StepFinder::go_on(const WalkSignal& signal) {
  const bool stray = signal.vertical_part(kPartOver_s) < kStillUpright && repetition(signal, typical_s_, 2) < kRegular;
  stray_ = stray ? stray_ + 1 : 0;
  if (stray_ >= kStrayToEnd) {
    walking_ = false;
    since_ns_ = static_cast<int64_t>(best_.t_ns);
    peak_count_ = 0;
    return;
  }
  if (peak_count_ < 2) return;
  typical_s_ += 0.25 * (std::min(interval_s(peak_count_ - 1), kLongest_s) - typical_s_);
  typical_swing_ += 0.2 * (best_.value - best_.low - typical_swing_);
  if (!stray) emit(signal, peaks_[peak_count_ - 2], best_);
}

/// The walk begins when the last peaks are alike. Those before them, which were weaker or slower because somebody set
/// out, belong to it too.
void StepFinder::begin(const WalkSignal& signal) {
  const size_t last = peak_count_ - 1, first_alike = peak_count_ - kToBegin;
  double shortest = 1e9, longest = 0, weakest = 1e9, strongest = 0, swings = 0;
  for (size_t i = first_alike + 1; i <= last; ++i) {
    const double swing = peaks_[i].value - peaks_[i].low;
    shortest = std::min(shortest, interval_s(i)), longest = std::max(longest, interval_s(i));
    weakest = std::min(weakest, swing), strongest = std::max(strongest, swing);
    swings += swing;
  }
  const double mean_s = (peaks_[last].t_ns - peaks_[first_alike].t_ns) * 1e-9 / (kToBegin - 1);
  // Of somebody whose legs are unlike every other interval is like the one before last.
  const double side = interval_s(last) / interval_s(last - 2);
  const bool limps = std::max(side, 1 / side) < kSameLeg && longest < kUnlikeLegs * shortest;
  if (longest > kAlike * shortest && !limps) return;
  if (strongest > (longest > kAlike * shortest ? 1.5 : 3.0) * weakest) return;
  const double rate = signal.gyro_between(peaks_[first_alike].index, peaks_[last].index);
  const double swing_per_rate = swings / (kToBegin - 1) / std::max(rate, 1e-3);
  const double upright = swing_per_rate < kSurelyNoHand ? kSurelyUpright : kUpright;
  if (swing_per_rate < kSwingPerRate || signal.vertical_part(2 * kPartOver_s) < upright) return;
  if (repetition(signal, mean_s, 2) < kRegularToBegin) return;
  walking_ = true;
  stray_ = 0;
  typical_s_ = mean_s;
  typical_swing_ = swings / (kToBegin - 1);
  size_t first = first_alike;
  const auto belongs = [&](size_t i) {
    return interval_s(i + 1) < kSettingOut * mean_s && peaks_[i].upright > 0.5 * kUpright &&
           peaks_[i].value - peaks_[i].low > kWeakest * typical_swing_;
  };
  while (first > 0 && belongs(first - 1)) --first;
  // The first peak of all is the first foot's fall; or, when it is weak, the push with which the walker set out.
  Peak start = peaks_[first];
  const bool push = peaks_[first].value - std::min(peaks_[first].low, 0.0) < kPush * typical_swing_;
  start.t_ns -= mean_s * 1e9;
  start.index -= std::min(start.index, static_cast<size_t>(std::lround(mean_s * WalkSignal::kRate_hz)));
  since_ns_ = static_cast<int64_t>(push ? peaks_[first].t_ns : start.t_ns);
  if (!push) emit(signal, start, peaks_[first]);
  for (size_t i = first + 1; i <= last; ++i) emit(signal, peaks_[i - 1], peaks_[i]);
}

double StepFinder::repetition(const WalkSignal& signal, double interval_s, size_t intervals) const {
  const auto lag = static_cast<size_t>(std::lround(interval_s * WalkSignal::kRate_hz));
  double best = 0;
  for (size_t l = lag - 2; l <= lag + 2; ++l) best = std::max(best, signal.regularity(l, intervals * lag));
  return best;
}

void StepFinder::emit(const WalkSignal& signal, const Peak& from, const Peak& to) {
  const auto lag = static_cast<int64_t>(kArmLag_s * 1e9);
  FoundStep& step = found_[found_count_++];
  step.t_start_ns = static_cast<int64_t>(from.t_ns) - lag;
  step.t_end_ns = static_cast<int64_t>(to.t_ns) - lag;
  step.swing_mps2 = to.value - to.low;
  step.rise_m = signal.rise_between(from.index, to.index);
  step.gyro_radps = signal.gyro_between(from.index, to.index);
  step.frequency_hz = 1 / typical_s_;
}

}  // namespace odograph::steps
