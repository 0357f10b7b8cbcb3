// SPDX-License-Identifier: Apache-2.0
//
// Common parts of the tests of the sandbox and its supervisor: a victim, a host in a separate process, its descendants.
#pragma once

#include <csignal>
#include <initializer_list>

#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <sys/xattr.h>
#include <unistd.h>

#include "tests/support/support.hpp"

namespace odograph {

inline std::string read_all(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// A folder for the attacker to damage, with this process named as the host.
struct AttackTarget {
  TemporaryFolder folder;
  explicit AttackTarget(const char* attack) {
    write_text(folder / "file", "what the user has written");
    setxattr((folder / "file").c_str(), "user.keep", "x", 1, 0);
    setenv("ODOGRAPH_TEST_VICTIM", folder.path().c_str(), 1);
    setenv("ODOGRAPH_TEST_HOST", std::to_string(getpid()).c_str(), 1);
    setenv("ODOGRAPH_TEST_ATTACK", attack, 1);
  }
  ~AttackTarget() {
    for (const char* name : {"VICTIM", "HOST", "ATTACK", "CALLS"})
      unsetenv((std::string("ODOGRAPH_TEST_") + name).c_str());
  }
};

inline std::string joined(const std::vector<std::string>& lines) {
  std::string all;
  for (const auto& line : lines) all += line + "\n";
  return all;
}

/// Runs the work in a separate process and returns its lines.
template <class Work>
std::string in_a_process(Work&& work) {
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    const std::string lines = work();
    (void)!write(ends[1], lines.data(), lines.size());
    _exit(0);
  }
  close(ends[1]);
  std::string lines;
  char buffer[4096];
  for (ssize_t got; (got = read(ends[0], buffer, sizeof buffer)) > 0;) lines.append(buffer, static_cast<size_t>(got));
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  return lines + (WIFSIGNALED(status) ? "the host was ended by signal " + std::to_string(WTERMSIG(status)) : "");
}

/// Processes below this one, from /proc.
inline std::vector<pid_t> descendants(pid_t of) {
  std::vector<pid_t> found;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const pid_t process = std::atoi(entry.path().filename().c_str());
    std::ifstream file(entry.path() / "stat");
    std::string line;
    if (process <= 0 || !std::getline(file, line)) continue;
    char state = 0;
    int parent = 0;
    if (std::sscanf(line.c_str() + line.rfind(')') + 1, " %c %d", &state, &parent) == 2 && parent == of) {
      found.push_back(process);
      for (const pid_t below : descendants(process)) found.push_back(below);
    }
  }
  return found;
}
/// False for a zombie, which has no memory left.
inline bool is_alive(pid_t process) {
  const std::string pages = read_all("/proc/" + std::to_string(process) + "/statm");
  return !pages.empty() && pages.rfind("0 ", 0) != 0;
}

/// Makes these calls fail in this process and its descendants.
inline void refuse_calls(std::initializer_list<long> numbers, int error) {
  std::vector<sock_filter> code = {BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr))};
  for (const long number : numbers) {
    code.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<uint32_t>(number), 0, 1));
    code.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | static_cast<uint32_t>(error)));
  }
  code.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
  const sock_fprog program{static_cast<unsigned short>(code.size()), code.data()};
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program);
}

}  // namespace odograph
