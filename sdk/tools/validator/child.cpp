// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/validator/child.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include <poll.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>
#if defined(__linux__)
#include <sys/prctl.h>
#endif

namespace odograph {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kCallShare = 0.5;  // of the child's time: a single call with more of it hangs
constexpr char kEnd[] =
    "\x04"
    "end";  // sent last: a premature exit cannot send it

struct Phase {
  std::atomic<Clock::rep> began;
  char call[16], where[112];
};
Phase* phase = nullptr;  // shared with the child
int result_pipe = -1;    // of the child
std::vector<std::pair<std::string, std::string>> avoided;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

std::string how_it_ended(int status) {
  if (WIFSIGNALED(status)) return std::string("killed by ") + strsignal(WTERMSIG(status));
  return "the plugin ended the process with status " + std::to_string(WEXITSTATUS(status));
}

[[noreturn]] void exit_with(std::string text) {
  text += kEnd;
  for (size_t done = 0; done < text.size();) {
    const ssize_t count = write(result_pipe, text.data() + done, text.size() - done);
    if (count <= 0) break;
    done += static_cast<size_t>(count);
  }
  _exit(0);  // skip destructors, including the plugin's
}

[[noreturn]] void run_and_exit(const std::function<std::string()>& work) {
  std::string text;
  try {
    text = work();
  } catch (const std::exception& error) {
    text = std::string("the plugin threw an exception: ") + error.what();
  } catch (...) {
    text = "the plugin threw an exception other than std::exception";
  }
  exit_with(std::move(text));
}

/// How long the current call has taken, s; 0 without one.
double call_s() {
  return phase && phase->call[0] ? seconds_since(Clock::time_point(Clock::duration(phase->began.load()))) : 0;
}

/// A child process and the reading end of its pipe.
struct Child {
  size_t number;
  pid_t pid = -1;
  int pipe = -1;
  Clock::time_point started = Clock::now();
  std::string text{};

  bool ended() const { return text.ends_with(kEnd); }
};

/// In a child: it is killed when its parent ends, so that nothing is left of a child that is killed with its own
/// children.
void end_with([[maybe_unused]] pid_t parent) {
#if defined(__linux__)
  if (prctl(PR_SET_PDEATHSIG, SIGKILL, 0, 0, 0) == 0 && getppid() != parent) _exit(1);  // it ended before the call
#endif
}

Child begin(size_t number, const std::function<std::string(size_t)>& work) {
  Child child{number};
  int ends[2];
  if (pipe(ends) != 0) return child;
  if (!phase) {
    void* shared = mmap(nullptr, sizeof(Phase), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared != MAP_FAILED) phase = static_cast<Phase*>(shared);
  }
  note_phase("");
  std::fflush(nullptr);
  const pid_t parent = getpid();
  child.pid = fork();
  if (child.pid == 0) {
    end_with(parent);
    for (const int fatal : {SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGSEGV, SIGTERM}) signal(fatal, SIG_DFL);
    close(ends[0]);
    result_pipe = ends[1];
    run_and_exit([&] { return work(number); });
  }
  close(ends[1]);
  child.pipe = ends[0];
  return child;
}

/// Reads available data; false at its end.
bool read_some(Child& child) {
  char part[4096];
  const ssize_t count = read(child.pipe, part, sizeof part);
  if (count > 0) child.text.append(part, static_cast<size_t>(count));
  return count > 0 && !child.ended();  // another process may hold the pipe open
}

ChildResult finish(Child& child, double limit_s, bool in_time) {
  int status = 0;
  const double in_call_s = call_s();
  if (child.pipe >= 0) close(child.pipe);
  if (child.pid > 0 && (!in_time || child.ended()))
    kill(child.pid, SIGKILL);  // its threads may continue after its last message
  if (child.pid > 0) waitpid(child.pid, &status, 0);
  ChildResult result{child.ended(), child.text, seconds_since(child.started), ""};
  if (child.pid < 0) {
    result.text = "no child process";
  } else if (result.finished) {
    result.text.resize(result.text.size() - (sizeof kEnd - 1));
  } else {
    std::string where;
    for (const char* part : {phase ? phase->call : "", phase ? phase->where : ""})
      if (*part) where += (where.empty() ? " in " : " ") + std::string(part);
    result.text = (in_time ? how_it_ended(status) : "took longer than " + number(limit_s) + " s") + where;
    if (!in_time && in_call_s >= kCallShare * limit_s) result.hung_call = phase->call;
  }
  return result;
}

struct Limits {
  double whole_s = kInfinity, call_s = kInfinity;
};

/// Waits until one of them ends or times out, and moves it to the end.
ChildResult finish_one(std::vector<Child>& running, const Limits& limits) {
  for (;;) {
    std::vector<pollfd> pipes;
    double left_s = limits.call_s - call_s();
    for (const Child& child : running) {
      pipes.push_back({child.pipe, POLLIN, 0});
      left_s = std::min(left_s, limits.whole_s - seconds_since(child.started));
    }
    const bool all_there = std::all_of(running.begin(), running.end(), [](const Child& c) { return c.pid > 0; });
    const int wait_ms = !all_there || left_s <= 0 ? 0 : left_s < 1e6 ? static_cast<int>(left_s * 1e3) + 1 : -1;
    if (poll(pipes.data(), pipes.size(), wait_ms) < 0) continue;
    for (size_t i = 0; i < running.size(); ++i) {
      const bool hangs = call_s() >= limits.call_s;
      const bool in_time = running[i].pid < 0 || (!hangs && seconds_since(running[i].started) < limits.whole_s);
      if (running[i].pid > 0 && in_time && (!pipes[i].revents || read_some(running[i]))) continue;
      std::swap(running[i], running.back());
      return finish(running.back(), hangs ? limits.call_s : limits.whole_s, in_time);
    }
  }
}

void run_all(size_t count, size_t side_by_side, const Limits& limits, const std::function<std::string(size_t)>& work,
             const std::function<bool(size_t, const ChildResult&)>& done) {
  std::vector<Child> running;
  bool more = true;
  for (size_t next = 0; (more && next < count) || !running.empty();) {
    while (more && next < count && running.size() < side_by_side) running.push_back(begin(next++, work));
    const ChildResult result = finish_one(running, limits);
    more &= done(running.back().number, result);
    running.pop_back();
  }
}

}  // namespace

void note_phase(const std::string& call, const std::string& where) {
  for (const auto& [name, text] : avoided)
    if (name == call) exit_with(text);
  if (!phase) return;
  phase->began = Clock::now().time_since_epoch().count();
  std::snprintf(phase->call, sizeof phase->call, "%s", call.c_str());
  std::snprintf(phase->where, sizeof phase->where, "%s", where.c_str());
}

void avoid_call(const std::string& call, const std::string& text) { avoided.emplace_back(call, text); }

ChildResult run_in_child(double limit_s, const std::function<std::string()>& work, double call_limit_s) {
  ChildResult result;
  run_all(
      1, 1, {limit_s, call_limit_s}, [&](size_t) { return work(); },
      [&](size_t, const ChildResult& one) {
        result = one;
        return true;
      });
  return result;
}

void run_in_children(size_t count, size_t side_by_side, const std::function<std::string(size_t)>& work,
                     const std::function<bool(size_t, const ChildResult&)>& done) {
  run_all(count, side_by_side, {}, work, done);
}

}  // namespace odograph
