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

/// As of odo_frame, and what the largest sensors of phones give (48 megapixels) and some more.
constexpr uint32_t kMaxSide = 16384;
constexpr uint64_t kMaxPixels = 64'000'000;

/// The size that the header of a PNG, JPEG, BMP, PGM or PPM states at `offset` of a file, without decoding anything.
/// Failure: the file, and that it is none of these, or larger than the constants above.
Result<PictureSize> picture_size(const std::filesystem::path& file, uint64_t offset = 0);
/// The same of a file in memory, which `name` stands for.
Result<PictureSize> picture_size(std::span<const unsigned char> bytes, const std::string& name);

}  // namespace odograph
