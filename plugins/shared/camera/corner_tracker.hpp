// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace odograph {

/// Corners (Shi & Tomasi 1994) followed from frame to frame by pyramidal Lucas-Kanade (Bouguet 2000), forwards and
/// back, spread over the picture by a grid. Knows nothing of geometry.
class CornerTracker {
 public:
  struct Parameters {
    int most = 500;         ///< corners kept
    int cell_px = 32;       ///< at most one new corner a cell
    double quality = 0.01;  ///< relative to the best corner
    int window_px = 21;     ///< of Lucas-Kanade
    int levels = 4;         ///< of the pyramid
    double back_px = 0.7;   ///< largest forward-backward distance
  };
  struct Track {
    uint64_t id;
    cv::Point2f pixel;
  };

  explicit CornerTracker(const Parameters& parameters) : p_(parameters) {}

  /// Follows the corners into the next picture (8-bit grey), from where they were or, where given, from where they are
  /// expected (one for each track). What is lost is gone from tracks().
  void follow(const cv::Mat& grey, const std::vector<cv::Point2f>& expected = {});
  /// Instead, where the next picture shows nothing: all corners are gone, and refill() finds none in it.
  void skip();
  /// Fills the empty cells with new corners of the latest picture. `mask` may be empty.
  void refill(const cv::Mat& mask);
  /// Removes tracks for which `keep` is false (same order as tracks()).
  void drop(const std::vector<char>& keep);
  void clear();
  /// All of it, the picture too, to go on from later: pictures are otherwise shared between copies.
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
