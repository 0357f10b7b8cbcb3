// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <odograph/types.h>
#include <opencv2/core.hpp>

namespace odograph {

constexpr int kMaxCorners = 400;  ///< maximum

/// Trackability of corners in a recording.
struct TrackFigures {
  std::vector<double> lengths;  ///< frames, of corners first seen in the first half
  std::vector<double> inliers;  ///< per pair of frames, fraction of the tracked corners that one motion explains
  std::vector<double> flow_px;  ///< per pair, median
  std::vector<double> kept;     ///< per pair, fraction of the corners found again
  size_t frames = 0;
  double rate_hz = 0;  ///< of the frames, if known
};

/// Tracks corners with pyramidal Lucas-Kanade, forwards and backwards.
class CornerFlowStatistics {
 public:
  explicit CornerFlowStatistics(size_t frames_in_all) : half_(frames_in_all / 2) {}

  void add(const cv::Mat& grey, const odo_calibration& calibration);
  void finish() {
    for (const size_t birth : births_) end(birth);
  }

  TrackFigures figures;

 private:
  void end(size_t birth) {
    if (birth < half_) figures.lengths.push_back(static_cast<double>(figures.frames - birth));
  }

  void follow(const cv::Mat& picture, const odo_calibration& calibration);

  void refill(const cv::Mat& picture);

  const size_t half_;
  cv::Mat before_;
  std::vector<cv::Point2f> corners_;
  std::vector<size_t> births_;
};

}  // namespace odograph
