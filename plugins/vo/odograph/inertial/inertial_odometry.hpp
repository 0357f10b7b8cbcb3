// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "plugins/vo/odograph/inertial/corners.hpp"
#include "plugins/vo/odograph/inertial/filter.hpp"
#include "plugins/vo/odograph/inertial/start.hpp"
#include "plugins/vo/odograph/visual/odometry.hpp"

namespace odograph::vio {

/// A frame's motion and what the inertial side knows with it.
struct InertialMotion {
  vo::Motion motion;
  int64_t from_ns = 0, t_ns = 0;
  bool metric = false;     ///< the rest is valid, and the motion in metres
  double scale_sigma = 0;  ///< relative
  Eigen::Vector3d velocity_c = Eigen::Vector3d::Zero(), gravity_c = Eigen::Vector3d::Zero();
  Eigen::Vector3d gyro_bias_b = Eigen::Vector3d::Zero(), accel_bias_b = Eigen::Vector3d::Zero();
};

/// The odometry of a phone with an IMU. Until inertia tells the metre it is the visual odometry; then a visual-inertial
/// filter, which starts from standing or from the visual odometry in motion, and goes on through darkness by inertia
/// alone. Where the filter is lost or wrong the visual odometry begins anew, with a new scale group.
///
/// A frame is followed at once and estimated when the IMU has reached its last row, or the next frame comes.
class InertialOdometry {
 public:
  struct Parameters {
    FilterParameters filter;
    StartParameters start;
    GuidedCorners::Parameters corners;
    double least_interval_s = 0.045;  ///< frames that come faster are followed, not estimated
    double lost_sigma_mps = 1.0;      ///< of the velocity: the filter is lost
    double degraded_sigma_mps = 0.3;
    double mended_s = 6;         ///< of moving: what was told of the way is mended by the motions that follow
    double most_speed_mps = 15;  ///< of what a phone in a hand does
    double most_accel_bias_mps2 = 1.5;
    double most_camera_pull = 100;  ///< Filter::camera_pull: the filter is wrong, not the camera
    double least_accepted = 0.3;    ///< of the tracks, for `diverged_s`: the filter is wrong
    double diverged_s = 1.0;
    /// Of the tracks, for `blind_s` of moving: the velocity is what accelerometer and inclination have made of it. It
    /// is then off by more than the filter knows, and points that come into view are put where it fits them (a walk in
    /// Linz came out four times as long).
    int least_seen = 10;
    double blind_s = 4;
    double start_every_s = 0.25;           ///< a start in motion is tried
    double scale_sigma_factor = 2;         ///< the filter takes corners' errors for independent, which they are not:
    double scale_sigma_floor = 0.01;       ///< relative; both by the 5 m stretches of euroc_mh05 and a simulated phone
    double scale_sigma_stabilised = 0.02;  ///< relative, times the gain of a stabilised lens: what its model leaves out
    double rotation_floor_rad = 2e-4;      ///< of a frame's motion: what the corners share in their errors
    double standing_bias_factor = 3;  ///< of the gyroscope bias's sigma, in the covariance of a camera that stands: 3.1
                                      ///< sigmas off on a stabilised phone
    double position_floor_m = 2e-3;   ///< the same; 0.4 px at a depth of 2.5 m
  };

  InertialOdometry(const Parameters& parameters, const Camera& camera);

  /// Accelerometer and gyroscope in b. Without a force only the gyroscope's rate, and no metre.
  void add_imu(const ImuSample& sample, bool has_force);
  /// The next frame, at once behind finish(). Its pixels are used within the call alone.
  void begin(const vo::Frame& frame);
  /// The motion of the frame that was begun, once the IMU reaches far enough, or at once with `force`.
  std::optional<InertialMotion> finish(bool force);

  /// Of the frames to come: focused or shifted, as the camera says. What was refined of the calibrated lens stays.
  void change_lens(const CameraModel& told);
  /// That of the newest frame, as it is refined.
  CameraModel lens() const;

  const Filter* filter() const { return filter_ ? &*filter_ : nullptr; }

 private:
  struct Pending {
    int64_t t_ns;
    vo::Motion visual;
    bool estimate;
  };

  /// The frame that was told last, by a clone of the window.
  struct Told {
    uint32_t clone;
    Eigen::Isometry3d T_clone_c;
  };

  void try_start(int64_t t_ns);
  Eigen::Isometry3d previous_pose() const;
  InertialMotion estimate(const Pending& frame);
  InertialMotion report(int64_t t_ns, const Navigation& nav, bool with_clone);
  void lose();
  Eigen::Isometry3d camera_pose(const Navigation& nav) const;
  Eigen::Quaterniond rotation_since(int64_t from_ns, int64_t to_ns) const;

  Parameters p_;
  Camera camera_;          ///< as calibrated at the start
  CameraModel lens_told_;  ///< of the newest frame
  ImuBuffer imu_;
  GuidedCorners corners_;
  FrameCorners seen_;  ///< corners_ as the calibrated lens would have them
  std::optional<vo::Odometry> visual_;
  std::deque<StartFrame> start_frames_;
  std::optional<Filter> filter_;
  std::optional<Pending> pending_;
  std::vector<Told> told_;  ///< the newest clone and the one before it
  Eigen::Isometry3d T_w_previous_ = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_visual_ = Eigen::Isometry3d::Identity();  // chained from the visual motions of a group
  int64_t previous_ns_ = INT64_MIN, estimated_ns_ = INT64_MIN, tried_ns_ = INT64_MIN, refused_since_ns_ = INT64_MIN,
          blind_since_ns_ = INT64_MIN;
  int64_t accel_ns_ = INT64_MIN;
  double moved_s_ = 0;  ///< since the start, without standing
  unsigned group_ = 0, visual_group_ = 0;
  unsigned tracked_ = 0, accepted_ = 0;
};

}  // namespace odograph::vio
