// SPDX-License-Identifier: Apache-2.0
//
// Failing sensors, fuzzed data, and cost.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <memory>

#include "sdk/host/core/sample_gate.hpp"
#include "sdk/tools/validator/case_fixture.hpp"

namespace odograph {
CASES(fault)
namespace {

/// Maximum median duration of a call, wall clock: a phone's inertial samples arrive at 200 Hz, its pictures at 30 Hz.
constexpr double kImuCall_s = 5e-3, kFrameCall_s = 33e-3;
constexpr double kMemory_mb = 512;

/// Passes modified input: no crash, no fatal status, no non-finite number.
Verdict survives(CaseFixture& fixture, const std::vector<AnyMessage>& messages,
                 const std::function<void(AnyMessage&)>& change = {}) {
  const auto driver = fixture.start_instance();
  MessageLayout layout;
  layout.change = change;
  driver->process(messages, layout);
  for (const auto& [status, times] : driver->statuses)
    if (status <= -2000) return "it returned " + std::to_string(status) + ", which quarantines it";
  for (const std::string& violation : driver->violations)
    if (violation.starts_with("numbers") || violation.starts_with("count")) return violation;
  return "";
}

/// The doubles after the header of a message of a known type: all fields but times and counts.
template <class Change>
void change_numbers(AnyMessage& message, Change&& change) {
  const auto of = [&](double* values, int count) {
    for (int i = 0; i < count; ++i) change(values[i]);
  };
  odo_header& h = message.header();
  switch (h.type) {
    case ODO_TYPE_IMU: of(reinterpret_cast<odo_imu&>(h).gyro_b, 3), of(reinterpret_cast<odo_imu&>(h).accel_b, 3); break;
    case ODO_TYPE_MAGNETOMETER: of(reinterpret_cast<odo_magnetometer&>(h).field_b, 3); break;
    case ODO_TYPE_BAROMETER: of(&reinterpret_cast<odo_barometer&>(h).pressure_pa, 1); break;
    case ODO_TYPE_GNSS: of(&reinterpret_cast<odo_gnss&>(h).latitude_rad, 15); break;
    case ODO_TYPE_STEP: of(&reinterpret_cast<odo_step&>(h).length_m, 4); break;
    case ODO_TYPE_VO_MOTION: of(reinterpret_cast<odo_vo_motion&>(h).p_c0_c1, 39); break;
    case ODO_TYPE_FIX: of(reinterpret_cast<odo_fix&>(h).p_n, 12); break;
    case ODO_TYPE_WAYPOINT: of(reinterpret_cast<odo_waypoint&>(h).p_n, 4); break;
    case ODO_TYPE_POSE: of(reinterpret_cast<odo_pose&>(h).p_n, 6); break;
    default: break;
  }
}

/// Every tenth message, so that good ones lie between.
MessageLayout every_tenth(double value) {
  MessageLayout layout;
  auto count = std::make_shared<int>(0);
  layout.change = [=](AnyMessage& message) {
    if (++*count % 10 == 0) change_numbers(message, [=](double& x) { x = value; });
  };
  return layout;
}

Verdict only(CaseFixture& fixture, uint32_t type) {
  if (!fixture.accepts(type)) return not_applicable("it is given no " + message_name(type));
  std::vector<AnyMessage> some;
  for (const AnyMessage& message : fixture.input)
    if (message.header().type == type) some.push_back(message);
  return survives(fixture, some);
}

Verdict gap(CaseFixture& fixture, int64_t gap_ns) {
  const int64_t middle = TestInput::kStart_ns + 2'000'000'000;
  return survives(fixture, fixture.input, [=](AnyMessage& message) {
    if (message.header().t_ns > middle) shift(message, gap_ns);
  });
}

// ---- what it costs -------------------------------------------------------------------------------------------------

/// The median of the best of three runs, so that a busy machine does not fail a good plugin.
Verdict fast_enough(CaseFixture& fixture, uint32_t type, double limit_s) {
  if (!fixture.accepts(type)) return not_applicable("it is given no " + message_name(type));
  double best = 1e9;
  for (int run = 0; run < 3 && best > limit_s; ++run) {
    const auto driver = fixture.start_instance();
    std::vector<double> of_type;
    for (const AnyMessage& message : fixture.input) {
      if (of_type.size() >= 30) break;
      driver->process({message});
      if (message.header().type == type) of_type.push_back(driver->call_s.back());
    }
    std::sort(of_type.begin(), of_type.end());
    if (!of_type.empty()) best = std::min(best, of_type[of_type.size() / 2]);
  }
  if (best <= limit_s) return "";
  return "a call takes " + std::to_string(best * 1e3) + " ms in the median; expected less than " +
         std::to_string(limit_s * 1e3);
}

CASE(fault, "faults.zeros", "survives sensors that read zero", 20, 4) {
  return survives(fixture, fixture.input, every_tenth(0.0).change);
}

CASE(fault, "faults.huge", "survives numbers of 1e300", 20, 4) {
  return survives(fixture, fixture.input, every_tenth(1e300).change);
}

CASE(fault, "faults.subnormal", "survives subnormal numbers", 20, 4) {
  return survives(fixture, fixture.input, every_tenth(std::numeric_limits<double>::denorm_min()).change);
}

CASE(fault, "faults.nan", "survives NaN", 20, 4) {
  return survives(fixture, fixture.input, every_tenth(std::nan("")).change);
}

CASE(fault, "faults.long_steps", "survives steps of 700 m", 20, 5) {
  if (!fixture.accepts(ODO_TYPE_STEP)) return not_applicable("it receives no steps");
  return survives(fixture, fixture.input, [](AnyMessage& message) {
    if (message.header().type == ODO_TYPE_STEP) reinterpret_cast<odo_step&>(message.header()).length_m = 700;
  });
}

CASE(fault, "faults.only_imu", "survives IMU input only", 20, 4) { return only(fixture, ODO_TYPE_IMU); }

CASE(fault, "faults.without_imu", "survives the lack of an IMU", 20, 4) {
  if (!fixture.accepts(ODO_TYPE_IMU)) return not_applicable("it receives no imu");
  std::vector<AnyMessage> some;
  for (const AnyMessage& message : fixture.input)
    if (message.header().type != ODO_TYPE_IMU) some.push_back(message);
  return survives(fixture, some);
}

CASE(fault, "faults.gap_10s", "survives a pause of 10 s", 20, 5) { return gap(fixture, 10'000'000'000); }

CASE(fault, "faults.gap_1h", "survives a pause of an hour", 20, 5) { return gap(fixture, 3'600'000'000'000); }

CASE(fault, "faults.late_clock", "survives a clock near its limit, 2^62 ns", 20, 4) {
  return survives(fixture, fixture.input, [](AnyMessage& message) { shift(message, INT64_MAX / 2 - 60'000'000'000); });
}

CASE(fault, "faults.early_clock", "survives times below zero", 20, 4) {
  return survives(fixture, fixture.input, [](AnyMessage& message) { shift(message, INT64_MIN / 2); });
}

CASE(fault, "faults.twice", "survives duplicate messages", 20, 3) {
  std::vector<AnyMessage> doubled;
  for (const AnyMessage& message : fixture.input) doubled.push_back(message), doubled.push_back(message);
  return survives(fixture, doubled);
}

CASE(fault, "faults.backwards", "survives messages in the wrong order", 20, 3) {
  auto reversed = fixture.input;
  std::reverse(reversed.begin(), reversed.end());
  return survives(fixture, reversed);
}

/// Flips bits anywhere after the header except in pointers; makes numbers finite again, as a host would.
CASE(fault, "faults.fuzzed", "survives flipped bits", 20, 6) {
  uint32_t random = 99;
  const SampleGate gate;
  return survives(fixture, fixture.input, [&](AnyMessage& message) {
    random = random * 1664525u + 1013904223u;
    if (random >> 30 || message.header().type == ODO_TYPE_FRAME) return;
    auto* bytes = reinterpret_cast<unsigned char*>(&message.header());
    const size_t size = message.header().struct_size - sizeof(odo_header);
    for (int i = 0; i < 3; ++i) {
      random = random * 1664525u + 1013904223u;
      bytes[sizeof(odo_header) + (random >> 8) % size] ^= static_cast<unsigned char>(1u << (random & 7));
    }
    const bool dropped = !message_is_good(message.header()) || !gate.within_range(message.header());
    if (dropped) message.header().type = 0x0FED;  // as any host would drop it
  });
}

/// The host knows only the size of a vendor's message: a plugin that declares the type must check the rest.
CASE(fault, "faults.vendor", "survives vendors' messages of any size and content", 20, 3) {
  constexpr uint32_t sizes[] = {32, 40, 48, 64, 96, 200, 4096};
  std::vector<AnyMessage> mixed;
  uint32_t random = 7, made = 0;
  for (const AnyMessage& message : fixture.input) {
    mixed.push_back(message);
    for (uint32_t k = 0; k < fixture.table().input_count; ++k) {
      if (!ODO_IS_VENDOR(fixture.table().inputs[k])) continue;
      alignas(8) unsigned char bytes[4096];
      for (unsigned char& byte : bytes)
        byte = static_cast<unsigned char>((random = random * 1664525u + 1013904223u) >> 24);
      odo_header header{};
      header.struct_size = sizes[made++ % std::size(sizes)];
      header.type = fixture.table().inputs[k], header.t_ns = message.header().t_ns;
      std::memcpy(bytes, &header, sizeof header);
      mixed.emplace_back(*reinterpret_cast<const odo_header*>(bytes));
    }
  }
  return made == 0 ? not_applicable("it declares no vendor messages") : survives(fixture, mixed);
}

CASE(fault, "faults.unknown_flags", "survives flags of a later version", 20, 3) {
  return survives(fixture, fixture.input, [](AnyMessage& message) { message.header().flags |= 0xFFFF0000; });
}

CASE(fault, "faults.no_flags", "survives messages in which nothing is valid", 20, 3) {
  int count = 0;
  return survives(fixture, fixture.input, [&](AnyMessage& message) {
    if (++count % 5 == 0) message.header().flags = 0;
  });
}

CASE(fault, "faults.later_lists", "survives modes, states and models of a later version", 20, 4) {
  return survives(fixture, fixture.input, [](AnyMessage& message) {
    odo_header& h = message.header();
    if (h.type == ODO_TYPE_STEP) reinterpret_cast<odo_step&>(h).mode = 4711;
    if (h.type == ODO_TYPE_VO_MOTION)
      reinterpret_cast<odo_vo_motion&>(h).state = 4711, reinterpret_cast<odo_vo_motion&>(h).reason = 4711;
    if (h.type == ODO_TYPE_POSE) reinterpret_cast<odo_pose&>(h).state = 4711;
    if (h.type == ODO_TYPE_CALIBRATION) reinterpret_cast<odo_calibration&>(h).model = 4711;
  });
}

CASE(fault, "cost.imu", "needs less than 5 ms for an inertial sample", 30, 3) {
  return fast_enough(fixture, ODO_TYPE_IMU, kImuCall_s);
}

CASE(fault, "cost.frame", "needs less than 33 ms for a picture of 64 x 48", 60, 4) {
  return fast_enough(fixture, ODO_TYPE_FRAME, kFrameCall_s);
}

CASE(fault, "cost.motion", "needs less than 5 ms for a motion", 30, 4) {
  return fast_enough(fixture, ODO_TYPE_VO_MOTION, kImuCall_s);
}

CASE(fault, "cost.memory", "needs less than 512 MB", 20, 4) {
  fixture.run(fixture.input, {});
  const double mb = resident_mb();
  return mb < kMemory_mb ? "" : std::to_string(mb) + " MB; expected less than 512";
}

}  // namespace

}  // namespace odograph
