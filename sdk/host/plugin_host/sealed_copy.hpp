// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "sdk/host/config/manifest.hpp"

namespace odograph {

/// Copies the manifest's library into sealed memory and compares its hash with the manifest's. Returns the path under
/// which the loader opens the copy, so that the code mapped is the code hashed, even if the file changes. A copy lives
/// as long as the process, like a loaded library; libraries with the same hash share a path, so that the loader opens
/// them once. On systems without sealed memory (all but Linux), returns the library's own path.
Result<std::filesystem::path> sealed_copy(const Manifest& manifest);

/// Whether the hash of `copy` (the library itself or a copy) equals the manifest's. True or a failure.
Result<bool> has_hash_of(const Manifest& manifest, const std::filesystem::path& copy);

}  // namespace odograph
