// SPDX-License-Identifier: Apache-2.0
#include "sdk/plugin_host/instance.hpp"

#include <cstddef>

#include <odograph/absolute_fixer.h>
#include <odograph/attitude.h>
#include <odograph/scale_source.h>
#include <odograph/step_estimator.h>
#include <odograph/vo_frontend.h>

#include <odograph/odograph.h>

namespace odograph {
namespace {

constexpr int64_t kLargestState = 16 << 20;  // bytes that a plugin may save
constexpr int kFailuresBeforeGivingUp = 5;

/// A table may end before a function that is optional; then it reads as null.
#define ODO_OPTIONAL(table, function) (ODO_HAS(&(table), function) ? (table).function : nullptr)

}  // namespace

std::vector<odo_value> values_of(const PluginChoice& choice) {
  std::vector<odo_value> values;
  for (const auto& [spec, value] : choice.parameters) {
    odo_value out{};
    out.struct_size = sizeof out;
    out.name = {spec.name.data(), spec.name.size()};
    out.text = {value.text.data(), value.text.size()};
    switch (spec.type) {
      case SpecType::boolean:
        out.type = ODO_PARAMETER_BOOL;
        out.integer = value.boolean;
        break;
      case SpecType::integer:
        out.type = ODO_PARAMETER_INT;
        out.integer = value.integer;
        break;
      case SpecType::real:
        out.type = ODO_PARAMETER_REAL;
        out.reals = &value.real;
        out.count = 1;
        break;
      case SpecType::reals:
        out.type = ODO_PARAMETER_REALS;
        out.reals = value.reals.data();
        out.count = value.reals.size();
        break;
      case SpecType::choice: out.type = ODO_PARAMETER_CHOICE; break;
      default: out.type = ODO_PARAMETER_STRING;
    }
    values.push_back(out);
  }
  return values;
}

KindTypes kind_types(const std::string& id) {
  if (id == ODO_INTERFACE_ATTITUDE)
    return {{ODO_TYPE_IMU, ODO_TYPE_MAGNETOMETER, ODO_TYPE_IMU_NOISE}, {ODO_TYPE_ATTITUDE}};
  if (id == ODO_INTERFACE_STEP_ESTIMATOR)
    return {{ODO_TYPE_IMU, ODO_TYPE_ATTITUDE, ODO_TYPE_BAROMETER, ODO_TYPE_FIX}, {ODO_TYPE_STEP, ODO_TYPE_MOTION_MODE}};
  if (id == ODO_INTERFACE_VO_FRONTEND)
    return {{ODO_TYPE_CALIBRATION, ODO_TYPE_FRAME, ODO_TYPE_IMU, ODO_TYPE_IMU_NOISE, ODO_TYPE_ATTITUDE},
            {ODO_TYPE_VO_MOTION, ODO_TYPE_CALIBRATION}};
  if (id == ODO_INTERFACE_SCALE_SOURCE)
    return {{ODO_TYPE_VO_MOTION, ODO_TYPE_STEP, ODO_TYPE_MOTION_MODE, ODO_TYPE_FIX}, {ODO_TYPE_SCALE}};
  if (id == ODO_INTERFACE_ABSOLUTE_FIXER)
    return {{ODO_TYPE_GNSS, ODO_TYPE_BAROMETER, ODO_TYPE_WAYPOINT, ODO_TYPE_FRAME, ODO_TYPE_CALIBRATION, ODO_TYPE_POSE},
            {ODO_TYPE_FIX}};
  return {};
}

KindTypes plugin_types(const std::string& id, const odo_plugin& table) {
  KindTypes types = kind_types(id);
  types.inputs.insert(types.inputs.end(), table.inputs, table.inputs + table.input_count);
  types.outputs.insert(types.outputs.end(), table.outputs, table.outputs + table.output_count);
  return types;
}

PluginInstance::PluginInstance(std::shared_ptr<PluginLibrary> library, HostServices& host, uint32_t number,
                               const PluginChoice& choice)
    : library_(std::move(library)), host_(host), number_(number), choice_(choice), id_(choice.manifest.id) {
  const KindTypes types = plugin_types(choice.interface_id, library_->table());
  for (const uint32_t type : types.inputs) inputs_.add(type);
  for (const uint32_t type : types.outputs) outputs_.add(type);
  sink_.struct_size = sizeof(odo_sink);
  sink_.instance = number;
  sink_.emit = emit;
  sink_.owner = this;
}

PluginInstance::~PluginInstance() {
  if (instance_) library_->table().destroy(instance_);
}

Result<std::unique_ptr<PluginInstance>> PluginInstance::make(const PluginChoice& choice, bool verify_hash,
                                                             uint32_t number, HostServices& host) {
  auto library = PluginLibrary::load(choice.manifest, verify_hash, &host);
  if (!library) return library.failure();
  host.name_instance(number, choice.manifest.id);
  std::unique_ptr<PluginInstance> made(new PluginInstance(*library, host, number, choice));
  if (const int32_t status = made->start(); status < 0)
    return Failure{status, choice.manifest.library.string() + ": plugin '" + choice.manifest.id +
                               "' could not be created, configured and activated: " + odo_status_text(status)};
  return made;
}

int32_t PluginInstance::start() {
  const odo_plugin& table = library_->table();
  const odo_string interface_id{choice_.interface_id.data(), choice_.interface_id.size()};
  int32_t status = table.create(&host_, number_, &interface_id, &instance_);
  if (status >= 0 && !instance_) status = ODO_E_ERROR;
  if (status < 0) {
    instance_ = nullptr;
    return status;
  }
  const auto values = values_of(choice_);
  status = table.configure(instance_, values.data(), static_cast<uint32_t>(values.size()), sizeof(odo_value));
  if (status >= 0) status = table.activate(instance_, &sink_);
  return status;
}

int32_t PluginInstance::emit(const odo_sink* sink, const odo_header* event) {
  PluginInstance& self = *static_cast<const Sink*>(sink)->owner;
  if (!event) {
    self.fault("no_event", "emitted event = null", ODO_E_ARGUMENT);
    return ODO_E_ARGUMENT;
  }
  const auto name = [&] { return message_name(event->type); };
  if (!self.outputs_.has(event->type)) {
    if (ODO_IS_EVENT(event->type) && !message_info(event->type)) return ODO_E_UNSUPPORTED;  // of a newer plugin
    self.fault("wrong_event", "emitted type = " + name() + "; expected one that its kind owes or its table declares",
               ODO_E_ARGUMENT);
    return ODO_E_ARGUMENT;
  }
  AnyMessage* slot = self.buffer_.next();
  if (!slot) {
    if (!std::exchange(self.overflow_told_, true))
      self.fault("many_events", "emitted more than " + std::to_string(EventBuffer::kCapacity) + " events in one call",
                 ODO_E_EXHAUSTED);
    return ODO_E_EXHAUSTED;
  }
  if (!slot->assign(*event)) {
    self.buffer_.drop_last();
    const MessageInfo* info = message_info(event->type);
    self.fault("event_size",
               "emitted a " + name() + " with struct_size = " + std::to_string(event->struct_size) + "; expected " +
                   std::to_string(info ? info->min_size : sizeof(odo_header)) + " to " +
                   std::to_string(ODO_LARGEST_MESSAGE),
               ODO_E_STRUCT_SIZE);
    return ODO_E_STRUCT_SIZE;
  }
  slot->header().source = self.number_;
  if (const std::string fault = message_fault(slot->header()); !fault.empty()) {
    self.buffer_.drop_last();
    self.fault("bad_event", "emitted a " + name() + " with " + fault, ODO_E_ARGUMENT);
    return ODO_E_ARGUMENT;
  }
  return ODO_OK;
}

std::span<AnyMessage> PluginInstance::process(const odo_header& message) {
  buffer_.clear();
  overflow_told_ = false;
  if (!alive_ || !wants(message.type)) return {};
  const odo_header* messages[] = {&message};
  const odo_batch batch{sizeof(odo_batch), 1, messages};
  const int32_t status = library_->table().process(instance_, &batch);
  if (status < 0)
    failed(status, message);
  else
    failures_in_a_row_ = 0;
  return buffer_.events();
}

void PluginInstance::failed(int32_t status, const odo_header& message) {
  if (status == ODO_E_DISCARD || status == ODO_E_ARGUMENT || status == ODO_E_EXHAUSTED || status == ODO_E_UNSUPPORTED) {
    const std::string why = status == ODO_E_DISCARD ? "" : std::string(": ") + odo_status_text(status);
    fault(
        "discarded",
        "discarded a sample of " + message_name(message.type) + " (t_ns = " + std::to_string(message.t_ns) + ")" + why,
        status);
    return;
  }
  fault("failed", "failed at a sample of " + message_name(message.type) + ": " + odo_status_text(status), status);
  if (status == ODO_E_FATAL) library_->quarantine();
  if (library_->quarantined() || ++failures_in_a_row_ >= kFailuresBeforeGivingUp) {
    alive_ = false;
    host_.report(number_, ODO_SEVERITY_ERROR, "given_up", "is left out from now on");
    return;
  }
  reset();
}

void PluginInstance::reset() {
  was_reset_ = true;
  const odo_plugin& table = library_->table();
  const auto function = ODO_OPTIONAL(table, reset);
  if (function && function(instance_) >= 0) return;
  table.destroy(instance_);
  instance_ = nullptr;
  if (start() < 0) alive_ = false;
}

std::vector<uint8_t> PluginInstance::save() const {
  const auto function = ODO_OPTIONAL(library_->table(), save);
  if (!alive_ || !function) return {};
  const int64_t needed = function(instance_, nullptr, 0);
  if (needed <= 0 || needed > kLargestState) return {};
  std::vector<uint8_t> bytes(static_cast<size_t>(needed));
  return function(instance_, bytes.data(), bytes.size()) == needed ? bytes : std::vector<uint8_t>();
}

bool PluginInstance::load(std::span<const uint8_t> data) {
  const auto function = ODO_OPTIONAL(library_->table(), load);
  return alive_ && function && function(instance_, data.data(), data.size()) >= 0;
}

const void* PluginInstance::extension(std::string_view id) const {
  const auto function = ODO_OPTIONAL(library_->table(), get_interface);
  return alive_ && function ? function(instance_, id.data(), id.size()) : nullptr;
}

void PluginInstance::fault(const char* key, const std::string& text, int32_t status) {
  ++faults_;
  host_.report(number_, ODO_SEVERITY_WARNING, key, text, status);
}

}  // namespace odograph
