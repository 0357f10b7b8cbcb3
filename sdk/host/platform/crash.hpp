// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace odograph {

/// Callbacks for set_crash_handler() while the process ends: they must neither allocate nor lock.
struct CrashHandler {
  void (*name)(
      const char* how) noexcept;  ///< "segmentation fault", "exit() was called"; called on the terminating thread
  bool (*exits_immediately)() noexcept;  ///< whether exit() on this thread must end the process immediately
};

/// Installs the handler. It is called when a signal (SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT) without another handler
/// ends this process, and at exit(), which becomes _exit(`status`) if the handler requests it. The signal's other
/// effects are unchanged. No effect on systems without signals. Once per process. [any]
void set_crash_handler(const CrashHandler& handler, int status);

/// Provides an alternate signal stack for this thread until it ends, because an overflowed stack cannot run the
/// handler. [any]
void ensure_signal_stack();

/// Writes to standard error without buffering. Async-signal-safe. [any]
void write_error(const char* text, size_t size) noexcept;

}  // namespace odograph
