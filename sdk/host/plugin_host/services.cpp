// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/plugin_host/services.hpp"

#include <algorithm>
#include <cstring>
#include <string_view>
#include <utility>

#include "sdk/host/base/printable.hpp"
#include "sdk/host/base/version.hpp"
#include "sdk/host/plugin_host/assets.hpp"

namespace odograph {
namespace {

HostServices& of(const odo_host* host) { return *const_cast<HostServices*>(static_cast<const HostServices*>(host)); }

constexpr size_t kMaxKinds = 256;  // of reports per origin; further kinds share one
constexpr size_t kLongestKey = 256, kLongestText = 4096;

std::string text_of(const odo_string* s, size_t longest) {
  return s && s->size ? std::string(s->data, std::min<uint64_t>(s->size, longest)) : std::string();
}

/// SplitMix64 (Steele, Lea & Flood 2014): neighbouring inputs yield uncorrelated outputs.
uint64_t mix(uint64_t x) {
  x += 0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

}  // namespace

HostServices::HostServices(uint64_t seed, std::vector<std::filesystem::path> assets, Listener listener, AppServices app)
    : odo_host{}, seed_(seed), assets_(std::move(assets)), listener_(std::move(listener)), app_(app) {
  struct_size = sizeof(odo_host);
  abi_major_min = abi_major_max = ODO_ABI_MAJOR;
  abi_minor = ODO_ABI_MINOR;
  version = {kVersion, std::strlen(kVersion)};
  get_service = find_service;
  asset_contents_.struct_size = sizeof asset_contents_;
  asset_contents_.user = this;
  asset_contents_.open = [](void* user, const odo_string* name, odo_asset** asset, uint64_t* size) -> int32_t {
    return open_asset(static_cast<const HostServices*>(user)->assets_, text_of(name, kLongestText), asset, size);
  };
  asset_contents_.read = read_asset;
  asset_contents_.close = close_asset;
}

const void* HostServices::find_service(const odo_host* host, const char* id, uint64_t size) {
  return of(host).service({id, static_cast<size_t>(size)});
}

/// Ids that begin with "odo." belong to the host; for assets, the app's contents take precedence over the host's.
const void* HostServices::service(std::string_view id) {
  const bool app_may_have_it = !id.starts_with("odo.") || id == ODO_SERVICE_CONTENTS;
  const void* found = app_may_have_it && app_.get ? app_.get(app_.user, id.data(), id.size()) : nullptr;
  return found ? found : own_service(id);
}

const void* HostServices::own_service(std::string_view id) const {
  static const odo_report_service reports{
      sizeof(odo_report_service), 0,
      [](const odo_host* host, uint32_t instance, uint32_t severity, const odo_string* key, const odo_string* text) {
        of(host).report(instance, severity, text_of(key, kLongestKey), text_of(text, kLongestText), ODO_OK,
                        Author::plugin);
      }};
  static const odo_random_service random{sizeof(odo_random_service), 0,
                                         [](const odo_host* host, uint32_t instance, uint64_t stream) {
                                           return mix(mix(of(host).seed_ + instance) ^ stream);
                                         }};
  static const odo_asset_service paths{
      sizeof(odo_asset_service), 0,
      [](const odo_host* host, const odo_string* name, char* path, uint64_t capacity) -> int64_t {
        const auto found = find_asset(of(host).assets_, text_of(name, kLongestText));
        if (!found) return ODO_E_NOT_FOUND;
        const std::string text = found->string();
        std::copy_n(text.data(), std::min<uint64_t>(capacity, text.size()), path);
        return static_cast<int64_t>(text.size());
      }};
  static const odo_wake_service wakes{sizeof(odo_wake_service), 0,
                                      [](const odo_host* host, uint32_t instance) { of(host).wake(instance); }};
  static const odo_run_service live{sizeof(odo_run_service), 1}, replay{sizeof(odo_run_service), 0};
  if (id == ODO_SERVICE_RUN) return live_ ? &live : &replay;
  if (id == ODO_SERVICE_REPORT) return &reports;
  if (id == ODO_SERVICE_RANDOM) return &random;
  if (id == ODO_SERVICE_ASSETS) return &paths;
  if (id == ODO_SERVICE_CONTENTS) return &asset_contents_;
  if (id == ODO_SERVICE_WAKE) return &wakes;
  return nullptr;
}

void HostServices::wake(uint32_t instance) {
  {
    const std::lock_guard lock(mutex_);
    if (names_.count(instance) == 0) return;
    woken_.insert(instance);
    has_woken_ = true;
  }
  if (wake_listener_) wake_listener_();
}

std::set<uint32_t> HostServices::take_woken() {
  const std::lock_guard lock(mutex_);
  has_woken_ = false;
  return std::exchange(woken_, {});
}

void HostServices::name_instance(uint32_t instance, const std::string& id) {
  const std::lock_guard lock(mutex_);
  names_[instance] = id;
}

void HostServices::report(uint32_t instance, uint32_t severity, const std::string& key, const std::string& text,
                          int32_t status, Author author) {
  Report report{severity, "host", one_line(key, kLongestKey), "", instance, 1, status};
  {
    const std::lock_guard lock(mutex_);
    if (const auto name = names_.find(instance); name != names_.end()) report.origin = name->second;
    const auto now = std::chrono::steady_clock::now();
    auto& kinds = recent_[{report.origin, author}];
    if (kinds.size() >= kMaxKinds && kinds.count(report.key) == 0) report.key = "more";
    auto [entry, is_new] = kinds.try_emplace(report.key);
    if (!is_new && now - entry->second.last < std::chrono::seconds(1)) {
      ++entry->second.suppressed;
      return;
    }
    report.text = one_line(text, kLongestText);  // only for reports passed on: thousands may be suppressed at once
    report.count += entry->second.suppressed;
    if (entry->second.suppressed > 0)
      report.text += " (and " + std::to_string(entry->second.suppressed) + " more like it)";
    entry->second = {now, 0};
  }
  if (listener_) listener_(report);
}

}  // namespace odograph
