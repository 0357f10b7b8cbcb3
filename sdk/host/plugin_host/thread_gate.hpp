// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

namespace odograph {

/// Maximum threads of a plugin's process: enough for two libraries with a thread for each of 100 cores.
constexpr unsigned kMaxThreads = 256;

/// From now on, a new thread of this process waits until the owner of the other end of the socket `gate` approves it
/// (ThreadGate). False, with errno, without kernel support (Linux 5.5). Closes `gate`.
bool require_thread_approval(int gate);

/// The approving end, in another process.
class ThreadGate {
 public:
  ThreadGate(int gate, pid_t process) : fd_(gate), process_(process) {}
  /// The descriptor to poll, or negative.
  int descriptor() const { return fd_; }
  /// Call when it is ready: the first call receives the notification descriptor, later calls answer one request each.
  void answer();

 private:
  int fd_;
  bool listening_ = false;
  pid_t process_;
  unsigned approved_ = 0;  // approved in all
};

}  // namespace odograph
