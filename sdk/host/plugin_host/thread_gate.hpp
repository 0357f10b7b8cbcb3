// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

namespace odograph {

/// How many threads a plugin's process may have: two libraries with a thread for each of 100 cores fit.
constexpr unsigned kMaxThreads = 256;

/// From now on a new thread of this process waits until the one who has the other end of the socket `gate` lets it
/// (ThreadGate). False, with errno, where the system has no such thing (Linux 5.5). `gate` is closed.
bool ask_for_threads(int gate);

/// The other end, in another process.
class ThreadGate {
 public:
  ThreadGate(int gate, pid_t counted) : fd_(gate), counted_(counted) {}
  /// What to poll for, or below 0.
  int descriptor() const { return fd_; }
  /// After it was ready: the first time takes over the descriptor that is asked on, then answers one question.
  void answer();

 private:
  int fd_;
  bool listening_ = false;
  pid_t counted_;
  unsigned let_ = 0;  // in all
};

}  // namespace odograph
