// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/plugin_host/breadcrumb.hpp"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <mutex>

#include "sdk/host/platform/coarse_clock.hpp"
#include "sdk/host/platform/crash.hpp"

namespace odograph {
namespace {

constexpr int kSlots = 128;  // threads within plugins at once; further ones are not named
constexpr int kExitOfPlugin = 4;
constexpr size_t kLongestId = 96;

struct Crumb {
  std::atomic<bool> taken{false};
  std::atomic<const char*> call{nullptr};
  std::atomic<int64_t> since_ns{0};
  std::atomic<uint64_t> plugin[kLongestId / 8] =
      {};  // eight characters in each, terminated; read while another thread writes
};

/// Appends what fits and returns the new size.
size_t append(char* text, size_t size, size_t capacity, const char* part) {
  while (*part && size < capacity) text[size++] = *part++;
  return size;
}

size_t describe(const Crumb& crumb, char* text, size_t capacity) noexcept {
  const char* call = crumb.call.load(std::memory_order_acquire);
  if (!call) return 0;
  size_t size = 0;
  for (size_t k = 0; k < kLongestId && size < capacity; ++k) {
    const uint64_t letters = crumb.plugin[k / 8].load(std::memory_order_relaxed);
    const auto each = static_cast<char>(letters >> (8 * (k % 8)));
    if (each == 0) break;
    text[size++] = each;
  }
  return append(text, append(text, size, capacity, " in "), capacity, call);
}

Crumb crumbs[kSlots];
thread_local int current = -1;

std::atomic<bool> watching{false};

/// `how` the process ends, such as "aborted".
void name_plugin(const char* how) noexcept {
  char call[kLongestId + 32];
  const size_t size = current_plugin_call(call, sizeof call);
  if (size == 0) return;
  constexpr char kHead[] = "odograph: ";
  constexpr char kWhere[] = " in plugin ";
  write_error(kHead, sizeof kHead - 1);
  write_error(how, std::strlen(how));
  write_error(kWhere, sizeof kWhere - 1);
  write_error(call, size);
  write_error("\n", 1);
}

}  // namespace

Breadcrumb::Breadcrumb(const std::string& plugin, const char* call) noexcept : slot_(-1), outer_(current) {
  if (watching.load(std::memory_order_relaxed)) give_signal_stack();
  for (int i = 0; i < kSlots; ++i) {
    bool free = false;
    if (!crumbs[i].taken.compare_exchange_strong(free, true, std::memory_order_acquire)) continue;
    slot_ = i;
    const size_t size = std::min(plugin.size(), kLongestId - 1);
    for (size_t k = 0; k <= size; k += 8) {
      uint64_t letters = 0;
      for (size_t letter = 0; letter < 8 && k + letter < size; ++letter)
        letters |= static_cast<uint64_t>(static_cast<unsigned char>(plugin[k + letter])) << (8 * letter);
      crumbs[i].plugin[k / 8].store(letters, std::memory_order_relaxed);
    }
    crumbs[i].since_ns.store(coarse_now_ns(), std::memory_order_relaxed);
    crumbs[i].call.store(call, std::memory_order_release);
    break;
  }
  current = slot_;
}

Breadcrumb::~Breadcrumb() {
  current = outer_;
  if (slot_ < 0) return;
  crumbs[slot_].call.store(nullptr, std::memory_order_relaxed);
  crumbs[slot_].taken.store(false, std::memory_order_release);
}

size_t current_plugin_call(char* text, size_t capacity) noexcept {
  int slot = current;
  for (int i = 0; slot < 0 && i < kSlots; ++i)
    if (crumbs[i].call.load(std::memory_order_acquire)) slot = i;
  return slot < 0 ? 0 : describe(crumbs[slot], text, capacity);
}

void abort_for_ended_thread() noexcept {
  name_plugin("pthread_exit() on the host's thread was called");
  std::abort();
}

void for_each_long_call(int64_t longer_than_ns, const std::function<void(const LongCall&)>& tell) {
  const int64_t now = coarse_now_ns();
  for (const Crumb& crumb : crumbs) {
    if (!crumb.call.load(std::memory_order_acquire)) continue;
    const int64_t since_ns = crumb.since_ns.load(std::memory_order_relaxed);
    if (now - since_ns <= longer_than_ns) continue;
    char text[kLongestId + 32];
    const std::string what(text, describe(crumb, text, sizeof text));
    if (!what.empty()) tell({what, since_ns, now - since_ns});
  }
}

void name_crashing_plugins() {
  static std::once_flag once;
  std::call_once(once, [] {
    watching = true;
    watch_crashes({name_plugin, []() noexcept { return current >= 0; }}, kExitOfPlugin);
  });
}

}  // namespace odograph
