// SPDX-License-Identifier: Apache-2.0
// | Messages pushed by an app and events emitted by a plugin: any bytes of any type, into a pipeline with every kind of
// plugin. A message is a type number, its size, the meaning of its time, and its bytes. session.hpp checks the output.
#include <cstring>
#include <vector>

#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/session.hpp"

namespace {

constexpr uint32_t kInputs[] = {ODO_TYPE_IMU,          ODO_TYPE_MAGNETOMETER, ODO_TYPE_BAROMETER, ODO_TYPE_GNSS,
                                ODO_TYPE_FRAME,        ODO_TYPE_CALIBRATION,  ODO_TYPE_IMU_NOISE, ODO_TYPE_WAYPOINT,
                                ODO_TYPE_VENDOR(0, 3), ODO_TYPE_VENDOR(0, 1)};
constexpr uint32_t kEvents[] = {ODO_TYPE_ATTITUDE,
                                ODO_TYPE_STEP,
                                ODO_TYPE_MOTION_MODE,
                                ODO_TYPE_VO_MOTION,
                                ODO_TYPE_SCALE,
                                ODO_TYPE_FIX,
                                ODO_TYPE_POSE,
                                ODO_TYPE_STATE,
                                ODO_TYPE_CORRECTION,
                                ODO_TYPE_CALIBRATION,
                                ODO_TYPE_VENDOR(0, ODO_VENDOR_EVENT | 2)};
constexpr size_t kMaxMessages = 48;
constexpr int kInputsOfSession = 200;
constexpr uint32_t kMaxPixels = 48;  // of a side

struct alignas(8) Message {
  unsigned char bytes[2048] = {};
  odo_header& header(size_t at = 0) { return *reinterpret_cast<odo_header*>(bytes + at); }
};

/// The pixels belong to the app: sizes and pointers are valid ones.
void give_pixels(odo_frame& frame) {
  static const std::vector<uint8_t> pixels(size_t(kMaxPixels) * kMaxPixels * 16, 90);
  frame.width %= kMaxPixels + 1, frame.height %= kMaxPixels + 1;
  for (odo_plane* plane : {&frame.planes[0], &frame.planes[1], &frame.planes[2], &frame.planes[3], &frame.mask})
    *plane = {pixels.data(), kMaxPixels * 4, 1 + plane->pixel_stride % 2, 0};
  frame.loan.retain = nullptr, frame.loan.release = nullptr, frame.loan.owner = nullptr;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  // One session takes many inputs with increasing times: creating one is slower than running an input.
  static odo_session* session = nullptr;
  static int64_t now_ns = 1'000'000'000;
  static int inputs = 0;
  if (++inputs % kInputsOfSession == 0) {
    odo_session_destroy(session);
    session = nullptr;
  }
  if (!session)
    session = fuzz::open(
        "attitude:\n  plugin: attitude/vqf\nstep_estimator:\n  plugin: step/renaudin2012\n"
        "vo_frontend:\n  plugin: test/echo\nscale_source:\n  plugin: scale/step_length\n"
        "absolute_fixers:\n  - plugin: fix/gnss\n  - plugin: fix/waypoint\n  - plugin: fix/barometer\n");
  fuzz::Bytes left(data, size);
  for (size_t count = 0; !left.empty() && count < kMaxMessages; ++count) {
    const auto which = left.take<uint8_t>(), length = left.take<uint8_t>(), time = left.take<uint8_t>();
    Message message;
    constexpr size_t kAll = std::size(kInputs) + std::size(kEvents);
    const size_t number = which % kAll;
    const bool is_event = number >= std::size(kInputs);
    const size_t at = is_event ? sizeof(odo_header) : 0, bytes = length * 4u;
    const auto body = left.take(bytes);
    std::memcpy(message.bytes + at, body.data(), body.size());
    odo_header& inner = message.header(at);
    inner.struct_size = static_cast<uint32_t>(bytes);
    inner.type = is_event ? kEvents[number - std::size(kInputs)] : kInputs[number];
    now_ns += int64_t(time % 64) * 1'000'000;
    if (time < 224) inner.t_ns = now_ns;  // otherwise the input's own time
    if (is_event) {
      odo_header& outer = message.header();
      outer.struct_size = static_cast<uint32_t>(sizeof(odo_header) + bytes);
      outer.type = ODO_TYPE_VENDOR(0, 1);
      outer.t_ns = now_ns;
    }
    if (inner.type == ODO_TYPE_FRAME && bytes >= sizeof(odo_frame)) give_pixels(reinterpret_cast<odo_frame&>(inner));
    if (inner.type == ODO_TYPE_FRAME && bytes < sizeof(odo_frame)) continue;
    odo_session_push(session, &message.header());
  }
  odo_session_flush(session);
  odo_pose pose{};
  pose.header.struct_size = sizeof pose;
  if (odo_session_get_pose(session, ODO_TIME_LATEST, &pose) == ODO_OK) fuzz::check(pose.header);
  return 0;
}
