// SPDX-License-Identifier: Apache-2.0
//
// Frames of isolated plugins: location of the pixels, ownership, cost.
#include <odograph/vo_frontend.h>

#include <odograph/plugin_messages.hpp>

#include "sdk/host/core/frame_store.hpp"
#include "tests/isolation/isolated_plugin.hpp"
#include "tests/support/test_plugins.hpp"
#include "tests/support/messages.hpp"

TEST_SUITE_BEGIN("isolation_frames");

namespace {

constexpr uint32_t kWidth = 640, kHeight = 480;
constexpr size_t kBytes = size_t(kWidth) * kHeight;

odo_frame grey_frame(const std::vector<uint8_t>& pixels, int number) {
  return grey_frame_at(1'000'000'000 + number * 33'000'000LL, pixels.data(), kWidth, kHeight);
}

/// Reports of test/retaining_vo about the frames it keeps, with this many frames in the session's store.
std::vector<odo_vo_motion> keep(const std::string& isolation, int frames) {
  const TestPlugins plugins{"retaining_vo"};
  RunningApp app("odograph: 1\ntime_ordering: {frames: " + std::to_string(frames) +
                     "}\nvo_frontend: {plugin: test/retaining_vo, isolation: " + isolation + "}\n",
                 ODO_RUN_REPLAY, plugins.path());
  app.push(calibration(kWidth, kHeight));
  std::vector<uint8_t> pixels(kBytes);
  for (int i = 0; i < 30; ++i) {
    std::fill(pixels.begin(), pixels.end(), static_cast<uint8_t>(i));  // the host has copied them
    const odo_frame frame = grey_frame(pixels, i);
    CHECK(app.push(frame) >= 0);
    app.flush();
  }
  CHECK(app.statistics().plugin_faults == 0);
  return app.all<odo_vo_motion>(ODO_TYPE_VO_MOTION);
}

}  // namespace

TEST_CASE("isolated plugins see a session's frame without a copy") {
  const TestPlugins plugins{"needy_vo"};
  IsolatedPlugin isolated("vo_frontend: {plugin: test/needy_vo, isolation: process}\n", plugins.path());
  const auto lens = calibration(kWidth, kHeight);
  isolated.plugin->process(lens.header);
  SharedPixels& shared = isolated.host.shared_pixels();
  FrameStore store(4, &shared);
  const std::vector<uint8_t> pixels(kBytes, 90);
  for (int i = 0; i < 10; ++i) {
    odo_frame frame = grey_frame(pixels, i);
    REQUIRE(store.adopt(reinterpret_cast<odo_borrowed&>(frame)) == ODO_OK);
    const auto events = isolated.plugin->process(frame.header);
    CHECK(events.size() == (i > 0 ? 2 : 0));  // points and a motion
    if (i > 0) CHECK(odo::Points(as<odo_points>(events[0].header())).size() == 300);
    CHECK(store.in_use() == 1);
    frame.loan.release(frame.loan.owner);
    CHECK(store.in_use() == 0);
  }
  CHECK(shared.reserved() == kBytes);  // memory of one picture: it was never copied

  for (int i = 10; i < 20; ++i) {  // frames of other memory are copied, and each copy is freed
    const odo_frame frame = grey_frame(pixels, i);
    CHECK(isolated.plugin->process(frame.header).size() == 2);
  }
  CHECK(shared.reserved() == 2 * kBytes);
  CHECK(isolated.plugin->faults() == 0);
}

TEST_CASE("frames kept by an isolated plugin do not change, and none is kept beyond the quota") {
  for (const int frames : {2, 3, 8}) {
    CAPTURE(frames);
    const auto inside = keep("none", frames), outside = keep("process", frames);
    REQUIRE(outside.size() == 29);
    REQUIRE(inside.size() == 29);
    const double most = std::min(3, frames - 1);
    for (size_t i = 0; i < outside.size(); ++i) {
      CAPTURE(i);
      CHECK(outside[i].p_c0_c1[0] == std::min<double>(static_cast<double>(i) + 2, most));
      if (frames == 8) CHECK(outside[i].p_c0_c1[1] == std::max(0, static_cast<int>(i) - 1));
      CHECK(outside[i].p_c0_c1[0] == inside[i].p_c0_c1[0]);
      CHECK(outside[i].p_c0_c1[1] == inside[i].p_c0_c1[1]);
    }
  }
}

TEST_CASE("pixel memory of any size is allocated, freed and never exceeds the total") {
  SharedPixels pixels;
  const auto small = pixels.take(10'000), large = pixels.take(100'000);
  REQUIRE(small.size() >= 10'000);
  REQUIRE(large.size() >= 100'000);
  CHECK(large.data() >= small.data() + small.size());
  std::memset(large.data(), 7, large.size());
  pixels.give_back(large);
  CHECK(pixels.take(9'000).data() == large.data());  // the small one is taken
  pixels.give_back(large);
  pixels.give_back(small);
  CHECK(pixels.take(9'000).data() == small.data());  // the smallest one that is large enough
  CHECK(pixels.take(SharedPixels::kBytes).empty());
  CHECK(pixels.take(SharedPixels::kBytes + 1).empty());
  pixels.give_back(small);
  CHECK(pixels.take(SharedPixels::kBytes).size() == SharedPixels::kBytes);  // all free: the whole memory again
  CHECK(pixels.take(1).empty());
}

TEST_CASE("isolation adds less than 0.25 ms to a frame") {
  const TestPlugins plugins{"needy_vo"};
  IsolatedPlugin isolated("vo_frontend: {plugin: test/needy_vo, isolation: process}\n", plugins.path());
  const auto lens = calibration(kWidth, kHeight);
  isolated.plugin->process(lens.header);
  FrameStore store(4, &isolated.host.shared_pixels());
  const std::vector<uint8_t> pixels(kBytes, 90);
  std::vector<double> us;
  for (int i = 0; i < 2000; ++i) {
    odo_frame frame = grey_frame(pixels, i);
    REQUIRE(store.adopt(reinterpret_cast<odo_borrowed&>(frame)) == ODO_OK);
    const auto start = std::chrono::steady_clock::now();
    isolated.plugin->process(frame.header);
    us.push_back(milliseconds_since(start) * 1e3);
    frame.loan.release(frame.loan.owner);
  }
  std::sort(us.begin(), us.end());
  MESSAGE("a frame of 640 x 480 takes " << us[1000] << " us in the median, " << us[1980] << " at 99 %");
  CHECK(us[1000] < 250);
  CHECK(isolated.plugin->faults() == 0);
}
