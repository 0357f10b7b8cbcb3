// SPDX-License-Identifier: Apache-2.0
//
// ROS 1 bags and MCAP, with their first pictures decoded.
#include "sdk/tools/recording/recording.hpp"
#include "tests/fuzz/scratch.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto recording = odograph::read_log(fuzz::put("recording.log", {data, size}));
  size_t pictures = 0;
  for (size_t i = 0; recording && i < recording->messages.size() && pictures < 3; ++i) {
    if (recording->messages[i].message.header().type != ODO_TYPE_FRAME) continue;
    ++pictures;
    (void)odograph::encoded_picture(recording->messages[i].picture);
    if (const auto frame = odograph::load_frame(recording->messages[i])) frame->loan.release(frame->loan.owner);
  }
  return 0;
}
