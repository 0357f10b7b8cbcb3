// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace odograph {

/// What watch_crashes calls while the process ends: nothing in it may allocate or lock.
struct CrashHandler {
  void (*name)(const char* how) noexcept;  ///< "segmentation fault", "exit() was called"; on the thread that ends it
  bool (*ends_at_exit)() noexcept;         ///< whether an exit() on this thread is to end the process at once
};

/// From here on the handler is called when a signal (SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT) that has no other
/// handler ends this process, and at exit(), which becomes _exit(`status`) where the handler says so. What the signal
/// does besides stays as it was. Nothing where the system has no signals. Once for a process. [any]
void watch_crashes(const CrashHandler& handler, int status);

/// A stack for the handler on this thread: one that overflowed cannot carry it. Until the thread's end. [any]
void give_signal_stack();

/// To standard error, at once, by no library. Async-signal-safe. [any]
void write_error(const char* text, size_t size) noexcept;

}  // namespace odograph
