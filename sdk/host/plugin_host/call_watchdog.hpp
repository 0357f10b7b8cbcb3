// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include "sdk/host/plugin_host/services.hpp"

namespace odograph {

/// Reports plugins of this process whose calls do not return, once per call: they cannot be ended here, but the report
/// names the culprit. Runs on its own thread, which mostly sleeps.
class CallWatchdog {
 public:
  struct Parameters {
    /// s, on the steady clock; our plugins load their models faster on a slow phone (judgement).
    double longest_call_s = 5;
    double period_s = 1;  ///< between two checks
  };

  /// Reports to `host`, which outlives it.
  explicit CallWatchdog(HostServices& host) : CallWatchdog(host, Parameters()) {}
  CallWatchdog(HostServices& host, const Parameters& parameters);
  ~CallWatchdog();
  CallWatchdog(const CallWatchdog&) = delete;
  CallWatchdog& operator=(const CallWatchdog&) = delete;

 private:
  void check();

  HostServices& host_;
  const Parameters parameters_;
  std::set<std::pair<int64_t, std::string>> reported_;  // reported calls, by start time and name
  std::mutex mutex_;
  std::condition_variable ends_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace odograph
