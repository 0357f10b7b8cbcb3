// SPDX-License-Identifier: Apache-2.0
//
// Pictures: borrowed, retained, in any format, of any size.
#include <cstring>

#include "sdk/tools/validator/case_fixture.hpp"
#include "sdk/tools/validator/child.hpp"

namespace odograph {
CASES(frame)
namespace {

constexpr uint32_t kW = TestInput::kWidth, kH = TestInput::kHeight;

odo_frame& frame_of(AnyMessage& message) { return reinterpret_cast<odo_frame&>(message.header()); }
bool is_frame(const AnyMessage& message) { return message.header().type == ODO_TYPE_FRAME; }

/// Runs the walk with each frame modified and returns the instance. Throws a Verdict on failure.
std::unique_ptr<PluginDriver> walked(CaseFixture& fixture, const std::function<void(AnyMessage&)>& change) {
  if (!fixture.accepts(ODO_TYPE_FRAME)) throw not_applicable("it is given no frames");
  auto driver = fixture.start_instance();
  if (!driver) return nullptr;
  MessageLayout layout;
  layout.change = [&](AnyMessage& message) {
    if (is_frame(message)) change(message);
  };
  const int32_t status = driver->process(fixture.input, layout);
  if (status < 0) throw Verdict("process failed with status " + std::to_string(status));
  for (const std::string& violation : driver->violations)
    if (violation.starts_with("numbers")) throw Verdict(violation);
  return driver;
}

Verdict survives(CaseFixture& fixture, const std::function<void(AnyMessage&)>& change) {
  walked(fixture, change);
  return {};
}

void lend(AnyMessage& message, LoanCounter& loans) {
  odo_frame& frame = frame_of(message);
  frame.loan.owner = &loans;
  frame.loan.retain = LoanCounter::retain;
  frame.loan.release = LoanCounter::release;
}

/// The same grey picture with chroma planes, or as grey RGB.
void as_format(AnyMessage& message, uint32_t format, std::vector<uint8_t>& pixels) {
  odo_frame& frame = frame_of(message);
  const uint8_t* grey = frame.planes[0].data;
  frame.format = format;
  const uint32_t channels = format == ODO_FORMAT_RGB8                                  ? 3
                            : format == ODO_FORMAT_RGBA8 || format == ODO_FORMAT_BGRA8 ? 4
                                                                                       : 1;
  pixels.assign(kW * kH * channels + kW * kH / 2, 128);
  for (uint32_t i = 0; i < kW * kH; ++i)
    for (uint32_t c = 0; c < channels; ++c) pixels[i * channels + c] = c == 3 ? 255 : grey[i];
  frame.planes[0] = {pixels.data(), kW * channels, channels, 0};
  const uint8_t* chroma = pixels.data() + kW * kH;
  if (format == ODO_FORMAT_NV12 || format == ODO_FORMAT_NV21) frame.planes[1] = {chroma, kW, 2, 0};
  if (format == ODO_FORMAT_YUV420) {
    frame.planes[1] = {chroma, kW / 2, 1, 0};
    frame.planes[2] = {chroma + kW * kH / 4, kW / 2, 1, 0};
  }
}

template <uint32_t format>
Verdict format_as_grey(CaseFixture& fixture) {
  std::vector<std::vector<uint8_t>> kept;
  const auto plain = fixture.run(fixture.input, {});
  const auto driver = walked(fixture, [&](AnyMessage& message) { as_format(message, format, kept.emplace_back()); });
  return difference(plain, driver->bytes());
}

/// Read-only pixels at the end of a page that is unmapped after the call.
CASE(frame, "frames.borrowed", "reads the pixels only within the call, and writes none", 20, 4) {
  if (!fixture.accepts(ODO_TYPE_FRAME)) return not_applicable("it is given no frames");
  MessageLayout layout;
  layout.guarded = true;
  const auto plain = fixture.run(fixture.input, {}), other = fixture.run(fixture.input, layout);
  return difference(plain, other);
}

/// Every retained frame must be released by destroy. Pixels stay valid while retained.
CASE(frame, "frames.balance", "releases what it retains", 20, 4) {
  LoanCounter loans;
  auto driver = walked(fixture, [&](AnyMessage& message) { lend(message, loans); });
  if (loans.released > loans.retained) return "released more often than retained";
  driver->destroy();
  if (loans.released == loans.retained) return "";
  return "retained " + std::to_string(loans.retained) + " times, released " + std::to_string(loans.released) + " times";
}

CASE(frame, "frames.quota", "retains at most 7 frames at once", 20, 4) {
  LoanCounter loans;
  int most = 0;
  const auto driver = walked(fixture, [&](AnyMessage& message) {
    most = std::max(most, loans.retained - loans.released);
    lend(message, loans);
  });
  return most <= 7 ? ""
                   : "it holds " + std::to_string(most) +
                         " frames at once; a host provides 8, one of them for the next frame";
}

CASE(frame, "frames.exhausted", "works with a host that refuses to retain frames", 20, 4) {
  LoanCounter loans;
  loans.refuse = true;
  const auto driver = walked(fixture, [&](AnyMessage& message) { lend(message, loans); });
  return loans.released == 0 ? "" : "it released a frame that it could not retain";
}

/// Larger strides: the padding between rows is not part of the picture.
CASE(frame, "frames.strides", "reads rows by their stride", 20, 3) {
  std::vector<std::vector<uint8_t>> kept;
  const auto plain = fixture.run(fixture.input, {});
  const auto driver = walked(fixture, [&](AnyMessage& message) {
    auto& wide = kept.emplace_back((kW + 24) * kH, uint8_t(0xEE));
    odo_frame& frame = frame_of(message);
    for (uint32_t y = 0; y < kH; ++y) std::memcpy(&wide[y * (kW + 24)], frame.planes[0].data + y * kW, kW);
    frame.planes[0].data = wide.data();
    frame.planes[0].row_stride = kW + 24;
  });
  return difference(plain, driver->bytes());
}

CASE_OF(frame, "frames.nv12", "sees the same in NV12", 20, 3, format_as_grey<ODO_FORMAT_NV12>);
CASE_OF(frame, "frames.nv21", "sees the same in NV21", 20, 3, format_as_grey<ODO_FORMAT_NV21>);
CASE_OF(frame, "frames.yuv420", "sees the same in three planes of YUV 4:2:0", 20, 3, format_as_grey<ODO_FORMAT_YUV420>);
CASE_OF(frame, "frames.rgb", "sees the same in RGB", 20, 3, format_as_grey<ODO_FORMAT_RGB8>);
CASE_OF(frame, "frames.rgba", "sees the same in RGBA", 20, 3, format_as_grey<ODO_FORMAT_RGBA8>);
CASE_OF(frame, "frames.bgra", "sees the same in BGRA", 20, 3, format_as_grey<ODO_FORMAT_BGRA8>);
CASE(frame, "frames.later_format", "survives a format of a later version", 20, 3) {
  return survives(fixture, [](AnyMessage& message) { frame_of(message).format = 99; });
}

CASE(frame, "frames.other_size", "survives frames of another size than the calibration's", 20, 3) {
  int count = 0;
  return survives(fixture, [&](AnyMessage& message) {
    if (++count % 3 == 0) frame_of(message).width = kW / 2, frame_of(message).height = kH / 2;
  });
}

CASE(frame, "frames.tiny", "survives frames of one pixel", 20, 3) {
  return survives(fixture, [](AnyMessage& message) { frame_of(message).width = frame_of(message).height = 1; });
}

CASE(frame, "frames.black", "survives black frames", 20, 3) {
  static const std::vector<uint8_t> pixels(kW * kH, 0);
  return survives(fixture, [](AnyMessage& message) { frame_of(message).planes[0].data = pixels.data(); });
}

CASE(frame, "frames.noise", "survives noise", 20, 3) {
  std::vector<std::vector<uint8_t>> kept;
  uint32_t random = 1;
  return survives(fixture, [&](AnyMessage& message) {
    auto& pixels = kept.emplace_back(kW * kH);
    for (uint8_t& pixel : pixels) random = random * 1664525u + 1013904223u, pixel = static_cast<uint8_t>(random >> 24);
    frame_of(message).planes[0].data = pixels.data();
  });
}

CASE(frame, "frames.mask", "survives a mask that covers everything", 20, 3) {
  static const std::vector<uint8_t> mask(kW * kH, 0);
  return survives(fixture, [](AnyMessage& message) {
    frame_of(message).mask = {mask.data(), kW, 1, 0};
    message.header().flags |= ODO_FRAME_MASK;
  });
}

CASE(frame, "frames.unknown_camera", "survives frames of a camera without description", 20, 3) {
  return survives(fixture, [](AnyMessage& message) { message.header().source = 7; });
}

CASE(frame, "frames.no_calibration", "survives frames before any calibration", 20, 3) {
  if (!fixture.accepts(ODO_TYPE_FRAME)) return not_applicable("it is given no frames");
  std::vector<AnyMessage> without;
  for (const AnyMessage& message : fixture.input)
    if (message.header().type != ODO_TYPE_CALIBRATION) without.push_back(message);
  const auto driver = fixture.start_instance();
  const int32_t status = driver->process(without);
  return status >= 0 ? "" : "process failed with status " + std::to_string(status) + " without a camera description";
}

/// Varies the focal length by 3 % and back, like autofocus.
CASE(frame, "frames.autofocus", "survives a focal length that changes by 3 %", 20, 4) {
  int count = 0;
  return survives(fixture, [&](AnyMessage& message) {
    odo_frame& frame = frame_of(message);
    message.header().flags |= ODO_FRAME_INTRINSICS;
    frame.fx = frame.fy = 60 * (1 + 0.03 * ((++count / 5) % 2));
    frame.cx = 31.5, frame.cy = 23.5;
  });
}

}  // namespace

}  // namespace odograph
