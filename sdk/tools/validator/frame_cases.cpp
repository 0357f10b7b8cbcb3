// SPDX-License-Identifier: Apache-2.0
//
// Pictures: borrowed, retained, in any format, of any size.
#include <cstring>

#include "sdk/tools/validator/bench.hpp"
#include "sdk/tools/validator/child.hpp"

namespace odograph {
namespace {

constexpr uint32_t kW = TestInput::kWidth, kH = TestInput::kHeight;

odo_frame& frame_of(AnyMessage& message) { return reinterpret_cast<odo_frame&>(message.header()); }
bool is_frame(const AnyMessage& message) { return message.header().type == ODO_TYPE_FRAME; }

/// Runs the walk with each frame modified and returns the instance. Throws a Verdict on failure.
std::unique_ptr<Subject> walked(Bench& bench, const std::function<void(AnyMessage&)>& change) {
  if (!bench.wants(ODO_TYPE_FRAME)) throw not_applicable("it is given no frames");
  auto subject = bench.started();
  if (!subject) return nullptr;
  Handling handling;
  handling.change = [&](AnyMessage& message) {
    if (is_frame(message)) change(message);
  };
  const int32_t status = subject->process(bench.input, handling);
  if (status < 0) throw Verdict("process failed with status " + std::to_string(status));
  for (const std::string& breach : subject->breaches)
    if (breach.starts_with("numbers")) throw Verdict(breach);
  return subject;
}

Verdict survives(Bench& bench, const std::function<void(AnyMessage&)>& change) {
  walked(bench, change);
  return {};
}

void lend(AnyMessage& message, FrameLedger& ledger) {
  odo_frame& frame = frame_of(message);
  frame.loan.owner = &ledger;
  frame.loan.retain = FrameLedger::retain;
  frame.loan.release = FrameLedger::release;
}

/// Every retained frame must be released by destroy. Pixels stay valid while retained.
Verdict balance(Bench& bench) {
  FrameLedger ledger;
  auto subject = walked(bench, [&](AnyMessage& message) { lend(message, ledger); });
  if (ledger.released > ledger.retained) return "released more often than retained";
  subject->destroy();
  if (ledger.released == ledger.retained) return "";
  return "retained " + std::to_string(ledger.retained) + " times, released " + std::to_string(ledger.released) +
         " times";
}

Verdict quota(Bench& bench) {
  FrameLedger ledger;
  int most = 0;
  const auto subject = walked(bench, [&](AnyMessage& message) {
    most = std::max(most, ledger.retained - ledger.released);
    lend(message, ledger);
  });
  return most <= 7 ? ""
                   : "it holds " + std::to_string(most) +
                         " frames at once; a host provides 8, one of them for the next frame";
}

Verdict exhausted(Bench& bench) {
  FrameLedger ledger;
  ledger.refuse = true;
  const auto subject = walked(bench, [&](AnyMessage& message) { lend(message, ledger); });
  return ledger.released == 0 ? "" : "it released a frame that it could not retain";
}

/// Read-only pixels at the end of a page that is unmapped after the call.
Verdict gone(Bench& bench) {
  if (!bench.wants(ODO_TYPE_FRAME)) return not_applicable("it is given no frames");
  Handling handling;
  handling.guarded = true;
  const auto plain = bench.run(bench.input, {}), other = bench.run(bench.input, handling);
  return difference(plain, other);
}

/// Larger strides: the padding between rows is not part of the picture.
Verdict strides(Bench& bench) {
  std::vector<std::vector<uint8_t>> kept;
  const auto plain = bench.run(bench.input, {});
  const auto subject = walked(bench, [&](AnyMessage& message) {
    auto& wide = kept.emplace_back((kW + 24) * kH, uint8_t(0xEE));
    odo_frame& frame = frame_of(message);
    for (uint32_t y = 0; y < kH; ++y) std::memcpy(&wide[y * (kW + 24)], frame.planes[0].data + y * kW, kW);
    frame.planes[0].data = wide.data();
    frame.planes[0].row_stride = kW + 24;
  });
  return difference(plain, subject->bytes());
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

Verdict format_as_grey(Bench& bench, uint32_t format) {
  std::vector<std::vector<uint8_t>> kept;
  const auto plain = bench.run(bench.input, {});
  const auto subject = walked(bench, [&](AnyMessage& message) { as_format(message, format, kept.emplace_back()); });
  return difference(plain, subject->bytes());
}
Verdict nv12(Bench& bench) { return format_as_grey(bench, ODO_FORMAT_NV12); }
Verdict nv21(Bench& bench) { return format_as_grey(bench, ODO_FORMAT_NV21); }
Verdict yuv420(Bench& bench) { return format_as_grey(bench, ODO_FORMAT_YUV420); }
Verdict rgb(Bench& bench) { return format_as_grey(bench, ODO_FORMAT_RGB8); }
Verdict rgba(Bench& bench) { return format_as_grey(bench, ODO_FORMAT_RGBA8); }
Verdict bgra(Bench& bench) { return format_as_grey(bench, ODO_FORMAT_BGRA8); }

Verdict later_format(Bench& bench) {
  return survives(bench, [](AnyMessage& message) { frame_of(message).format = 99; });
}

Verdict other_size(Bench& bench) {
  int count = 0;
  return survives(bench, [&](AnyMessage& message) {
    if (++count % 3 == 0) frame_of(message).width = kW / 2, frame_of(message).height = kH / 2;
  });
}

Verdict tiny(Bench& bench) {
  return survives(bench, [](AnyMessage& message) { frame_of(message).width = frame_of(message).height = 1; });
}

Verdict black(Bench& bench) {
  static const std::vector<uint8_t> pixels(kW * kH, 0);
  return survives(bench, [](AnyMessage& message) { frame_of(message).planes[0].data = pixels.data(); });
}

Verdict noise(Bench& bench) {
  std::vector<std::vector<uint8_t>> kept;
  uint32_t random = 1;
  return survives(bench, [&](AnyMessage& message) {
    auto& pixels = kept.emplace_back(kW * kH);
    for (uint8_t& pixel : pixels) random = random * 1664525u + 1013904223u, pixel = static_cast<uint8_t>(random >> 24);
    frame_of(message).planes[0].data = pixels.data();
  });
}

Verdict masked(Bench& bench) {
  static const std::vector<uint8_t> mask(kW * kH, 0);
  return survives(bench, [](AnyMessage& message) {
    frame_of(message).mask = {mask.data(), kW, 1, 0};
    message.header().flags |= ODO_FRAME_MASK;
  });
}

Verdict unknown_camera(Bench& bench) {
  return survives(bench, [](AnyMessage& message) { message.header().source = 7; });
}

/// Varies the focal length by 3 % and back, like autofocus.
Verdict autofocus(Bench& bench) {
  int count = 0;
  return survives(bench, [&](AnyMessage& message) {
    odo_frame& frame = frame_of(message);
    message.header().flags |= ODO_FRAME_INTRINSICS;
    frame.fx = frame.fy = 60 * (1 + 0.03 * ((++count / 5) % 2));
    frame.cx = 31.5, frame.cy = 23.5;
  });
}

Verdict no_calibration(Bench& bench) {
  if (!bench.wants(ODO_TYPE_FRAME)) return not_applicable("it is given no frames");
  std::vector<AnyMessage> without;
  for (const AnyMessage& message : bench.input)
    if (message.header().type != ODO_TYPE_CALIBRATION) without.push_back(message);
  const auto subject = bench.started();
  const int32_t status = subject->process(without);
  return status >= 0 ? "" : "process failed with status " + std::to_string(status) + " without a camera description";
}

}  // namespace

std::vector<Case> frame_cases() {
  return {
      {"frames.borrowed", "reads the pixels only within the call, and writes none", 20, 4, true, gone},
      {"frames.balance", "releases what it retains", 20, 4, true, balance},
      {"frames.quota", "retains at most 7 frames at once", 20, 4, true, quota},
      {"frames.exhausted", "works with a host that refuses to retain frames", 20, 4, true, exhausted},
      {"frames.strides", "reads rows by their stride", 20, 3, true, strides},
      {"frames.nv12", "sees the same in NV12", 20, 3, true, nv12},
      {"frames.nv21", "sees the same in NV21", 20, 3, true, nv21},
      {"frames.yuv420", "sees the same in three planes of YUV 4:2:0", 20, 3, true, yuv420},
      {"frames.rgb", "sees the same in RGB", 20, 3, true, rgb},
      {"frames.rgba", "sees the same in RGBA", 20, 3, true, rgba},
      {"frames.bgra", "sees the same in BGRA", 20, 3, true, bgra},
      {"frames.later_format", "survives a format of a later version", 20, 3, true, later_format},
      {"frames.other_size", "survives frames of another size than the calibration's", 20, 3, true, other_size},
      {"frames.tiny", "survives frames of one pixel", 20, 3, true, tiny},
      {"frames.black", "survives black frames", 20, 3, true, black},
      {"frames.noise", "survives noise", 20, 3, true, noise},
      {"frames.mask", "survives a mask that covers everything", 20, 3, true, masked},
      {"frames.unknown_camera", "survives frames of a camera without description", 20, 3, true, unknown_camera},
      {"frames.no_calibration", "survives frames before any calibration", 20, 3, true, no_calibration},
      {"frames.autofocus", "survives a focal length that changes by 3 %", 20, 4, true, autofocus},
  };
}

}  // namespace odograph
