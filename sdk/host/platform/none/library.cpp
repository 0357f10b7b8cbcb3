// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/platform/library.hpp"

namespace odograph {

void* open_library(const std::filesystem::path&, std::string& why) {
  why = "this platform has no shared libraries";
  return nullptr;
}

void* library_symbol(void*, const char*) { return nullptr; }

std::filesystem::path own_file() { return {}; }

}  // namespace odograph
