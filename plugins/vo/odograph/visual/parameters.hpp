// SPDX-License-Identifier: Apache-2.0
//
// All parameters of the visual odometry. "Empirical": chosen on simulated and real clips during development; no
// parameter sweep is recorded.
#pragma once

#include <cstddef>
#include <cstdint>

#include "plugins/shared/camera/corner_tracker.hpp"
#include "plugins/shared/camera/picture_content.hpp"

namespace odograph::vo {

/// Pictures with little information. Grey values are means of 0 to 255.
struct LightParameters {
  PictureContent::Parameters content;  ///< with less content nothing is tracked
  /// Below it the picture is smoothed: the noise has a larger gradient than the scene; empirical.
  double dim_grey = 60;
  double dim_blur_px = 1.5;  ///< standard deviation of that Gaussian; empirical
};

/// Error model of a gyroscope's rotation.
struct GyroscopeParameters {
  int64_t longest_gap_ns = 60'000'000;    ///< between samples; beyond it the rotation is unknown; empirical
  double angle_random_walk = 5e-4;        ///< rad/sqrt(s); twice the 2.4e-4 of an old phone
  double scale_error = 5e-3;              ///< of the angle: BMI270, ICM-20602 0.4 to 1 %, calibrated in phones
  double timing_rad = 2e-4;               ///< of every rotation: time stamps; empirical
  double bias_sigma_radps = 0.01;         ///< before the first estimate: 0.6 deg/s
  double known_bias_sigma_radps = 5e-4;   ///< lower bound from the rotation of a picture; empirical
  double known_bias_drift_radps = 0.003;  ///< uncertainty of the rate while the camera is lost; empirical
  double min_bias_s = 0.4;                ///< of pure rotation; empirical
};

/// Standard deviation of a corner in the picture, estimated online because it depends on the light.
struct CornerNoiseParameters {
  double begin_px = 0.4;              ///< initial: a corner tracked in daylight; empirical
  double min_px = 0.3, max_px = 1.2;  ///< limits of the estimate; empirical
  double update_weight = 0.1;         ///< weight of the newest frame; empirical
  double coarser = 1.3;               ///< factor after a frame that only a larger noise explains; empirical
};

/// Starting a map from two views.
struct MapStartParameters {
  double min_parallax_rad = 0.004;   ///< median: 2 px with a focal length of 500 px, five sigmas of a corner
  double min_parallax_ratio = 0.25;  ///< min residual parallax after one rotation, of min_parallax_rad, to run RANSAC
  int trials = 200;                  ///< of the five-point RANSAC: 0.998 with half of the matches wrong
  double inlier_sigmas = 3;          ///< epipolar distance of an inlier
  double min_inliers = 0.5;          ///< of the matches
  /// Of the parallax. A wrong rotation may compensate a wrong displacement, but not by more than this.
  double rotation_agrees = 1.5;
  double rotation_sigma = 0.25;       ///< of the parallax: rotation error after a start; `odograph bench vo`
  double displacement_sigma = 0.1;    ///< relative, of the first displacement; empirical
  double triangulation_error = 0.02;  ///< max reprojection error of a point, normalized; empirical
};

/// Iterations of fit_pose.
struct PoseFitParameters {
  int iterations = 12, min_iterations = 6;
  double shrink = 0.4;        ///< factor on the scale of the loss per iteration (graduated non-convexity); empirical
  double min_scale = 2.5;     ///< of the loss, sigmas; empirical
  double inlier_sigmas = 3;   ///< 1.1 % of correct points are farther off (Rayleigh)
  double settled_rad = 1e-7;  ///< convergence threshold of a step
};

/// Pose estimation by the map.
struct PoseParameters {
  int min_points = 12;        ///< min agreeing points: four times what P3P needs; empirical
  double min_inliers = 0.25;  ///< min share of the points with a depth
  double good_inliers = 0.5;  ///< share of them above which no other fit is tried
  double loose_px = 8;        ///< max error of a prediction; empirical
  double coarse = 2.5;        ///< factor on the corner noise for the second attempt: blur, night; empirical
  double ransac_sigmas = 4;   ///< of an inlier of P3P
  int ransac_trials = 200;
  double ransac_confidence = 0.999;
  double after_ransac = 0.3;       ///< of loose_px, after P3P; empirical
  double max_deviation_rad = 0.5;  ///< max deviation of a frame's rotation from the prediction; empirical
  int max_misses = 2;              ///< consecutive frames that may contradict a point; the next one drops it
  /// Min share of agreeing points while the first window fills: less in more than max_suspect_frames consecutive frames
  /// means that the start from little parallax was wrong; empirical.
  double suspect_inliers = 0.72;
  int max_suspect_frames = 1;
  double rotation_floor_rad = 1e-4;  ///< of a motion: time stamps, displacement between rows; `odograph bench vo`
  PoseFitParameters fit;
};

struct KeyframeParameters {
  size_t window = 8;            ///< keyframes; adjusting them takes about 5 ms
  double parallax_rad = 0.012;  ///< median since the last keyframe; empirical
  double few_left = 0.6;        ///< share of the corners or points of the last keyframe; empirical
  double standing = 0.004;  ///< of the median depth: keyframes nearer to each other count as one position; empirical
  double point_parallax_rad = 0.002;  ///< min of a point for its depth to be used: half that of a start
  double triangulation_error = 0.02;  ///< max reprojection error of a point, normalized; empirical
  double outlier_sigmas = 4;          ///< residual after an adjustment above which an observation is an outlier
  double farthest = 200;              ///< median depths: practically at infinity
};

/// Adjustment of the window of keyframes.
struct AdjustmentParameters {
  int iterations = 6;                ///< of Levenberg-Marquardt: the window was adjusted one keyframe ago; empirical
  double function_tolerance = 1e-4;  ///< relative change of the cost at which it stops; empirical
  double cauchy_sigmas = 1.5;        ///< scale of the loss; empirical
  double bias_sigma_radps = 0.01;    ///< about the previous window's bias, initially zero
  double baseline_sigma = 1e-3;      ///< relative: fixes the scale until the first keyframe has left the window
  double min_inverse_depth = 1e-6;
  double min_depth = 1e-3;  ///< of a point in its anchor: below it counts as behind the camera
};

struct RelocaliseParameters {
  double patience_s = 1.0;   ///< until a new map starts: longer than a passer-by occludes; empirical
  double min_inliers = 0.4;  ///< share of the keyframe's points, below which the match is rejected; empirical
};

struct OdometryParameters {
  CornerTracker::Parameters corners{
      .max_corners = 250, .cell_px = 28, .quality = 0.01, .window_px = 19, .levels = 3, .back_px = 0.7};  ///< empirical
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
