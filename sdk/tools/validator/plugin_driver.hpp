// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <odograph/plugin.h>

#include "sdk/host/messages/messages.hpp"

namespace odograph {

/// An event as emitted, with the plugin's input so far.
struct SeenEvent {
  AnyMessage message;
  int64_t input_ns = INT64_MIN;  ///< newest time in the plugin's input
  uint32_t input_type = 0;       ///< type of the message being processed
  size_t call = 0;               ///< index of the call to process
};

/// Memory layout of the messages of a call.
struct MessageLayout {
  bool guarded = false;  ///< read-only, at the end of a page with nothing behind it; unmapped after the call
  size_t batch = 1;      ///< messages per call
  std::function<void(AnyMessage&)> change;  ///< applied to each message before it is passed
};

/// A plugin instance driven by the validator through the same calls as the host's, but more strictly: every violation
/// of the contract is recorded in `violations`.
class PluginDriver {
 public:
  PluginDriver(const odo_plugin& table, const odo_host& host, const std::string& interface_id);
  ~PluginDriver() { destroy(); }
  PluginDriver(const PluginDriver&) = delete;

  /// Calls create, configure and activate; returns the first negative status.
  int32_t start(const std::vector<odo_value>& values);
  int32_t create();
  int32_t configure(const std::vector<odo_value>& values);
  int32_t activate();
  /// Returns the worst status, ignoring those that are valid answers to an input (discard, exhausted).
  int32_t process(const std::vector<AnyMessage>& messages, const MessageLayout& layout = {});
  int32_t call(const odo_batch& batch);
  int32_t reset();
  void destroy();

  bool has(size_t offset) const { return table_.struct_size >= offset + sizeof(void*); }
  odo_instance* instance() const { return instance_; }
  const odo_plugin& table() const { return table_; }
  /// The events' bytes, for comparison.
  std::vector<std::vector<unsigned char>> bytes() const;

  std::vector<SeenEvent> events;
  std::vector<std::string> violations;
  std::map<int32_t, int> statuses;  ///< counts of each status of process
  std::vector<double> call_s;       ///< of each call to process, wall clock
  uint32_t sink_size = sizeof(odo_sink);

 private:
  struct Sink : odo_sink {
    double size_of_a_later_version[4];
    PluginDriver* owner;
  };
  int32_t emit(const odo_header* event);
  void violation(const std::string& text);

  odo_plugin table_;
  const odo_host& host_;
  std::string interface_id_;
  Sink sink_{};
  odo_instance* instance_ = nullptr;
  TypeSet outputs_;
  bool in_process_ = false;
  std::thread::id thread_;
  size_t calls_ = 0, events_in_call_ = 0;
  int64_t input_ns_ = INT64_MIN;
  uint32_t input_type_ = 0;
};

/// Frames lent for a call by a strict host: their pixels are unmapped once nobody holds them.
struct LoanCounter {
  int retained = 0, released = 0;
  bool refuse = false;  ///< retain returns ODO_E_EXHAUSTED
  static int32_t ODO_CALL retain(void* owner);
  static void ODO_CALL release(void* owner);
};

/// Resident memory of this process.
double resident_mb();

}  // namespace odograph
