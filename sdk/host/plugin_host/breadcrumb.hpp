// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace odograph {

/// Notes, for the time of a scope, that this thread is within a call of a plugin, where a signal handler can read it.
/// No allocation, no system call but the first time on a thread.
class Breadcrumb {
 public:
  /// `call` is a literal.
  Breadcrumb(const std::string& plugin, const char* call) noexcept;
  ~Breadcrumb();
  Breadcrumb(const Breadcrumb&) = delete;
  Breadcrumb& operator=(const Breadcrumb&) = delete;

 private:
  int slot_;
  int outer_;
};

/// Which plugin's call this thread is in, as "attitude/vqf in process"; of another thread where this one is in none.
/// Async-signal-safe. Returns the bytes written, without a terminator; 0 where no plugin is being called.
size_t current_plugin_call(char* text, size_t capacity) noexcept;

/// For a plugin that ends the thread of its caller (pthread_exit), which is not its own: names it on standard error and
/// aborts. Without it the C++ runtime would say "terminate called without an active exception".
[[noreturn]] void abort_for_ended_thread() noexcept;

/// A plugin's call that has not come back, as "attitude/vqf in process".
struct LongCall {
  std::string what;
  int64_t since_ns, lasts_ns;  ///< by this machine's steady clock
};

/// Calls of all threads of this process that last for longer. [any]
void for_each_long_call(int64_t longer_than_ns, const std::function<void(const LongCall&)>& tell);

/// From here on the plugin is named on standard error when a signal (SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT) ends
/// this process within a plugin's call, and an exit() from within one becomes _exit(4). Only signals that have no other
/// handler; what the signal does besides stays as it was. Once for a process. [any]
void name_crashing_plugins();

}  // namespace odograph
