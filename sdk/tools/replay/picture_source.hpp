// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "sdk/host/base/result.hpp"
#include "sdk/tools/evaluation/corner_flow.hpp"
#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// A picture loaded on demand: 8-bit grey, or empty if unreadable.
struct PictureSource {
  std::string name;
  std::function<cv::Mat()> grey;
};

/// A grey copy of a frame's pixels.
cv::Mat grey_of(const odo_frame& frame);

/// The pictures at a path, by content: a picture, a folder of pictures, a recording's frames, or a video. Frames are
/// decimated to about three a second.
Result<std::vector<PictureSource>> pictures_of(const std::string& path);

/// Trackability of corners in a recording's first frames, `most` at most. ODO_E_DATA with fewer than ten frames or
/// without a calibration.
Result<TrackFigures> measure_corner_flow(const Recording& recording, size_t most,
                                         const std::function<void(size_t done, size_t all)>& progress = {});

}  // namespace odograph
