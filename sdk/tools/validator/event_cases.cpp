// SPDX-License-Identifier: Apache-2.0
//
// Requirements on every event, whatever its type.
#include <algorithm>
#include <cmath>
#include <map>

#include <odograph/absolute_fixer.h>
#include <odograph/surface_finder.h>
#include <odograph/scale_source.h>

#include "sdk/tools/validator/case_fixture.hpp"

namespace odograph {
CASES(event)
namespace {

Verdict no_violation(CaseFixture& fixture, const char* beginning) {
  const auto driver = fixture.walked_instance();
  for (const std::string& violation : driver->violations)
    if (violation.starts_with(beginning)) return violation;
  return "";
}

/// Checks each event; returns the first non-empty result.
template <class Ask>
Verdict of_each_event(CaseFixture& fixture, Ask&& ask) {
  const auto driver = fixture.walked_instance();
  for (const SeenEvent& event : driver->events) {
    const odo_header& header = event.message.header();
    if (const std::string found = ask(event, header); !found.empty())
      return "a " + message_name(header.type) + " at t_ns = " + std::to_string(header.t_ns) + " " + found;
  }
  return "";
}

CASE(event, "process.works", "accepts good input without an error", 20, 10, .any_input = true) {
  const auto driver = fixture.walked_instance();
  for (const auto& [status, times] : driver->statuses)
    if (status <= ODO_E_MEMORY || status == ODO_E_STATE || status == ODO_E_ARGUMENT)
      return std::to_string(times) + " times status " + std::to_string(status) + " on good input" +
             (fixture.reports.empty() ? "" : ", it reported: " + fixture.reports.back());
  return "";
}

CASE(event, "process.status", "returns status codes of the ABI", 20, 5, .any_input = true) {
  const auto driver = fixture.walked_instance();
  for (const auto& [status, times] : driver->statuses)
    if (status > ODO_NOT_READY)
      return "process returned the status " + std::to_string(status) + ", which is not defined";
  return "";
}

CASE(event, "events.some", "emits events in a walk of 10 s", 20, 10) {
  const auto driver = fixture.walked_instance();
  if (!driver->events.empty()) return "";
  if (fixture.serves(ODO_INTERFACE_ABSOLUTE_FIXER) || fixture.serves(ODO_INTERFACE_SCALE_SOURCE) ||
      fixture.serves(ODO_INTERFACE_SURFACE_FINDER))
    return not_applicable("a fix plugin, a scale source or a surface finder need not emit anything here");
  return "it emits nothing in a walk of 10 s";
}

CASE(event, "events.type", "emits only events of its kind and those that its table declares", 20, 10,
     .any_input = true) {
  return no_violation(fixture, "type");
}

CASE(event, "events.size", "emits events with the size of their structs", 20, 10, .any_input = true) {
  return no_violation(fixture, "size");
}

CASE(event, "events.numbers", "emits finite numbers in their ranges and unit quaternions", 20, 10, .any_input = true) {
  return no_violation(fixture, "numbers");
}

CASE(event, "events.count", "emits at most 256 events in a call", 20, 10, .any_input = true) {
  return no_violation(fixture, "count");
}

CASE(event, "events.reserved", "leaves reserved fields zero", 20, 10, .any_input = true) {
  return of_each_event(fixture, [](const SeenEvent&, const odo_header& h) -> std::string {
    return h.reserved == 0 ? "" : "has header.reserved = " + std::to_string(h.reserved) + "; expected 0";
  });
}

/// The flags of each type, from its header; a plugin must not set the host's own.
CASE(event, "events.flags", "sets the flags of the type, none of the host's", 20, 10, .any_input = true) {
  static const std::map<uint32_t, uint32_t> known = {
      {ODO_TYPE_ATTITUDE, 2 * ODO_ATTITUDE_GYRO_BIAS - 1},
      {ODO_TYPE_STEP, 2 * ODO_STEP_HEADING_SIGMA - 1},
      {ODO_TYPE_MOTION_MODE, 0},
      {ODO_TYPE_VO_MOTION, 2 * ODO_VO_INERTIAL - 1},
      {ODO_TYPE_SCALE, 2 * ODO_SCALE_NOT_BY_STEPS - 1},
      {ODO_TYPE_FIX, 2 * ODO_FIX_SLANT_SIGMA - 1},
      {ODO_TYPE_REFINED, 2 * ODO_REFINED_LINE_TIME - 1},
      {ODO_TYPE_POINTS, ODO_POINTS_METRIC},
      {ODO_TYPE_SURFACE, 0},
      {ODO_TYPE_KEY_FRAME, 0},
      {ODO_TYPE_MAP_POSE, 0},
      {ODO_TYPE_RELATIVE_POSE, 2 * ODO_RELATIVE_POSE_ROTATION - 1},
  };
  return of_each_event(fixture, [](const SeenEvent&, const odo_header& h) -> std::string {
    if (const uint32_t of_host = h.flags & ODO_FLAG_HOST_MASK)
      return "has a flag set that only the host may set: " + std::to_string(of_host);
    const auto found = known.find(h.type);
    return found == known.end() || (h.flags & ~(found->second | ODO_FLAG_QUALITY)) == 0
               ? ""
               : "has flags = " + std::to_string(h.flags) + ", with bits that have no meaning";
  });
}

CASE(event, "events.time_order", "emits each type in time order", 20, 10, .any_input = true) {
  std::map<uint32_t, int64_t> latest;
  return of_each_event(fixture, [&](const SeenEvent&, const odo_header& h) -> std::string {
    const auto [entry, is_new] = latest.try_emplace(h.type, h.t_ns);
    if (!is_new && h.t_ns < entry->second) return "is before the one before it";
    entry->second = h.t_ns;
    return "";
  });
}

/// A plugin can only know times up to the newest of its input.
CASE(event, "events.time_known", "emits times of the sensor clock, none ahead of its input", 20, 10,
     .any_input = true) {
  if (fixture.input.empty()) return not_applicable("it receives no input");
  int64_t first = INT64_MAX;  // of the samples; sensor descriptions may have any time
  for (const AnyMessage& message : fixture.input)
    if (message.header().type != ODO_TYPE_CALIBRATION && message.header().type != ODO_TYPE_IMU_NOISE)
      first = std::min(first, message.header().t_ns);
  if (first != INT64_MAX) first -= 2'000'000'000;
  return of_each_event(fixture, [&](const SeenEvent& e, const odo_header& h) -> std::string {
    if (h.t_ns > e.input_ns) return "is " + std::to_string(h.t_ns - e.input_ns) + " ns ahead of all its input";
    if (h.t_ns < first && h.type != ODO_TYPE_CALIBRATION)
      return "is before the first sample: is it on the sensor clock?";
    return "";
  });
}

/// A variance of zero in a component stated as known claims an exactness that no estimate has.
CASE(event, "events.uncertainty", "states a non-zero uncertainty for each component stated as known", 20, 10,
     .any_input = true) {
  return of_each_event(fixture, [](const SeenEvent&, const odo_header& h) -> std::string {
    if (h.type == ODO_TYPE_STEP && as<odo_step>(h).sigma_m <= 0)
      return "has sigma_m = 0; expected the standard deviation of the length";
    if (h.type == ODO_TYPE_VO_MOTION && (h.flags & ODO_VO_COVARIANCE) && (h.flags & ODO_VO_ROTATION) &&
        as<odo_vo_motion>(h).covariance[0] + as<odo_vo_motion>(h).covariance[7] + as<odo_vo_motion>(h).covariance[14] <=
            0)
      return "has a rotation with variance 0";
    return "";
  });
}

CASE(event, "events.lists", "uses the modes, states and reasons of the lists", 20, 10, .any_input = true) {
  return of_each_event(fixture, [](const SeenEvent&, const odo_header& h) -> std::string {
    const auto out_of = [](const char* field, uint32_t value) {
      return std::string("has ") + field + " = " + std::to_string(value) + ", which is not in the list";
    };
    if (h.type == ODO_TYPE_STEP && as<odo_step>(h).mode > ODO_MODE_HANDLING)
      return out_of("mode", as<odo_step>(h).mode);
    if (h.type == ODO_TYPE_MOTION_MODE && as<odo_motion_mode>(h).mode > ODO_MODE_HANDLING)
      return out_of("mode", as<odo_motion_mode>(h).mode);
    if (h.type != ODO_TYPE_VO_MOTION) return "";
    const auto& m = as<odo_vo_motion>(h);
    if (m.state < ODO_TRACKING || m.state > ODO_LOST) return out_of("state", m.state);
    return m.reason > ODO_REASON_NO_SCALE ? out_of("reason", m.reason) : "";
  });
}

}  // namespace

}  // namespace odograph
