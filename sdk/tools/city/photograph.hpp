// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include <opencv2/core.hpp>

#include "sdk/host/base/result.hpp"

namespace odograph {

/// A picture file and its EXIF position, heading and focal length (by libexif).
struct Photograph {
  std::filesystem::path file;
  std::optional<double> focal_px;
  std::optional<std::array<double, 2>> place_deg;  ///< latitude, longitude; none at 0, 0, which means unknown
  std::optional<double> place_sigma_m;             ///< GPSHPositioningError
  std::optional<double> heading_deg;               ///< GPSImgDirection, from north to the east
  bool heading_is_magnetic = false;                ///< from magnetic north: the declination is not in EXIF
};

/// Reads what a picture in a format that OpenCV supports states about itself; EXIF is optional. Failures name the file.
/// Thread: any.
Result<Photograph> read_photograph(const std::filesystem::path& file);
/// Its pixels, 8-bit BGR, rotated by its EXIF orientation. Fails also where the file is truncated. Thread: any.
Result<cv::Mat> read_pixels(const Photograph& photograph);

/// The focal length in pixels of a lens on a picture of that size: "26mm" (35 mm equivalent), "70deg" (angle of the
/// long side), "1500px", else a camera.yaml of this aspect.
Result<double> focal_of_lens(const std::string& lens, const cv::Size& size);

}  // namespace odograph
