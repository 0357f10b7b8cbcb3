// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include <opencv2/core.hpp>

#include "plugins/camera/camera_model.hpp"
#include "plugins/camera/corner_tracker.hpp"
#include "plugins/vo/odograph/inertial/filter.hpp"

namespace odograph::vio {

/// Follows corners from frame to frame from where the gyroscope's rotation and their last parallax put them; takes out
/// those that no one translation explains together with that rotation (two-point RANSAC, Troiani et al. 2014).
class GuidedCorners {
 public:
  struct Parameters {
    CornerTracker::Parameters tracker{
        .most = 220, .cell_px = 28, .quality = 0.01, .window_px = 19, .levels = 3, .back_px = 0.7};
    double refill_below = 0.85;  ///< of `most`
    double epipolar_px = 2.0;    ///< distance from the epipolar line of an inlier
    int trials = 40;
    double dim_grey = 60, dim_blur_px = 1.5;  ///< by night the noise has more gradient than what is there
  };

  explicit GuidedCorners(const Parameters& parameters) : p_(parameters), tracker_(parameters.tracker) {}

  /// `q_c0_c1`: the camera's rotation since the frame before.
  const FrameCorners& follow(const cv::Mat& grey, const cv::Mat& mask, int64_t t_ns, double dt_s,
                             const Eigen::Quaterniond& q_c0_c1, const CameraModel& lens);
  const FrameCorners& corners() const { return corners_; }
  /// Of the corners of the frame before, those that are still followed.
  size_t followed() const { return followed_; }
  double mean_grey() const { return tracker_.mean_grey(); }

 private:
  Parameters p_;
  CornerTracker tracker_;
  cv::Mat smooth_;
  std::map<uint64_t, Eigen::Vector2d> parallax_px_s_;  // of what the rotation left over, last
  FrameCorners corners_;
  size_t followed_ = 0;
};

}  // namespace odograph::vio
