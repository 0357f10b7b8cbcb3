// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "plugins/shared/camera/camera_model.hpp"
#include "plugins/shared/camera/picture_content.hpp"
#include "plugins/vo/odograph/inertial/filter.hpp"
#include "plugins/vo/odograph/inertial/patch.hpp"

namespace odograph::vio {

/// Follows corners from frame to frame from where the gyroscope's rotation and their last parallax put them; takes out
/// those that no one translation explains together with that rotation (two-point RANSAC, Troiani et al. 2014).
class GuidedCorners {
 public:
  struct Parameters {
    int most = 220;               ///< corners kept
    int cell_px = 28;             ///< at most one new corner a cell
    double min_distance_px = 10;  ///< between new corners
    double quality = 0.01;        ///< relative to the best corner
    int block_px = 3;             ///< over which a corner is looked at, of the picture of half the size
    int window_px = 13;           ///< of Lucas-Kanade
    int levels = 3;               ///< of the pyramid
    double settled_px = 0.01;     ///< its last step
    int light_px = 11;  ///< window over which the brightness about a corner is compared between frames; by hand
    double light_change = 0.03;  ///< its median ratio: more, and Lucas-Kanade, which knows no change of light, is given
                                 ///< a picture without it; by hand
    double back_px = 0.7;        ///< largest distance between the way there and the way back
    Patch::Parameters patch;     ///< of a corner against the picture where it was found
    double reference_error = 6;  ///< grey levels, mean: what looks otherwise than where it was found is dropped
    double reference_px = 1.5;   ///< most that the reference moves a corner
    double min_growth = 0.5, max_growth = 3;  ///< in area, until a corner's patch is taken anew
    double refill_below = 0.7;                ///< of `most`
    double epipolar_px = 2.0;                 ///< distance from the epipolar line of an inlier
    int trials = 40;                          ///< of RANSAC: 0.9999 with half of the corners wrong
    size_t min_for_ransac = 10;               ///< corners
    double min_inliers = 0.4;  ///< of them: fewer, and it is the rotation that is wrong, nobody is taken out; by hand
    PictureContent::Parameters content;       ///< less of it, and nothing is followed
    double dim_grey = 60, dim_blur_px = 1.5;  ///< by night the noise has more gradient than what is there
  };

  explicit GuidedCorners(const Parameters& parameters) : p_(parameters) {}

  /// `q_c0_c1`: the camera's rotation since the frame before; `shift_px`: what a stabilised lens moved the picture;
  /// `lens`: the one that took the picture.
  const FrameCorners& follow(const cv::Mat& grey, const cv::Mat& mask, int64_t t_ns, double dt_s,
                             const Eigen::Quaterniond& q_c0_c1, const Eigen::Vector2d& shift_px,
                             const CameraModel& lens);
  /// In the latest frame's own pixels.
  const FrameCorners& corners() const { return corners_; }
  /// Of the corners of the frame before, those that are still followed.
  size_t followed() const { return followed_; }
  bool too_dark() const { return !content_.shows_something(p_.content); }

 private:
  struct Track {
    uint64_t id = 0;
    cv::Point2f pixel;
    size_t patch = 0;                                    ///< of patches_
    Patch::Map map;                                      ///< of the patch in the latest picture
    bool known = false;                                  ///< there is a patch
    Eigen::Vector3d ray = Eigen::Vector3d::Zero();       ///< z = 1
    Eigen::Vector2d turned = Eigen::Vector2d::Zero();    ///< where rotation and shift alone put it, px
    Eigen::Vector2d parallax = Eigen::Vector2d::Zero();  ///< of the rest, px/s
  };
  using Pyramid = std::vector<cv::Mat>;

  void predict(const Eigen::Quaterniond& q_c0_c1, const Eigen::Vector2d& shift_px, const CameraModel& before,
               double dt_s, std::vector<cv::Point2f>& to);
  double light_ratio(const std::vector<cv::Point2f>& to) const;
  const Pyramid& relit(double ratio);
  void track_forward(const Pyramid& now, std::vector<cv::Point2f>& to);
  void refine_by_patch(const cv::Mat& picture, const Eigen::Quaterniond& q_c0_c1);
  void drop_outliers(const Eigen::Quaterniond& q_c0_c1, const Eigen::Vector2d& shift_px);
  void refill(const cv::Mat& picture, const cv::Mat& mask);
  void keep_only(const std::vector<char>& keep);

  Parameters p_;
  Pyramid before_, now_, relit_;
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
