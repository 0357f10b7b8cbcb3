// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/plugin_host/supervisor.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <string>

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include "sdk/host/plugin_host/shared_memory.hpp"
#include "sdk/host/plugin_host/thread_gate.hpp"

namespace odograph {
namespace {

constexpr int kLookAfterHost_ms = 200;  // polling interval on systems without process descriptors
constexpr int kLastOutput_ms = 100;     // for the plugin's last output, if nobody reads it
constexpr int kLongestWrite_ms = 20;

/// Limits the time of a write to a pipe or terminal of another process, by repeated signals. Its flags must not be
/// changed, and poll() reports a terminal as ready that accepts only a part.
class WriteLimit {
 public:
  WriteLimit() { set(kLongestWrite_ms); }
  ~WriteLimit() { set(0); }
  WriteLimit(const WriteLimit&) = delete;
  /// Call once, before use.
  static void prepare() {
    struct sigaction action {};
    action.sa_handler = [](int) {};  // without SA_RESTART
    sigaction(SIGALRM, &action, nullptr);
  }

 private:
  static void set(int period_ms) {
    const itimerval timer{{0, period_ms * 1000}, {0, period_ms * 1000}};
    setitimer(ITIMER_REAL, &timer, nullptr);
  }
};

/// Forwards the plugin's output without waiting for long, so that the host remains supervised.
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
  void become_supervisor() { close(plugins_end_); }
  pollfd wanted() const { return left() > 0 ? pollfd{to_, POLLOUT, 0} : pollfd{from_, POLLIN, 0}; }
  /// One step, after wanted() was ready. Returns whether anything was forwarded.
  bool step() {
    if (left() == 0) {
      const ssize_t got = from_ < 0 ? 0 : read(from_, buffer_, sizeof buffer_);
      if (got < 0 && (errno == EAGAIN || errno == EINTR)) return false;
      if (got <= 0) return close_pipe(), false;
      at_ = 0;
      end_ = static_cast<size_t>(got);
    }
    pollfd ready{to_, POLLOUT, 0};
    if (poll(&ready, 1, 0) != 1) return false;
    const ssize_t written = limited_write();
    if (written < 0 && errno == EINTR) return false;
    if (written <= 0)
      at_ = end_;  // there is no reader
    else
      at_ += static_cast<size_t>(written);
    return true;
  }

 private:
  size_t left() const { return end_ - at_; }
  ssize_t limited_write() const {
    const WriteLimit limit;
    return write(to_, buffer_ + at_, left());
  }
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

/// Starts the first process of a process namespace, which ends with it; it idles until the supervisor is gone. Returns
/// its id.
pid_t start_namespace_init() {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) _exit(2);
  const pid_t first = fork();
  if (first < 0) _exit(2);
  if (first > 0) {
    close(ends[0]);
    high_descriptor(ends[1]);  // stays open as long as the supervisor lives
    return first;
  }
  prctl(PR_SET_DUMPABLE, 0, 0, 0, 0);
  prctl(PR_SET_NAME, "odograph-names");
  const int end = dup2(ends[0], 0);
  close_from(1);
  char byte;
  while (read(end, &byte, 1) < 0 && errno == EINTR) {
  }
  _exit(0);
}

/// Kills and reaps the process, so that no zombie is left to its adopter.
void kill_and_reap(pid_t process) {
  if (process <= 0) return;
  kill(process, SIGKILL);
  while (waitpid(process, nullptr, 0) < 0 && errno == EINTR) {
  }
}

/// Ends in the same way as the other process.
[[noreturn]] void exit_like(int status) {
  if (WIFSIGNALED(status)) {
    const rlimit none{0, 0};
    setrlimit(RLIMIT_CORE, &none);
    signal(WTERMSIG(status), SIG_DFL);
    sigset_t own;  // SIGTERM is blocked here
    sigemptyset(&own);
    sigaddset(&own, WTERMSIG(status));
    sigprocmask(SIG_UNBLOCK, &own, nullptr);
    raise(WTERMSIG(status));
  }
  _exit(WIFEXITED(status) ? WEXITSTATUS(status) : 2);
}

/// The supervisor's supervision, from the child's start to its end.
class Supervisor {
 public:
  /// `stop`: SIGTERM as a descriptor (block_stop). `first`: first process of the namespace; 0 without one.
  Supervisor(pid_t child, pid_t host, pid_t first, int stop, int gate, Relay* relays)
      : child_(child),
        host_(host),
        first_(first),
        stop_(stop),
        child_fd_(descriptor_of(child)),
        host_fd_(descriptor_of(host)),
        gate_(gate, child),
        relays_(relays) {}
  [[noreturn]] void run() {
    prctl(PR_SET_DUMPABLE, 0, 0, 0, 0);  // no process of the same user may trace it
    signal(SIGPIPE, SIG_IGN);
    WriteLimit::prepare();
    for (;;) {
      pollfd wanted[] = {{host_fd_, POLLIN, 0},           {child_fd_, POLLIN, 0}, {stop_, POLLIN, 0},
                         {gate_.descriptor(), POLLIN, 0}, relays_[0].wanted(),    relays_[1].wanted()};
      const bool asks = host_fd_ < 0 || child_fd_ < 0;
      poll(wanted, std::size(wanted), asks ? kLookAfterHost_ms : -1);
      if (wanted[0].revents || wanted[2].revents || getppid() != host_) give_up();
      int status = 0;
      if ((asks || wanted[1].revents) && waitpid(child_, &status, WNOHANG) == child_) finish(status);
      if (wanted[3].revents) gate_.answer();
      for (int i = 0; i < 2; ++i)
        if (wanted[4 + i].revents) relays_[i].step();
    }
  }

 private:
  /// The host is gone, or no longer needs the plugin.
  [[noreturn]] void give_up() {
    kill_and_reap(child_);
    kill_and_reap(first_);
    _exit(0);
  }
  /// False if nothing is left, nobody reads it, or the host no longer waits.
  bool forward_remaining(Relay& relay) const {
    pollfd wanted[] = {relay.wanted(), {stop_, POLLIN, 0}};
    if (wanted[0].fd < 0 || poll(wanted, 2, kLastOutput_ms) < 1) return false;
    return wanted[1].revents == 0 && relay.step();
  }
  [[noreturn]] void finish(int status) {
    for (int i = 0; i < 2; ++i)
      while (forward_remaining(relays_[i])) continue;
    kill_and_reap(first_);
    exit_like(status);
  }
  pid_t child_, host_, first_;
  int stop_;
  int child_fd_, host_fd_;
  ThreadGate gate_;
  Relay* relays_;
};

/// SIGTERM as a descriptor; applies to this process, not the child.
int block_stop(sigset_t& stop) {
  sigemptyset(&stop);
  sigaddset(&stop, SIGTERM);
  sigprocmask(SIG_BLOCK, &stop, nullptr);
  return high_descriptor(signalfd(-1, &stop, SFD_CLOEXEC));
}

/// If memory runs short, the kernel should end this process before its host, as if it used this share of the machine's
/// memory more.
void raise_oom_score() {
  constexpr int kThousandths = 200, kHighest = 1000;
  const int fd = open("/proc/self/oom_score_adj", O_RDWR | O_CLOEXEC);
  char text[16] = {};
  if (fd >= 0 && read(fd, text, sizeof text - 1) > 0) {
    const std::string more = std::to_string(std::min(kHighest, std::atoi(text) + kThousandths));
    (void)!pwrite(fd, more.data(), more.size(), 0);
  }
  if (fd >= 0) close(fd);
}

}  // namespace

ChildContext fork_supervised(int first_closed) {
  const pid_t host = getppid();
  close_from(first_closed);
  Relay relays[] = {Relay(1), Relay(2)};
  int gate[2];
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, gate) != 0) _exit(2);
  for (int& end : gate) end = high_descriptor(end);
  sigset_t stop;
  const int stop_fd = block_stop(stop);
  ChildContext context{};
  pid_t first = 0;
  if (unshare(CLONE_NEWUSER | CLONE_NEWPID | CLONE_NEWNET) == 0)
    first = start_namespace_init();
  else
    context.missing = std::string("no namespaces of users and processes (") + std::strerror(errno) + ")";
  const pid_t child = fork();
  if (child < 0) _exit(2);
  if (child > 0) {
    for (Relay& relay : relays) relay.become_supervisor();
    close(gate[1]);
    for (int fd = 3; fd < first_closed; ++fd) close(fd);  // the host's descriptors: it must notice the child's end
    Supervisor(child, host, first, stop_fd, gate[0], relays).run();
  }
  prctl(PR_SET_PDEATHSIG, SIGKILL, 0, 0, 0);
  sigprocmask(SIG_UNBLOCK, &stop, nullptr);
  raise_oom_score();
  for (Relay& relay : relays) relay.become_child();
  const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (nothing != 0) dup2(nothing, 0);
  context.gate = dup2(gate[1], first_closed);
  close_from(context.gate + 1);
  return context;
}

}  // namespace odograph
