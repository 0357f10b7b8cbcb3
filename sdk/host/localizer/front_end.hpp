// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <variant>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "sdk/host/localizer/measurement.hpp"
#include "sdk/host/localizer/metre_check.hpp"
#include "sdk/host/localizer/gyro_orientation.hpp"
#include "sdk/host/localizer/scale_group.hpp"
#include "sdk/host/localizer/scale_update.hpp"
#include "sdk/host/localizer/tracker.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph {

/// A front-end's motions: rotation, scale and displacement, and how uncertain they leave the track.
class FrontEnd {
 public:
  struct Parameters {
    double drift_per_root_m = 0.01;  ///< m/sqrt(m), horizontal axes, without scale and heading (odograph bench vo)
    double height_drift_per_root_m = 0.02;  ///< the same downwards: 0.4 to 1.2 m over 700 m of three simulated walks
    double rotation_walk = 1e-3;  ///< rad/sqrt(s) of its heading: 0.018 deg a frame at 10 Hz (odograph bench vo)
    double inertial_rotation_walk = 1.5e-3;  ///< the same with inertia: 3 to 50 mrad over ten minutes of six real walks
    double start_rate_radps = 0.01;      ///< rad/s: gyroscope bias of a front-end with inertia before it has walked;
                                         ///< 4.6 to 17 mrad/s on four stabilised phones, below 1 without a stabiliser
    double walked_scale_sigma = 0.10;    ///< of log-scale: below it such a front-end has walked, and knows the metric
                                         ///< scale better than walkers differ, so that steps do not move it
    double lead_scale_sigma = 0.2;       ///< of log-scale: above, a front-end with inertia does not outweigh fixes
    double rotation_off_rad = 0.015;     ///< rad from the gyroscope's, above which a rotation is none of the phone;
                                         ///< stabilised lenses differ by 2 to 3 mrad; by hand
    double rotation_off_share = 0.05;    ///< of the rotation: the gyroscope's scale, a rolling shutter; by hand
    double tilt_time_s = 10;             ///< s over which the attitude levels a front-end without inertia; judgement
    double rewind_s = 1.5;               ///< s before the first metric motion that inertia covers: an inclination of
                                         ///< 5 mrad is 6 cm then; front-ends start in 1.2 s (odograph bench vo)
    double rewind_sigma_mps = 0.1;       ///< m/s of the velocity that is rewound
    double silent_start_s = 6.0;         ///< s after the first frame of a camera that has never moved
    double unstated_scale_sigma = 0.02;  ///< relative, of a metric front-end that states none; judgement
    double metric_scale_walk = 2e-4;     ///< 1/sqrt(s) of log-scale of a metric one: 0.5 % in ten minutes; judgement
    double scale_walk = 2e-3;            ///< 1/sqrt(m) of another: 0.9 % between halves of 10 m (odograph bench vo)
    double doubted_scale_walk = 0.015;   ///< 1/sqrt(m) of one whose metric scale contradicts the steps
    double walking_m = 0.5;              ///< m a second, above which the camera walks: half the slowest walk
  };

  FrontEnd(Tracker& tracker, LocalizerInputs inputs) : tracker_(tracker), inputs_(inputs), gyroscope_(tracker) {}
  void reset();
  /// Nothing was measured for a while: what waits for its scale is given up, since nobody knows how much of that time
  /// it is.
  void pause() { group_.take_waiting(); }
  void on_calibration(const odo_calibration& calibration);

  /// The camera begins: its first frame, or its first motion.
  void begin(int64_t t_ns, bool has_stepped);
  bool begun() const { return first_frame_ns_ != INT64_MIN; }

  struct Outcome {
    uint32_t state, reason;
    bool moved;             ///< the track, by a displacement in metres (or as the papers' do, in units)
    double moved_m;         ///< of the camera
    double caught_up_m;     ///< of that by motions before this one, which had no scale
    bool metric, inertial;  ///< the motion was
  };
  /// What the track is when a motion comes.
  struct Situation {
    bool shown;        ///< positions have been published
    bool placed;       ///< its place in n is known
    bool fixed;        ///< ... by a fix
    bool has_stepped;  ///< there are steps
  };
  Outcome apply(const RelativeMotion& relative, const Situation& track);
  GyroOrientation& gyroscope() { return gyroscope_; }
  /// A scale outside of a motion.
  UpdateResult apply(const odo_scale& scale);
  /// Whether its metric scale is judged by a step of that length; true where the verdict has changed.
  bool check_metres(const odo_step& step, const Eigen::Vector3d& moved_o);

  /// Nothing will come of the time until now.
  bool is_silent(int64_t now_ns) const;
  bool lost() const { return lost_; }
  bool moves() const { return moves_; }
  /// When it moved the track last; INT64_MIN before it did.
  int64_t moved_ns() const { return translated_ns_; }
  const ScaleGroup& group() const { return group_; }
  bool doubted() const { return metre_check_.doubted(); }
  bool knows_metres() const;  ///< steps are not to move its scale
  bool leads() const;
  int64_t leads_since_ns() const { return leads_since_ns_; }
  bool metric() const { return group_.metric; }
  ScaleUpdate& scale() { return scale_; }
  const ScaleUpdate& scale() const { return scale_; }
  const Eigen::Quaterniond& q_b_c() const { return q_b_c_; }
  const Eigen::Vector3d& p_b_c() const { return p_b_c_; }
  Eigen::Vector3d gyro_bias_b = Eigen::Vector3d::Zero(), accel_bias_b = Eigen::Vector3d::Zero();

 private:
  /// A motion while it is worked on.
  struct Moving {
    const odo_vo_motion& m;
    TrackPoint from;
    Eigen::Quaterniond q_o_c0, q_o_b1;
    double dt_s;
    bool metric, inertial, rotates, translates, rotation_known;
    uint32_t state, reason;
    Eigen::Vector3d d_o;     ///< of the camera, m
    double caught_up_m = 0;  ///< before it, that waited for its scale
    bool doubtful = false;   ///< what was not seen makes the track's place doubtful
  };
  Moving begin_motion(const odo_vo_motion& motion);
  std::optional<Eigen::Quaterniond> rotated(const Moving& moving);
  bool rotates_with_gyroscope(const odo_vo_motion& motion) const;
  double heading_variance(const Moving& moving) const;
  void level(Moving& moving) const;
  bool to_metres(Moving& moving, const odo_scale* scale);
  bool to_metres_as_in_papers(Moving& moving, const odo_scale* scale);
  double catch_up(const odo_scale* scale, bool horizontal, bool doubtful);
  bool is_impossible(const Moving& moving) const;
  void begin_here(const Moving& moving);
  void move(const Moving& moving, bool moves);
  bool walks(int64_t t_ns) const;

  Parameters p_;
  Tracker& tracker_;
  LocalizerInputs inputs_;
  Eigen::Quaterniond q_b_c_ = rear_camera_mount();
  Eigen::Vector3d p_b_c_ = Eigen::Vector3d::Zero();
  ScaleUpdate scale_;
  MetreCheck metre_check_;
  GyroOrientation gyroscope_;

  ScaleGroup group_;
  bool lost_ = false, moves_ = false;
  int64_t first_frame_ns_ = INT64_MIN, translated_ns_ = INT64_MIN, leads_since_ns_ = INT64_MIN;
  double blind_sigma_m_ = 0;  // of what it moved since it saw something
};

}  // namespace odograph
