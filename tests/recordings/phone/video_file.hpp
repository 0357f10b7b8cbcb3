// SPDX-License-Identifier: Apache-2.0
//
// Videos in the format of phones, for tests.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

/// Grey pictures as H.264 in MP4, shown at `times_ns` after the first. Quality 0 is lossless; otherwise x264's CRF.
/// Returns true on success.
bool write_video(const std::filesystem::path& file, const std::vector<cv::Mat>& pictures,
                 const std::vector<int64_t>& times_ns, int quality = 0);

/// Adds Sensor Logger's track of timed metadata: for each time in the video (ns) a Unix time (ns), as a signed 64-bit
/// number under the key sensor_logger.epoch_timestamp (QuickTime File Format, "mebx").
void add_metadata_track(const std::filesystem::path& file, const std::vector<std::pair<int64_t, int64_t>>& samples);
