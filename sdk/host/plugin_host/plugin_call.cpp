// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/plugin_host/plugin_call.hpp"

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

struct CallSlot {
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

size_t describe(const CallSlot& call_slot, char* text, size_t capacity) noexcept {
  const char* call = call_slot.call.load(std::memory_order_acquire);
  if (!call) return 0;
  size_t size = 0;
  for (size_t k = 0; k < kLongestId && size < capacity; ++k) {
    const uint64_t letters = call_slot.plugin[k / 8].load(std::memory_order_relaxed);
    const auto each = static_cast<char>(letters >> (8 * (k % 8)));
    if (each == 0) break;
    text[size++] = each;
  }
  return append(text, append(text, size, capacity, " in "), capacity, call);
}

CallSlot call_slots[kSlots];
thread_local int current = -1;

std::atomic<bool> handler_installed{false};

/// `how` the process ends, such as "aborted".
void print_plugin_call(const char* how) noexcept {
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

PluginCallScope::PluginCallScope(const std::string& plugin, const char* call) noexcept : slot_(-1), outer_(current) {
  if (handler_installed.load(std::memory_order_relaxed)) ensure_signal_stack();
  for (int i = 0; i < kSlots; ++i) {
    bool free = false;
    if (!call_slots[i].taken.compare_exchange_strong(free, true, std::memory_order_acquire)) continue;
    slot_ = i;
    const size_t size = std::min(plugin.size(), kLongestId - 1);
    for (size_t k = 0; k <= size; k += 8) {
      uint64_t letters = 0;
      for (size_t letter = 0; letter < 8 && k + letter < size; ++letter)
        letters |= static_cast<uint64_t>(static_cast<unsigned char>(plugin[k + letter])) << (8 * letter);
      call_slots[i].plugin[k / 8].store(letters, std::memory_order_relaxed);
    }
    call_slots[i].since_ns.store(coarse_now_ns(), std::memory_order_relaxed);
    call_slots[i].call.store(call, std::memory_order_release);
    break;
  }
  current = slot_;
}

PluginCallScope::~PluginCallScope() {
  current = outer_;
  if (slot_ < 0) return;
  call_slots[slot_].call.store(nullptr, std::memory_order_relaxed);
  call_slots[slot_].taken.store(false, std::memory_order_release);
}

size_t current_plugin_call(char* text, size_t capacity) noexcept {
  int slot = current;
  for (int i = 0; slot < 0 && i < kSlots; ++i)
    if (call_slots[i].call.load(std::memory_order_acquire)) slot = i;
  return slot < 0 ? 0 : describe(call_slots[slot], text, capacity);
}

void abort_for_ended_thread() noexcept {
  print_plugin_call("pthread_exit() on the host's thread was called");
  std::abort();
}

void for_each_long_call(int64_t longer_than_ns, const std::function<void(const LongCall&)>& visit) {
  const int64_t now = coarse_now_ns();
  for (const CallSlot& call_slot : call_slots) {
    if (!call_slot.call.load(std::memory_order_acquire)) continue;
    const int64_t since_ns = call_slot.since_ns.load(std::memory_order_relaxed);
    if (now - since_ns <= longer_than_ns) continue;
    char text[kLongestId + 32];
    const std::string what(text, describe(call_slot, text, sizeof text));
    if (!what.empty()) visit({what, since_ns, now - since_ns});
  }
}

void install_crash_handler() {
  static std::once_flag once;
  std::call_once(once, [] {
    handler_installed = true;
    set_crash_handler({print_plugin_call, []() noexcept { return current >= 0; }}, kExitOfPlugin);
  });
}

}  // namespace odograph
