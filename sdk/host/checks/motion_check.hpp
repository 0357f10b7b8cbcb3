// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <odograph/samples.h>

#include "sdk/host/checks/input_fault.hpp"
#include "sdk/math/ring.hpp"

namespace odograph {

/// Checks unit, level, range, sign and axes of the inertial sensors by what they say of each other: the mean specific
/// force of a second, rotated by the gyroscope, is gravity, whose direction stays. No allocation. Not thread-safe.
class MotionCheck {
 public:
  struct Parameters {
    double window_s = 1;                      ///< s, of a mean: one or two steps
    double max_gap_s = 0.1;                   ///< s without a sample, after which it starts anew
    int min_samples = 20;                     ///< of a window
    int steady = 3;                           ///< windows in a row for a statement about the accelerometer alone
    double quiet_mps2 = 0.3;                  ///< m/s^2 rms of the norm: a phone that lies or is held still; judgement
    double unturned_rad = 0.03;               ///< turned within a window: a car in a roundabout turns by 0.2 or more
    double low_mps2 = 8.8, high_mps2 = 10.8;  ///< m/s^2, norm at rest: beyond any data sheet's scale error and bias;
                                              ///< a curve leaned into has more, whose force stays in b though b turns
    double one_g_low = 0.75, one_g_high = 1.3;  ///< the same, of a number of g
    double still = 0.5;                         ///< m/s^2, norm at rest without gravity, at most
    double moving = 6;                          ///< m/s^2, mean norm of a walk without gravity: 1 to 4; judgement
    double with_gravity = 0.8, without_gravity = 0.4;  ///< norm of the mean over mean norm; judgement
    double fast_mps2 = 20;         ///< m/s^2, norm of the mean: twice gravity, an aircraft that is banked by 60 degrees
    double clipped_share = 0.05;   ///< of the samples at one extreme; a sine has 1.4 % within a thousandth of it
    double clipped_scatter = 1;    ///< m/s^2 rms of an axis that can be called clipped
    double filtered_mps2 = 0.003;  ///< rms of the norm; honest at least 0.032, of 22 real recordings
    double filtered_rad = 0.1;     ///< turned within a window
    double walking_mps2 = 0.7;     ///< rms of the norm: a slow walk in the hand
    double steady_level =
        1.5;                  ///< ratio of the largest to the least mean force of windows whose directions are compared
    double turned_rad = 0.4;  ///< rad, turn of gravity in b that shows the gyroscope's unit, sign and axes
    double claimed_rad = 1.6;  ///< rad, of turns by the gyroscope while gravity stays: a roundabout at 0.4 g has 1.1
    double cancelled = 0.87, held = 0.97;  ///< norm of the mean over mean norm of gravity that is swung to and fro, and
                                           ///< that is held; judgement
    double explained = 0.25;               ///< share of the contradiction that a better explanation leaves; judgement
    double biased_rad = 1.2;  ///< rad in eight seconds that gravity does not show: 0.15 rad/s; real sensors have 0.1
    int biased_windows = 4;   ///< in a row
    double straight = 0.4;    ///< rotation over the sum of its parts, of a phone that is held; judgement
    double vertical = 0.8;    ///< cosine, of axis and mean force: a car in a curve of 0.7 g turns about the vertical
    /// rad, between two directions of gravity in b, and after the rotation by the gyroscope: an acceleration that turns
    /// them as far makes the norm exceed `high_mps2`, by which it may be at most 0.86 rad.
    double swept_rad = 1.0, left_rad = 0.88;
    double step_rad = 0.35;    ///< rad, in steps from one second to the next of more than this; judgement
    int steps = 3;             ///< a fall or a spin that exceeds the gyroscope's range is in two of them
    double silent_rad = 1e-6;  ///< rad in a second: no gyroscope ...
    double unnoticed_rad = 1;  ///< rad: ... if gravity in b has turned by that meanwhile
  };

  explicit MotionCheck(FaultFound found) : found_(std::move(found)) { reset(); }
  /// A sample with gyroscope and accelerometer, in time order.
  void add(const odo_imu& imu);
  void reset();

  /// Of the newest window, m/s^2; zero before.
  Eigen::Vector3d force_b() const {
    return windows_.empty() ? Eigen::Vector3d::Zero()
                            : Eigen::Vector3d(windows_.back(0).force / windows_.back(0).samples);
  }
  /// Time for which the phone was shaken as by steps, s; also before a reset.
  double walked_s() const { return walked_s_; }

 private:
  static constexpr size_t kWindows = 8, kRates = 3;
  /// What the gyroscope's numbers are multiplied by: right, opposite sign, degrees.
  static constexpr double kRate[kRates] = {1, -1, 0.017453292519943295};
  /// Sums over the samples of a window.
  struct Window {
    Window() {
      for (auto& of_rate : rotated) of_rate.fill(Eigen::Matrix3d::Zero());
    }
    /// By rate and axis of the accelerometer: rotated into a fixed frame as if it was each axis of b (columns), so that
    /// any exchange of axes can be evaluated later.
    std::array<std::array<Eigen::Matrix3d, 3>, kRates> rotated;
    Eigen::Vector3d force = Eigen::Vector3d::Zero(), rotation = Eigen::Vector3d::Zero();  ///< in b
    double norm = 0, norm2 = 0, turned_rad = 0;
    int samples = 0;

    Eigen::Vector3d direction(size_t rate, const SignedAxes& axes) const;
  };
  /// The range of an axis, and how often its ends occurred.
  struct Range {
    double low = 0, high = 0, sum = 0, sum2 = 0;
    int lows = 0, highs = 0, samples = 0;
    void add(double value);
  };

  void end_window();
  void check_level(const Window& w);
  void check_range();
  void check_axes();
  void check_bias();
  double turn(size_t rate, const SignedAxes& axes) const;
  double rotation_in_body() const;
  bool swings_too_far() const;
  bool is_unexplained() const;

  Parameters p_;
  FaultFound found_;
  Ring<Window, kWindows> windows_;
  Window now_;
  std::array<Range, 3> ranges_;
  std::array<Eigen::Quaterniond, kRates> q_e_b_;
  int64_t begun_ns_ = 0, last_ns_ = 0;
  int in_g_ = 0, without_ = 0, off_ = 0, filtered_ = 0, biased_ = 0;  // windows in a row
  double walked_s_ = 0;
  int range_windows_ = 0;  // since the ranges began
};

}  // namespace odograph
