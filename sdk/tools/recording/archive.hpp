// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "sdk/host/base/result.hpp"
#include "sdk/host/platform/temporary_folder.hpp"

namespace odograph {

/// Limits for unpacking an archive.
struct UnpackLimits {
  uint64_t bytes = 64ull << 30;  ///< in total; and at most nine tenths of the free disk space
  size_t files = 100'000;
  /// Maximum ratio of unpacked to packed size beyond the first `free_bytes`: text compresses 3 to 20 times, a zip bomb
  /// 1000 times.
  uint64_t ratio = 100, free_bytes = 256ull << 20;
};

/// By its first bytes: zip, and other formats that apps send (gzip, 7z, xz).
bool looks_like_archive(const std::filesystem::path& file);

/// Unpacks into a temporary folder, which exists as long as the result. Refuses, with the reason (ODO_E_DATA): names
/// that lead out of the folder, links, sizes above the limits, passwords, damage.
Result<std::shared_ptr<const TemporaryFolder>> unpack(const std::filesystem::path& file,
                                                      const UnpackLimits& limits = {});

/// Decompresses bzip2, LZ4 or Zstandard data; false if it is damaged or has not the stated size.
bool unpack_bytes(std::span<const unsigned char> packed, uint64_t size, std::vector<unsigned char>& bytes);

}  // namespace odograph
