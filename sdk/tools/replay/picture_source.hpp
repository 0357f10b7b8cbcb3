// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "sdk/host/base/result.hpp"
#include "sdk/tools/evaluation/corner_follower.hpp"
#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// A picture that is loaded when it is asked for: 8-bit grey, or empty where it cannot be read.
struct PictureSource {
  std::string name;
  std::function<cv::Mat()> grey;
};

/// A frame's pixels in grey, a copy.
cv::Mat grey_of(const odo_frame& frame);

/// The pictures behind a path, found out by looking: a picture, a folder of them, a recording's frames, or a video
/// (by ffmpeg where it is installed). Of frames that follow each other quickly some three a second are taken.
Result<std::vector<PictureSource>> pictures_of(const std::string& path);

/// How well corners can be followed through a recording's first frames, `most` at most. ODO_E_DATA with fewer than ten
/// frames or without a calibration.
Result<TrackFigures> followed_corners(const Recording& recording, size_t most,
                                      const std::function<void(size_t done, size_t all)>& progress = {});

}  // namespace odograph
