// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "plugins/shared/camera/camera_model.hpp"
#include "plugins/shared/camera/picture_content.hpp"
#include "plugins/vo/odograph/inertial/filter.hpp"
#include "plugins/vo/odograph/inertial/patch.hpp"

namespace odograph::vio {

/// Tracks corners from frame to frame. The gyroscope's rotation and their last parallax predict their positions;
/// corners that no single translation explains together with that rotation are rejected (two-point RANSAC, Troiani et
/// al. 2014).
class GuidedCorners {
 public:
  struct Parameters {
    int max_corners = 220;        ///< max corners
    int cell_px = 28;             ///< at most one new corner per cell
    double min_distance_px = 10;  ///< between new corners
    double quality = 0.01;        ///< relative to the best corner
    int block_px = 3;             ///< neighbourhood of the corner measure, in the picture of half the size
    int window_px = 13;           ///< of Lucas-Kanade
    int levels = 3;               ///< of the pyramid
    double settled_px = 0.01;     ///< convergence threshold of the last step
    int light_px = 11;            ///< window for comparing the brightness around a corner between frames; empirical
    double light_change = 0.03;   ///< median brightness change above which Lucas-Kanade, which assumes constant
                                  ///< brightness, gets a corrected picture; empirical
    double back_px = 0.7;         ///< max forward-backward error
    Patch::Parameters patch;      ///< match of a corner against the picture in which it was found
    double reference_error = 6;   ///< grey levels, mean: a corner whose patch differs by more is dropped
    double reference_px = 1.5;    ///< max correction of a corner by its patch
    double min_growth = 0.5, max_growth = 3;  ///< of the area, before a new patch is taken
    double refill_below = 0.7;                ///< of `max_corners`
    double epipolar_px = 2.0;                 ///< max distance of an inlier from the epipolar line
    int trials = 40;                          ///< of RANSAC: 0.9999 with half of the corners wrong
    size_t min_for_ransac = 10;               ///< corners
    double min_inliers = 0.4;  ///< min share: below it the rotation is assumed wrong, and none is rejected; empirical
    PictureContent::Parameters content;       ///< with less content nothing is tracked
    double dim_grey = 60, dim_blur_px = 1.5;  ///< at night the noise has a larger gradient than the scene
  };

  explicit GuidedCorners(const Parameters& parameters) : p_(parameters) {}

  /// `q_c0_c1`: rotation of the camera since the previous frame; `shift_px`: shift of the picture by a stabilised lens;
  /// `lens`: lens of this picture.
  const FrameCorners& follow(const cv::Mat& grey, const cv::Mat& mask, int64_t t_ns, double dt_s,
                             const Eigen::Quaterniond& q_c0_c1, const Eigen::Vector2d& shift_px,
                             const CameraModel& lens);
  /// In the latest frame's own pixels.
  const FrameCorners& corners() const { return corners_; }
  /// Number of corners of the previous frame that are still tracked.
  size_t followed() const { return followed_; }
  bool too_dark() const { return !content_.has_content(p_.content); }

 private:
  struct Track {
    uint64_t id = 0;
    cv::Point2f pixel;
    size_t patch = 0;                                    ///< index in patches_
    Patch::Map map;                                      ///< of the patch in the latest picture
    bool known = false;                                  ///< the patch is valid
    Eigen::Vector3d ray = Eigen::Vector3d::Zero();       ///< z = 1
    Eigen::Vector2d turned = Eigen::Vector2d::Zero();    ///< position by rotation and lens shift alone, px
    Eigen::Vector2d parallax = Eigen::Vector2d::Zero();  ///< motion beyond that, px/s
  };
  using Pyramid = std::vector<cv::Mat>;

  void predict(const Eigen::Quaterniond& q_c0_c1, const Eigen::Vector2d& shift_px, const CameraModel& before,
               double dt_s, std::vector<cv::Point2f>& to);
  double brightness_ratio(const std::vector<cv::Point2f>& to) const;
  const Pyramid& correct_brightness(double ratio);
  void track_forward(const Pyramid& now, std::vector<cv::Point2f>& to);
  void refine_by_patch(const cv::Mat& picture, const Eigen::Quaterniond& q_c0_c1);
  void drop_outliers(const Eigen::Quaterniond& q_c0_c1, const Eigen::Vector2d& shift_px);
  void refill(const cv::Mat& picture, const cv::Mat& mask);
  void keep_only(const std::vector<char>& keep);

  Parameters p_;
  Pyramid before_, now_, brightness_corrected_;
  std::vector<Track> tracks_;
  std::vector<Patch> patches_;
  std::vector<size_t> free_patches_;
  FrameCorners corners_;
  cv::Mat smooth_;
  CameraModel lens_;  ///< of the latest picture
  uint64_t next_id_ = 0;
  size_t followed_ = 0;
  PictureContent content_;
};

}  // namespace odograph::vio
