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

/// Output to the app: events and reports through its callback, the last error on request. Any thread may report; one
/// thread publishes. The callback is called without a lock and may set another callback. [any]
class Outbox {
 public:
  static constexpr size_t kMaxReports = 64;  ///< waiting reports; further ones are only kept as the last error

  ~Outbox() { delete receiver_.load(); }
  /// Returns once the previous callback has finished, unless called from within it.
  void set_callback(TypeSet types, odo_callback callback, void* user);
  /// Called by one thread at a time, like publish_reports().
  void publish(const odo_header& event);
  void add(const Report& report);
  /// Whether publish_reports() would call the callback.
  bool report_is_waiting() const;
  void publish_reports(int64_t t_ns);
  void set_last_error(Failure error);
  /// Returns and clears the newest error or warning; ODO_OK and no text if there is none.
  Failure take_last_error();

 private:
  struct Receiver {
    TypeSet types;
    odo_callback callback;
    void* user;
  };

  // Publishing takes no lock: a receiver is read while runs_ is set, and deleted once it has been seen cleared.
  std::atomic<const Receiver*> receiver_{nullptr};
  std::atomic<bool> runs_{false};
  std::atomic<std::thread::id> thread_{{}};  // thread that publishes, if it runs
  std::atomic<int> waiting_{0};              // threads that wait for it
  std::atomic<bool> wants_reports_{false}, has_reports_{false};
  std::mutex mutex_;  // guards what follows
  std::condition_variable returned_;
  Failure last_error_{ODO_OK, ""};
  std::vector<Report> reports_;
};

}  // namespace odograph
