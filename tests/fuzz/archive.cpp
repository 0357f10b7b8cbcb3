// SPDX-License-Identifier: Apache-2.0
//
// Archives of recordings: zip, tar in gzip or xz, 7z.
#include "sdk/tools/recording/archive.hpp"
#include "tests/fuzz/scratch.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const bool in_memory = setenv("TMPDIR", fuzz::folder().c_str(), 1) == 0;
  (void)in_memory;
  const auto& file = fuzz::put("recording.zip", {data, size});
  if (odograph::looks_like_archive(file))
    (void)odograph::unpack(file, {.bytes = 1 << 20, .files = 64, .ratio = 100, .free_bytes = 1 << 14});
  return 0;
}
