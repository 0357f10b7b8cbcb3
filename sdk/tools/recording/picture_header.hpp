// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "sdk/host/base/result.hpp"

namespace odograph {

struct PictureSize {
  uint32_t width, height;
};

/// Limit of odo_frame; above the largest phone sensors (48 megapixels).
constexpr uint32_t kMaxSide = 16384;
constexpr uint64_t kMaxPixels = 64'000'000;

/// The size stated in the header of a PNG, JPEG, BMP, PGM or PPM at `offset` of a file, without decoding. Failures name
/// the file: another format, or larger than the limits above.
Result<PictureSize> picture_size(const std::filesystem::path& file, uint64_t offset = 0);
/// The same for a file in memory; `name` is used in messages.
Result<PictureSize> picture_size(std::span<const unsigned char> bytes, const std::string& name);

}  // namespace odograph
