// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/platform/temporary_folder.hpp"

#include <random>

namespace odograph {

// %TEMP% is private to the user.
std::filesystem::path make_temporary_folder() {
  std::random_device random;
  std::error_code error;
  const auto where = std::filesystem::temp_directory_path(error);
  constexpr int kTries = 100;
  for (int i = 0; !error && i < kTries; ++i)
    if (const auto folder = where / ("odograph-" + std::to_string(random()));
        std::filesystem::create_directory(folder, error))
      return folder;
  return {};
}

}  // namespace odograph
