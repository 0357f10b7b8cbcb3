// SPDX-License-Identifier: Apache-2.0
#include "sdk/sim/city_model.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, size_t size) {
  (void)odograph::parse_city_json({reinterpret_cast<const char*>(data), size}, "fuzz");
  return 0;
}
