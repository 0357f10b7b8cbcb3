// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "plugins/step/odograph/walk_signal.hpp"

namespace odograph::steps {

/// A step with the inputs of the length model.
struct FoundStep {
  int64_t t_start_ns, t_end_ns;  ///< one foot's contact to the other's
  double swing_mps2;             ///< maximum minus minimum of the smoothed vertical acceleration
  double rise_m;                 ///< of the trunk, maximum minus minimum, mean of the last two steps: those of one leg
                                 ///< or arm differ
  double gyro_radps;             ///< mean angular rate
  double frequency_hz;           ///< of the steps around it
  double vertical_part;          ///< of the power of the alternating acceleration, over the last steps
  double repetition;             ///< autocorrelation after a stride, over the last steps: regularity of the walk
  double turning_radps = 0;      ///< rate at which the path bends, over the last strides
  double second_harmonic = 0;    ///< of the vertical acceleration (WalkSignal), over the last steps
  Eigen::Vector2d surge_n = Eigen::Vector2d::Zero();  ///< horizontal acceleration at a walk's phase lead over the
                                                      ///< vertical one, divided by its amplitude
  bool gentle;                                        ///< found by the finder of gentle steps
  int since_stood = 100;                              ///< steps since the walker stood, without this one (GaitFinder)
  bool on_leg = false;                                ///< the phone swings with a leg (CarryModeClassifier)
};

/// Resuming a walk that has just ended, for a few steps. Set on the 80 mall walks.
struct Resume {
  size_t peaks = 3;
  double within_s = 12, after_steps = 6;  ///< max time since that walk's end, and its min length
  double interval = 1.4, swing = 0.4;     ///< max ratio of the intervals, and min relative swing, against that walk
};
inline constexpr Resume kResume;

/// Running and stairs, so quick, strong and even that a swinging arm does not matter. Set on two flights of stairs.
struct QuickGait {
  double hz = 2.1, swing_mps2 = 5.0;    ///< min frequency and mean swing
  double regularity = 0.9, part = 0.5;  ///< min autocorrelation at the step lag and vertical part
};
inline constexpr QuickGait kQuickGait;

/// Walking with the phone anywhere, by strides that repeat on all axes.
struct Strides {
  size_t min_peaks = 7;                               ///< of three strides
  double alike = 0.8;                                 ///< min repetition of all axes over two strides to start
  double swing_mps2 = 1.5;                            ///< min mean swing to start: softer steps are the other finder's
  double rotating_radps = 1.6, rotating_alike = 0.6;  ///< above both a hand draws eights: on a leg the feet differ
  double foot_alike = 0.3;   ///< max difference of two intervals of one foot to start, relative to the mean interval
  double missed_foot = 2.6;  ///< max interval in which one foot's contact is missing, relative to the typical one
  double both_feet = 1.6;    ///< the same, above which it is
};

/// Finds foot contacts as peaks of the smoothed vertical acceleration, where the trunk is lowest and is pushed up. A
/// walk starts with four similar peaks whose signal repeats and is mostly vertical, as in a hand; or, wherever the
/// phone is, with three strides that each repeat the previous one on all three axes: on a leg the two feet differ.
/// These steps are reported together. The walk continues while such steps keep coming. Waving, typing and turning on
/// the spot are as strong but neither vertical nor that regular, and are rejected. Does not allocate.
class StepFinder {
 public:
  /// Numbers without a source were set on the walks listed in the README.
  struct Parameters {
    bool gentle = false;
    double min_swing_mps2 = 0.5;     ///< smaller peaks are not steps, even of a shuffling walker
    double relative_swing = 0.25;    ///< min swing within a walk, relative to the typical one
    double longest_s = 1.1;          ///< max duration of a step; after it a walk is over
    double missing = 2.0;            ///< of the typical interval, after which a walk is over
    size_t min_peaks = 4;            ///< similar peaks
    double alike = 1.45;             ///< max ratio of their intervals
    double start_regularity = 0.85;  ///< min autocorrelation at the step lag to start
    double upright = 0.75;           ///< min vertical part of the power to start
    double still_upright = 0.40;     ///< the same to continue
    double regular = 0.5;            ///< min autocorrelation at a step, or of all axes at a stride, to continue
    Strides strides;
    double max_rise_m = 0.12;                   ///< of a trunk, also in running: more is a shaken phone
    double min_symmetry = 0, symmetric_hz = 0;  ///< min repetition of all axes after a stride, from that frequency on
    double swing_per_rate = 3.5;                ///< min m/s^2 per rad/s to start: a moving hand rotates more
    double max_tilting_radps = 1e9;             ///< rms tilting above which a hand's motion hides steps
    double swing_per_tilting = 0;               ///< m/s^2 per rad/s above which tilting hides none
    double min_alternating_part = 0;            ///< min vertical part of the alternating power
    double initiation_interval = 1.7;           ///< max interval of the first steps, relative to the mean
    double weakest = 0.12;                      ///< min swing of the same, relative to the typical one
    size_t kept_peaks = 8;         ///< number of peaks before the start that are examined, at most kMaxPeaks
    double weak = 0;               ///< relative to the strongest: weaker gentle peaks before a walk are harmonics
    double confirm_s = 0.12;       ///< time for which a peak must stay the highest
    double shortest_s = 0.27;      ///< min duration of a step: 3.7 per second, a sprint
    double quickest_s = 0.38;      ///< min of a gentle step
    double gentle_hz = 1.5;        ///< frequency that min_swing refers to; quicker steps are smoothed more
    double refractory = 0.55;      ///< min interval of peaks within a walk, relative to the typical one
    double push = 0.55;            ///< of the typical swing: a weaker first peak is a push-off
    int max_invalid = 3;           ///< consecutive invalid steps that end a walk
    double max_swing_ratio = 3.0;  ///< max ratio of swings to start
    double part_over_s = 0.8;      ///< averaging time of the vertical part and of the hand's tilting
    double gentle_over_s = 2.0;    ///< the same, in addition, for gentle steps
    double turning_over_s = 4.0;   ///< averaging time of the path's bend: two to four strides
    double arm_lag_s = 0.03;       ///< lag of the hand behind the trunk
    /// Phase lead of the forward surge over the push up; RIDI: 1.1 on legs, 1.8 elsewhere.
    double surge_lead_rad = 1.75;
    double learn_interval = 0.25, learn_swing = 0.2,
           learn_part = 0.1;  ///< weights of the newest step in the typical one
    static Parameters of_gentle_steps();
  };

  StepFinder() : StepFinder(Parameters{}) {}
  explicit StepFinder(const Parameters& parameters) : p_(parameters) {}
  /// Examines the newest smoothed value of the signal.
  void update(const WalkSignal& signal);
  /// Steps found by the last update(), oldest first.
  std::span<const FoundStep> found() const { return {found_.data(), found_count_}; }
  bool walking() const { return walking_; }
  /// Start of the present walk, or end of the last one.
  int64_t since_ns() const { return since_ns_; }
  void reset() { *this = StepFinder(p_); }

 private:
  static constexpr size_t kMaxPeaks = 16;
  struct Peak {
    size_t index;
    double t_ns;  // between samples
    double value, low;
    bool may_be_foot;  // may be a foot's contact, by the simultaneous motion of the hand
  };
  /// The peaks from `first` to the newest.
  struct Run {
    size_t first;
    double mean_s, shortest_s, longest_s, weakest, strongest, mean_swing;
  };
  Run run_from(size_t first) const;
  bool steps_alike(const WalkSignal& signal, const Run& run) const;
  bool strides_alike(const WalkSignal& signal, const Run& run) const;
  bool quick_gait(const WalkSignal& signal, const Run& run) const;
  bool rises_too_far(const Run& run) const;
  bool resembles_last_walk(const WalkSignal& signal, const Run& run) const;
  double standing_s(const Run& run) const;  // since the last walk
  double longest_s(const WalkSignal& signal) const;
  void start(const WalkSignal& signal, const Run& run, double repetition);
  bool hand_moves(const WalkSignal& signal, double swing_mps2, double seconds) const;
  bool may_be_walk(const WalkSignal& signal, double swing_mps2, size_t first, size_t last) const;
  void confirm(const WalkSignal& signal);
  void try_start(const WalkSignal& signal);
  void try_start_without_weak(const WalkSignal& signal);
  void continue_walk(const WalkSignal& signal);
  double repetition(const WalkSignal& signal, double interval_s, size_t intervals) const;
  double stride_repetition(const WalkSignal& signal, double interval_s, size_t strides) const;
  double harmonic_before(const WalkSignal& signal, size_t end) const;
  void emit(const WalkSignal& signal, const Peak& from, const Peak& to);
  double interval_s(size_t newer) const;

  Parameters p_;
  bool walking_ = false;
  int64_t since_ns_ = 0;
  bool candidate_ = false;
  Peak best_{};
  double low_ = 1e9;
  std::array<Peak, kMaxPeaks> peaks_{};  // newest last
  size_t peak_count_ = 0;
  int invalid_ = 0;
  double walked_ = 0;  // steps of the present or last walk, including those before it resumed
  double typical_swing_ = 0, typical_s_ = 0.55, typical_part_ = 0, typical_repetition_ = 0, typical_harmonic_ = 0,
         last_rise_m_ = 0;
  std::array<FoundStep, kMaxPeaks> found_{};
  size_t found_count_ = 0;
};

}  // namespace odograph::steps
