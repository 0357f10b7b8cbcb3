// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "plugins/shared/camera/camera_model.hpp"

namespace odograph::skyline {

/// What a pixel shows that tells sky from the rest: grey value against the sky's, texture at two scales, and how strong
/// the weakest barrier is that must be crossed to come here from the zenith.
struct SkyFeatures {
  static constexpr int kCount = 14;
  /// About this many columns or rows, whichever is larger: a pixel is then half a degree of a wide lens.
  static constexpr int kLonger_px = 320;

  cv::Mat channels[kCount];  ///< CV_32F, all of the small picture's size
  cv::Mat valid;             ///< CV_8U, 255 where the lens's calibration means something and no mask forbids
  double scale = 1;          ///< pixels of the picture for one of the small one

  /// Pixel of the small picture for one of the picture.
  Eigen::Vector2d small_of(const Eigen::Vector2d& pixel) const {
    return (pixel.array() + 0.5).matrix() / scale - Eigen::Vector2d(0.5, 0.5);
  }
};

/// What is sky at the zenith. The networks were taught with these values: others want another training
/// (docs/sky_network.md).
struct SkyReferenceParameters {
  double part = 0.10;           ///< of the picture, around the zenith, is asked what the sky looks like
  double noise_quantile = 0.5;  ///< of the contrast there: the smoother part of it counts
  double sky_quantile = 0.7;    ///< of the grey values of that: the sky's
  double seed_quantile = 0.3;   ///< of them: what is darker is no seed
  double min_part = 0.002;      ///< of the picture must be left as seeds
  size_t min_valid = 100;       ///< pixels: fewer tell no reference
};

/// Computes the features of picture after picture of one camera. Thread: one at a time.
class SkyFeatureMaker {
 public:
  /// `farthest_rad`: from the optical axis; what lies beyond is the rim of a fisheye lens and shows nothing.
  SkyFeatureMaker(const CameraModel& camera, cv::Size size, double farthest_rad);

  /// `grey`: 8-bit; `mask`: 0 where the picture is not to be used, may be empty; `up_c`: the zenith's direction in c,
  /// unit. False where nothing of the picture lies near the zenith and is smooth enough to be sky: no reference then.
  /// Without `around` the channels of wide surroundings (3 and from 10 on) are left as they are.
  bool make(const cv::Mat& grey, const cv::Mat& mask, const Eigen::Vector3d& up_c, SkyFeatures& out,
            bool around = true);

 private:
  /// What the sky looks like, by what lies nearest to the zenith.
  struct Reference {
    std::vector<int> seeds;  ///< pixels that are sky
    int sky = 0, noise = 0;  ///< its grey value and contrast
  };
  void prepare(const cv::Mat& grey, const cv::Mat& mask, SkyFeatures& out);
  std::optional<Reference> find_reference(const std::vector<float>& height, const cv::Mat& valid) const;
  void flood(const cv::Mat& contrast, const std::vector<int>& seeds);
  void spread(int side, cv::Mat& mean, cv::Mat& to);

  SkyReferenceParameters p_;
  cv::Size size_, small_;
  double scale_;
  cv::Mat lens_valid_;                 // 255 where a ray is known
  std::vector<Eigen::Vector3f> rays_;  // of the small picture's pixels, unit
  cv::Mat image_, blurred_, low_, high_, contrast_, level_, float_, mean_, square_;
  std::vector<std::vector<int>> queue_;  // pixels to be flooded, by barrier
};

/// Unit ray of a pixel; false beyond `farthest_rad` from the optical axis or where the lens's polynomial turns back.
bool ray_of(const CameraModel& camera, const Eigen::Vector2d& pixel, double farthest_rad, Eigen::Vector3d& ray);
/// Pixel of a unit ray; false as above. Unlike CameraModel::project it knows rays near and beyond 90 degrees.
bool pixel_of(const CameraModel& camera, const Eigen::Vector3d& ray, double farthest_rad, Eigen::Vector2d& pixel);

}  // namespace odograph::skyline
