// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace odograph {

/// The corners of a frame. A corner keeps its id while it is tracked; ids ascend.
struct TrackedFrame {
  int64_t t_ns = 0;  ///< on the camera's clock, of the middle row
  std::vector<uint64_t> ids;
  std::vector<cv::Point2f> pixels;
};

/// Corners (Shi & Tomasi 1994) tracked from frame to frame with pyramidal Lucas-Kanade (Bouguet 2000), with a
/// forward-backward check. Not thread-safe.
class CornerTracks {
 public:
  struct Parameters {
    int most = 300;         ///< corners tracked at once
    int apart_px = 18;      ///< between corners, at 640 columns; scales with the picture
    double quality = 0.01;  ///< of a new corner, relative to the best
    int window_px = 21;     ///< of Lucas-Kanade
    int levels = 4;         ///< of the pyramid
    double back_px = 0.5;   ///< maximum distance after tracking forwards and backwards
  };
  explicit CornerTracks(const Parameters& parameters) : p_(parameters) {}

  /// Tracks the corners into the next picture (8-bit grey, same size as the previous one).
  TrackedFrame follow(const cv::Mat& grey, int64_t t_ns);

 private:
  void refill(const cv::Mat& grey);
  Parameters p_;
  std::vector<cv::Mat> pyramid_;
  TrackedFrame latest_;
  uint64_t next_id_ = 0;
};

}  // namespace odograph
