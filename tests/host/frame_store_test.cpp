// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/base/pixels.hpp"
#include "sdk/host/core/frame_store.hpp"
#include "sdk/host/messages/messages.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("frame_store");

namespace {

/// Frames that must be copied, of the same pixels.
std::vector<odo_frame> small_frames(size_t count) {
  static const std::vector<uint8_t> pixels(8 * 8, 90);
  std::vector<odo_frame> frames(count, make_message<odo_frame>(ODO_TYPE_FRAME, 1'000'000'000));
  for (odo_frame& f : frames) {
    f.format = ODO_FORMAT_GREY8;
    f.width = f.height = 8;
    f.planes[0] = {pixels.data(), 8, 1, 0};
    f.loan.retain = nullptr, f.loan.release = nullptr;
  }
  return frames;
}

}  // namespace

TEST_CASE("plugins may keep all frames of the quota but one, which stays free for the next frame") {
  FrameStore store(3);
  std::vector<odo_frame> frames = small_frames(4);
  for (size_t i = 0; i < 2; ++i) {
    REQUIRE(store.adopt(reinterpret_cast<odo_borrowed&>(frames[i])) == ODO_OK);
    CHECK(frames[i].loan.retain(frames[i].loan.owner) == ODO_OK);  // a plugin's
    frames[i].loan.release(frames[i].loan.owner);                  // the host's
  }
  CHECK(store.in_use() == 2);
  REQUIRE(store.adopt(reinterpret_cast<odo_borrowed&>(frames[2])) == ODO_OK);
  CHECK(frames[2].loan.retain(frames[2].loan.owner) == ODO_E_EXHAUSTED);
  frames[2].loan.release(frames[2].loan.owner);
  CHECK(store.adopt(reinterpret_cast<odo_borrowed&>(frames[3])) == ODO_OK);  // there is room for the next one
  for (const size_t i : {0, 1, 3}) frames[i].loan.release(frames[i].loan.owner);
  CHECK(store.in_use() == 0);
}

TEST_CASE("a frame beyond the quota is refused until one is released; a held frame can be retained again") {
  FrameStore store(2);
  std::vector<odo_frame> frames = small_frames(3);
  const auto adopt = [&](size_t i) { return store.adopt(reinterpret_cast<odo_borrowed&>(frames[i])); };
  const auto retain = [&](size_t i) { return frames[i].loan.retain(frames[i].loan.owner); };
  const auto release = [&](size_t i) { frames[i].loan.release(frames[i].loan.owner); };
  REQUIRE(adopt(0) == ODO_OK);
  REQUIRE(retain(0) == ODO_OK);  // by a plugin
  REQUIRE(adopt(1) == ODO_OK);
  frames[2].loan.owner = &store;  // the app's
  REQUIRE(adopt(2) == ODO_E_EXHAUSTED);
  CHECK(!frames[2].loan.owner);
  CHECK(store.in_use() == 2);
  REQUIRE(retain(0) == ODO_OK);  // by another plugin: no further frame is held
  CHECK(retain(1) == ODO_E_EXHAUSTED);
  for (int holder = 0; holder < 3; ++holder) {
    CHECK(store.in_use() == 2);
    release(0);
  }
  CHECK(store.in_use() == 1);
  REQUIRE(adopt(2) == ODO_OK);
  release(1), release(2);
  CHECK(store.in_use() == 0);
}

namespace {

/// A plane by this table: one sample per block of pixels, with a number of bytes.
struct Sampled {
  uint32_t across, down, bytes;
};

std::vector<Sampled> planes_of(uint32_t format) {
  switch (format) {
    case ODO_FORMAT_GREY8: return {{1, 1, 1}};
    case ODO_FORMAT_RGB8: return {{1, 1, 3}};
    case ODO_FORMAT_RGBA8:
    case ODO_FORMAT_BGRA8: return {{1, 1, 4}};
    case ODO_FORMAT_NV12:
    case ODO_FORMAT_NV21: return {{1, 1, 1}, {2, 2, 2}};
    default: return {{1, 1, 1}, {2, 2, 1}, {2, 2, 1}};
  }
}

/// A frame with padding behind each row, or bottom up, and the bytes of its samples in order.
struct Padded {
  odo_frame frame = make_message<odo_frame>(ODO_TYPE_FRAME, 0);
  std::vector<std::vector<uint8_t>> memory;
  std::vector<uint8_t> expected;  ///< without gaps between rows; 0 in the gaps of a pixel stride

  Padded(uint32_t format, uint32_t w, uint32_t h, uint32_t chroma_stride, bool bottom_up, bool masked) {
    frame.format = format, frame.width = w, frame.height = h;
    const auto planes = planes_of(format);
    for (size_t k = 0; k < planes.size(); ++k)
      frame.planes[k] =
          add(planes[k], format == ODO_FORMAT_YUV420 && k > 0 ? chroma_stride : planes[k].bytes, bottom_up);
    if (!masked) return;
    frame.header.flags |= ODO_FRAME_MASK;
    frame.mask = add({1, 1, 1}, 1, false);
  }

 private:
  odo_plane add(const Sampled& s, uint32_t pixel_stride, bool bottom_up) {
    const uint32_t columns = (frame.width + s.across - 1) / s.across, rows = (frame.height + s.down - 1) / s.down;
    const uint32_t length = (columns - 1) * pixel_stride + s.bytes, stride = length + 3;
    std::vector<uint8_t>& bytes = memory.emplace_back(size_t{stride} * rows, uint8_t{0xEE});
    const auto from = [&](uint32_t row) { return size_t{stride} * (bottom_up ? rows - 1 - row : row); };
    for (uint32_t row = 0; row < rows; ++row)
      for (uint32_t i = 0; i < length; ++i) {
        const bool gap = i % pixel_stride >= s.bytes;
        bytes[from(row) + i] = gap ? 0 : static_cast<uint8_t>(1 + (memory.size() * 53 + row * 31 + i) % 200);
        expected.push_back(bytes[from(row) + i]);
      }
    const int64_t step = stride;
    return {bytes.data() + from(0), bottom_up ? -step : step, pixel_stride, 0};
  }
};

}  // namespace

TEST_CASE("a copied frame has every sample of every plane in each format, at odd and even sizes, and nothing beyond") {
  for (uint32_t format = ODO_FORMAT_GREY8; format <= ODO_FORMAT_BGRA8; ++format)
    for (uint32_t w = 1; w <= 6; ++w)
      for (uint32_t h = 1; h <= 6; ++h)
        for (const bool odd : {false, true}) {
          CAPTURE(format);
          CAPTURE(w);
          CAPTURE(h);
          CAPTURE(odd);
          Padded padded(format, w, h, odd ? 2 : 1, odd, odd);
          odo_frame frame = padded.frame;
          REQUIRE(pixel_bytes(frame) == padded.expected.size());
          std::vector<uint8_t> copy(padded.expected.size() + 8, 0xAB);
          REQUIRE(copy_pixels(frame, std::span(copy).first(padded.expected.size())));
          CHECK(std::equal(padded.expected.begin(), padded.expected.end(), copy.begin()));
          CHECK(std::count(copy.end() - 8, copy.end(), 0xAB) == 8);
          CHECK(frame.planes[0].data == copy.data());
          if (odd) CHECK(frame.mask.data == copy.data() + padded.expected.size() - size_t{w} * h);
          for (size_t k = 0; k < planes_of(format).size(); ++k) {
            odo_frame narrow = padded.frame, missing = padded.frame;
            narrow.planes[k].row_stride += narrow.planes[k].row_stride > 0 ? -4 : 4;  // one less than a row
            CHECK_FALSE(copy_pixels(narrow, copy));
            missing.planes[k].data = nullptr;
            CHECK_FALSE(copy_pixels(missing, copy));
          }
        }
}
