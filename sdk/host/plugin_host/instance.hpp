// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <future>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/host/plugin_host/backend.hpp"
#include "sdk/host/plugin_host/services.hpp"

namespace odograph {

/// The events that one call to process emitted, in a fixed arena: no allocation after construction.
class EventBuffer {
 public:
  static constexpr size_t kCapacity = 256;
  EventBuffer() { events_.reserve(kCapacity); }
  void clear() {
    for (; count_ > AnyMessage::kKeptLarge; --count_) events_[count_ - 1].release_memory();
    count_ = 0;
  }
  AnyMessage* next() {
    if (count_ == kCapacity) return nullptr;
    if (count_ == events_.size()) events_.emplace_back();  // memory is touched only when needed
    return &events_[count_++];
  }
  void drop_last() { --count_; }
  std::span<AnyMessage> events() { return {events_.data(), count_}; }

 private:
  std::vector<AnyMessage> events_;
  size_t count_ = 0;
};

/// One plugin instance over its whole life. Its events are checked before anything uses them. A failing instance is
/// reset, and after repeated failures no longer called; a library that returns ODO_E_FATAL is quarantined. If a
/// plugin's own process ends, it is restarted with its saved state after doubling waits (in sensor time, so that a
/// replay is reproducible); in a live session on another thread (HostServices::Pace). A fallback, if configured,
/// replaces a plugin that was given up or ended too often.
class PluginInstance {
 public:
  struct Parameters {
    int failures_before_giving_up = 5;          ///< consecutive
    int64_t first_wait_ns = 100'000'000;        ///< after the second consecutive end; none after the first
    int64_t longest_wait_ns = 10'000'000'000;   ///< judgement: a user looks again after ten seconds
    int64_t stable_ns = 1'000'000'000;          ///< a longer run resets the count of ends
    int ends_before_fallback = 3;               ///< consecutive
    int64_t between_saves_ns = 10'000'000'000;  ///< of an isolated plugin's state; the maximum loss
    int64_t recovering_ns = 1'000'000'000;      ///< after a restart, during which the pose is degraded
  };

  /// Creates, configures and activates a plugin. A failure names the plugin, the step and the plugin's reports. The end
  /// of the plugin's own process is not a failure: it is restarted as later on.
  static Result<std::unique_ptr<PluginInstance>> make(const PluginChoice& choice, LibraryCheck check, uint32_t number,
                                                      HostServices& host);
  /// Waits for a start on another thread, which ends soon once the host's pace is `ending`.
  ~PluginInstance();
  PluginInstance(const PluginInstance&) = delete;
  PluginInstance& operator=(const PluginInstance&) = delete;

  /// Whether the plugin receives messages of this type, by its kind or its table.
  bool wants(uint32_t type) const { return inputs_.has(type); }
  bool takes_several_cameras() const { return (flags_ & ODO_PLUGIN_SEVERAL_CAMERAS) != 0; }
  /// Whether it may emit events of this type.
  bool emits(uint32_t type) const { return outputs_.has(type); }
  /// Passes one message and returns the resulting events, valid until the next call. [process]
  std::span<AnyMessage> process(const odo_header& message);
  /// As process(), without a message, for a plugin that requested it (odo.wake/1), or that has started. [process]
  std::span<AnyMessage> wake();
  /// Returns to the state after activation. [control]
  void reset();
  /// True once after a reset, including one after a failure: the sensor descriptions must be sent again.
  bool take_reset() { return std::exchange(was_reset_, false); }

  /// State that survives a restart; empty if the plugin saves none. [control]
  std::vector<uint8_t> save() const;
  /// False, and nothing changed, if the plugin rejects the data. [control]
  bool load(std::span<const uint8_t> data);

  /// The plugin's map; empty if it makes none, or has none yet. [control]
  std::vector<uint8_t> save_map() const;
  /// Passes a map to it; it gets that again whenever it starts anew. False, and nothing changed, if it rejects the map.
  /// [control]
  bool load_map(std::span<const uint8_t> data);
  /// Whether it was given a map with these first eight bytes.
  bool has_loaded(uint64_t map) const;

  /// An extension's table, or null, as for a plugin in its own process. [process]
  const void* extension(std::string_view id) const;

  const std::string& id() const { return choice_->manifest.id; }
  /// Its number in reports and in the `source` of its events, from 1.
  uint32_t number() const { return number_; }
  const std::string& interface_id() const { return choice_->interface_id; }
  /// False while its process is down, and after a permanent failure.
  bool alive() const { return alive_ && backend_; }
  /// True for a while after its process was restarted.
  bool recovering() const { return now_ns_ < recovering_until_ns_; }
  uint64_t faults() const { return faults_; }
  /// Id of the plugin's own process; -1 if it has none.
  int process_id() const;

 private:
  struct Sink : odo_sink {
    PluginInstance* owner;
  };

  PluginInstance(const PluginChoice& choice, LibraryCheck check, HostServices& host, uint32_t number);
  using Started = Result<std::unique_ptr<PluginBackend>>;

  static int32_t emit(const odo_sink* sink, const odo_header* event);
  void choose(std::shared_ptr<const PluginChoice> choice);
  Started start() const;
  Result<bool> take(Started started);
  bool isolated() const { return choice_->isolation.kind != Isolation::Kind::none; }
  bool has_ended() const { return backend_ && !backend_->ended().empty(); }
  void check_call_time(int64_t took_ns);
  void on_process_end(const std::string& what);
  void restart();
  void restarted(Started started);
  void give_up();
  bool use_fallback();
  void use_types(const KindTypes& types);
  bool can_receive(const odo_header& message);
  void save_periodically();
  void pass_maps(PluginBackend& backend) const;
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
  std::unique_ptr<PluginBackend> backend_;  // null while its process is down
  std::thread starter_;                     // reads choice_ and saved_, which do not change meanwhile
  std::future<Started> starting_;           // its result, valid until that is taken
  std::string replaced_;                    // plugin for which a fallback starts
  uint64_t faults_ = 0;
  int consecutive_failures_ = 0;
  bool alive_ = true;
  bool was_reset_ = false;
  bool overflow_reported_ = false;  // the overflow of this call has been reported
  // For a plugin process, in sensor time:
  int64_t now_ns_ = INT64_MIN, started_ns_ = INT64_MIN, restart_at_ns_ = INT64_MIN, recovering_until_ns_ = INT64_MIN;
  int64_t saved_ns_ = INT64_MIN;
  int consecutive_ends_ = 0;
  std::vector<uint8_t> saved_;
  std::vector<std::vector<uint8_t>> maps_;  // that it was given
};

/// The fault of an event, for a report.
struct EventFault {
  const char* key = "";
  std::string text;
};

/// Checks whether a plugin with these outputs may emit an event, and copies it: ODO_OK, ODO_E_UNSUPPORTED (to be
/// ignored without a fault), or a status with its fault.
int32_t validate_event(const odo_header& event, const TypeSet& outputs, AnyMessage& copy, EventFault& fault);

/// The parameters of a choice in the plugin's form; they point into the choice.
std::vector<odo_value> values_of(const PluginChoice& choice);

}  // namespace odograph
