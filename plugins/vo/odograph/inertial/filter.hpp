// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "plugins/vo/odograph/inertial/imu_buffer.hpp"
#include "plugins/vo/odograph/inertial/observe.hpp"
#include "plugins/vo/odograph/inertial/parameters.hpp"
#include "plugins/vo/odograph/inertial/standing.hpp"
#include "plugins/vo/odograph/inertial/state.hpp"
#include "plugins/vo/odograph/inertial/update.hpp"

namespace odograph::vio {

/// Statistics of one frame.
struct FrameReport {
  bool imu_whole = true;  ///< no samples were missing
  bool standing = false;
  int tried = 0, accepted = 0;      ///< tracks and landmarks
  std::vector<double> nis_per_dof;  ///< of each track and landmark tried
  std::vector<double> rms_px;       ///< Outcome::rms_px of the tracks tried
};

/// Visual-inertial multi-state constraint Kalman filter (Mourikis & Roumeliotis 2007) with landmarks (Li & Mourikis
/// 2013), a rolling shutter whose rows have their own pose, and online refinement of lens, extrinsics, time offset and
/// row time; right-invariant errors (state.hpp). One thread, deterministic.
class Filter {
 public:
  /// Initial state and its standard deviations; the camera is as calibrated.
  struct Start {
    int64_t t_ns = 0;  ///< IMU time
    Navigation nav;
    double tilt_rad = 0, velocity_mps = 0, gyro_bias_radps = 0, accel_bias_mps2 = 0;
    double scale = 0;  ///< relative, common to the velocity and all lengths of the map
    /// Mean specific force of a body at rest and its sigma: limits the tilt to the error of the accelerometer bias.
    std::optional<Eigen::Vector3d> rest_force_b;
    double rest_force_mps2 = 0;
  };
  Filter(const FilterParameters& parameters, const Camera& camera, const Start& start);

  /// The IMU samples must reach the frame's time plus the camera's time offset.
  FrameReport process(const FrameCorners& frame, const ImuBuffer& imu);

  const State& state() const { return state_; }
  /// The camera's pose in the newest clone.
  const Clone& newest() const { return state_.clones.back(); }
  /// Relative standard deviation of the metric scale.
  double scale_sigma() const { return scale_sigma_; }
  double velocity_sigma() const { return std::sqrt(velocity_covariance().trace()); }
  /// Deviation of the camera from its calibration: sum of squares of time offset, focal length, principal point and, if
  /// given, row time, each over the sigma of its prior, which widens once for a lens that contradicts it. Infinite
  /// beyond what a lens is off by (max_focal_off, max_centre_off). A wrong scale shows in the camera parameters first.
  double calibration_chi2() const;
  /// Corner noise as estimated from the innovations, px.
  double gate_sigma() const { return p_.gate_sigma; }

 private:
  using Track = std::vector<Observation>;

  Eigen::Matrix3d velocity_covariance() const;
  bool is_translating(int64_t t_ns);
  bool is_standing(const FrameCorners& frame, const ImuBuffer& imu) const;
  bool without_parallax() const;
  void marginalise_clone(size_t i);
  void inflate_landmark_noise(double dt_s);
  void update_landmarks(const FrameCorners& frame, FrameReport& report);
  void update_tracks(FrameReport& report);
  void marginalise();
  void detect_fixed_lens();
  double lens_chi2() const;
  void doubt_lens();
  void update_scale_sigma();
  void update_pixel_sigma(const FrameReport& report, double dt_s);
  static void count(const Outcome& outcome, FrameReport& report);

  FilterParameters p_;
  Camera calibrated_;
  State state_;
  std::map<uint64_t, Track> tracks_;  // ordered: the same updates in the same order each time
  std::deque<FrameCorners> recent_;   // over the last half second
  uint32_t next_id_ = 0;
  bool was_standing_ = false;
  struct Motion {
    int64_t t_ns;
    Eigen::Vector3d v_w;
    Eigen::Quaterniond q_w_b;
  };
  std::deque<Motion> motions_;             // over the last mean_s
  bool fixed_lens_ = false;                // the lens is known to have no stabiliser
  std::optional<int64_t> fixed_since_ns_;  // time since which the lens appears fixed
  bool lens_doubted_ = false;              // its priors have been widened
  double scale_sigma_ = 1;
};

}  // namespace odograph::vio
