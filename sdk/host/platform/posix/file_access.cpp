// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/platform/file_access.hpp"

namespace odograph {
namespace fs = std::filesystem;

bool is_world_writable(const fs::path& path, bool owners_only_is_safe) {
  std::error_code error;
  const auto permissions = fs::status(path, error).permissions();
  if (error || (permissions & fs::perms::others_write) == fs::perms::none) return false;
  return !owners_only_is_safe || (permissions & fs::perms::sticky_bit) == fs::perms::none;
}

}  // namespace odograph
