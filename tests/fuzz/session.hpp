// SPDX-License-Identifier: Apache-2.0
//
// Sessions with linked plugins, so that creating one reads no file, and the invariants of their output.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <odograph/odograph.h>

#include "sdk/host/messages/messages.hpp"

// clang-format off
#define FUZZ_FOR_EACH_PLUGIN(PLUGIN) \
  PLUGIN(attitude_vqf) PLUGIN(attitude_magyq) PLUGIN(step_renaudin2012) PLUGIN(step_odograph) \
  PLUGIN(scale_step_length) PLUGIN(scale_inertial) PLUGIN(fix_gnss) PLUGIN(fix_waypoint) PLUGIN(fix_barometer) \
  PLUGIN(vo_five_point) PLUGIN(test_echo) PLUGIN(test_obeys)
// clang-format on

extern "C" {
#define FUZZ_DECLARE(plugin) int32_t ODO_CALL odo_plugin_entry_##plugin(const odo_host*, odo_plugin*);
FUZZ_FOR_EACH_PLUGIN(FUZZ_DECLARE)
#undef FUZZ_DECLARE
}

namespace fuzz {

/// Aborts the program if the invariant is violated.
inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "not held: %s\n", what);
  std::abort();
}

/// An event of a host: within the table of bounds, and a pose is finite.
inline void check(const odo_header& event) {
  using namespace odograph;
  if (event.type == ODO_TYPE_REPORT && event.t_ns == INT64_MIN) return;  // before the first sample
  if (const std::string fault = message_fault(event); !fault.empty())
    require(false, (message_name(event.type) + ": " + fault).c_str());
  const auto finite = [](const double* values, size_t count) {
    return std::all_of(values, values + count, [](double x) { return std::isfinite(x); });
  };
  if (event.type == ODO_TYPE_POSE) {
    const auto& pose = as<odo_pose>(event);
    require(finite(pose.q_n, 4) && finite(pose.p_n, 3) && finite(pose.velocity_n, 3) && finite(pose.covariance, 36) &&
                std::isfinite(pose.scale + pose.scale_sigma + pose.distance_m),
            "every number of a pose is one");
  }
  if (event.type == ODO_TYPE_CORRECTION) {
    const auto& correction = as<odo_correction>(event);
    require(finite(correction.q_n, 4) && finite(correction.p_n, 3), "every number of a correction is one");
  }
}

inline void register_plugins() {
#define FUZZ_REGISTER(plugin) \
  require(odo_register_plugin(odo_plugin_entry_##plugin, nullptr) == ODO_OK, "a plugin is registered: " #plugin);
  FUZZ_FOR_EACH_PLUGIN(FUZZ_REGISTER)
#undef FUZZ_REGISTER
}

/// Of a saved state or map, as in saved_state.cpp: the last eight bytes are the FNV-1a of those before.
inline void correct_checksum(std::vector<uint8_t>& blob) {
  if (blob.size() < 8) return;
  uint64_t hash = 14695981039346656037u;
  for (size_t i = 0; i + 8 < blob.size(); ++i) hash = (hash ^ blob[i]) * 1099511628211u;
  std::memcpy(blob.data() + blob.size() - 8, &hash, sizeof hash);
}

/// A session whose every event is checked.
inline odo_session* open(const std::string& pipeline, uint32_t run = ODO_RUN_REPLAY) {
  static const bool registered = (register_plugins(), true);
  (void)registered;
  const std::string yaml = "odograph: 1\n" + pipeline;
  odo_session_options options{};
  options.struct_size = sizeof options;
  options.run = run;
  options.config_text = {yaml.data(), yaml.size()};
  odo_error error{sizeof error, ODO_OK, {}};
  odo_session* session = nullptr;
  if (odo_session_create(&options, &session, &error) != ODO_OK) require(false, error.message);
  odo_session_set_callback(
      session, nullptr, ODO_ALL_EVENTS, [](void*, const odo_header* event) { check(*event); }, nullptr);
  return session;
}

}  // namespace fuzz
