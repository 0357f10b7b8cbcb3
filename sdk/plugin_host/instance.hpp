// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sdk/config/pipeline_config.hpp"
#include "sdk/core/messages.hpp"
#include "sdk/plugin_host/library.hpp"
#include "sdk/plugin_host/services.hpp"

namespace odograph {

/// The events that one call to process gave, in a fixed arena: nothing is allocated after construction.
class EventBuffer {
 public:
  static constexpr size_t kCapacity = 256;
  EventBuffer() : events_(kCapacity) {}
  void clear() { count_ = 0; }
  AnyMessage* next() { return count_ < kCapacity ? &events_[count_++] : nullptr; }
  void drop_last() { --count_; }
  std::span<AnyMessage> events() { return {events_.data(), count_}; }

 private:
  std::vector<AnyMessage> events_;
  size_t count_ = 0;
};

/// One instance of a plugin, through its whole life. What it emits is checked before anybody sees it. A failing
/// instance is reset, and after too many failures left out; a library that says ODO_E_FATAL is quarantined.
class PluginInstance {
 public:
  /// Creates, configures and activates. The failure names the plugin, the step and what the plugin reported.
  static Result<std::unique_ptr<PluginInstance>> make(const PluginChoice& choice, bool verify_hash, uint32_t number,
                                                      HostServices& host);
  ~PluginInstance();
  PluginInstance(const PluginInstance&) = delete;
  PluginInstance& operator=(const PluginInstance&) = delete;

  /// True when the plugin's kind is given messages of this type, or the plugin declares that it wants them.
  bool wants(uint32_t type) const { return inputs_.has(type); }
  /// True when it owes or declares events of this type.
  bool gives(uint32_t type) const { return outputs_.has(type); }
  /// Hands one message in and returns the events that came out; they are valid until the next call. [process]
  std::span<AnyMessage> process(const odo_header& message);
  /// Back to the state after activation. [control]
  void reset();
  /// True once after a reset, also one of its own after a failure: what describes the sensors is to be told anew.
  bool take_reset() { return std::exchange(was_reset_, false); }

  /// What should survive a restart; empty where the plugin keeps nothing. [control]
  std::vector<uint8_t> save() const;
  /// False, and nothing changed, when the plugin does not take it. [control]
  bool load(std::span<const uint8_t> data);

  /// An extension's table, or null. [any]
  const void* extension(std::string_view id) const;

  const std::string& id() const { return id_; }
  /// Its number in reports and in the `source` of its events, from 1.
  uint32_t number() const { return number_; }
  const std::string& interface_id() const { return choice_.interface_id; }
  /// False once it failed for good.
  bool alive() const { return alive_; }
  uint64_t faults() const { return faults_; }

 private:
  struct Sink : odo_sink {
    PluginInstance* owner;
  };

  PluginInstance(std::shared_ptr<PluginLibrary> library, HostServices& host, uint32_t number,
                 const PluginChoice& choice);
  static int32_t emit(const odo_sink* sink, const odo_header* event);
  int32_t start();
  void failed(int32_t status, const odo_header& message);
  void fault(const char* key, const std::string& text, int32_t status);

  std::shared_ptr<PluginLibrary> library_;
  HostServices& host_;
  uint32_t number_;
  PluginChoice choice_;
  std::string id_;
  TypeSet inputs_, outputs_;
  odo_instance* instance_ = nullptr;
  Sink sink_{};
  EventBuffer buffer_;
  uint64_t faults_ = 0;
  int failures_in_a_row_ = 0;
  bool alive_ = true;
  bool was_reset_ = false;
  bool overflow_told_ = false;  // in this call
};

/// The message types a kind is given and owes; empty for an unknown interface.
struct KindTypes {
  std::vector<uint32_t> inputs, outputs;
};
KindTypes kind_types(const std::string& interface_id);
/// The same, and what the plugin's table declares beyond.
KindTypes plugin_types(const std::string& interface_id, const odo_plugin& table);

/// A choice's parameters as a plugin is given them; they point into the choice.
std::vector<odo_value> values_of(const PluginChoice& choice);

}  // namespace odograph
