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

/// Names plugins of this process whose calls do not come back, once for each call: nothing can end them here, but
/// somebody is to know whom to blame. A thread of its own, which sleeps.
class HangWatch {
 public:
  struct Parameters {
    double longest_call_s = 5;  ///< of this machine's clock; ours load their models in less on a slow phone (judgement)
    double period_s = 1;        ///< between two looks
  };

  /// Reports to `host`, which outlives it.
  explicit HangWatch(HostServices& host) : HangWatch(host, Parameters()) {}
  HangWatch(HostServices& host, const Parameters& parameters);
  ~HangWatch();
  HangWatch(const HangWatch&) = delete;
  HangWatch& operator=(const HangWatch&) = delete;

 private:
  void look();

  HostServices& host_;
  const Parameters parameters_;
  std::set<std::pair<int64_t, std::string>> told_;  // by the time at which they began, and what they are
  std::mutex mutex_;
  std::condition_variable ends_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace odograph
