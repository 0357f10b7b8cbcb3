// SPDX-License-Identifier: Apache-2.0
//
// What count_frame.py counts: a session within one program, with attitude/vqf and a front-end without an algorithm
// (hostile/needy_vo.cpp). After two seconds, push_imu and push_frame are called once each.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include <odograph/odograph.h>
#include <odograph/plugin.h>

#include "sdk/host/messages/messages.hpp"

extern "C" {
int32_t ODO_CALL odo_plugin_entry_attitude_vqf(const odo_host* host, odo_plugin* out);
int32_t ODO_CALL ODO_PLUGIN_ENTRY(const odo_host* host, odo_plugin* out);

// Names for callgrind's options.
int32_t push_imu(odo_session* session, const odo_imu* imu) { return odo_session_push(session, &imu->header); }
int32_t push_frame(odo_session* session, const odo_frame* frame) { return odo_session_push(session, &frame->header); }
}

namespace {

using odograph::make_message;

constexpr int64_t kMs = 1'000'000;
uint64_t events = 0;
uint32_t last_event = 0;

void on_event(void*, const odo_header* event) {
  ++events;
  last_event = event->type;
}

odo_imu imu_at(int64_t t_ns) {
  auto imu = make_message<odo_imu>(ODO_TYPE_IMU, t_ns);
  imu.header.flags = ODO_IMU_GYRO | ODO_IMU_ACCEL;
  imu.gyro_b[1] = 0.05 * std::sin(static_cast<double>(t_ns) * 1e-9);
  imu.accel_b[1] = 9.81;
  return imu;
}

int32_t ODO_CALL keep(void*) { return ODO_OK; }
void ODO_CALL drop(void*) {}

/// Lends its pixels, so that they are not copied.
odo_frame frame_at(int64_t t_ns) {
  static const std::vector<uint8_t> pixels(64 * 48, 90);
  static int owner = 0;
  auto frame = make_message<odo_frame>(ODO_TYPE_FRAME, t_ns);
  frame.format = ODO_FORMAT_GREY8;
  frame.width = 64, frame.height = 48;
  frame.planes[0] = {pixels.data(), 64, 1, 0};
  frame.loan.owner = &owner, frame.loan.retain = keep, frame.loan.release = drop;
  return frame;
}

odo_calibration calibration() {
  auto camera = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  camera.model = ODO_CAMERA_PINHOLE;
  camera.width = 64, camera.height = 48;
  camera.fx = camera.fy = 64, camera.cx = 32, camera.cy = 24;
  return camera;
}

int fail(const std::string& text) {
  std::fprintf(stderr, "count_frame: %s\n", text.c_str());
  return 1;
}

}  // namespace

int main() {
  odo_register_plugin(odo_plugin_entry_attitude_vqf, nullptr);
  odo_register_plugin(ODO_PLUGIN_ENTRY, nullptr);
  const std::string config =
      "odograph: 1\nattitude: {plugin: attitude/vqf}\nvo_frontend: {plugin: test/needy_vo}\n"
      "coupling: {type: localizer}\ntime_ordering: {max_wait: 0 s}\n";
  odo_session_options options{};
  options.struct_size = sizeof options;
  options.run = ODO_RUN_REPLAY;
  options.config_text = {config.data(), config.size()};
  odo_error error{sizeof error, ODO_OK, {}};
  odo_session* session = nullptr;
  if (odo_session_create(&options, &session, &error) != ODO_OK) return fail(error.message);
  odo_session_set_callback(session, nullptr, ODO_ALL_EVENTS, on_event, nullptr);
  const odo_calibration camera = calibration();
  odo_session_push(session, &camera.header);
  int64_t t_ns = 0;
  for (; t_ns < 2000 * kMs; t_ns += 5 * kMs) {
    const odo_imu imu = imu_at(t_ns);
    odo_session_push(session, &imu.header);
    const odo_frame frame = frame_at(t_ns + kMs);
    if (t_ns % (100 * kMs) == 0) odo_session_push(session, &frame.header);
  }
  const odo_imu imu = imu_at(t_ns);
  events = 0;
  if (push_imu(session, &imu) != ODO_OK || events != 1 || last_event != ODO_TYPE_ATTITUDE)
    return fail("the sample has not given one attitude");
  const odo_frame frame = frame_at(t_ns + kMs);
  events = 0;
  if (push_frame(session, &frame) != ODO_OK || events != 2 || last_event != ODO_TYPE_POSE)
    return fail("the frame has not given one motion and one pose");
  odo_session_destroy(session);
  return 0;
}
