// SPDX-License-Identifier: Apache-2.0
//
// Templates of `odograph plugin new`; words between @ are replaced.
#pragma once

namespace odograph {

/// The parts that depend on the kind: a small working algorithm, to be replaced.
struct Skeleton {
  const char* kind;
  const char* interface_macro;
  const char* summary;
  const char* input;     // the message that it processes
  const char* state;     // members, for both languages
  const char* cpp_body;  // body of on(message, output)
  const char* c_body;    // body of on_message(self, message)
  const char* rest;      // rest of the pipeline.yaml that it needs
};

inline const Skeleton kSkeletons[] = {
    {"attitude", "ODO_INTERFACE_ATTITUDE", "Level by the accelerometer, heading by the gyroscope", "odo_imu",
     "  double heading_rad = 0, up_b[3] = {0, 0, 0};\n  int64_t last_ns = 0;\n",
     R"(    for (int i = 0; i < 3; ++i)  // beyond any sensor's range; it would corrupt up_b permanently
      if (!(std::abs(message.gyro_b[i]) < 1e3 && std::abs(message.accel_b[i]) < 1e3))
        throw odo::Error(ODO_E_DISCARD, "gyro_b or accel_b is beyond any sensor");
    const double dt = last_ns ? 1e-9 * static_cast<double>(message.header.t_ns - last_ns) : 0.0;
    last_ns = message.header.t_ns;
    for (int i = 0; i < 3; ++i) up_b[i] += (message.accel_b[i] - up_b[i]) * (dt > 0 ? std::min(1.0, gain * dt) : 1.0);
    const double norm = std::sqrt(up_b[0] * up_b[0] + up_b[1] * up_b[1] + up_b[2] * up_b[2]);
    if (!(norm > 1.0)) return;
    double yaw_rate = 0;
    for (int i = 0; i < 3; ++i) yaw_rate -= message.gyro_b[i] * up_b[i] / norm;  // about down
    heading_rad += dt > 0 && dt < 1 ? yaw_rate * dt : 0;
    auto event = odo::make<odo_attitude>(message.header.t_ns);
    // The shortest rotation from up_b to z, half a turn about x (up is -z in North-East-Down), the heading about z.
    double w = norm + up_b[2], x = up_b[1], y = -up_b[0];
    const double q = std::sqrt(w * w + x * x + y * y), c = std::cos(heading_rad / 2), s = std::sin(heading_rad / 2);
    if (q > 1e-6 * norm) w /= q, x /= q, y /= q;
    else w = 0, x = 1, y = 0;
    event.q_n_b[0] = -c * x - s * y, event.q_n_b[1] = c * w, event.q_n_b[2] = s * w, event.q_n_b[3] = c * y - s * x;
    for (int i = 0; i < 3; ++i) event.covariance_n[4 * i] = 0.01;
    output.emit(event);
)",
     R"(  const odo_imu *imu = (const odo_imu *)(const void *)message;
  const double dt = self->last_ns ? 1e-9 * (double)(message->t_ns - self->last_ns) : 0.0;
  const double blend = dt > 0 ? (self->gain * dt < 1 ? self->gain * dt : 1) : 1;
  double norm, yaw_rate = 0, w, x, y, q, c, s;
  odo_attitude event;
  int i;
  if (message->type != ODO_TYPE_IMU) return ODO_OK;
  for (i = 0; i < 3; ++i) /* no sensor says that, and it would stay in up_b for ever */
    if (!(fabs(imu->gyro_b[i]) < 1e3 && fabs(imu->accel_b[i]) < 1e3)) return ODO_E_DISCARD;
  self->last_ns = message->t_ns;
  for (i = 0; i < 3; ++i) self->up_b[i] += (imu->accel_b[i] - self->up_b[i]) * blend;
  norm = sqrt(self->up_b[0] * self->up_b[0] + self->up_b[1] * self->up_b[1] + self->up_b[2] * self->up_b[2]);
  if (!(norm > 1.0)) return ODO_NOT_READY;
  for (i = 0; i < 3; ++i) yaw_rate -= imu->gyro_b[i] * self->up_b[i] / norm; /* about down */
  self->heading_rad += dt > 0 && dt < 1 ? yaw_rate * dt : 0;
  memset(&event, 0, sizeof event);
  event.header.struct_size = sizeof event;
  event.header.type = ODO_TYPE_ATTITUDE;
  event.header.t_ns = message->t_ns;
  /* The shortest rotation that takes up_b to z, half a turn about x (up is -z in North-East-Down), the heading about z. */
  w = norm + self->up_b[2], x = self->up_b[1], y = -self->up_b[0];
  q = sqrt(w * w + x * x + y * y), c = cos(self->heading_rad / 2), s = sin(self->heading_rad / 2);
  if (q > 1e-6 * norm) {
    w /= q, x /= q, y /= q;
  } else {
    w = 0, x = 1, y = 0;
  }
  event.q_n_b[0] = -c * x - s * y, event.q_n_b[1] = c * w, event.q_n_b[2] = s * w, event.q_n_b[3] = c * y - s * x;
  for (i = 0; i < 3; ++i) event.covariance_n[4 * i] = 0.01;
  return self->sink->emit(self->sink, &event.header);
)",
     "step_estimator:\n  plugin: step/odograph\ncoupling:\n  type: localizer\n"},
    {"step_estimator", "ODO_INTERFACE_STEP_ESTIMATOR", "A step of one length for each swing of the accelerometer",
     "odo_imu", "  int64_t last_ns = 0;\n  bool high = false;\n  uint32_t count = 0;\n",
     R"(    const double* a = message.accel_b;
    const bool now = std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) > 10.8;
    const bool begins = !std::exchange(high, now) && now;
    if (!begins || message.header.t_ns - last_ns < 300'000'000) return;
    const int64_t before_ns = std::exchange(last_ns, message.header.t_ns);
    if (message.header.t_ns - before_ns > 1'500'000'000) return;  // the first of a walk
    auto event = odo::make<odo_step>(message.header.t_ns);
    event.t_start_ns = before_ns, event.t_end_ns = message.header.t_ns;
    event.length_m = gain, event.sigma_m = 0.2 * gain;
    event.frequency_hz = 1e9 / static_cast<double>(message.header.t_ns - before_ns);
    event.index = count++;
    output.emit(event);
)",
     R"(  const odo_imu *imu = (const odo_imu *)(const void *)message;
  const double *a = imu->accel_b;
  const int64_t before_ns = self->last_ns;
  odo_step event;
  int now, begins;
  if (message->type != ODO_TYPE_IMU) return ODO_OK;
  now = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) > 10.8;
  begins = now && !self->high;
  self->high = now;
  if (!begins || message->t_ns - before_ns < 300000000) return ODO_OK;
  self->last_ns = message->t_ns;
  if (message->t_ns - before_ns > 1500000000) return ODO_OK; /* the first of a walk */
  memset(&event, 0, sizeof event);
  event.header.struct_size = sizeof event;
  event.header.type = ODO_TYPE_STEP;
  event.header.t_ns = message->t_ns;
  event.t_start_ns = before_ns, event.t_end_ns = message->t_ns;
  event.length_m = self->gain, event.sigma_m = 0.2 * self->gain;
  event.frequency_hz = 1e9 / (double)(message->t_ns - before_ns);
  event.index = self->count++;
  return self->sink->emit(self->sink, &event.header);
)",
     "attitude:\n  plugin: attitude/vqf\ncoupling:\n  type: localizer\n"},
    {"vo_frontend", "ODO_INTERFACE_VO_FRONTEND", "Reports each frame without a motion, as initialising", "odo_frame",
     "  int64_t last_ns = 0;\n  bool begun = false;\n",
     R"(    if (begun && message.header.t_ns <= last_ns) throw odo::Error(ODO_E_DISCARD, "t_ns is not after the frame's before");
    const int64_t from_ns = std::exchange(last_ns, message.header.t_ns);
    if (!std::exchange(begun, true)) return;
    auto event = odo::make<odo_vo_motion>(message.header.t_ns);
    event.t_from_ns = from_ns;
    event.camera = message.header.source;
    event.state = ODO_LOST, event.reason = ODO_REASON_INITIALISING;
    output.emit(event);
)",
     R"(  const odo_frame *frame = (const odo_frame *)(const void *)message;
  const int64_t from_ns = self->last_ns;
  odo_vo_motion event;
  if (message->type != ODO_TYPE_FRAME) return ODO_OK;
  if (self->begun && message->t_ns <= from_ns) return ODO_E_DISCARD;
  self->last_ns = message->t_ns;
  if (!self->begun) {
    self->begun = 1;
    return ODO_NOT_READY;
  }
  memset(&event, 0, sizeof event);
  event.header.struct_size = sizeof event;
  event.header.type = ODO_TYPE_VO_MOTION;
  event.header.t_ns = message->t_ns;
  event.t_from_ns = from_ns;
  event.camera = frame->header.source;
  event.state = ODO_LOST, event.reason = ODO_REASON_INITIALISING;
  return self->sink->emit(self->sink, &event.header);
)",
     "attitude:\n  plugin: attitude/vqf\nstep_estimator:\n  plugin: step/odograph\ncoupling:\n  type: localizer\n"},
    {"scale_source", "ODO_INTERFACE_SCALE_SOURCE", "Scale from one known speed", "odo_vo_motion", "",
     R"(    const double* p = message.p_c0_c1;
    const double units = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    if ((message.header.flags & ODO_VO_TRANSLATION) == 0 || !(units > 1e-9 && units < 1e9)) return;
    auto event = odo::make<odo_scale>(message.header.t_ns);
    event.scale = gain * 1e-9 * static_cast<double>(message.header.t_ns - message.t_from_ns) / units;
    event.sigma = 0.2 * event.scale;
    event.valid_from_ns = message.t_from_ns, event.valid_to_ns = message.header.t_ns;
    event.scale_group = message.scale_group;
    output.emit(event);
)",
     R"(  const odo_vo_motion *motion = (const odo_vo_motion *)(const void *)message;
  const double *p = motion->p_c0_c1;
  double units;
  odo_scale event;
  if (message->type != ODO_TYPE_VO_MOTION) return ODO_OK;
  units = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
  if (!(message->flags & ODO_VO_TRANSLATION) || !(units > 1e-9 && units < 1e9)) return ODO_NOT_READY;
  memset(&event, 0, sizeof event);
  event.header.struct_size = sizeof event;
  event.header.type = ODO_TYPE_SCALE;
  event.header.t_ns = message->t_ns;
  event.scale = self->gain * 1e-9 * (double)(message->t_ns - motion->t_from_ns) / units;
  event.sigma = 0.2 * event.scale;
  event.valid_from_ns = motion->t_from_ns, event.valid_to_ns = message->t_ns;
  event.scale_group = motion->scale_group;
  return self->sink->emit(self->sink, &event.header);
)",
     "vo_frontend:\n  plugin: vo/five_point\n"},
    {"absolute_fixer", "ODO_INTERFACE_ABSOLUTE_FIXER", "A fix for each waypoint", "odo_waypoint", "",
     R"(    if (!(std::hypot(message.p_n[0], message.p_n[1]) < 1e7 && message.sigma_m < 1e7)) return;  // not a position on the Earth
    auto event = odo::make<odo_fix>(message.header.t_ns);
    event.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE;
    for (int i = 0; i < 2; ++i) event.p_n[i] = message.p_n[i];
    const double sigma = std::max(gain * 0.01, message.sigma_m);
    for (int i = 0; i < 3; ++i) event.covariance_n[4 * i] = sigma * sigma;
    output.emit(event);
)",
     R"(  const odo_waypoint *waypoint = (const odo_waypoint *)(const void *)message;
  odo_fix event;
  double sigma;
  int i;
  if (message->type != ODO_TYPE_WAYPOINT) return ODO_OK;
  if (!(fabs(waypoint->p_n[0]) < 1e7 && fabs(waypoint->p_n[1]) < 1e7 && waypoint->sigma_m < 1e7)) return ODO_E_DISCARD;
  memset(&event, 0, sizeof event);
  event.header.struct_size = sizeof event;
  event.header.type = ODO_TYPE_FIX;
  event.header.t_ns = message->t_ns;
  event.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE;
  for (i = 0; i < 2; ++i) event.p_n[i] = waypoint->p_n[i];
  sigma = waypoint->sigma_m > 0.01 * self->gain ? waypoint->sigma_m : 0.01 * self->gain;
  for (i = 0; i < 3; ++i) event.covariance_n[4 * i] = sigma * sigma;
  return self->sink->emit(self->sink, &event.header);
)",
     "attitude:\n  plugin: attitude/vqf\nstep_estimator:\n  plugin: step/odograph\ncoupling:\n  type: localizer\n"},
};

inline constexpr char kCpp[] = R"(// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include <odograph/plugin.hpp>

namespace {

struct Plugin {
  double gain = @DEFAULT@;  // the initialiser is the parameter's default

  static constexpr odo::Description description{"@ID@", "0.1.0", "@SUMMARY@", @INTERFACE@};

  static std::vector<odo::Parameter<Plugin>> parameters() {
    return {odo::real("gain", "@UNIT@", @LOW@, @HIGH@, &Plugin::gain, "@HELP@")};
  }

  void on(const @INPUT@& message, odo::Output& output) {
@BODY@  }

@STATE@};

}  // namespace

ODO_PLUGIN(Plugin)
)";

inline constexpr char kC[] = R"(/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <odograph/@KIND@.h>
#include <odograph/messages.h>

struct odo_instance {
  const odo_sink *sink;
  double gain;
@STATE@};

#define TEXT(literal) {literal, sizeof(literal) - 1}
static const odo_string kind = TEXT(@INTERFACE@);

static int32_t ODO_CALL create(const odo_host *host, uint32_t number, const odo_string *wanted, odo_instance **out) {
  (void)host, (void)number;
  if (!out || !wanted || wanted->size != kind.size || memcmp(wanted->data, kind.data, kind.size) != 0)
    return ODO_E_UNSUPPORTED;
  *out = (odo_instance *)calloc(1, sizeof **out);
  if (!*out) return ODO_E_MEMORY;
  (*out)->gain = @DEFAULT@;
  return ODO_OK;
}

static int32_t ODO_CALL configure(odo_instance *self, const odo_value *values, uint32_t count, uint32_t stride) {
  uint32_t i;
  for (i = 0; i < count; ++i) { /* the rows of a newer host are larger */
    const odo_value *value = (const odo_value *)(const void *)((const char *)values + (size_t)i * stride);
    if (value->name.size == 4 && memcmp(value->name.data, "gain", 4) == 0) self->gain = value->reals[0];
  }
  return ODO_OK;
}

static int32_t ODO_CALL activate(odo_instance *self, const odo_sink *sink) {
  self->sink = sink;
  return ODO_OK;
}

static int32_t on_message(odo_instance *self, const odo_header *message) {
@BODY@}

static int32_t ODO_CALL process(odo_instance *self, const odo_batch *batch) {
  int32_t worst = ODO_OK;
  uint32_t i;
  for (i = 0; i < batch->count; ++i) {
    const int32_t status = on_message(self, batch->messages[i]);
    if (status < worst) worst = status;
  }
  return worst;
}

static int32_t ODO_CALL reset(odo_instance *self) {
  const odo_instance before = *self;
  memset(self, 0, sizeof *self);
  self->sink = before.sink, self->gain = before.gain;
  return ODO_OK;
}

static void ODO_CALL destroy(odo_instance *self) { free(self); }

static const odo_parameter parameters[] = {{sizeof(odo_parameter), ODO_PARAMETER_REAL, TEXT("gain"), TEXT("@UNIT@"),
                                            TEXT("@HELP@"), TEXT("@DEFAULT@"), {NULL, 0}, @LOW@, @HIGH@, 1, 0}};

int32_t ODO_CALL ODO_PLUGIN_ENTRY(const odo_host *host, odo_plugin *out) {
  static const odo_string id = TEXT("@ID@"), version = TEXT("0.1.0"), summary = TEXT("@SUMMARY@");
  static const odo_string refusal = TEXT("plugin and host have no common ABI version");
  odo_plugin table;
  uint32_t size;
  if (!host || !out || out->struct_size < ODO_PLUGIN_SIZE_MIN) return ODO_E_STRUCT_SIZE;
  if (!ODO_HOST_FITS(host)) {
    out->refusal = refusal;
    return ODO_E_VERSION;
  }
  memset(&table, 0, sizeof table);
  table.struct_size = sizeof table;
  table.abi_major = ODO_ABI_MAJOR, table.abi_minor = ODO_ABI_MINOR;
  table.interfaces = &kind, table.interface_count = 1;
  table.id = id, table.version = version, table.summary = summary;
  table.parameters = parameters, table.parameter_count = 1, table.parameter_stride = sizeof(odo_parameter);
  table.create = create, table.configure = configure, table.activate = activate;
  table.process = process, table.reset = reset, table.destroy = destroy;
  /* An older or newer host has a smaller or larger table. */
  size = out->struct_size < table.struct_size ? out->struct_size : table.struct_size;
  memcpy(out, &table, size);
  out->struct_size = size;
  return ODO_OK;
}
)";

inline constexpr char kCMake[] = R"(cmake_minimum_required(VERSION 3.16)
project(@FILE@ LANGUAGES @LANGUAGE@)
find_package(Odograph REQUIRED)
add_library(@FILE@ MODULE @SOURCE@)
target_link_libraries(@FILE@ PRIVATE Odograph::abi@LIBRARIES@)
set_target_properties(@FILE@ PROPERTIES PREFIX "" @STANDARD@)
# Export only the entry function; allow no undefined symbols.
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/plugin.map "{ global: odo_plugin_entry_*; local: *; };")
target_link_options(@FILE@ PRIVATE @STATIC@-Wl,--version-script=${CMAKE_CURRENT_BINARY_DIR}/plugin.map -Wl,-z,defs)
# Write the manifest beside the library.
find_program(ODOGRAPH_PROGRAM odograph HINTS ${Odograph_DIR}/../../../bin ${Odograph_DIR}/../../../../bin REQUIRED)
add_custom_command(TARGET @FILE@ POST_BUILD COMMAND ${ODOGRAPH_PROGRAM} plugin manifest $<TARGET_FILE:@FILE@> VERBATIM)
# `ctest --test-dir build`; check.xml is for CI systems; conformance.md and its badge are for publication.
include(CTest)
add_test(NAME check COMMAND ${ODOGRAPH_PROGRAM} plugin check $<TARGET_FILE:@FILE@> --format junit -o check.xml --statement .)
add_test(NAME pipeline COMMAND ${ODOGRAPH_PROGRAM} config check ${CMAKE_CURRENT_SOURCE_DIR}/pipeline.yaml)
set_tests_properties(pipeline PROPERTIES ENVIRONMENT ODOGRAPH_PLUGIN_PATH=${CMAKE_CURRENT_BINARY_DIR})
)";

inline constexpr char kReadme[] = R"(# @ID@

```sh
cmake -B build -DCMAKE_PREFIX_PATH=PREFIX && cmake --build build   # PREFIX: where Odograph is installed
odograph plugin check build/@FILE@.so
odograph plugins @ID@ --plugins build   # its summary and its parameters, as it was built
odograph run -c pipeline.yaml -i RECORDING
```
)";

}  // namespace odograph
