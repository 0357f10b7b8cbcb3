// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <odograph/types.h>

#include "sdk/host/base/few.hpp"

namespace odograph {

/// The parts of the pipeline that affect the fusion.
struct FusionInputs {
  bool vo = false;     ///< a front-end is configured: poses are the camera's
  bool scale = false;  ///< a scale source is configured
};

struct UpdateResult {
  bool accepted = false;  ///< it was used; false also if it contained nothing to use
  double nis = 0.0;       ///< normalised innovation squared, 0 if not gated
  int dof = 0;            ///< degrees of freedom of nis
};

/// A message for the report.
struct Notice {
  const char* key = nullptr;
  const char* text = nullptr;
  uint32_t severity = ODO_SEVERITY_WARNING;
};

/// A correction of the track: a point x in the old navigation frame is at q * x + p in the new one. q has unit norm, p
/// is in metres.
struct Correction {
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  uint32_t reason = 0;  ///< ODO_CORRECTION_*
  odo_pose pose{};      ///< the newest published pose, corrected; at its time both frames agree best
};

/// What an input has to publish, in this order. The caller lends it, publishes and clears it; further inputs may add to
/// it before. No allocation.
struct Outputs {
  std::optional<Correction> correction;   ///< of all poses published so far; those of several inputs are composed
  Few<odo_pose, 4> poses;                 ///< new ones, for a frame, a step or the first attitude
  std::optional<odo_fix> step_reference;  ///< a metric displacement for step estimators, as a position fix
  Few<Notice, 4> notices;

  void clear() { correction.reset(), poses.clear(), step_reference.reset(), notices.clear(); }
};

/// Uncertainty of the metric scale of the current scale group, and its sources.
struct ScaleKnowledge {
  double sigma = 0;                     ///< relative; 0: unknown
  double by_inertia = 0, by_steps = 0;  ///< shares of the information (1/variance), 0 to 1
};

/// Maximum extrapolation beyond the newest pose, at its velocity, unless that is of steps; empirical, not tuned.
inline constexpr int64_t kMaxExtrapolation_ns = 500'000'000;

/// How a velocity was measured: not at all, as the mean of the last two steps or of the last motion, or at its end.
enum class Velocity { none, steps, mean, now };

/// Seconds that a walker has walked, horizontally, beyond the end of his newest step, `since_s` after it. He goes on at
/// its velocity until the next step is due. If it does not come he has stood since: the position returns as it went.
inline double walked_on_s(double since_s, double due_s) {
  return std::clamp(since_s, 0.0, std::max(0.0, 2 * due_s - since_s));
}

/// The estimate for a time.
struct Estimate {
  odo_pose pose{};  ///< of the camera if there is one, otherwise of the body; only set flags are valid
  Eigen::Quaterniond q_n_b = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_n_b = Eigen::Vector3d::Zero();  ///< m
  Eigen::Vector3d v_n_b = Eigen::Vector3d::Zero();  ///< m/s, of the body
  Velocity velocity = Velocity::none;
  int64_t velocity_until_ns = INT64_MAX;                   ///< by steps: when the next step is due
  Eigen::Vector3d gyro_bias_b = Eigen::Vector3d::Zero();   ///< rad/s, to be subtracted
  Eigen::Vector3d accel_bias_b = Eigen::Vector3d::Zero();  ///< m/s^2, to be subtracted
};

/// The heading refers to north, magnetic or true; without a declination the two are treated as the same.
inline bool refers_to_north(const odo_attitude& attitude) {
  return (attitude.header.flags & (ODO_ATTITUDE_MAGNETIC_NORTH | ODO_ATTITUDE_TRUE_NORTH)) != 0;
}

}  // namespace odograph
