// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>

#include "plugins/fix/skyline/city_outline.hpp"
#include "sdk/tools/simulation/city_model.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, size_t size) {
  (void)odograph::parse_city_json({reinterpret_cast<const char*>(data), size}, "fuzz");
  try {
    (void)odograph::skyline::parse_city_outline({reinterpret_cast<const char*>(data), size}, "fuzz", {});
  } catch (const std::runtime_error&) {  // rejected with a reason
  }
  return 0;
}
