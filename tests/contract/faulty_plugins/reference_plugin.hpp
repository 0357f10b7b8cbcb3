// SPDX-License-Identifier: Apache-2.0
//
// A small good plugin of each kind, in which the faulty plugins of this folder change one item. They are written for
// the walk of `odograph plugin check` and report its truth. Each is built separately, with FAULTY_name defined; the
// name of the library is that of the case that must detect it.
#pragma once

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include <odograph/absolute_fixer.h>
#include <odograph/attitude.h>
#include <odograph/messages.h>
#include <odograph/plugin.h>
#include <odograph/scale_source.h>
#include <odograph/step_estimator.h>
#include <odograph/vo_frontend.h>

namespace faulty {

enum Kind { attitude, steps, odometry, scale, fixer };

union Event {
  odo_header header;
  odo_attitude attitude;
  odo_step step;
  odo_motion_mode mode;
  odo_vo_motion motion;
  odo_scale scale;
  odo_fix fix;
  odo_calibration calibration;
  Event() { std::memset(static_cast<void*>(this), 0, sizeof *this); }
};

struct State {
  const odo_host* host = nullptr;
  const odo_sink* sink = nullptr;
  double gain = 1;
  uint32_t steps = 0, inputs = 0;
  int64_t last_step_ns = 0, last_frame_ns = INT64_MIN;
  bool mode_said = false;
  void* more = nullptr;
};

// Each faulty plugin defines one of these.
void on_table(odo_plugin& table);
void on_event(State& state, Event& event);
int32_t on_input(State& state, const odo_header& message);
Kind kind();

inline State& of(odo_instance* instance) { return *reinterpret_cast<State*>(instance); }

inline void emit(State& s, Event& event, uint32_t type, uint32_t size, int64_t t_ns) {
  event.header.type = type, event.header.struct_size = size, event.header.t_ns = t_ns, event.header.quality = 0.5f;
  on_event(s, event);
  s.sink->emit(s.sink, &event.header);
}

inline void answer_imu(State& s, const odo_header& m) {
  Event event;
  event.attitude.q_n_b[1] = 1;
  for (int i = 0; i < 3; ++i) event.attitude.covariance_n[4 * i] = 1e-3;
  emit(s, event, ODO_TYPE_ATTITUDE, sizeof(odo_attitude), m.t_ns);
}

inline void answer_walk(State& s, const odo_header& m) {
  if (!s.mode_said) {
    s.mode_said = true;
    Event event;
    event.mode.mode = ODO_MODE_WALKING_TEXTING;
    emit(s, event, ODO_TYPE_MOTION_MODE, sizeof(odo_motion_mode), m.t_ns);
  }
  if (s.last_step_ns == 0) s.last_step_ns = m.t_ns;
  if (m.t_ns - s.last_step_ns < 500'000'000) return;
  Event event;
  event.step.t_start_ns = m.t_ns - 500'000'000, event.step.t_end_ns = m.t_ns;
  event.step.length_m = 0.7 * s.gain, event.step.sigma_m = 0.05, event.step.frequency_hz = 2;
  event.step.mode = ODO_MODE_WALKING_TEXTING, event.step.index = s.steps++;
  s.last_step_ns = m.t_ns;
  emit(s, event, ODO_TYPE_STEP, sizeof(odo_step), m.t_ns);
}

inline void answer_frame(State& s, const odo_header& m) {
  const int64_t from_ns = std::exchange(s.last_frame_ns, m.t_ns);
  if (from_ns == INT64_MIN || from_ns >= m.t_ns) return;
  Event event;
  event.motion.t_from_ns = from_ns;
  event.motion.header.flags = ODO_VO_ROTATION | ODO_VO_TRANSLATION | ODO_VO_COVARIANCE;
  event.motion.q_c0_c1[0] = 1, event.motion.p_c0_c1[0] = 0.1;
  for (int i = 0; i < 6; ++i) event.motion.covariance[7 * i] = 1e-4;
  event.motion.state = ODO_TRACKING, event.motion.tracked = 90, event.motion.inliers = 80;
  emit(s, event, ODO_TYPE_VO_MOTION, sizeof(odo_vo_motion), m.t_ns);
}

inline void answer_motion(State& s, const odo_header& m) {
  const auto& motion = reinterpret_cast<const odo_vo_motion&>(m);
  Event event;
  event.scale.valid_from_ns = motion.t_from_ns, event.scale.valid_to_ns = m.t_ns;
  event.scale.scale = 1.4 * s.gain, event.scale.sigma = 0.1, event.scale.scale_group = motion.scale_group;
  emit(s, event, ODO_TYPE_SCALE, sizeof(odo_scale), m.t_ns);
}

inline void answer_waypoint(State& s, const odo_header& m) {
  Event event;
  event.fix.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE;
  event.fix.p_n[0] = reinterpret_cast<const odo_waypoint&>(m).p_n[0];
  for (int i = 0; i < 3; ++i) event.fix.covariance_n[4 * i] = 1;
  emit(s, event, ODO_TYPE_FIX, sizeof(odo_fix), m.t_ns);
}

inline int32_t process(odo_instance* instance, const odo_batch* batch) {
  State& s = of(instance);
  for (uint32_t i = 0; i < batch->count; ++i) {
    const odo_header& m = *batch->messages[i];
    ++s.inputs;
    if (const int32_t status = on_input(s, m); status < 0) return status;
    if (kind() == attitude && m.type == ODO_TYPE_IMU) answer_imu(s, m);
    if (kind() == steps && m.type == ODO_TYPE_IMU) answer_walk(s, m);
    if (kind() == odometry && m.type == ODO_TYPE_FRAME) answer_frame(s, m);
    if (kind() == scale && m.type == ODO_TYPE_VO_MOTION) answer_motion(s, m);
    if (kind() == fixer && m.type == ODO_TYPE_WAYPOINT) answer_waypoint(s, m);
  }
  return ODO_OK;
}

inline const odo_string& interface_of() {
  static const odo_string all[] = {{ODO_INTERFACE_ATTITUDE, sizeof ODO_INTERFACE_ATTITUDE - 1},
                                   {ODO_INTERFACE_STEP_ESTIMATOR, sizeof ODO_INTERFACE_STEP_ESTIMATOR - 1},
                                   {ODO_INTERFACE_VO_FRONTEND, sizeof ODO_INTERFACE_VO_FRONTEND - 1},
                                   {ODO_INTERFACE_SCALE_SOURCE, sizeof ODO_INTERFACE_SCALE_SOURCE - 1},
                                   {ODO_INTERFACE_ABSOLUTE_FIXER, sizeof ODO_INTERFACE_ABSOLUTE_FIXER - 1}};
  return all[kind()];
}

inline odo_string str(const char* text) { return {text, std::strlen(text)}; }

inline std::vector<odo_parameter>& parameters() {
  static std::vector<odo_parameter> rows = {{sizeof(odo_parameter), ODO_PARAMETER_REAL, str("gain"), str(""),
                                             str("Of what it says (a judgement)."), str("1"), str(""), 0.5, 2, 1, 0},
                                            {sizeof(odo_parameter), ODO_PARAMETER_CHOICE, str("colour"), str(""),
                                             str("Of nothing."), str("red"), str("red|blue"), 0, 0, 0, 0}};
  return rows;
}

inline int32_t create(const odo_host* host, uint32_t, const odo_string* id, odo_instance** out) {
  const odo_string& mine = interface_of();
  if (!out || !id || id->size != mine.size || std::memcmp(id->data, mine.data, mine.size) != 0)
    return ODO_E_UNSUPPORTED;
  auto* state = new State;
  state->host = host;
  *out = reinterpret_cast<odo_instance*>(state);
  return ODO_OK;
}

inline int32_t configure(odo_instance* instance, const odo_value* values, uint32_t count, uint32_t stride) {
  for (uint32_t i = 0; i < count; ++i) {
    const auto& value = *reinterpret_cast<const odo_value*>(reinterpret_cast<const char*>(values) + size_t(i) * stride);
    if (value.name.size == 4 && std::memcmp(value.name.data, "gain", 4) == 0) of(instance).gain = value.reals[0];
  }
  return ODO_OK;
}

inline int32_t reset(odo_instance* instance) {
  State& s = of(instance);
  const State kept = s;
  s = State();
  s.host = kept.host, s.sink = kept.sink, s.gain = kept.gain;
  return ODO_OK;
}

inline int64_t save(odo_instance* instance, void* data, uint64_t capacity) {
  if (capacity >= 16) {
    std::memcpy(data, "ZOOSTATE", 8);
    std::memcpy(static_cast<char*>(data) + 8, &of(instance).gain, 8);
  }
  return 16;
}

inline int32_t load(odo_instance* instance, const void* data, uint64_t size) {
  double gain = 0;
  if (size != 16 || std::memcmp(data, "ZOOSTATE", 8) != 0) return ODO_E_DATA;
  std::memcpy(&gain, static_cast<const char*>(data) + 8, 8);
  if (!(gain >= 0.5 && gain <= 2)) return ODO_E_DATA;
  of(instance).gain = gain;
  return ODO_OK;
}

inline odo_plugin good_table() {
  odo_plugin t;
  std::memset(&t, 0, sizeof t);
  t.struct_size = sizeof t;
  t.abi_major = ODO_ABI_MAJOR, t.abi_minor = ODO_ABI_MINOR;
  t.interface_count = 1, t.interfaces = &interface_of();
  t.id = str("test/faulty"), t.version = str("1.0.0"), t.summary = str("Good, but for one thing.");
  t.parameters = parameters().data(), t.parameter_count = static_cast<uint32_t>(parameters().size());
  t.parameter_stride = sizeof(odo_parameter);
  t.create = create, t.configure = configure, t.process = process, t.reset = reset, t.save = save, t.load = load;
  t.activate = [](odo_instance* i, const odo_sink* sink) -> int32_t { return of(i).sink = sink, ODO_OK; };
  t.destroy = [](odo_instance* i) { delete &of(i); };
  return t;
}

inline int32_t good_entry(const odo_host* host, odo_plugin* out) {
  if (!host || !out || out->struct_size < ODO_PLUGIN_SIZE_MIN) return ODO_E_STRUCT_SIZE;
  if (!ODO_HOST_FITS(host)) {
    out->refusal = str("another ABI");
    return ODO_E_VERSION;
  }
  odo_plugin table = good_table();
  on_table(table);
  const uint32_t size = out->struct_size < table.struct_size ? out->struct_size : table.struct_size;
  std::memcpy(static_cast<void*>(out), &table, size);
  out->struct_size = size;
  return ODO_OK;
}

}  // namespace faulty

// The items that a faulty plugin changes: its table, its events, its handling of an input, or its entry.
#define GOOD_ENTRY                                                                        \
  extern "C" ODO_EXPORT int32_t ODO_PLUGIN_ENTRY(const odo_host* host, odo_plugin* out) { \
    return good_entry(host, out);                                                         \
  }
#define OWN_ENTRY(k)                                                \
  Kind faulty::kind() { return k; }                                 \
  void faulty::on_event(State&, Event&) {}                          \
  int32_t faulty::on_input(State&, const odo_header&) { return 0; } \
  void faulty::on_table([[maybe_unused]] odo_plugin& t)
#define TABLE(k) GOOD_ENTRY OWN_ENTRY(k)
#define EVENT(k)                                                    \
  GOOD_ENTRY                                                        \
  Kind faulty::kind() { return k; }                                 \
  void faulty::on_table(odo_plugin&) {}                             \
  int32_t faulty::on_input(State&, const odo_header&) { return 0; } \
  void faulty::on_event([[maybe_unused]] State& s, [[maybe_unused]] Event& e)
#define INPUT(k)                           \
  GOOD_ENTRY                               \
  Kind faulty::kind() { return k; }        \
  void faulty::on_table(odo_plugin&) {}    \
  void faulty::on_event(State&, Event&) {} \
  int32_t faulty::on_input([[maybe_unused]] State& s, [[maybe_unused]] const odo_header& m)
