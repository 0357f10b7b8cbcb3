// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/host/plugin_host/backend.hpp"
#include "sdk/host/plugin_host/services.hpp"

namespace odograph {

/// The events that one call to process gave, in a fixed arena: nothing is allocated after construction.
class EventBuffer {
 public:
  static constexpr size_t kCapacity = 256;
  EventBuffer() { events_.reserve(kCapacity); }
  void clear() { count_ = 0; }
  AnyMessage* next() {
    if (count_ == kCapacity) return nullptr;
    if (count_ == events_.size()) events_.emplace_back();  // memory is touched once it is needed
    return &events_[count_++];
  }
  void drop_last() { --count_; }
  std::span<AnyMessage> events() { return {events_.data(), count_}; }

 private:
  std::vector<AnyMessage> events_;
  size_t count_ = 0;
};

/// One instance of a plugin, through its whole life. What it emits is checked before anybody sees it. A failing
/// instance is reset, and after too many failures left out; a library that says ODO_E_FATAL is quarantined. One in a
/// process of its own that ends is started anew, with what it had learnt, after waits that double (of sensor time, so
/// that a replay repeats itself). Where there is a fallback, it takes the place of what was given up or ended too
/// often.
class PluginInstance {
 public:
  struct Parameters {
    int failures_before_giving_up = 5;          ///< in a row
    int64_t first_wait_ns = 100'000'000;        ///< after the second end in a row; the first costs no wait
    int64_t longest_wait_ns = 10'000'000'000;   ///< Judgement: an app's user looks again after ten seconds
    int64_t good_ns = 1'000'000'000;            ///< what ran for longer begins to count its ends anew
    int ends_before_fallback = 3;               ///< in a row
    int64_t between_saves_ns = 10'000'000'000;  ///< of what an isolated plugin has learnt; that much may be lost
    int64_t recovering_ns = 1'000'000'000;      ///< after a new start the pose is called degraded
  };

  /// Creates, configures and activates. The failure names the plugin, the step and what the plugin reported. A plugin
  /// whose own process ends meanwhile is no failure: it is started anew like later.
  static Result<std::unique_ptr<PluginInstance>> make(const PluginChoice& choice, LibraryCheck check, uint32_t number,
                                                      HostServices& host);
  ~PluginInstance();
  PluginInstance(const PluginInstance&) = delete;
  PluginInstance& operator=(const PluginInstance&) = delete;

  /// True when the plugin's kind is given messages of this type, or the plugin declares that it wants them.
  bool wants(uint32_t type) const { return inputs_.has(type); }
  bool takes_several_cameras() const { return (flags_ & ODO_PLUGIN_SEVERAL_CAMERAS) != 0; }
  /// True when it emits or declares events of this type.
  bool gives(uint32_t type) const { return outputs_.has(type); }
  /// Hands one message in and returns the events that came out; they are valid until the next call. [process]
  std::span<AnyMessage> process(const odo_header& message);
  /// As process, with no message, for a plugin that has asked for it (odo.wake/1). [process]
  std::span<AnyMessage> wake();
  /// Back to the state after activation. [control]
  void reset();
  /// True once after a reset, also one of its own after a failure: what describes the sensors is to be told anew.
  bool take_reset() { return std::exchange(was_reset_, false); }

  /// What should survive a restart; empty where the plugin keeps nothing. [control]
  std::vector<uint8_t> save() const;
  /// False, and nothing changed, when the plugin does not take it. [control]
  bool load(std::span<const uint8_t> data);

  /// An extension's table, or null, as for a plugin in a process of its own. [process]
  const void* extension(std::string_view id) const;

  const std::string& id() const { return choice_->manifest.id; }
  /// Its number in reports and in the `source` of its events, from 1.
  uint32_t number() const { return number_; }
  const std::string& interface_id() const { return choice_->interface_id; }
  /// False while its process is down, and once it failed for good.
  bool alive() const { return alive_ && backend_; }
  /// True for a while after its process was started anew.
  bool recovering() const { return now_ns_ < recovering_until_ns_; }
  uint64_t faults() const { return faults_; }
  /// Of the plugin's own process; -1 where it has none.
  int process_id() const;

 private:
  struct Sink : odo_sink {
    PluginInstance* owner;
  };

  PluginInstance(const PluginChoice& choice, LibraryCheck check, HostServices& host, uint32_t number);
  static int32_t emit(const odo_sink* sink, const odo_header* event);
  Result<bool> open();
  bool isolated() const { return choice_->isolation.kind != Isolation::Kind::none; }
  bool has_ended() const { return backend_ && !backend_->ended().empty(); }
  void note_time(int64_t took_ns);
  void note_end(const std::string& what);
  void revive();
  void give_up();
  bool use_fallback();
  void learn_types();
  bool can_take(const odo_header& message);
  void save_now_and_then();
  std::span<AnyMessage> finish(int32_t status, const odo_header* message);
  void failed(int32_t status, const odo_header* message);
  void fault(const char* key, const std::string& text, int32_t status);

  Parameters parameters_;
  std::shared_ptr<const PluginChoice> choice_;
  LibraryCheck check_;
  HostServices& host_;
  uint32_t number_;
  TypeSet inputs_, outputs_;
  uint32_t flags_ = 0;  // ODO_PLUGIN_*
  Sink sink_{};
  EventBuffer buffer_;
  std::unique_ptr<PluginBackend> backend_;  // none while its process is down
  uint64_t faults_ = 0;
  int failures_in_a_row_ = 0;
  bool alive_ = true;
  bool was_reset_ = false;
  bool overflow_told_ = false;  // in this call
  // Of a process of its own, in sensor time:
  int64_t now_ns_ = INT64_MIN, started_ns_ = INT64_MIN, back_at_ns_ = INT64_MIN, recovering_until_ns_ = INT64_MIN;
  int64_t saved_ns_ = INT64_MIN;
  int ends_in_a_row_ = 0;
  std::vector<uint8_t> saved_;
};

/// What is wrong with an event, for a report.
struct EventFault {
  const char* key = "";
  std::string text;
};

/// Whether a plugin with these outputs may emit an event, with a copy of it: ODO_OK, ODO_E_UNSUPPORTED (nothing is
/// wrong), or a status with its fault.
int32_t judge_event(const odo_header& event, const TypeSet& outputs, AnyMessage& copy, EventFault& fault);

/// The message types a kind is given and emits; empty for an unknown interface.
KindTypes kind_types(const std::string& interface_id);
/// The same, and what the plugin's table declares beyond.
KindTypes plugin_types(const std::string& interface_id, const odo_plugin& table);

/// A choice's parameters as a plugin is given them; they point into the choice.
std::vector<odo_value> values_of(const PluginChoice& choice);

}  // namespace odograph
