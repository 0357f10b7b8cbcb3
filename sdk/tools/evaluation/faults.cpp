// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/evaluation/faults.hpp"

#include <algorithm>

#include "sdk/host/config/table.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/simulation/random.hpp"

namespace odograph {
namespace {

using table::choice, table::integer, table::map, table::real;

constexpr const char* kKinds[] = {"drop", "repeat", "delay", "shift", "value", "black", "damaged"};

/// The part of an inertial sample that a fault affects; 0 for whole messages.
uint32_t half_of(const std::string& sensor) {
  return sensor == "accelerometer" ? ODO_IMU_ACCEL : sensor == "gyroscope" ? ODO_IMU_GYRO : 0;
}

bool concerns(const SensorFault& fault, const odo_header& header) {
  if (header.type == ODO_TYPE_CALIBRATION || header.type == ODO_TYPE_IMU_NOISE) return false;
  const std::string& s = fault.sensor;
  if (s == "all") return true;
  if (const uint32_t half = half_of(s)) return header.type == ODO_TYPE_IMU && (header.flags & half);
  return header.type == (s == "imu"            ? ODO_TYPE_IMU
                         : s == "magnetometer" ? ODO_TYPE_MAGNETOMETER
                         : s == "barometer"    ? ODO_TYPE_BAROMETER
                         : s == "gnss"         ? ODO_TYPE_GNSS
                                               : ODO_TYPE_FRAME);
}

void read_as(odo_header& header, const std::string& sensor, double value) {
  const auto fill = [value](double* numbers, size_t count) { std::fill_n(numbers, count, value); };
  switch (header.type) {
    case ODO_TYPE_IMU: {
      auto& imu = reinterpret_cast<odo_imu&>(header);
      if (sensor != "accelerometer") fill(imu.gyro_b, 3);
      if (sensor != "gyroscope") fill(imu.accel_b, 3);
      break;
    }
    case ODO_TYPE_MAGNETOMETER: fill(reinterpret_cast<odo_magnetometer&>(header).field_b, 3); break;
    case ODO_TYPE_BAROMETER: fill(&reinterpret_cast<odo_barometer&>(header).pressure_pa, 1); break;
    case ODO_TYPE_GNSS:
      fill(&reinterpret_cast<odo_gnss&>(header).latitude_rad, 1);
      fill(&reinterpret_cast<odo_gnss&>(header).longitude_rad, 1);
      break;
    default: break;
  }
}

/// A message and its delivery time.
struct Delivery {
  int64_t at_ns;
  RecordedMessage message;
};

/// Applies a fault to the last delivery in the list.
void apply_fault(std::vector<Delivery>& all, const SensorFault& fault) {
  Delivery& one = all.back();
  odo_header& header = one.message.message.header();
  const auto by_ns = nanoseconds(fault.by_s);
  switch (fault.kind) {
    case FaultKind::drop:
      if (const uint32_t half = half_of(fault.sensor); half && (header.flags & 3 & ~half))
        header.flags &= ~half;
      else
        all.pop_back();
      break;
    case FaultKind::repeat: all.push_back(Delivery(one)); break;
    case FaultKind::delay: one.at_ns += by_ns; break;
    case FaultKind::shift: header.t_ns += by_ns; break;
    case FaultKind::value: read_as(header, fault.sensor, fault.value); break;
    case FaultKind::black: one.message.picture.gain_percent = 0; break;
    case FaultKind::damaged:
      if (header.type == ODO_TYPE_FRAME) one.message.picture = {};
  }
}

}  // namespace

const Spec& faults_spec() {
  static const Spec spec = [] {
    Spec version = integer("odograph_faults", 1, 1, "1", "version of this file format");
    version.required = true;
    Spec kind = choice("fault", "drop|repeat|delay|shift|value|black|damaged", "",
                       "drop: missing; repeat: twice; delay: delivered later; shift: wrong times; value: constant "
                       "reading; black, damaged: pictures");
    kind.required = true;
    Spec sensor =
        choice("sensor", "imu|accelerometer|gyroscope|magnetometer|barometer|gnss|camera|all", "", "of which");
    sensor.required = true;
    Spec value{.name = "value", .type = SpecType::real, .fallback = "0", .help = "of `value`, in the sensor's SI unit"};
    Spec faults{.name = "faults", .type = SpecType::list, .help = "faults, applied in order", .required = true};
    faults.children = {map("", "a fault",
                           {kind, sensor, real("from", "s", 0, 1e6, "0", "after the recording's first message"),
                            real("for", "s", 0, 1e6, "0", "how long; 0: to the end"),
                            real("part", "", 0, 1, "1", "fraction of the samples, at random"),
                            real("by", "s", -1e6, 1e6, "0", "of delay and shift"), value})};
    return map("faults", "Faults injected into the sensors of a recording",
               {version, integer("seed", 0, 1e15, "0", "seed of the random choices"), faults});
  }();
  return spec;
}

Result<SensorFaults> read_faults(const std::string& path) {
  const auto node = read_yaml(path);
  if (!node) return node.failure();
  const PluginResolver none = [](const std::string&, const std::string&) -> Result<const std::vector<Spec>*> {
    return Failure{ODO_E_CONFIG, "no plugins here"};
  };
  const auto checked = validate(*node, faults_spec(), path, none);
  if (!checked) return checked.failure();
  SensorFaults out;
  out.seed = static_cast<uint64_t>((*checked)["seed"].integer);
  for (const Value& item : (*checked)["faults"].items) {
    const auto kind = std::find(std::begin(kKinds), std::end(kKinds), item["fault"].text) - std::begin(kKinds);
    out.faults.push_back({static_cast<FaultKind>(kind), item["sensor"].text, item["from"].real, item["for"].real,
                          item["part"].real, item["by"].real, item["value"].real});
  }
  return out;
}

Recording with_faults(const Recording& recording, const SensorFaults& faults) {
  Recording out = recording;
  if (recording.messages.empty()) return out;
  const int64_t begin_ns = recording.messages.front().message.header().t_ns;
  std::vector<Delivery> deliveries;
  for (const RecordedMessage& m : recording.messages) deliveries.push_back({m.message.header().t_ns, m});
  for (size_t k = 0; k < faults.faults.size(); ++k) {
    const SensorFault& fault = faults.faults[k];
    Random random(faults.seed, k);
    std::vector<Delivery> next;
    next.reserve(deliveries.size());
    for (Delivery& one : deliveries) {
      const odo_header& header = one.message.message.header();
      const double t_s = seconds(header.t_ns - begin_ns);
      const bool now = t_s >= fault.from_s && (fault.for_s <= 0 || t_s < fault.from_s + fault.for_s);
      const bool hit = now && concerns(fault, header) && random.uniform() < fault.part;
      next.push_back(std::move(one));
      if (hit) apply_fault(next, fault);
    }
    deliveries = std::move(next);
  }
  std::stable_sort(deliveries.begin(), deliveries.end(),
                   [](const auto& a, const auto& b) { return a.at_ns < b.at_ns; });
  out.messages.clear();
  for (Delivery& one : deliveries) out.messages.push_back(std::move(one.message));
  return out;
}

}  // namespace odograph
