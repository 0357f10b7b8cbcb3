// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include <odograph/odograph.h>

#include "sdk/host/base/result.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/host/plugin_host/services.hpp"

namespace odograph {

/// What goes to the app: events and reports through its callback, the last error on request. Reports are collected from
/// any thread and published by one. The callback is called without a lock and may set another one. [any]
class Outbox {
 public:
  static constexpr size_t kMaxReports = 64;  ///< that wait; more are only the last error

  /// Returns when the callback before is no longer running, unless called from within it.
  void set_callback(TypeSet types, odo_callback callback, void* user);
  /// One thread at a time, as publish_reports.
  void publish(const odo_header& event);
  void add(const Report& report);
  /// True when publish_reports would call the callback.
  bool report_is_waiting() const;
  void publish_reports(int64_t t_ns);
  void set_last_error(Failure error);
  /// The newest error or warning since the last call; ODO_OK and no text where there is none.
  Failure take_last_error();

 private:
  mutable std::mutex mutex_;
  std::condition_variable returned_;
  odo_callback callback_ = nullptr;
  void* user_ = nullptr;
  TypeSet types_;
  bool runs_ = false;
  std::thread::id thread_;  // on which it runs
  Failure last_error_{ODO_OK, ""};
  std::vector<Report> reports_;
  std::atomic<bool> has_callback_{false}, has_reports_{false};
};

}  // namespace odograph
