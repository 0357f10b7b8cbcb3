// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace odograph {

/// Records, for its scope, that this thread is within a call of a plugin, readable from a signal handler. No
/// allocation; no system call except the first time on a thread.
class PluginCallScope {
 public:
  /// `call` must be a string literal.
  PluginCallScope(const std::string& plugin, const char* call) noexcept;
  ~PluginCallScope();
  PluginCallScope(const PluginCallScope&) = delete;
  PluginCallScope& operator=(const PluginCallScope&) = delete;

 private:
  int slot_;
  int outer_;
};

/// The plugin call on this thread, as "attitude/vqf in process"; if there is none, that of another thread.
/// Async-signal-safe. Returns the bytes written, without a terminator; 0 if no plugin is being called.
size_t current_plugin_call(char* text, size_t capacity) noexcept;

/// For a plugin that ends its caller's thread (pthread_exit): names the plugin on standard error and aborts. Otherwise
/// the C++ runtime would print "terminate called without an active exception".
[[noreturn]] void abort_for_ended_thread() noexcept;

/// A plugin call that has not returned, as "attitude/vqf in process".
struct LongCall {
  std::string what;
  int64_t since_ns, lasts_ns;  ///< on the steady clock
};

/// Visits the calls of all threads of this process that have lasted longer. [any]
void for_each_long_call(int64_t longer_than_ns, const std::function<void(const LongCall&)>& visit);

/// From now on, the plugin is named on standard error when a signal (SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT) ends
/// this process within a plugin call, and exit() from within a plugin becomes _exit(4). Signals with another handler
/// are left alone; a signal's other effects are unchanged. Once per process. [any]
void install_crash_handler();

}  // namespace odograph
