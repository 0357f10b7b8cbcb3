// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <string>

#include "sdk/config/pipeline_config.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  (void)odograph::read_pipeline_config(std::string(reinterpret_cast<const char*>(data), size), "fuzz.yaml",
                                       {ODOGRAPH_FUZZ_PLUGINS});
  return 0;
}
