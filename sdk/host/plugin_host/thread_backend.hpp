// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/plugin_host/separate_backend.hpp"
#include "sdk/host/plugin_host/services.hpp"

namespace odograph {

/// An instance in this process on a thread of its own, with a watchdog: what it is given is copied, pixels too, and a
/// call that takes longer than its limit is left behind with its thread. Then ended() says so; the late call ends its
/// own instance when it comes back, and what it says is not heard. A plugin that ends its thread (pthread_exit) ends
/// the same way. A crash is a crash of the app.
class ThreadBackend : public SeparateBackend {
 public:
  struct Parameters {
    int max_left_behind = 8;  ///< calls of one library that have not come back; with more nothing is loaded (judgement)
  };

  /// `choice` is copied; `host` and `sink` are used until it is destroyed, within its own calls alone. A failure with
  /// ODO_E_FATAL is an end like a later one.
  static Result<std::unique_ptr<ThreadBackend>> load(const PluginChoice& choice, LibraryCheck check, HostServices& host,
                                                     const odo_sink& sink);
  ~ThreadBackend() override;

  int32_t start() override;
  int32_t process(const odo_header& message) override;
  int32_t wake() override;
  int32_t reset() override;
  std::vector<uint8_t> save() override;
  bool load(std::span<const uint8_t> data) override;

 private:
  class Worker;
  enum class Call { load, start, process, reset, save, restore, wake };

  explicit ThreadBackend(std::shared_ptr<Worker> worker) : worker_(std::move(worker)) {}
  bool exchange(Call call, double limit_s);
  std::string why_none(const char* call, double limit_s) const;

  std::shared_ptr<Worker> worker_;  // shared with its thread
};

}  // namespace odograph
