// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

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

/// "By hand": chosen on the simulated walks of `odograph bench walk700`, phone scenarios and euroc_mh05 while the
/// filter was written; no sweep of it is recorded.
struct InertialOdometryParameters {
  FilterParameters filter;
  StartParameters start;
  GuidedCorners::Parameters corners;
  // The data.
  int64_t silent_accel_ns = 500'000'000;  ///< an accelerometer that says nothing for so long is none; by hand
  int64_t imu_margin_ns = 2'000'000;      ///< by which the IMU must be past a frame's last row; by hand
  double min_interval_s = 0.045;          ///< frames that come faster are followed, not estimated: 20 Hz suffice
  // When the filter is lost or wrong.
  double lost_sigma_mps = 1.0;       ///< of the velocity: lost; by hand
  double degraded_sigma_mps = 0.3;   ///< of the velocity; by hand
  double max_speed_mps = 15;         ///< of what a phone in a hand does
  double max_accel_bias_mps2 = 1.5;  ///< more than any phone has; by hand
  double max_camera_pull = 100;      ///< Filter::camera_pull: the filter is wrong, not the camera; by hand
  int min_tried = 8;                 ///< tracks: fewer do not tell that the filter is wrong; by hand
  double min_accepted = 0.3;         ///< of the tracks, for `diverged_s`: the filter is wrong; by hand
  double diverged_s = 1.0;
  /// Of the tracks, for `unseen_s` of moving: the velocity is what accelerometer and inclination have made of it. It
  /// is then off by more than the filter knows, and points that come into view are put where it fits them (a walk in
  /// Linz came out four times as long).
  int min_seen = 10;
  double unseen_s = 4;
  double min_used = 0.1;           ///< of the followed corners, for degraded_unseen_s: less is degraded; by hand
  double degraded_unseen_s = 0.3;  ///< of that, degraded: two blinks of a hand before the lens; by hand
  // What is told of a motion.
  double start_every_s = 0.25;  ///< a start in motion is tried
  /// A start in motion is a hypothesis. It is believed when so many later ones, each solved anew from all frames by
  /// then, find the same scale within so much of its logarithm.
  int confirmations = 1;
  double max_spread = 0.15;
  /// How far they were apart stays in what is stated of the scale, and fades over so much moving.
  double spread_s = 4;
  double keep_frames_s = 3.5;            ///< for a start: StartParameters::max_s and some
  double scale_sigma_factor = 2;         ///< the filter takes corners' errors for independent, which they are not:
  double scale_sigma_floor = 0.01;       ///< relative; both by the 5 m stretches of euroc_mh05 and a simulated phone
  double scale_sigma_stabilised = 0.02;  ///< relative, times the gain of a stabilised lens: what its model leaves out
  double rotation_floor_rad = 2e-4;      ///< of a frame's motion: what the corners share in their errors
  double standing_bias_factor = 3;       ///< of the gyroscope bias's sigma, in the covariance of a camera that stands:
                                         ///< 3.1 sigmas off on a stabilised phone
  double position_floor_m = 2e-3;        ///< as rotation_floor_rad; 0.4 px at a depth of 2.5 m
};

/// The odometry of a phone with an IMU. Until inertia tells the metre it is the visual odometry (Initialising); then a
/// visual-inertial filter (Filtering), which starts from standing or from the visual odometry in motion, and goes on
/// through darkness by inertia alone. Where the filter is lost or wrong the visual odometry begins anew, with a new
/// scale group.
///
/// A frame goes through begin(), its corners followed at once, and finish(), which estimates its motion when the IMU
/// has reached its last row, or the next frame comes. One thread, deterministic.
class InertialOdometry {
 public:
  using Parameters = InertialOdometryParameters;

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

  /// Nothing while the metre is not known.
  const Filter* filter() const;

 private:
  /// A start in motion that later ones have confirmed so often.
  struct Hypothesis {
    Filter filter;
    int confirmed = 0;
    double spread = 0;  ///< of the logarithm of the scale
  };
  /// No metre yet: the visual odometry, and the frames from which a filter may start.
  struct Initialising {
    std::unique_ptr<vo::Odometry> visual;  ///< on the heap: it is large
    std::deque<StartFrame> frames;
    Eigen::Isometry3d T_w_c = Eigen::Isometry3d::Identity();  ///< chained from the motions of a scale group
    unsigned visual_group = 0;
    std::optional<Hypothesis> hypothesis;
  };
  /// A frame that was told, by a clone of the window.
  struct Told {
    uint32_t clone;
    Eigen::Isometry3d T_clone_c;
  };
  /// The filter runs.
  struct Filtering {
    Filter filter;
    Eigen::Isometry3d T_w_previous;  ///< the frame before as it was told
    std::vector<Told> told;          ///< the same by the newest clone and the one before it
    double moved_s = 0;              ///< since the start, without standing
    std::optional<int64_t> refused_since_ns, unseen_since_ns;
    unsigned tracked = 0, accepted = 0;  ///< corners of the newest frame that was estimated
    double spread = 0;                   ///< of the hypotheses that it started from
    std::optional<int64_t> few_since_ns;
  };
  using Phase = std::variant<Initialising, Filtering>;

  /// A frame that waits for the IMU.
  struct Pending {
    int64_t t_ns;
    FrameCorners corners;  ///< as the calibrated lens would have them
    vo::Motion visual;     ///< while initialising
    bool estimate;
  };
  /// What a frame comes to: its motion, and the phase after it where that changes.
  struct Outcome {
    InertialMotion motion;
    std::optional<Phase> next;
  };

  Outcome advance(Initialising& phase, const Pending& frame);
  Outcome advance(Filtering& phase, const Pending& frame);

  FrameCorners follow(const vo::Frame& frame);
  bool has_accelerometer(int64_t t_ns) const;
  bool imu_reaches(int64_t t_ns) const;
  void compose(Initialising& phase, const vo::Motion& visual);
  std::optional<Filtering> try_start(Initialising& phase, int64_t t_ns);
  bool confirm(Initialising& phase, Filter next) const;
  Initialising begin_anew() const;
  bool is_wrong(Filtering& phase, const FrameReport& seen, int64_t t_ns) const;
  InertialMotion tell(Filtering& phase, int64_t t_ns, const Navigation& nav, bool with_clone) const;
  Eigen::Matrix<double, 6, 6> motion_covariance(const Filter& filter, int64_t t_ns, bool with_clone) const;
  Eigen::Isometry3d previous_pose(const Filtering& phase) const;
  Eigen::Quaterniond rotation_between(int64_t from_ns, int64_t to_ns) const;
  Navigation navigation_at(const Filter& filter, int64_t frame_ns) const;
  const Camera& camera() const { return filter() ? filter()->state().camera : camera_; }
  FailureReason dark_or_few_features() const;

  Parameters p_;
  Camera camera_;          ///< as calibrated at the start
  CameraModel lens_told_;  ///< of the newest frame
  ImuBuffer imu_;
  GuidedCorners corners_;
  Phase phase_;
  std::optional<Pending> pending_;
  std::optional<int64_t> previous_ns_, estimated_ns_, tried_ns_, accel_ns_;
  unsigned group_ = 0;
};

}  // namespace odograph::vio
