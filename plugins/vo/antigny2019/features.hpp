// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace odograph::antigny2019 {

/// Points of a picture with their descriptors.
struct Features {
  std::vector<cv::Point2f> pixels;
  std::vector<float> strength;
  cv::Mat
      descriptors;  ///< one row each, CV_32F (compared by SSD) or CV_8U bits (by Hamming distance, which is their SSD)
};

/// Finds and describes feature points. One thread at a time.
class FeatureFinder {
 public:
  virtual ~FeatureFinder() = default;
  virtual Features find(const cv::Mat& grey, const cv::Mat& mask) = 0;
  /// `kind`: surf (Bay et al. 2006, as in dlib), sift, orb or akaze (as in OpenCV). `most` points, the strongest.
  static std::unique_ptr<FeatureFinder> make(const std::string& kind, int most);
};

/// Sparse selection: of each cell of the picture the strongest few, so that no rich corner of it rules.
Features sparse(const Features& all, cv::Size picture, int cell_px, int in_a_cell);

/// Pairs (index in `first`, index in `second`) that are each other's nearest, by sum of squared differences, and nearer
/// than `ratio` times the second nearest.
std::vector<std::pair<int, int>> match(const Features& first, const Features& second, double ratio);

}  // namespace odograph::antigny2019
