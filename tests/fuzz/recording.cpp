// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/recording/recording.hpp"
#include "tests/fuzz/scratch.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  (void)odograph::read_odo(fuzz::put("recording.odo", {data, size}));
  return 0;
}
