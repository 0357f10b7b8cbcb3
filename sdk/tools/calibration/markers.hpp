// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include <opencv2/core.hpp>

struct apriltag_family;

namespace odograph {

/// A dictionary of square markers: AprilTag families, which ArUco calls DICT_APRILTAG_36h11 and so on.
class MarkerFamily {
 public:
  explicit MarkerFamily(const std::string& name);
  ~MarkerFamily();
  MarkerFamily(const MarkerFamily&) = delete;
  MarkerFamily& operator=(const MarkerFamily&) = delete;

  explicit operator bool() const { return family_ != nullptr; }
  size_t count() const;
  /// The marker's cells including its black border: 0 or 255.
  cv::Mat picture(size_t id) const;
  apriltag_family* raw() const { return family_; }

 private:
  std::string name_;
  apriltag_family* family_ = nullptr;
};

/// A detected marker, px.
struct SeenMarker {
  size_t id;
  std::array<cv::Point2d, 4> corners;  ///< of the upright marker: lower left, lower right, upper right, upper left
};

}  // namespace odograph
