// SPDX-License-Identifier: Apache-2.0
#include "sdk/plugin_host/manifest.hpp"
#include "tests/fuzz/scratch.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  (void)odograph::read_manifest(fuzz::put("plugin.odoplugin.json", {data, size}));
  return 0;
}
