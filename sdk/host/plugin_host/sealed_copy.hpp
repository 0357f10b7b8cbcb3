// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "sdk/host/config/manifest.hpp"

namespace odograph {

/// Copies the manifest's library into memory, seals that against every change, and compares its hash with the
/// manifest's. The answer is the path that the loader opens the copy by: what it maps is what was hashed, whatever
/// becomes of the file. A copy is kept as long as the process, as a loaded library is; a library of the same hash has
/// the same path, so that the loader opens it once. Where the system has no sealed memory (all but Linux) it is the
/// library's own path.
Result<std::filesystem::path> sealed_copy(const Manifest& manifest);

/// The library's hash is the manifest's, read from `copy` (the library itself, or a copy of it). True or a Failure.
Result<bool> has_hash_of(const Manifest& manifest, const std::filesystem::path& copy);

}  // namespace odograph
