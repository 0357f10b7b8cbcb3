// SPDX-License-Identifier: Apache-2.0
//
// Every number of the visual odometry that could be another one. "By hand": chosen on simulated and real clips while
// the odometry was written; no sweep of it is recorded.
#pragma once

#include <cstddef>
#include <cstdint>

#include "plugins/shared/camera/corner_tracker.hpp"
#include "plugins/shared/camera/picture_content.hpp"

namespace odograph::vo {

/// Pictures that tell little. Grey values are means of 0 to 255.
struct LightParameters {
  PictureContent::Parameters content;  ///< less of it, and nothing is followed
  double dim_grey = 60;      ///< below it the picture is smoothed: the noise has more gradient than the scene; by hand
  double dim_blur_px = 1.5;  ///< standard deviation of that Gaussian; by hand
};

/// What a gyroscope's rotation may be off by.
struct GyroscopeParameters {
  int64_t longest_gap_ns = 60'000'000;    ///< between samples: more, and the rotation is unknown; by hand
  double angle_random_walk = 5e-4;        ///< rad/sqrt(s); twice the 2.4e-4 of an old phone
  double scale_error = 5e-3;              ///< of the angle: BMI270, ICM-20602 0.4 to 1 %, calibrated in phones
  double timing_rad = 2e-4;               ///< of every rotation: time stamps; by hand
  double bias_sigma_radps = 0.01;         ///< before anything is known: 0.6 deg/s
  double known_bias_sigma_radps = 5e-4;   ///< no rotation of a picture makes it smaller; by hand
  double known_bias_drift_radps = 0.003;  ///< by which a lost camera's rotation gets less known; by hand
  double learn_bias_after_s = 0.4;        ///< of rotation alone; by hand
};

/// Standard deviation of a corner in the picture: it depends on the light and is learnt.
struct CornerNoiseParameters {
  double begin_px = 0.4;              ///< of a corner followed by day; by hand
  double min_px = 0.3, max_px = 1.2;  ///< that are believed; by hand
  double learn = 0.1;                 ///< weight of the newest frame; by hand
  double coarser = 1.3;               ///< factor after a frame that only coarser corners explain; by hand
};

/// Two views become a map.
struct MapStartParameters {
  double min_parallax_rad = 0.004;  ///< median: 2 px with a focal length of 500 px, five sigmas of a corner
  double worth_trying = 0.25;       ///< of min_parallax_rad, that one rotation leaves over: below, no RANSAC
  int trials = 200;                 ///< of the five-point RANSAC: 0.998 with half the matches wrong
  double inlier_sigmas = 3;         ///< distance of an epipolar inlier
  double min_inliers = 0.5;         ///< of the matches
  /// Of the parallax: a false displacement can be made up for by a false rotation, but by no larger one.
  double rotation_agrees = 1.5;
  double rotation_sigma = 0.25;       ///< of the parallax: what a start leaves of the rotation; `odograph bench vo`
  double displacement_sigma = 0.1;    ///< relative, of the first displacement; by hand
  double triangulation_error = 0.02;  ///< largest of a point, normalized; by hand
};

/// Iterations of fit_pose.
struct PoseFitParameters {
  int iterations = 12, min_iterations = 6;
  double shrink = 0.4;        ///< of the loss's scale by an iteration (graduated non-convexity); by hand
  double min_scale = 2.5;     ///< of the loss, sigmas; by hand
  double inlier_sigmas = 3;   ///< 1.1 % of good points are farther off (Rayleigh)
  double settled_rad = 1e-7;  ///< last step
};

/// The camera is placed by the map.
struct PoseParameters {
  int min_points = 12;        ///< that agree: four times what three-point pose needs; by hand
  double min_inliers = 0.25;  ///< of the points with a depth, of a pose
  double good_inliers = 0.5;  ///< of them, of a fit beside which no other is tried
  double loose_px = 8;        ///< that a prediction may be off; by hand
  double coarse = 2.5;        ///< factor of a corner's sigma that is tried next: blur, night; by hand
  double ransac_sigmas = 4;   ///< of P3P's inliers
  int ransac_trials = 200;
  double ransac_confidence = 0.999;
  double after_ransac = 0.3;  ///< of loose_px, from where P3P puts the camera; by hand
  double surprise_rad = 0.5;  ///< most that a frame rotates otherwise than predicted; by hand
  int max_misses = 2;         ///< frames in a row that contradict a point: with the next it is dropped
  /// Of the points, while the first window fills: fewer that agree in more than max_doubts frames in a row, and the
  /// map's start from little parallax was a false one; by hand.
  double doubtful_inliers = 0.72;
  int max_doubts = 1;
  double rotation_floor_rad = 1e-4;  ///< of a motion: time stamps, displacement between rows; `odograph bench vo`
  PoseFitParameters fit;
};

struct KeyframeParameters {
  size_t window = 8;                  ///< keyframes; their adjustment takes about 5 ms
  double parallax_rad = 0.012;        ///< median since the last keyframe; by hand
  double few_left = 0.6;              ///< of the corners or points of the last keyframe; by hand
  double standing = 0.004;            ///< of the median depth: keyframes nearer to each other are one place; by hand
  double point_parallax_rad = 0.002;  ///< of a point whose depth shall count: half that of a start
  double triangulation_error = 0.02;  ///< largest of a point, normalized; by hand
  double outlier_sigmas = 4;          ///< that an adjustment leaves over of a wrong observation
  double farthest = 200;              ///< median depths: farther is as good as infinitely far
};

/// Adjustment of the window of keyframes.
struct AdjustmentParameters {
  int iterations = 6;                ///< of Levenberg-Marquardt: the window was adjusted a keyframe ago; by hand
  double function_tolerance = 1e-4;  ///< relative change of the cost that ends it; by hand
  double cauchy_sigmas = 1.5;        ///< scale of the loss; by hand
  double bias_sigma_radps = 0.01;    ///< about the last window's bias, which began at none
  double baseline_sigma = 1e-3;      ///< relative: holds the scale until the first keyframe has left the window
  double min_inverse_depth = 1e-6;
  double min_depth = 1e-3;  ///< of a point's anchor depth: nearer is behind the camera
};

struct RelocaliseParameters {
  double patience_s = 1.0;   ///< then a new map begins: long enough for a passer-by; by hand
  double min_inliers = 0.4;  ///< of the points of the keyframe: a few that agree are no place; by hand
};

struct OdometryParameters {
  CornerTracker::Parameters corners{
      .most = 250, .cell_px = 28, .quality = 0.01, .window_px = 19, .levels = 3, .back_px = 0.7};  ///< by hand
  LightParameters light;
  GyroscopeParameters gyroscope;
  CornerNoiseParameters noise;
  MapStartParameters start;
  PoseParameters pose;
  KeyframeParameters keyframe;
  AdjustmentParameters adjustment;
  RelocaliseParameters relocalise;
};

}  // namespace odograph::vo
