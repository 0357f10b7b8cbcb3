// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "sdk/host/base/rigid.hpp"
#include "sdk/math/ring.hpp"

namespace odograph {

/// A pose without jumps beside one with jumps. At each jump their difference absorbs the jump; it then decays
/// exponentially, at limited speed while it is small. A pure function of the jumps and of time.
class SmoothPose {
 public:
  /// Judgement: 0.5 m/s is less than half the walking speed, and 0.8 cm between two pictures at 60 Hz.
  struct Parameters {
    double time_constant_s = 0.15;
    double max_speed_mps = 0.5;    ///< up to 0.5 m; a larger difference decays within `far_time_constant_s`
    double max_rate_radps = 0.17;  ///< 10 deg/s, likewise
    double far_time_constant_s = 1;
  };

  struct Pose {
    Eigen::Quaterniond q_n = Eigen::Quaterniond::Identity();
    Eigen::Vector3d p_n = Eigen::Vector3d::Zero();  ///< m
  };

  SmoothPose() = default;
  explicit SmoothPose(const Parameters& parameters) : parameters_(parameters) {}

  /// At t, the pose with jumps went from `before` to `after`: the smooth pose does not change and converges from there.
  void jumped(int64_t t_ns, const Pose& before, const Pose& after);
  /// The smooth pose at t for the pose with jumps; before the latest jump, with the difference at the jump.
  Pose at(int64_t t_ns, const Pose& pose) const;
  /// Rotates the axes of n.
  void rotate(const Eigen::Quaterniond& q) { rotation_n_ = q * rotation_n_, shift_n_ = q * shift_n_; }
  /// Sets the difference to zero.
  void reset() { *this = SmoothPose(parameters_); }

 private:
  Parameters parameters_;
  int64_t since_ns_ = 0;
  Eigen::Vector3d rotation_n_ = Eigen::Vector3d::Zero();  // rad, at since_ns_: smooth relative to jumping, in n
  Eigen::Vector3d shift_n_ = Eigen::Vector3d::Zero();     // m
};

/// A smooth pose beside one that moves with each correction of n. What was smooth at a time before a correction
/// remains so, although the pose of that time moves.
class CorrectionBlend {
 public:
  explicit CorrectionBlend(const SmoothPose::Parameters& parameters) : parameters_(parameters) { reset(); }

  /// At t, the pose in n was `before`; a point x in the old n is at `correction` * x in the new one.
  void correct(int64_t t_ns, const Rigid& correction, const SmoothPose::Pose& before);
  /// The smooth pose at t for the pose in today's n; before the oldest stored correction, with the difference at it.
  SmoothPose::Pose at(int64_t t_ns, SmoothPose::Pose pose) const;
  /// Forgets all corrections.
  void reset();

 private:
  struct Correction {
    int64_t since_ns = INT64_MIN;
    Rigid T_new_old;
    SmoothPose smooth;
  };

  SmoothPose::Parameters parameters_;
  Ring<Correction, 16> corrections_;  // poses wait at most half a second, fixes rarely come at more than 10 Hz
};

}  // namespace odograph
