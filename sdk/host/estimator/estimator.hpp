// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <variant>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <odograph/types.h>

#include "sdk/host/estimator/held_poses.hpp"

namespace odograph {

struct CouplingConfig;
struct StartPose;

/// What the pipeline consists of, as far as the estimator must know.
struct EstimatorInputs {
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

/// What an estimator learns from besides the IMU. Pointers are borrowed for the call. Every message carries its own
/// time, which may lie before the newest IMU sample. A fix comes with p_n filled in (see resolve_geodetic).
using Measurement = std::variant<FrameTime, const odo_attitude*, RelativeMotion, const odo_step*, const odo_scale*,
                                 const odo_fix*, const odo_barometer*, const odo_motion_mode*>;

struct UpdateResult {
  bool accepted = false;  ///< it was used; false also where there was nothing to use
  double nis = 0.0;       ///< normalised innovation squared, 0 where no gate was asked
  int dof = 0;            ///< degrees of freedom of nis
};

/// For a report; without a key there is nothing to tell.
struct Notice {
  const char* key = nullptr;
  const char* text = nullptr;
};

/// Why the track jumped.
constexpr uint32_t kCorrectionFix = 1;        // a position or orientation from outside
constexpr uint32_t kCorrectionScale = 2;      // the metre became known, or better known
constexpr uint32_t kCorrectionRecovered = 3;  // a sick part was started anew

/// The track was corrected: what was at x in the old navigation frame is at q * x + p in the new one. q is unit, p in
/// metres; t_ns is the time of the pose at which the two agree best.
struct Correction {
  int64_t t_ns = 0;
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  uint32_t reason = 0;  ///< kCorrection*
};

/// How well the metre of the present scale group is known, and by whom.
struct ScaleKnowledge {
  double sigma = 0;                     ///< relative; 0: not known
  double by_inertia = 0, by_steps = 0;  ///< shares of the information (1/variance), 0 to 1
};

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

/// Makes one pose of everything. Inputs come in the order in which the pipeline handles them; IMU samples in order of
/// time. One thread at a time, but at() on any. Output depends on the inputs and the config alone.
class Estimator {
 public:
  virtual ~Estimator() = default;

  virtual void on_calibration(const odo_calibration& calibration) = 0;
  virtual void on_imu_noise(const odo_imu_noise& noise) = 0;

  /// A whole sample, gyroscope and accelerometer.
  virtual void propagate(const odo_imu& imu) = 0;
  virtual UpdateResult update(const Measurement& measurement) = 0;

  /// Writes the earlier frame's orientation into a motion (ODO_FLAG_NAVIGATION), for scale sources.
  virtual void prepare(odo_vo_motion& motion) const = 0;

  /// The pose at t, or the newest for INT64_MIN; ahead of the newest by at most 0.5 s, flagged as extrapolated.
  /// ODO_NOT_READY before the first, ODO_E_NOT_FOUND outside of what is kept. [any]
  virtual int32_t at(int64_t t_ns, Estimate& out) const = 0;

  /// A pose to publish, for a frame, a step or the first attitude: each is given once; false when there is none.
  virtual bool take_pose(odo_pose& pose) = 0;
  /// A jump of the track, once, with the latest pose anew; false when there is none.
  virtual bool take_correction(Correction& correction, odo_pose& pose) = 0;
  /// A metric displacement reference for the step estimator, as a position fix; false when there is none.
  virtual bool take_step_reference(odo_fix& reference) = 0;

  /// Holds the body's pose at t, or the oldest that is kept: what is learnt later moves it as it should, by as much of
  /// a correction as is its own. A number from 1, never given twice; 0 where that time has not come yet. let_go ends
  /// it.
  virtual uint64_t hold_pose(int64_t t_ns) = 0;
  virtual void let_go(uint64_t id) = 0;
  /// As it is known now; false where it is not held (any more: reset).
  virtual bool held_pose(uint64_t id, HeldPose& out) const = 0;
  /// The body's pose now with its covariance, as held_pose has it; `own` and `cross` are the same as `now`.
  virtual bool pose_now(HeldPose& out) const = 0;
  /// Horizontal position against n is known, by the start that was given or by a fix.
  virtual bool is_placed() const = 0;

  /// Nothing where the estimator does not tell.
  /// Something that a person should know, once.
  virtual Notice take_notice() { return {}; }
  virtual ScaleKnowledge scale_knowledge() const { return {}; }
  virtual double distance_m() const = 0;
  /// As at the start, for a sensor clock that was set back. The calibration stays.
  virtual void reset() = 0;
};

/// The estimator that the config names.
std::unique_ptr<Estimator> make_estimator(const CouplingConfig& config, const StartPose& start, EstimatorInputs inputs);

/// The heading is against north, magnetic or true; without a declination the two are taken for the same.
inline bool refers_to_north(const odo_attitude& attitude) {
  return (attitude.header.flags & (ODO_ATTITUDE_MAGNETIC_NORTH | ODO_ATTITUDE_TRUE_NORTH)) != 0;
}

class Geodesy;
/// Fills in p_n where the fix is geodetic; the first such fix is the origin where there is none.
void resolve_geodetic(odo_fix& fix, Geodesy& geodesy);

}  // namespace odograph
