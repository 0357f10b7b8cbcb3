// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace odograph {

/// A pose that never jumps, beside one that does: the difference between the two is taken over at each jump and then
/// blended out, exponentially, and while it is small no faster than a limit. Pure function of the jumps and of time.
class SmoothPose {
 public:
  /// Judgement: 0.5 m/s is less than half of a walk, and 0.8 cm between two pictures at 60 Hz.
  struct Parameters {
    double time_constant_s = 0.15;
    double max_speed_mps = 0.5;    ///< up to 0.5 m; beyond, what is left of it in `far_time_constant_s`
    double max_rate_radps = 0.17;  ///< 10 deg/s, likewise
    double far_time_constant_s = 1;
  };

  struct Pose {
    Eigen::Quaterniond q_n = Eigen::Quaterniond::Identity();
    Eigen::Vector3d p_n = Eigen::Vector3d::Zero();  ///< m
  };

  SmoothPose() = default;
  explicit SmoothPose(const Parameters& parameters) : parameters_(parameters) {}

  /// At t the pose that jumps went from `before` to `after`: the smooth one stays where it was and follows from there.
  void jumped(int64_t t_ns, const Pose& before, const Pose& after);
  /// The smooth pose at t for the one that jumps; before the latest jump's time the difference is as at that time.
  Pose at(int64_t t_ns, const Pose& pose) const;
  /// No difference any more: what is smooth begins anew.
  void reset() { *this = SmoothPose(parameters_); }

 private:
  Parameters parameters_;
  int64_t since_ns_ = 0;
  Eigen::Vector3d rotation_n_ = Eigen::Vector3d::Zero();  // rad, at since_ns_: smooth against jumping, in n
  Eigen::Vector3d shift_n_ = Eigen::Vector3d::Zero();     // m
};

}  // namespace odograph
