// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/plugin_host/call_watchdog.hpp"

#include <chrono>
#include <string>

#include "sdk/host/plugin_host/plugin_call.hpp"

namespace odograph {

CallWatchdog::CallWatchdog(HostServices& host, const Parameters& parameters) : host_(host), parameters_(parameters) {
  thread_ = std::thread([this] {
    std::unique_lock lock(mutex_);
    const std::chrono::duration<double> period(parameters_.period_s);
    while (!ends_.wait_for(lock, period, [this] { return ending_; })) check();
  });
}

CallWatchdog::~CallWatchdog() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  ends_.notify_all();
  thread_.join();
}

void CallWatchdog::check() {
  std::set<std::pair<int64_t, std::string>> lasting;
  for_each_long_call(static_cast<int64_t>(parameters_.longest_call_s * 1e9), [&](const LongCall& call) {
    const std::pair<int64_t, std::string> one(call.since_ns, call.what);
    lasting.insert(one);
    if (reported_.count(one) > 0) return;
    host_.report(0, ODO_SEVERITY_ERROR, "hangs " + call.what,
                 "plugin " + call.what + " for " + std::to_string(call.lasts_ns / 1'000'000'000) +
                     " s so far; in its own process (isolation: process) it could be skipped",
                 ODO_E_ERROR);
  });
  reported_ = std::move(lasting);
}

}  // namespace odograph
