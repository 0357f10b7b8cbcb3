// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "sdk/host/base/result.hpp"
#include "sdk/host/platform/temporary_folder.hpp"

namespace odograph {

/// What unpacking an archive may cost.
struct UnpackLimits {
  uint64_t bytes = 64ull << 30;  ///< in all; and no more than nine tenths of the free disk
  size_t files = 100'000;
  /// Unpacked over packed, past the first `free_bytes`: text packs 3 to 20 to 1, a zip bomb 1000 to 1.
  uint64_t ratio = 100, free_bytes = 256ull << 20;
};

/// By its first bytes: zip, and what else apps send (gzip, 7z, xz).
bool looks_like_archive(const std::filesystem::path& file);

/// Unpacks into a temporary folder, which is there as long as the result. Refused in words (ODO_E_DATA): names that
/// lead out of the folder, links, what is larger than the limits, passwords, damage.
Result<std::shared_ptr<const TemporaryFolder>> unpack(const std::filesystem::path& file,
                                                      const UnpackLimits& limits = {});

/// What bzip2, LZ4 or Zstandard has packed; false where it is damaged or has not the stated size.
bool unpack_bytes(std::span<const unsigned char> packed, uint64_t size, std::vector<unsigned char>& bytes);

}  // namespace odograph
