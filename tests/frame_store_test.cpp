// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <vector>

#include "sdk/host/core/frame_store.hpp"
#include "sdk/host/messages/messages.hpp"

using namespace odograph;

TEST_SUITE_BEGIN("frame_store");

TEST_CASE("plugins may keep all frames of the quota but one, which stays free for the next") {
  FrameStore store(3);
  std::vector<uint8_t> pixels(8 * 8, 90);
  std::vector<odo_frame> frames(4, make_message<odo_frame>(ODO_TYPE_FRAME, 1'000'000'000));
  for (odo_frame& f : frames) {
    f.format = ODO_FORMAT_GREY8;
    f.width = f.height = 8;
    f.planes[0] = {pixels.data(), 8, 1, 0};
    f.retain = nullptr, f.release = nullptr;
  }
  for (size_t i = 0; i < 2; ++i) {
    REQUIRE(store.adopt(frames[i]) == ODO_OK);
    CHECK(frames[i].retain(&frames[i]) == ODO_OK);  // a plugin's
    frames[i].release(&frames[i]);                  // the host's
  }
  CHECK(store.in_use() == 2);
  REQUIRE(store.adopt(frames[2]) == ODO_OK);
  CHECK(frames[2].retain(&frames[2]) == ODO_E_EXHAUSTED);
  frames[2].release(&frames[2]);
  CHECK(store.adopt(frames[3]) == ODO_OK);  // the next one has a place
  for (const size_t i : {0, 1, 3}) frames[i].release(&frames[i]);
  CHECK(store.in_use() == 0);
}

TEST_SUITE_END();
