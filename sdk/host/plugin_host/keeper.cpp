// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/plugin_host/keeper.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "sdk/host/plugin_host/shared_memory.hpp"
#include "sdk/host/plugin_host/thread_gate.hpp"

namespace odograph {
namespace {

constexpr int kLookAfterHost_ms = 200;  // where the system has no descriptors of processes
constexpr int kLastOutput_ms = 100;     // for what the plugin wrote last, where nobody reads

/// Passes on what the plugin writes, without ever waiting: the watch over the host goes on.
class Relay {
 public:
  explicit Relay(int to) : to_(to) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) _exit(2);
    from_ = high_descriptor(ends[0]);
    plugins_end_ = high_descriptor(ends[1]);
    fcntl(from_, F_SETFL, O_NONBLOCK);
  }
  void become_child() { dup2(plugins_end_, to_); }
  void become_keeper() { close(plugins_end_); }
  pollfd wanted() const { return left() > 0 ? pollfd{to_, POLLOUT, 0} : pollfd{from_, POLLIN, 0}; }
  /// One step, after wanted() was ready. Whether something was passed on.
  bool step() {
    if (left() == 0) {
      const ssize_t got = from_ < 0 ? 0 : read(from_, buffer_, sizeof buffer_);
      if (got < 0 && (errno == EAGAIN || errno == EINTR)) return false;
      if (got <= 0) return close_pipe(), false;
      at_ = 0;
      end_ = static_cast<size_t>(got);
    }
    pollfd ready{to_, POLLOUT, 0};  // then at least PIPE_BUF, which buffer_ is no larger than, do not block
    if (poll(&ready, 1, 0) != 1) return false;
    const ssize_t written = write(to_, buffer_ + at_, left());
    if (written < 0 && errno == EINTR) return true;
    if (written <= 0)
      at_ = end_;  // nobody is there to read it
    else
      at_ += static_cast<size_t>(written);
    return true;
  }

 private:
  size_t left() const { return end_ - at_; }
  void close_pipe() {
    if (from_ >= 0) close(from_);
    from_ = -1;
  }
  int to_, from_ = -1, plugins_end_ = -1;
  char buffer_[4096];
  size_t at_ = 0, end_ = 0;
};

int descriptor_of(pid_t process) { return static_cast<int>(syscall(434 /* pidfd_open */, process, 0)); }

void close_from(int first) {
  if (syscall(436 /* close_range */, first, ~0u, 0) == 0) return;
  rlimit most{};
  getrlimit(RLIMIT_NOFILE, &most);
  for (int fd = first; fd < static_cast<int>(std::min<rlim_t>(most.rlim_cur, 65536)); ++fd) close(fd);
}

/// The first process of a process namespace, which ends with it: does nothing until the keeper is gone.
void hold_namespace() {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) _exit(2);
  const pid_t first = fork();
  if (first < 0) _exit(2);
  if (first > 0) {
    close(ends[0]);
    high_descriptor(ends[1]);  // stays open as long as the keeper lives
    return;
  }
  prctl(PR_SET_NAME, "odograph-names");
  const int end = dup2(ends[0], 0);
  close_from(1);
  char byte;
  while (read(end, &byte, 1) < 0 && errno == EINTR) {
  }
  _exit(0);
}

/// Ends as the other process did.
[[noreturn]] void end_like(int status) {
  if (WIFSIGNALED(status)) {
    const rlimit none{0, 0};
    setrlimit(RLIMIT_CORE, &none);
    signal(WTERMSIG(status), SIG_DFL);
    raise(WTERMSIG(status));
  }
  _exit(WIFEXITED(status) ? WEXITSTATUS(status) : 2);
}

/// The keeper's life, from the child's start to its end.
class Watch {
 public:
  Watch(pid_t child, pid_t host, int gate, Relay* relays)
      : child_(child),
        host_(host),
        child_fd_(descriptor_of(child)),
        host_fd_(descriptor_of(host)),
        gate_(gate, child),
        relays_(relays) {}
  [[noreturn]] void run() {
    signal(SIGPIPE, SIG_IGN);
    for (;;) {
      pollfd wanted[] = {{host_fd_, POLLIN, 0},
                         {child_fd_, POLLIN, 0},
                         {gate_.descriptor(), POLLIN, 0},
                         relays_[0].wanted(),
                         relays_[1].wanted()};
      const bool asks = host_fd_ < 0 || child_fd_ < 0;
      poll(wanted, 5, asks ? kLookAfterHost_ms : -1);
      if (wanted[0].revents || getppid() != host_) _exit(0);  // the child ends with its parent
      int status = 0;
      if ((asks || wanted[1].revents) && waitpid(child_, &status, WNOHANG) == child_) finish(status);
      if (wanted[2].revents) gate_.answer();
      for (int i = 0; i < 2; ++i)
        if (wanted[3 + i].revents) relays_[i].step();
    }
  }

 private:
  [[noreturn]] void finish(int status) {
    for (int i = 0; i < 2; ++i) {
      pollfd wanted = relays_[i].wanted();
      while (wanted.fd >= 0 && poll(&wanted, 1, kLastOutput_ms) == 1 && relays_[i].step()) wanted = relays_[i].wanted();
    }
    end_like(status);
  }
  pid_t child_, host_;
  int child_fd_, host_fd_;
  ThreadGate gate_;
  Relay* relays_;
};

}  // namespace

Kept keep(int first_closed) {
  const pid_t host = getppid();
  close_from(first_closed);
  Relay relays[] = {Relay(1), Relay(2)};
  int gate[2];
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, gate) != 0) _exit(2);
  for (int& end : gate) end = high_descriptor(end);
  Kept kept{};
  if (unshare(CLONE_NEWUSER | CLONE_NEWPID | CLONE_NEWNET) == 0)
    hold_namespace();
  else
    kept.lacks = std::string("no namespaces of users and processes (") + std::strerror(errno) + ")";
  const pid_t child = fork();
  if (child < 0) _exit(2);
  if (child > 0) {
    for (Relay& relay : relays) relay.become_keeper();
    close(gate[1]);
    for (int fd = 3; fd < first_closed; ++fd) close(fd);  // the host's: it is to see that the child ends
    Watch(child, host, gate[0], relays).run();
  }
  for (Relay& relay : relays) relay.become_child();
  const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (nothing != 0) dup2(nothing, 0);
  kept.gate = dup2(gate[1], first_closed);
  close_from(kept.gate + 1);
  return kept;
}

}  // namespace odograph
