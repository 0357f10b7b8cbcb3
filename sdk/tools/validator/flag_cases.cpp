// SPDX-License-Identifier: Apache-2.0
//
// Validity flags: a field without its flag has no meaning, so that its value must not change what a plugin emits.
#include <cstddef>
#include <cstring>
#include <map>

#include <odograph/vo_frontend.h>

#include "sdk/tools/validator/case_fixture.hpp"
#include "sdk/tools/validator/message_fields.hpp"

namespace odograph {
CASES(flag)
namespace {

/// 8-byte numbers that are valid with a flag, or with any of several.
struct Numbers {
  uint32_t type;
  const char* name;
  size_t offset, count;
  uint32_t flag;
  bool whole = false;  ///< durations in ns
};

#define FIELD(type, message, member, flag) \
  { type, #member, offsetof(message, member), sizeof(message::member) / 8, flag }
#define DURATION(type, message, member, flag) \
  { type, #member, offsetof(message, member), 1, flag, true }
#define ELEMENT(type, message, member, i, flag) \
  { type, #member, offsetof(message, member) + 8 * (i), 1, flag }

/// Beside kMessageFields: durations, single components, and the pose, which comes from the host.
const Numbers kMore[] = {
    DURATION(ODO_TYPE_FRAME, odo_frame, exposure_ns, ODO_FRAME_EXPOSURE),
    DURATION(ODO_TYPE_FRAME, odo_frame, line_time_ns, ODO_FRAME_LINE_TIME),
    DURATION(ODO_TYPE_CALIBRATION, odo_calibration, time_offset_ns, ODO_CALIBRATION_TIME_OFFSET),
    DURATION(ODO_TYPE_CALIBRATION, odo_calibration, line_time_ns, ODO_CALIBRATION_LINE_TIME),
    ELEMENT(ODO_TYPE_WAYPOINT, odo_waypoint, p_n, 2, ODO_WAYPOINT_VERTICAL),
    ELEMENT(ODO_TYPE_FIX, odo_fix, p_n, 0, ODO_FIX_NORTH),
    ELEMENT(ODO_TYPE_FIX, odo_fix, p_n, 1, ODO_FIX_EAST),
    ELEMENT(ODO_TYPE_FIX, odo_fix, p_n, 2, ODO_FIX_DOWN),
    FIELD(ODO_TYPE_POSE, odo_pose, q_n, ODO_POSE_ORIENTATION),
    FIELD(ODO_TYPE_POSE, odo_pose, p_n, ODO_POSE_POSITION),
    FIELD(ODO_TYPE_POSE, odo_pose, velocity_n, ODO_POSE_VELOCITY),
    FIELD(ODO_TYPE_POSE, odo_pose, covariance, ODO_POSE_COVARIANCE),
    FIELD(ODO_TYPE_POSE, odo_pose, angular_velocity, ODO_POSE_ANGULAR_VELOCITY),
    FIELD(ODO_TYPE_POSE, odo_pose, velocity_covariance, ODO_POSE_VELOCITY_COVARIANCE),
    FIELD(ODO_TYPE_POSE, odo_pose, floor_probability, ODO_POSE_FLOOR),
};

#undef FIELD
#undef DURATION
#undef ELEMENT

/// All of them, those of one flag together.
const std::map<std::pair<uint32_t, uint32_t>, std::vector<Numbers>>& optional_numbers() {
  static const auto all = [] {
    std::map<std::pair<uint32_t, uint32_t>, std::vector<Numbers>> by_flag;
    for (const MessageField& f : kMessageFields)
      if (f.flag != 0 && !(f.type == ODO_TYPE_FIX && f.flag == kFixPosition) &&
          !(f.type == ODO_TYPE_IMU && f.flag == ODO_IMU_GYRO))
        by_flag[{f.type, f.flag}].push_back({f.type, f.name, f.offset, f.count(), f.flag});
    for (const Numbers& one : kMore) by_flag[{one.type, one.flag}].push_back(one);
    return by_flag;
  }();
  return all;
}

/// A number of the same order of magnitude: a plugin that uses it emits another plausible event.
void change(unsigned char* at, bool whole) {
  if (whole) {
    int64_t value = 0;
    std::memcpy(&value, at, sizeof value);
    value += 1'000'000;  // 1 ms
    std::memcpy(at, &value, sizeof value);
    return;
  }
  double value = 0;
  std::memcpy(&value, at, sizeof value);
  value = 2 * value + 0.25;
  std::memcpy(at, &value, sizeof value);
}

/// Calls `with` for each number of the fields.
template <class With>
void each_number(const std::vector<Numbers>& fields, unsigned char* message, With&& with) {
  for (const Numbers& field : fields)
    for (size_t i = 0; i < field.count; ++i) with(message + field.offset + 8 * i, field.whole);
}

/// Zeroes what an event itself does not state as valid.
void clear_invalid(std::vector<unsigned char>& event) {
  const auto& header = *reinterpret_cast<const odo_header*>(event.data());
  for (const auto& [key, fields] : optional_numbers())
    if (key.first == header.type && (header.flags & key.second) == 0)
      each_number(fields, event.data(), [&](unsigned char* at, bool) {
        if (at + 8 <= event.data() + event.size()) std::memset(at, 0, 8);
      });
}

/// The events if no message has the flag, with the fields as they are or changed.
std::vector<std::vector<unsigned char>> events_without(CaseFixture& fixture, const std::vector<Numbers>& fields,
                                                       bool changed) {
  const auto subject = fixture.start_instance();
  const uint32_t type = fields.front().type, flag = fields.front().flag;
  MessageLayout layout;
  layout.change = [&](AnyMessage& message) {
    odo_header& header = message.header();
    if (header.type != type) return;
    header.flags &= ~(flag | flags_that_need(type, flag));
    if (changed) each_number(fields, reinterpret_cast<unsigned char*>(&header), change);
  };
  subject->process(fixture.input, layout);
  auto events = subject->bytes();
  for (auto& event : events) clear_invalid(event);
  return events;
}

CASE(flag, "process.flags", "uses fields only if their flag is set", 120, 4) {
  size_t asked = 0;
  for (const auto& [key, fields] : optional_numbers()) {
    const uint32_t type = key.first;
    const bool always_valid = type == ODO_TYPE_IMU && !fixture.serves(ODO_INTERFACE_VO_FRONTEND);  // vo_frontend.h
    if (!fixture.accepts(type) || always_valid) continue;
    ++asked;
    const auto as_is = events_without(fixture, fields, false), other = events_without(fixture, fields, true);
    if (const std::string found = difference(as_is, other); !found.empty())
      return "it uses " + std::string(fields.front().name) + " of " + message_name(type) +
             " without the flag with which it is valid: " + found + " when the values change";
  }
  return asked ? Verdict() : not_applicable("it receives nothing that has validity flags");
}

}  // namespace

}  // namespace odograph
