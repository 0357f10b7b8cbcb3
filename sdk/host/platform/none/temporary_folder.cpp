// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/platform/temporary_folder.hpp"

namespace odograph {

/// There are no other processes: takes the first free number.
std::filesystem::path make_temporary_folder() {
  std::error_code error;
  const auto where = std::filesystem::temp_directory_path(error);
  constexpr int kMaxFolders = 10'000;
  for (int i = 0; !error && i < kMaxFolders; ++i)
    if (const auto folder = where / ("odograph-" + std::to_string(i)); std::filesystem::create_directory(folder, error))
      return folder;
  return {};
}

}  // namespace odograph
