// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace odograph {

/// Whether every user of this machine may change the file, or put another one in the place of what lies in the folder;
/// false where the system does not say. `owners_only_is_safe`: not where each may add files to the folder but replace
/// none of others (POSIX's sticky bit, as of /tmp; Windows' right to delete children). [any]
bool everybody_writes(const std::filesystem::path& path, bool owners_only_is_safe);

}  // namespace odograph
