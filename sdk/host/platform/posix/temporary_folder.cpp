// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/platform/temporary_folder.hpp"

#include <cstdlib>

namespace odograph {

std::filesystem::path make_temporary_folder() {
  std::string name = (std::filesystem::temp_directory_path() / ("odograph-" + std::string(6, 'X'))).string();
  return mkdtemp(name.data()) ? std::filesystem::path(name) : std::filesystem::path();
}

}  // namespace odograph
