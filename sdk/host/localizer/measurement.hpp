// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <variant>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <odograph/types.h>

namespace odograph {

/// What the pipeline consists of, as far as the localizer must know.
struct LocalizerInputs {
  bool vo = false;     ///< a front-end is configured: poses are the camera's
  bool scale = false;  ///< a scale source is configured
};

/// A camera frame has been taken: the front-end will speak of this time later.
struct FrameTime {
  int64_t t_ns = 0;
};

/// Motion of a front-end with the scale that a scale source gave for it, or null.
struct RelativeMotion {
  const odo_vo_motion* motion = nullptr;
  const odo_scale* scale = nullptr;
};

/// What the localizer learns from besides the IMU. Pointers are borrowed for the call. Every message carries its own
/// time, which may lie before the newest IMU sample. A fix comes with p_n filled in (Geodesy::resolve).
using Measurement = std::variant<FrameTime, const odo_attitude*, RelativeMotion, const odo_step*, const odo_scale*,
                                 const odo_fix*, const odo_barometer*>;

struct UpdateResult {
  bool accepted = false;  ///< it was used; false also where there was nothing to use
  double nis = 0.0;       ///< normalised innovation squared, 0 where no gate was asked
  int dof = 0;            ///< degrees of freedom of nis
};

/// For a report; without a key there is nothing to tell.
struct Notice {
  const char* key = nullptr;
  const char* text = nullptr;
  uint32_t severity = ODO_SEVERITY_WARNING;
};

/// The track was corrected: what was at x in the old navigation frame is at q * x + p in the new one. q is unit, p in
/// metres; t_ns is the time of the pose at which the two agree best.
struct Correction {
  int64_t t_ns = 0;
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  uint32_t reason = 0;  ///< ODO_CORRECTION_*
};

/// How well the metre of the present scale group is known, and by whom.
struct ScaleKnowledge {
  double sigma = 0;                     ///< relative; 0: not known
  double by_inertia = 0, by_steps = 0;  ///< shares of the information (1/variance), 0 to 1
};

/// How far beyond the newest pose one is told, with its velocity; chosen by hand, not tuned.
inline constexpr int64_t kMaxExtrapolation_ns = 500'000'000;

/// The answer for a time.
struct Estimate {
  odo_pose pose{};  ///< of the camera where there is one, otherwise of the body; its flags are true when set
  Eigen::Quaterniond q_n_b = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_n_b = Eigen::Vector3d::Zero();  ///< m
  Eigen::Vector3d v_n_b = Eigen::Vector3d::Zero();  ///< m/s
  bool velocity_is_mean = false;  ///< v_n_b is the mean of the last motion, not the velocity at the pose's time
  Eigen::Vector3d gyro_bias_b = Eigen::Vector3d::Zero();   ///< rad/s, to be subtracted
  Eigen::Vector3d accel_bias_b = Eigen::Vector3d::Zero();  ///< m/s^2, to be subtracted
};

/// The heading is against north, magnetic or true; without a declination the two are taken for the same.
inline bool refers_to_north(const odo_attitude& attitude) {
  return (attitude.header.flags & (ODO_ATTITUDE_MAGNETIC_NORTH | ODO_ATTITUDE_TRUE_NORTH)) != 0;
}

}  // namespace odograph
