// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <variant>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <odograph/types.h>

namespace odograph {

/// The parts of the pipeline that affect the localizer.
struct LocalizerInputs {
  bool vo = false;     ///< a front-end is configured: poses are the camera's
  bool scale = false;  ///< a scale source is configured
};

/// A camera frame was received; the front-end's motion for it follows later.
struct FrameTime {
  int64_t t_ns = 0;
};

/// A front-end's motion with the scale that a scale source gave for it, or null.
struct RelativeMotion {
  const odo_vo_motion* motion = nullptr;
  const odo_scale* scale = nullptr;
};

/// Measurements besides the IMU. Pointers are borrowed for the call. Each message has its own time, which may precede
/// the newest IMU sample. A fix arrives with p_n filled in (Geodesy::resolve).
using Measurement = std::variant<FrameTime, const odo_attitude*, RelativeMotion, const odo_step*, const odo_scale*,
                                 const odo_fix*, const odo_barometer*>;

struct UpdateResult {
  bool accepted = false;  ///< it was used; false also if it contained nothing to use
  double nis = 0.0;       ///< normalised innovation squared, 0 if not gated
  int dof = 0;            ///< degrees of freedom of nis
};

/// A message for the report; empty if it has no key.
struct Notice {
  const char* key = nullptr;
  const char* text = nullptr;
  uint32_t severity = ODO_SEVERITY_WARNING;
};

/// A correction of the track: a point x in the old navigation frame is at q * x + p in the new one. q has unit norm, p
/// is in metres; t_ns is the time of the pose at which both agree best.
struct Correction {
  int64_t t_ns = 0;
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  uint32_t reason = 0;  ///< ODO_CORRECTION_*
};

/// Uncertainty of the metric scale of the current scale group, and its sources.
struct ScaleKnowledge {
  double sigma = 0;                     ///< relative; 0: unknown
  double by_inertia = 0, by_steps = 0;  ///< shares of the information (1/variance), 0 to 1
};

/// Maximum extrapolation beyond the newest pose, at its velocity; empirical, not tuned.
inline constexpr int64_t kMaxExtrapolation_ns = 500'000'000;

/// The estimate for a time.
struct Estimate {
  odo_pose pose{};  ///< of the camera if there is one, otherwise of the body; only set flags are valid
  Eigen::Quaterniond q_n_b = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_n_b = Eigen::Vector3d::Zero();  ///< m
  Eigen::Vector3d v_n_b = Eigen::Vector3d::Zero();  ///< m/s, of the body
  bool velocity_is_mean = false;  ///< v_n_b is the mean of the last motion, not the velocity at the pose's time
  Eigen::Vector3d gyro_bias_b = Eigen::Vector3d::Zero();   ///< rad/s, to be subtracted
  Eigen::Vector3d accel_bias_b = Eigen::Vector3d::Zero();  ///< m/s^2, to be subtracted
};

/// The heading refers to north, magnetic or true; without a declination the two are treated as the same.
inline bool refers_to_north(const odo_attitude& attitude) {
  return (attitude.header.flags & (ODO_ATTITUDE_MAGNETIC_NORTH | ODO_ATTITUDE_TRUE_NORTH)) != 0;
}

}  // namespace odograph
