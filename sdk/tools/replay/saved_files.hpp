// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include <odograph/map.h>
#include <odograph/plugin.h>

#include "sdk/host/base/result.hpp"

namespace odograph {

/// What a session writes to a file for a later one.
struct SavedFile {
  const char* what;
  uint64_t largest;  ///< bytes; more than any session saves
  decltype(&odo_session_save) save;
  decltype(&odo_session_load) load;
};
/// Several plugins at the 16 MiB limit.
inline constexpr SavedFile kStateFile{"state", 256u << 20, odo_session_save, odo_session_load};
inline constexpr SavedFile kMapFile{"map", uint64_t{ODO_LARGEST_MAP} + (1u << 20), odo_map_save, odo_map_load};

/// The bytes of such a file, which exists.
Result<std::string> read_saved_bytes(const SavedFile& saved, const std::string& path);
/// Loads it from a file; a missing file is not an error. An existing but unreadable file is a failure, because the run
/// would overwrite it; so is a file of which a part is rejected (ODO_PARTIAL).
Result<bool> read_saved(odo_session* session, const SavedFile& saved, const std::string& path);
/// Writes to a temporary file first, so that the old one survives a failure. Nothing without a path.
Result<bool> write_saved(odo_session* session, const SavedFile& saved, const std::string& path);

}  // namespace odograph
