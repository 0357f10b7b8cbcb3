// SPDX-License-Identifier: Apache-2.0
//
// A correct plugin table written by hand, in which the broken plugins change one item.
#pragma once

#include <cstring>

#include <odograph/plugin.h>
#include <odograph/scale_source.h>
#include <odograph/vo_frontend.h>

#ifndef HOSTILE_ID
#define HOSTILE_ID "test/hostile"
#endif

namespace hostile {

inline const odo_sink*& sink() {
  static const odo_sink* kept = nullptr;
  return kept;
}
inline int& instance() {
  static int thing = 0;
  return thing;
}

/// A message with its head, zero otherwise.
template <class Message>
Message make(uint32_t type, int64_t t_ns) {
  Message m;
  std::memset(static_cast<void*>(&m), 0, sizeof m);
  m.header.struct_size = sizeof m;
  m.header.type = type;
  m.header.t_ns = t_ns;
  return m;
}

/// A metric motion without rotation and displacement.
inline odo_vo_motion motion(int64_t from_ns, int64_t to_ns) {
  auto m = make<odo_vo_motion>(ODO_TYPE_VO_MOTION, to_ns);
  m.header.flags = ODO_VO_ROTATION | ODO_VO_TRANSLATION | ODO_VO_METRIC;
  m.t_from_ns = from_ns;
  m.q_c0_c1[0] = 1;
  m.state = ODO_TRACKING;
  return m;
}

inline int32_t emit(const odo_header& event) { return sink()->emit(sink(), &event); }

inline void nothing() {}

/// A `create` that also calls `begin`.
template <auto begin>
int32_t create_after(const odo_host*, uint32_t, const odo_string*, odo_instance** out) {
  begin();
  *out = reinterpret_cast<odo_instance*>(&instance());
  return ODO_OK;
}

/// A `process` that calls `take` with one message after the other, until it fails.
template <int32_t (*take)(const odo_header&)>
int32_t process_each(odo_instance*, const odo_batch* batch) {
  for (uint32_t i = 0; i < batch->count; ++i)
    if (const int32_t status = take(*batch->messages[i]); status < 0) return status;
  return ODO_OK;
}

/// Of this plugin only: several may be linked into one program.
static odo_plugin table() {
  static const odo_string interfaces[] = {{ODO_INTERFACE_SCALE_SOURCE, sizeof(ODO_INTERFACE_SCALE_SOURCE) - 1}};
  odo_plugin t;
  std::memset(&t, 0, sizeof t);
  t.struct_size = sizeof t;
  t.abi_major = ODO_ABI_MAJOR;
  t.abi_minor = ODO_ABI_MINOR;
  t.interface_count = 1;
  t.interfaces = interfaces;
  t.id = {HOSTILE_ID, sizeof(HOSTILE_ID) - 1};
  t.version = {"1.0.0", 5};
  t.create = create_after<nothing>;
  t.configure = [](odo_instance*, const odo_value*, uint32_t, uint32_t) -> int32_t { return ODO_OK; };
  t.activate = [](odo_instance*, const odo_sink* s) -> int32_t { return sink() = s, ODO_OK; };
  t.process = [](odo_instance*, const odo_batch*) -> int32_t { return ODO_OK; };
  t.destroy = [](odo_instance*) {};
  t.reset = [](odo_instance*) -> int32_t { return ODO_OK; };
  return t;
}

inline int32_t fill(odo_plugin* out, const odo_plugin& t, uint32_t size = sizeof(odo_plugin)) {
  std::memcpy(static_cast<void*>(out), &t, size);
  out->struct_size = size;
  return ODO_OK;
}

}  // namespace hostile

/// The entry of a plugin with the correct table but for what follows, a function of the table `t`.
#define HOSTILE_PLUGIN                                                    \
  static void change(odo_plugin& t);                                      \
  extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) { \
    odo_plugin t = hostile::table();                                      \
    change(t);                                                            \
    return hostile::fill(out, t);                                         \
  }                                                                       \
  static void change([[maybe_unused]] odo_plugin& t)
/// Makes it one of this kind.
#define HOSTILE_SERVES(t, kind)                           \
  static const odo_string served{kind, sizeof(kind) - 1}; \
  t.interfaces = &served
