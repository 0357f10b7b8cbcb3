// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace odograph {

/// Corners (Shi & Tomasi 1994) tracked from frame to frame by forward-backward pyramidal Lucas-Kanade (Bouguet 2000),
/// spread over the picture by a grid. Applies no geometric check.
class CornerTracker {
 public:
  struct Parameters {
    int max_corners = 500;  ///< max corners
    int cell_px = 32;       ///< at most one new corner per cell
    double quality = 0.01;  ///< relative to the best corner
    int window_px = 21;     ///< of Lucas-Kanade
    int levels = 4;         ///< of the pyramid
    double back_px = 0.7;   ///< max forward-backward error
  };
  struct Track {
    uint64_t id;
    cv::Point2f pixel;
  };

  explicit CornerTracker(const Parameters& parameters) : p_(parameters) {}

  /// Tracks the corners into the next picture (8-bit grey), starting from their last positions or, if given, from the
  /// expected ones (one per track). Lost tracks are removed from tracks().
  void follow(const cv::Mat& grey, const std::vector<cv::Point2f>& expected = {});
  /// Call instead if the next picture shows nothing: removes all corners, and refill() finds none in it.
  void skip();
  /// Detects new corners of the latest picture in empty cells. `mask` may be empty.
  void refill(const cv::Mat& mask);
  /// Removes tracks for which `keep` is false (same order as tracks()).
  void drop(const std::vector<char>& keep);
  void clear();
  /// Deep copy, the picture included, to resume from later: ordinary copies share pictures.
  CornerTracker snapshot() const;

  const std::vector<Track>& tracks() const { return tracks_; }

 private:
  Parameters p_;
  std::vector<cv::Mat> pyramid_, next_pyramid_;
  cv::Mat latest_;
  std::vector<Track> tracks_;
  uint64_t next_id_ = 0;
};

}  // namespace odograph
