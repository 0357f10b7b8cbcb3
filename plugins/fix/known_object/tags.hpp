// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace odograph::known_object {

/// A tag in a picture.
struct SeenTag {
  std::string family;
  int number = 0;
  std::array<cv::Point2f, 4> corners;  ///< lower left, lower right, upper right, upper left of the black border, px
};

/// AprilTag's detector (Wang & Olson, IROS 2016) for the families 36h11, 25h9 and 16h5. One thread at a time.
class TagDetector {
 public:
  /// Throws std::runtime_error for a family that is not known.
  explicit TagDetector(const std::vector<std::string>& families);
  ~TagDetector();
  TagDetector(const TagDetector&) = delete;
  TagDetector& operator=(const TagDetector&) = delete;

  /// All tags with at most one wrong bit and enough contrast.
  std::vector<SeenTag> find(const cv::Mat& grey) const;

 private:
  struct Library;
  std::unique_ptr<Library> library_;
};

}  // namespace odograph::known_object
