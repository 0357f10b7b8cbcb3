// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/validator/child.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <limits>
#include <vector>

#include <poll.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

namespace odograph {
namespace {

constexpr size_t kPhaseSize = 128;
constexpr char kEnd[] =
    "\x04"
    "end";              // sent last: a premature exit cannot send it
char* phase = nullptr;  // shared with the child

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

std::string how_it_ended(int status) {
  if (WIFSIGNALED(status)) return std::string("killed by ") + strsignal(WTERMSIG(status));
  return "the plugin ended the process with status " + std::to_string(WEXITSTATUS(status));
}

[[noreturn]] void run_and_exit(int fd, const std::function<std::string()>& work) {
  std::string text;
  try {
    text = work();
  } catch (const std::exception& error) {
    text = std::string("the plugin threw an exception: ") + error.what();
  } catch (...) {
    text = "the plugin threw an exception other than std::exception";
  }
  text += kEnd;
  for (size_t done = 0; done < text.size();) {
    const ssize_t count = write(fd, text.data() + done, text.size() - done);
    if (count <= 0) break;
    done += static_cast<size_t>(count);
  }
  _exit(0);  // skip destructors, including the plugin's
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

Child begin(size_t number, const std::function<std::string(size_t)>& work) {
  Child child{number};
  int ends[2];
  if (pipe(ends) != 0) return child;
  if (!phase) {
    void* shared = mmap(nullptr, kPhaseSize, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared != MAP_FAILED) phase = static_cast<char*>(shared);
  }
  note_phase("");
  std::fflush(nullptr);
  child.pid = fork();
  if (child.pid == 0) {
    for (const int fatal : {SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGSEGV, SIGTERM}) signal(fatal, SIG_DFL);
    close(ends[0]);
    run_and_exit(ends[1], [&] { return work(number); });
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
  if (child.pipe >= 0) close(child.pipe);
  if (child.pid > 0 && (!in_time || child.ended()))
    kill(child.pid, SIGKILL);  // its threads may continue after its last message
  if (child.pid > 0) waitpid(child.pid, &status, 0);
  ChildResult result{child.ended(), child.text, seconds_since(child.started)};
  const std::string where = phase && *phase ? std::string(" in ") + phase : "";
  if (child.pid < 0)
    result.text = "no child process";
  else if (result.finished)
    result.text.resize(result.text.size() - (sizeof kEnd - 1));
  else
    result.text = (in_time ? how_it_ended(status) : "took longer than " + number(limit_s) + " s") + where;
  return result;
}

/// Waits until one of them ends or times out, and moves it to the end.
ChildResult finish_one(std::vector<Child>& running, double limit_s) {
  for (;;) {
    std::vector<pollfd> pipes;
    double left_s = limit_s;
    for (const Child& child : running) {
      pipes.push_back({child.pipe, POLLIN, 0});
      left_s = std::min(left_s, limit_s - seconds_since(child.started));
    }
    const bool all_there = std::all_of(running.begin(), running.end(), [](const Child& c) { return c.pid > 0; });
    const int wait_ms = !all_there || left_s <= 0 ? 0 : left_s < 1e6 ? static_cast<int>(left_s * 1e3) + 1 : -1;
    if (poll(pipes.data(), pipes.size(), wait_ms) < 0) continue;
    for (size_t i = 0; i < running.size(); ++i) {
      const bool in_time = running[i].pid < 0 || seconds_since(running[i].started) < limit_s;
      if (running[i].pid > 0 && in_time && (!pipes[i].revents || read_some(running[i]))) continue;
      std::swap(running[i], running.back());
      return finish(running.back(), limit_s, in_time);
    }
  }
}

void run_all(size_t count, size_t side_by_side, double limit_s, const std::function<std::string(size_t)>& work,
             const std::function<bool(size_t, const ChildResult&)>& done) {
  std::vector<Child> running;
  bool more = true;
  for (size_t next = 0; (more && next < count) || !running.empty();) {
    while (more && next < count && running.size() < side_by_side) running.push_back(begin(next++, work));
    const ChildResult result = finish_one(running, limit_s);
    more &= done(running.back().number, result);
    running.pop_back();
  }
}

}  // namespace

void note_phase(const std::string& what) {
  if (phase) std::snprintf(phase, kPhaseSize, "%s", what.c_str());
}

ChildResult run_in_child(double limit_s, const std::function<std::string()>& work) {
  ChildResult result;
  run_all(
      1, 1, limit_s, [&](size_t) { return work(); },
      [&](size_t, const ChildResult& one) {
        result = one;
        return true;
      });
  return result;
}

void run_in_children(size_t count, size_t side_by_side, const std::function<std::string(size_t)>& work,
                     const std::function<bool(size_t, const ChildResult&)>& done) {
  run_all(count, side_by_side, std::numeric_limits<double>::infinity(), work, done);
}

}  // namespace odograph
