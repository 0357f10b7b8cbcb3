// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <odograph/plugin.h>

#include "sdk/host/plugin_host/shared_pixels.hpp"

namespace odograph {

/// A report of a plugin or of the host, for people.
struct Report {
  uint32_t severity;
  std::string origin;  // plugin id, or "host"
  std::string key;
  std::string text;
  uint32_t instance = 0;    // 0: the host
  uint64_t count = 1;       // how many like it this one stands for
  int32_t status = ODO_OK;  // that belongs to it
};

/// Services of the app for plugins (odo_session_options.get_service).
struct AppServices {
  void* user = nullptr;
  const void*(ODO_CALL* get)(void* user, const char* id, uint64_t id_size) = nullptr;
};

/// The odo_host that plugins see, with its services: report, random, assets, wake, and the app's. Outlives every
/// instance made with it.
class HostServices : public odo_host {
 public:
  using Listener = std::function<void(const Report&)>;

  /// `assets`: directories in which files that a config names are looked for, in this order.
  HostServices(uint64_t seed, std::vector<std::filesystem::path> assets, Listener listener, AppServices app = {});
  HostServices(const HostServices&) = delete;
  HostServices& operator=(const HostServices&) = delete;
  virtual ~HostServices() = default;

  /// Gives an instance number its plugin's name, for reports. [control]
  void name_instance(uint32_t instance, const std::string& id);

  /// Who a report is by: what a plugin reports never holds back what the host says about it.
  enum class Author { host, plugin };
  /// Passes a report on, key and text as one line each (one_line in base/printable.hpp), at most one a second (of this
  /// machine's clock) for each origin, author and key; the rest are counted into the next one. An origin with more than
  /// 256 keys has "more" for the rest. [any]
  virtual void report(uint32_t instance, uint32_t severity, const std::string& key, const std::string& text,
                      int32_t status = ODO_OK, Author author = Author::host);

  /// Notes that an instance asks to be called (odo.wake/1). [any]
  virtual void wake(uint32_t instance);
  bool has_woken() const { return has_woken_; }
  /// The instances that have asked since the last call, each once. [any]
  std::set<uint32_t> take_woken();
  /// Called whenever an instance asks, on its thread. [control]
  void on_wake(std::function<void()> listener) { wake_listener_ = std::move(listener); }

  /// Where plugins in processes of their own see frames.
  SharedPixels& shared_pixels() { return shared_pixels_; }
  uint64_t seed() const { return seed_; }
  const std::vector<std::filesystem::path>& assets() const { return assets_; }
  const AppServices& app() const { return app_; }

 protected:
  /// A service's table, or null.
  virtual const void* service(std::string_view id);

 private:
  static const void* find_service(const odo_host* host, const char* id, uint64_t size);
  const void* own_service(std::string_view id) const;

  struct Recent {
    std::chrono::steady_clock::time_point last;
    uint64_t held_back = 0;
  };

  uint64_t seed_;
  std::vector<std::filesystem::path> assets_;
  Listener listener_;
  AppServices app_;
  odo_asset_service_2 asset_contents_{};
  std::function<void()> wake_listener_;
  std::set<uint32_t> woken_;
  std::atomic<bool> has_woken_{false};
  SharedPixels shared_pixels_;
  std::mutex mutex_;
  std::map<uint32_t, std::string> names_;
  std::map<std::pair<std::string, Author>, std::map<std::string, Recent>> recent_;  // by key
};

}  // namespace odograph
