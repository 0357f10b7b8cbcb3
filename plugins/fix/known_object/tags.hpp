// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace odograph::known_object {

/// A detected tag.
struct SeenTag {
  std::string family;
  int number = 0;
  std::array<cv::Point2f, 4> corners;  ///< lower left, lower right, upper right, upper left of the black border, px
};

/// AprilTag's detector (Wang & Olson, IROS 2016) for the families 36h11, 25h9 and 16h5. Not thread-safe.
class TagDetector {
 public:
  struct Parameters {
    int wrong_bits = 1;     ///< max per tag
    float min_margin = 25;  ///< of a bit's grey value against black and white, as AprilTag recommends
  };
  /// Throws std::runtime_error for an unknown family.
  explicit TagDetector(const std::vector<std::string>& families);
  ~TagDetector();
  TagDetector(const TagDetector&) = delete;
  TagDetector& operator=(const TagDetector&) = delete;

  /// All tags with few wrong bits and enough contrast.
  std::vector<SeenTag> find(const cv::Mat& grey) const;

 private:
  struct Library;
  Parameters p_;
  std::unique_ptr<Library> library_;
};

}  // namespace odograph::known_object
