// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include <opencv2/core.hpp>

#include "sdk/host/base/result.hpp"

namespace odograph {

/// An upright photograph and its EXIF position, heading and focal length (by libexif).
struct Photograph {
  std::filesystem::path file;
  cv::Mat bgr;  ///< rotated by its EXIF orientation
  std::optional<double> focal_px;
  std::optional<std::array<double, 2>> place_deg;  ///< latitude, longitude
  std::optional<double> place_sigma_m;             ///< GPSHPositioningError
  std::optional<double> heading_deg;               ///< GPSImgDirection, from north to the east
  bool heading_is_magnetic = false;                ///< from magnetic north: the declination is not in EXIF
};

/// Reads a picture in a format that OpenCV supports; EXIF is optional. Failures name the file. Thread: any.
Result<Photograph> read_photograph(const std::filesystem::path& file);

/// The focal length in pixels of a lens on a picture of that size: "26mm" (35 mm equivalent), "70deg" (angle of the
/// long side), "1500px", else a camera.yaml of this aspect.
Result<double> focal_of_lens(const std::string& lens, const cv::Size& size);

}  // namespace odograph
