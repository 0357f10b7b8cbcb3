// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace odograph {

/// The corners of a frame. A corner keeps its id from frame to frame as long as it is found again; ids ascend.
struct TrackedFrame {
  int64_t t_ns = 0;  ///< as the camera's clock has it, of the middle row
  std::vector<uint64_t> ids;
  std::vector<cv::Point2f> pixels;
};

/// Corners (Shi & Tomasi 1994) followed from frame to frame by pyramidal Lucas-Kanade (Bouguet 2000), forwards and
/// back. One instance is used by one thread.
class CornerTracks {
 public:
  struct Parameters {
    int most = 300;         ///< corners followed at once
    int apart_px = 18;      ///< between corners, at 640 columns; grows with the picture
    double quality = 0.01;  ///< of a new corner, relative to the best
    int window_px = 21;     ///< of Lucas-Kanade
    int levels = 4;         ///< of the pyramid
    double back_px = 0.5;   ///< largest distance after following forwards and back
  };
  explicit CornerTracks(const Parameters& parameters) : p_(parameters) {}

  /// The corners in the next picture (8-bit grey, of the size of the one before).
  TrackedFrame follow(const cv::Mat& grey, int64_t t_ns);

 private:
  void refill(const cv::Mat& grey);
  Parameters p_;
  std::vector<cv::Mat> pyramid_;
  TrackedFrame latest_;
  uint64_t next_id_ = 0;
};

}  // namespace odograph
