// SPDX-License-Identifier: Apache-2.0
//
// Videos: the times of all frames, and the first and the last picture.
#include "sdk/tools/recording/video.hpp"
#include "tests/fuzz/scratch.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto video = odograph::Video::open(fuzz::put("movie.mp4", {data, size}), {}, {.frames = 100, .pixels = 256});
  if (!video) return 0;
  for (const size_t number : {size_t(0), (*video)->times_ns().size() - 1})
    if (const auto frame = (*video)->load(number, odo_frame{})) frame->loan.release(frame->loan.owner);
  return 0;
}
