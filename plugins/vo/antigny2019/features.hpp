// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace odograph::antigny2019 {

/// Feature points of a picture with their descriptors.
struct Features {
  std::vector<cv::Point2f> pixels;
  std::vector<float> strength;
  cv::Mat
      descriptors;  ///< one row each, CV_32F (compared by SSD) or CV_8U bits (by Hamming distance, which is their SSD)
};

/// Detects and describes feature points. Not thread-safe.
class FeatureFinder {
 public:
  virtual ~FeatureFinder() = default;
  virtual Features find(const cv::Mat& grey, const cv::Mat& mask) = 0;
  /// `kind`: surf (Bay et al. 2006, dlib's), sift, orb or akaze (OpenCV's). Returns at most the `most` strongest
  /// points.
  static std::unique_ptr<FeatureFinder> make(const std::string& kind, int most);
};

/// Sparse selection: keeps the strongest `in_a_cell` points of each cell, so that one textured region does not
/// dominate.
Features sparse(const Features& all, cv::Size picture, int cell_px, int in_a_cell);

/// Pairs (index in `first`, index in `second`) that are mutual nearest neighbours by sum of squared differences and
/// pass the ratio test: nearer than `ratio` times the second nearest.
std::vector<std::pair<int, int>> match(const Features& first, const Features& second, double ratio);

}  // namespace odograph::antigny2019
