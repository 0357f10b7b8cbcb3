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

/// An event as a plugin emitted it, with what was known then.
struct SeenEvent {
  AnyMessage message;
  int64_t input_ns = INT64_MIN;  ///< newest time of what the plugin had been given
  uint32_t input_type = 0;       ///< of the message that it answered
  size_t call = 0;               ///< number of the call to process
};

/// How the messages of one call are laid in memory.
struct Handling {
  bool guarded = false;  ///< read-only, at the end of a page with nothing behind; gone after the call
  size_t batch = 1;      ///< messages a call
  std::function<void(AnyMessage&)> change;  ///< of each message before it is handed in
};

/// A plugin instance driven by hand, through the same calls as the host's, but stricter: everything that it does
/// against the contract is noted in `breaches`.
class Subject {
 public:
  Subject(const odo_plugin& table, const odo_host& host, const std::string& interface_id);
  ~Subject() { destroy(); }
  Subject(const Subject&) = delete;

  /// create, configure and activate; the first status below 0.
  int32_t start(const std::vector<odo_value>& values);
  int32_t create();
  int32_t configure(const std::vector<odo_value>& values);
  int32_t activate();
  /// The worst status; what is no answer to an input (discard, exhausted) does not count.
  int32_t process(const std::vector<AnyMessage>& messages, const Handling& handling = {});
  int32_t call(const odo_batch& batch);
  int32_t reset();
  void destroy();

  bool has(size_t offset) const { return table_.struct_size >= offset + sizeof(void*); }
  odo_instance* instance() const { return instance_; }
  const odo_plugin& table() const { return table_; }
  /// The events' bytes, for comparison.
  std::vector<std::vector<unsigned char>> bytes() const;

  std::vector<SeenEvent> events;
  std::vector<std::string> breaches;
  std::map<int32_t, int> statuses;  ///< of process, how often each
  std::vector<double> call_s;       ///< of each call to process, this machine's clock
  uint32_t sink_size = sizeof(odo_sink);

 private:
  struct Sink : odo_sink {
    double size_of_a_later_version[4];
    Subject* owner;
  };
  int32_t emit(const odo_header* event);
  void breach(const std::string& text);

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

/// Frames lent for a call, as a strict host lends them: their pixels are gone when nobody holds them any more.
struct FrameLedger {
  int retained = 0, released = 0;
  bool refuse = false;  ///< retain answers ODO_E_EXHAUSTED
  static int32_t ODO_CALL retain(void* owner);
  static void ODO_CALL release(void* owner);
};

}  // namespace odograph
