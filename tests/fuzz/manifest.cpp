// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <string>

#include "sdk/host/config/manifest.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  (void)odograph::parse_manifest(std::string(reinterpret_cast<const char*>(data), size), "fuzz.odoplugin.json");
  return 0;
}
