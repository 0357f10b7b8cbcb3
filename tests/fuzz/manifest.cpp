// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <fstream>
#include <string>

#include <unistd.h>

#include "sdk/plugin_host/manifest.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const std::string path = "/tmp/odograph-fuzz-" + std::to_string(getpid()) + ".odoplugin.json";
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  (void)odograph::read_manifest(path);
  unlink(path.c_str());
  return 0;
}
