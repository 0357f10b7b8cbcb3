// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <vector>

#include <opencv2/core.hpp>

#include "plugins/camera/camera_model.hpp"
#include "plugins/vo/odograph/inertial/filter.hpp"

namespace odograph::vio {

/// Follows corners from frame to frame from where the gyroscope's rotation and their last parallax put them; takes out
/// those that no one translation explains together with that rotation (two-point RANSAC, Troiani et al. 2014).
class GuidedCorners {
 public:
  struct Parameters {
    int most = 220;              ///< corners kept
    int cell_px = 28;            ///< at most one new corner a cell
    double quality = 0.01;       ///< relative to the best corner
    int window_px = 15;          ///< of Lucas-Kanade
    int levels = 3;              ///< of the pyramid
    double back_px = 0.7;        ///< largest distance between the way there and the way back
    int reference_levels = 1;    ///< of the pyramid, against the picture where the corner was found
    double reference_error = 6;  ///< grey levels, mean: what looks otherwise than where it was found is dropped
    double reference_px = 1.5;   ///< most that the reference moves a corner
    size_t references = 8;       ///< frames that a corner is compared with its first picture
    double refill_below = 0.85;  ///< of `most`
    double epipolar_px = 2.0;    ///< distance from the epipolar line of an inlier
    int trials = 40;
    double dark_grey = 8;
    double dim_grey = 60, dim_blur_px = 1.5;  ///< by night the noise has more gradient than what is there
  };

  explicit GuidedCorners(const Parameters& parameters) : p_(parameters) {}

  /// `q_c0_c1`: the camera's rotation since the frame before.
  const FrameCorners& follow(const cv::Mat& grey, const cv::Mat& mask, int64_t t_ns, double dt_s,
                             const Eigen::Quaterniond& q_c0_c1, const CameraModel& lens);
  const FrameCorners& corners() const { return corners_; }
  /// Of the corners of the frame before, those that are still followed.
  size_t followed() const { return followed_; }
  double mean_grey() const { return mean_grey_; }

 private:
  struct Track {
    uint64_t id = 0;
    cv::Point2f pixel;
    uint32_t reference = 0;  ///< frame where it was found
    cv::Point2f reference_pixel;
    Eigen::Vector3d ray = Eigen::Vector3d::Zero();       ///< z = 1
    Eigen::Vector2d turned = Eigen::Vector2d::Zero();    ///< where the rotation alone puts it, px
    Eigen::Vector2d parallax = Eigen::Vector2d::Zero();  ///< of the rest, px/s
  };
  using Pyramid = std::vector<cv::Mat>;

  void predict(const Eigen::Quaterniond& q_c0_c1, const CameraModel& lens, double dt_s, std::vector<cv::Point2f>& to);
  void track_forward(const Pyramid& now, std::vector<cv::Point2f>& to);
  void refine_by_reference(const Pyramid& now);
  void drop_outliers(const Eigen::Quaterniond& q_c0_c1, const CameraModel& lens);
  void refill(const cv::Mat& picture, const cv::Mat& mask);

  Parameters p_;
  std::deque<std::pair<uint32_t, Pyramid>> pictures_;  ///< the latest
  std::vector<Track> tracks_;
  FrameCorners corners_;
  cv::Mat smooth_;
  uint64_t next_id_ = 0;
  uint32_t frame_ = 0;
  size_t followed_ = 0;
  double mean_grey_ = 0;
};

}  // namespace odograph::vio
