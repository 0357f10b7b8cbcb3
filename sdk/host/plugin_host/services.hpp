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

/// A report from a plugin or the host, for the user.
struct Report {
  uint32_t severity;
  std::string origin;  // plugin id, or "host"
  std::string key;
  std::string text;
  uint32_t instance = 0;    // 0: the host
  uint64_t count = 1;       // number of similar reports that this one represents
  int32_t status = ODO_OK;  // associated status
};

/// Services of the app for plugins (odo_session_options.get_service).
struct AppServices {
  void* user = nullptr;
  const void*(ODO_CALL* get)(void* user, const char* id, uint64_t id_size) = nullptr;
};

/// The odo_host that plugins see, with its services: report, random, assets, wake, and the app's. Outlives every
/// instance created with it.
class HostServices : public odo_host {
 public:
  using Listener = std::function<void(const Report&)>;

  /// `assets`: directories in which files named by a config are searched, in this order.
  HostServices(uint64_t seed, std::vector<std::filesystem::path> assets, Listener listener, AppServices app = {});
  HostServices(const HostServices&) = delete;
  HostServices& operator=(const HostServices&) = delete;
  virtual ~HostServices() = default;

  /// Sets the plugin name of an instance number, for reports. [control]
  void name_instance(uint32_t instance, const std::string& id);

  /// Author of a report: reports by a plugin never suppress the host's reports about it.
  enum class Author { host, plugin };
  /// Passes a report on, with key and text as one line each (one_line in base/printable.hpp), at most one a second (of
  /// this machine's clock) for each origin, author and key; the next one includes the count of those suppressed. An
  /// origin with more than 256 keys uses "more" for the rest. [any]
  virtual void report(uint32_t instance, uint32_t severity, const std::string& key, const std::string& text,
                      int32_t status = ODO_OK, Author author = Author::host);

  /// Notes that an instance requests a call (odo.wake/1). [any]
  virtual void wake(uint32_t instance);
  bool has_woken() const { return has_woken_; }
  /// The instances that requested a call since the last take, each once. [any]
  std::set<uint32_t> take_woken();
  /// Sets a listener for such requests, called on the requesting thread. [control]
  void on_wake(std::function<void()> listener) { wake_listener_ = std::move(listener); }

  /// Whether a plugin's own process may hold the pipeline: `waits` for its calls and restarts, as in a replay; `live`:
  /// it restarts on another thread; `ending`: nothing waits for it any more.
  enum class Pace { waits, live, ending };
  void set_pace(Pace pace) { pace_ = pace; }
  Pace pace() const { return pace_; }

  /// Whether samples arrive in real time (odo.run/1). Set before a plugin is created.
  void set_live(bool live) { live_ = live; }
  bool live() const { return live_; }

  /// Memory in which plugins in other processes see frames.
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
    uint64_t suppressed = 0;
  };

  uint64_t seed_;
  std::vector<std::filesystem::path> assets_;
  Listener listener_;
  AppServices app_;
  odo_content_service asset_contents_{};
  std::function<void()> wake_listener_;
  std::set<uint32_t> woken_;
  std::atomic<bool> has_woken_{false};
  std::atomic<Pace> pace_{Pace::waits};
  bool live_ = false;
  SharedPixels shared_pixels_;
  std::mutex mutex_;
  std::map<uint32_t, std::string> names_;
  std::map<std::pair<std::string, Author>, std::map<std::string, Recent>> recent_;  // by key
};

}  // namespace odograph
