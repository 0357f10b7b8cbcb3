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

/// Motion of a frame with the inertial estimates.
struct InertialMotion {
  vo::Motion motion;
  int64_t from_ns = 0, t_ns = 0;
  bool metric = false;     ///< the fields below are valid, and the motion is in metres
  double scale_sigma = 0;  ///< relative
  Eigen::Vector3d velocity_c = Eigen::Vector3d::Zero(), gravity_c = Eigen::Vector3d::Zero();
  Eigen::Vector3d gyro_bias_b = Eigen::Vector3d::Zero(), accel_bias_b = Eigen::Vector3d::Zero();
  std::vector<TrackedCorner> corners;  ///< empty if the frame was not estimated
  double corner_sigma_rad = 0;
};

/// "Empirical": chosen on the simulated walks of `odograph bench walk700`, phone scenarios and euroc_mh05 during
/// development; no parameter sweep is recorded.
struct InertialOdometryParameters {
  FilterParameters filter;
  StartParameters start;
  GuidedCorners::Parameters corners;
  // Input.
  /// An accelerometer without samples for this long is treated as absent; empirical.
  int64_t silent_accel_ns = 500'000'000;
  int64_t imu_margin_ns = 2'000'000;  ///< required IMU data beyond the last row of a frame; empirical
  /// Frames at shorter intervals are tracked but not used for estimation: 20 Hz suffice.
  double min_interval_s = 0.045;
  // Loss and divergence of the filter.
  double lost_sigma_mps = 1.0;       ///< velocity sigma above which the filter is lost; empirical
  double degraded_sigma_mps = 0.3;   ///< velocity sigma above which it is degraded; empirical
  double max_speed_mps = 15;         ///< max for a hand-held phone
  double max_accel_bias_mps2 = 1.5;  ///< above that of any phone; empirical
  double max_calibration_chi2 =
      100;                    ///< Filter::calibration_chi2 above which the filter, not the camera, is wrong; empirical
  int min_tried = 8;          ///< min tracks for the test of min_accepted; empirical
  double min_accepted = 0.3;  ///< share of the tracks; less for `diverged_s` means that the filter is wrong; empirical
  double diverged_s = 1.0;
  /// Min accepted tracks; with fewer, over `unseen_s` of motion, the velocity comes from accelerometer and tilt alone.
  /// Its error then exceeds the filter's covariance, and new points are triangulated to fit it (a walk in Linz came out
  /// four times as long).
  int min_seen = 10;
  double unseen_s = 4;
  double min_used = 0.1;           ///< share of the tracked corners; less for degraded_unseen_s is degraded; empirical
  double degraded_unseen_s = 0.3;  ///< twice the time for which a hand passes the lens; empirical
  // Reported motion.
  double start_every_s = 0.25;  ///< interval between attempts to start in motion
  /// Time constant, in motion, by which the spread of the hypotheses decays in the reported scale sigma.
  double spread_s = 4;
  double keep_frames_s = 3.5;            ///< frames kept for a start: StartParameters::max_s and a margin
  double scale_sigma_factor = 2;         ///< compensates that the filter assumes independent corner errors:
  double scale_sigma_floor = 0.01;       ///< relative; both from the 5 m segments of euroc_mh05 and a simulated phone
  double scale_sigma_stabilised = 0.02;  ///< relative, times the gain of a stabilised lens: its model error
  double rotation_floor_rad = 2e-4;      ///< of a frame's motion: the common error of the corners
  double standing_bias_factor = 3;       ///< factor on the gyro bias sigma in the covariance of a standing camera:
                                         ///< without it 3.1 sigmas off on a stabilised phone
  double position_floor_m = 2e-3;        ///< as rotation_floor_rad; 0.4 px at a depth of 2.5 m
};

/// Odometry of a phone with an IMU. While the metric scale is not observable it is the visual odometry (Initialising).
/// A visual-inertial filter (Filtering) then starts, from standing or from the visual odometry in motion, and bridges
/// darkness by inertia alone. If the filter is lost or wrong, the visual odometry restarts with a new scale group.
///
/// begin() tracks the corners of a frame at once; finish() estimates its motion when the IMU has reached its last row
/// or the next frame arrives. Not thread-safe; deterministic.
class InertialOdometry {
 public:
  using Parameters = InertialOdometryParameters;

  InertialOdometry(const Parameters& parameters, const Camera& camera);

  /// Accelerometer and gyroscope in b. Without a force only the angular rate is used, and there is no metric scale.
  void add_imu(const ImuSample& sample, bool has_force);
  /// The next frame; call finish(true) first. The pixels are used during the call only.
  void begin(const vo::Frame& frame);
  /// Motion of the frame passed to begin(), once the IMU reaches far enough, or at once with `force`.
  std::optional<InertialMotion> finish(bool force);

  /// Sets the camera's lens for the frames to come (refocused or shifted). The refinements of the calibrated lens
  /// remain.
  void change_lens(const CameraModel& newest);
  /// Refined lens of the newest frame.
  CameraModel lens() const;

  /// Null while the metric scale is unknown.
  const Filter* filter() const;

 private:
  /// No metric scale yet: the visual odometry, and the frames from which a filter may start.
  struct Initialising {
    std::unique_ptr<vo::Odometry> visual;  ///< on the heap: it is large
    std::deque<StartFrame> frames;
    Eigen::Isometry3d T_w_c = Eigen::Isometry3d::Identity();  ///< composed from the motions of a scale group
    unsigned visual_group = 0;
    std::optional<Filter> hypothesis;  ///< the newest start in motion
    StartEvidence evidence;            ///< for it, from those before it
  };
  /// A reported frame, relative to a clone of the window.
  struct ReportedFrame {
    uint32_t clone;
    Eigen::Isometry3d T_clone_c;
  };
  /// The filter runs.
  struct Filtering {
    Filter filter;
    Eigen::Isometry3d T_w_previous;       ///< previous frame as reported
    std::vector<ReportedFrame> reported;  ///< the same relative to the newest clone and the one before it
    double moved_s = 0;                   ///< since the start, without standing
    std::optional<int64_t> rejected_since_ns, unseen_since_ns;
    unsigned tracked = 0, accepted = 0;  ///< corners of the newest estimated frame
    double spread = 0;                   ///< of the hypotheses that started the filter
    std::optional<int64_t> few_since_ns;
  };
  using Phase = std::variant<Initialising, Filtering>;

  /// A frame that waits for the IMU.
  struct Pending {
    int64_t t_ns;
    FrameCorners corners;  ///< in pixels of the calibrated lens
    vo::Motion visual;     ///< while initialising
    bool estimate;
  };
  /// Result of a frame: its motion and, if the phase changes, the next phase.
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
  Initialising initial_phase() const;
  bool has_diverged(Filtering& phase, const FrameReport& seen, int64_t t_ns) const;
  InertialMotion make_motion(Filtering& phase, int64_t t_ns, const Navigation& nav, bool with_clone) const;
  void add_corners(const FrameCorners& seen, const Filter& filter, InertialMotion& motion) const;
  Eigen::Matrix<double, 6, 6> motion_covariance(const Filter& filter, int64_t t_ns, bool with_clone) const;
  Eigen::Isometry3d previous_pose(const Filtering& phase) const;
  Eigen::Quaterniond rotation_between(int64_t from_ns, int64_t to_ns) const;
  Navigation navigation_at(const Filter& filter, int64_t frame_ns) const;
  const Camera& camera() const { return filter() ? filter()->state().camera : camera_; }
  FailureReason dark_or_few_features() const;

  Parameters p_;
  Camera camera_;           ///< as calibrated at the start
  CameraModel frame_lens_;  ///< of the newest frame
  ImuBuffer imu_;
  GuidedCorners corners_;
  Phase phase_;
  std::optional<Pending> pending_;
  std::optional<int64_t> previous_ns_, estimated_ns_, tried_ns_, accel_ns_;
  unsigned group_ = 0;
};

}  // namespace odograph::vio
