// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "plugins/step/odograph/walk_signal.hpp"

namespace odograph::steps {

/// A step with what a length model wants to know of it.
struct FoundStep {
  int64_t t_start_ns, t_end_ns;  ///< one foot's contact to the other's
  double swing_mps2;             ///< largest less smallest smoothed vertical acceleration
  double rise_m;                 ///< of the trunk within the step, smoothed: highest less lowest
  double whole_rise_m;           ///< the same, with what the smoothing took given back
  double gyro_radps;             ///< mean rotation rate
  double frequency_hz;           ///< of the steps around it
  double vertical_part;          ///< of the alternating acceleration's power, over the last steps
  double repetition;             ///< of the acceleration after a stride, over the last steps: how regular the walk is
  Eigen::Vector2d surge_n = Eigen::Vector2d::Zero();  ///< horizontal acceleration that leads the vertical one as a
                                                      ///< walk's does, over the latter
  bool gentle;                                        ///< found by the finder of gentle steps
  int since_stood = 100;                              ///< steps since the walker stood, this one left out (GaitFinder)
};

/// Peaks like those of a walk that has just ended: a few steps, and he stands again. Set on the 80 mall walks.
struct Resume {
  size_t peaks = 3;
  double within_s = 12, after_steps = 6;  ///< of that walk's end, and how long it was
  double interval = 1.4, swing = 0.4;     ///< of theirs, either way, and the least, in parts of that walk's
};
inline constexpr Resume kResume;

/// Finds the contacts of feet as peaks of the smoothed vertical acceleration: the trunk is lowest there and is pushed
/// up. A walk begins with four peaks that are alike, whose signal repeats itself and is mostly vertical, as a hand that
/// holds the phone passes it on; or, wherever the phone is, with three strides of which each repeats the one before on
/// all three axes: on a leg, one foot's step is not like the other's. They are reported together. It goes on while such
/// steps keep coming. So waving, typing and turning on the spot, which are as strong but neither vertical nor
/// that regular, are no steps. No allocation.
class StepFinder {
 public:
  /// Numbers without a source were set on the walks that the README names.
  struct Parameters {
    bool gentle = false;
    double min_swing_mps2 = 0.5;     ///< a smaller one is no step, even of somebody who shuffles
    double relative_swing = 0.25;    ///< least swing within a walk, of the typical one
    double longest_s = 1.1;          ///< of a step; after that a walk is over
    double missing = 2.0;            ///< times the typical interval: a walk is over
    size_t to_begin = 4;             ///< peaks that are alike
    double alike = 1.45;             ///< largest over smallest of their intervals
    double regular_to_begin = 0.85;  ///< autocorrelation at a step's lag from which a walk may begin
    double upright = 0.75;           ///< vertical part of the power, to begin
    double still_upright = 0.40;     ///< the same to go on
    double regular = 0.5;         ///< autocorrelation at a step, or of all axes at a stride, with which a walk goes on
    size_t strides_to_begin = 7;  ///< peaks of three strides
    double strides_alike = 0.8;   ///< repetition of all axes over two strides, to begin
    double strides_swing_mps2 = 1.5;                    ///< mean swing, to begin: softer steps are the other finder's
    double rotating_radps = 1.6, rotating_alike = 0.6;  ///< above both a hand draws eights: on a leg the feet differ
    double foot_alike = 0.3;          ///< difference of two intervals of one foot, of the mean interval, to begin
    double swing_per_rate = 3.5;      ///< m/s^2 for a rad/s, to begin: a hand that moves by itself turns more
    double max_tilting_radps = 1e9;   ///< a hand that tilts more by itself hides steps; root mean square
    double swing_per_tilting = 0;     ///< m/s^2 for a rad/s, above which a hand that tilts more hides none
    double min_alternating_part = 0;  ///< vertical part of the alternating power
    double setting_out = 1.7;         ///< longest of the first steps, over the mean interval
    double weakest = 0.12;            ///< least swing of the same, of the typical one
    size_t kept_peaks = 8;            ///< those before a walk was sure of which are looked at, at most kMaxPeaks
    double weak = 0;                  ///< gentle peaks below this part of the strongest are harmonics, before a walk
    double confirm_s = 0.12;          ///< a peak must stay the highest for that long
    double shortest_s = 0.27;         ///< of a step: 3.7 a second, a sprint
    double quickest_s = 0.38;         ///< of a gentle step
    double gentle_hz = 1.5;           ///< the least swing is that of such steps; quicker ones are smoothed more
    double refractory = 0.55;         ///< of the typical interval, within a walk, between two peaks
    double push = 0.55;               ///< of the typical swing: a weaker first peak is no foot's
    int stray_to_end = 3;             ///< steps in a row that are not, which end a walk
    double max_swing_ratio = 3.0;     ///< largest over smallest swing, to begin
    double part_over_s = 0.8;         ///< over which the vertical part and the hand's tilting are taken
    double gentle_over_s = 2.0;       ///< the same, beside it, for gentle steps
    double arm_lag_s = 0.03;          ///< the hand follows the trunk by that much
    double surge_lead_rad = 1.75;     ///< of the surge ahead before the push up; RIDI: 1.1 on legs, 1.8 elsewhere
    double learn_interval = 0.25, learn_swing = 0.2,
           learn_part = 0.1;  ///< weight of the newest step in the typical one
    static Parameters of_gentle_steps();
  };

  StepFinder() : StepFinder(Parameters{}) {}
  explicit StepFinder(const Parameters& parameters) : p_(parameters) {}
  /// Looks at the newest smoothed value of the signal.
  void update(const WalkSignal& signal);
  /// What the last update() found, oldest first.
  std::span<const FoundStep> found() const { return {found_.data(), found_count_}; }
  bool walking() const { return walking_; }
  /// When the walk that goes on began, or the last one ended.
  int64_t since_ns() const { return since_ns_; }
  void reset() { *this = StepFinder(p_); }

 private:
  static constexpr size_t kMaxPeaks = 16;
  struct Peak {
    size_t index;
    double t_ns;  // between samples
    double value, low;
    bool a_foot;  // it may be a foot's contact, by what the hand does meanwhile
  };
  /// Peaks from one to the newest.
  struct Run {
    size_t first;
    double mean_s, shortest_s, longest_s, weakest, strongest, mean_swing;
  };
  Run run_from(size_t first) const;
  bool steps_alike(const WalkSignal& signal, const Run& run) const;
  bool strides_alike(const WalkSignal& signal, const Run& run) const;
  bool like_before(const WalkSignal& signal, const Run& run) const;
  double stood_s(const Run& run) const;  // since the last walk
  void start(const WalkSignal& signal, const Run& run, double repetition);
  bool hand_moves(const WalkSignal& signal, double swing_mps2, double seconds) const;
  bool may_be_walk(const WalkSignal& signal, double swing_mps2, size_t first, size_t last) const;
  void confirm(const WalkSignal& signal);
  void begin(const WalkSignal& signal);
  void begin_without_weak(const WalkSignal& signal);
  void go_on(const WalkSignal& signal);
  double repetition(const WalkSignal& signal, double interval_s, size_t intervals) const;
  double stride_repetition(const WalkSignal& signal, double interval_s, size_t strides) const;
  void emit(const WalkSignal& signal, const Peak& from, const Peak& to);
  double interval_s(size_t newer) const;

  Parameters p_;
  bool walking_ = false;
  int64_t since_ns_ = 0;
  bool candidate_ = false;
  Peak best_{};
  double low_ = 1e9;
  std::array<Peak, kMaxPeaks> peaks_{};  // the last ones, newest last
  size_t peak_count_ = 0;
  int stray_ = 0;
  double walked_ = 0;  // steps of the walk that goes on, or of the last one, with those that it resumed
  double typical_swing_ = 0, typical_s_ = 0.55, typical_part_ = 0, typical_repetition_ = 0;
  std::array<FoundStep, kMaxPeaks> found_{};
  size_t found_count_ = 0;
};

}  // namespace odograph::steps
