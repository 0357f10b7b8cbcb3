// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/validator/child.hpp"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>

#include <poll.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

namespace odograph {
namespace {

constexpr size_t kPhaseSize = 128;
constexpr char kEnd[] =
    "\x04"
    "end";              // sent last: an exit within the work cannot send it
char* phase = nullptr;  // shared with the child

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

/// Reads until the end of the pipe or of the time; false when the time was up.
bool read_all(int fd, double limit_s, std::string& text) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit_s);
  for (;;) {
    const double left_s = std::chrono::duration<double>(end - std::chrono::steady_clock::now()).count();
    pollfd wait{fd, POLLIN, 0};
    const int ready = left_s > 0 ? poll(&wait, 1, static_cast<int>(left_s * 1e3) + 1) : 0;
    if (ready == 0) return false;
    if (ready < 0 && errno == EINTR) continue;
    char part[4096];
    const ssize_t count = read(fd, part, sizeof part);
    if (count <= 0) return true;
    text.append(part, static_cast<size_t>(count));
    if (text.size() >= sizeof kEnd - 1 && text.ends_with(kEnd)) return true;  // somebody else may hold the pipe open
  }
}

std::string how_it_ended(int status) {
  if (WIFSIGNALED(status)) return std::string("killed by ") + strsignal(WTERMSIG(status));
  return "the plugin ended the process with status " + std::to_string(WEXITSTATUS(status));
}

[[noreturn]] void work_and_leave(int fd, const std::function<std::string()>& work) {
  std::string text;
  try {
    text = work();
  } catch (const std::exception& error) {
    text = std::string("an exception came out of the plugin: ") + error.what();
  } catch (...) {
    text = "an exception came out of the plugin that is not a std::exception";
  }
  text += kEnd;
  for (size_t done = 0; done < text.size();) {
    const ssize_t count = write(fd, text.data() + done, text.size() - done);
    if (count <= 0) break;
    done += static_cast<size_t>(count);
  }
  _exit(0);  // no destructors: the plugin's have had their turn or never will
}

}  // namespace

void note_phase(const std::string& what) {
  if (phase) std::snprintf(phase, kPhaseSize, "%s", what.c_str());
}

ChildResult run_in_child(double limit_s, const std::function<std::string()>& work) {
  ChildResult result;
  const auto started = std::chrono::steady_clock::now();
  int ends[2];
  if (pipe(ends) != 0) return {false, "no pipe for a child process", 0};
  if (!phase) {
    void* shared = mmap(nullptr, kPhaseSize, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared != MAP_FAILED) phase = static_cast<char*>(shared);
  }
  note_phase("");
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    for (const int fatal : {SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGSEGV, SIGTERM}) signal(fatal, SIG_DFL);
    close(ends[0]);
    work_and_leave(ends[1], work);
  }
  close(ends[1]);
  const bool in_time = child < 0 || read_all(ends[0], limit_s, result.text);
  close(ends[0]);
  int status = 0;
  const bool ended = result.text.ends_with(kEnd);
  if (child > 0 && (!in_time || ended)) kill(child, SIGKILL);  // after its word threads of the plugin may go on
  if (child > 0) waitpid(child, &status, 0);
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  const std::string where = phase && *phase ? std::string(" in ") + phase : "";
  if (child < 0) {
    result.text = "no child process";
  } else if (ended) {
    result.finished = true;
    result.text.resize(result.text.size() - (sizeof kEnd - 1));
  } else if (!in_time) {
    result.text = "took longer than " + number(limit_s) + " s" + where;
  } else {
    result.text = how_it_ended(status) + where;
  }
  return result;
}

}  // namespace odograph
