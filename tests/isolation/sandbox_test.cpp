// SPDX-License-Identifier: Apache-2.0
//
// Limits of an isolated plugin, tested by an attacker (hostile/escape.cpp): the table of docs/security.md.
#include <chrono>
#include <csignal>
#include <thread>

#include <fcntl.h>
#include <linux/fs.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <sys/xattr.h>
#include <unistd.h>

#include "tests/isolation/isolated_plugin.hpp"
#include "tests/isolation/sandboxed.hpp"
#include "tests/support/test_plugins.hpp"

TEST_SUITE_BEGIN("sandbox");

namespace {

const std::string kEscape = "attitude: {plugin: test/escape, isolation: process, time_limit: 0.5 s}\n";

std::string file_state(const fs::path& path) {
  struct stat s {};
  lstat(path.c_str(), &s);
  char attributes[256];
  const ssize_t named = listxattr(path.c_str(), attributes, sizeof attributes);
  int flags = 0;
  const int fd = open(path.c_str(), O_RDONLY);
  ioctl(fd, FS_IOC_GETFLAGS, &flags);
  close(fd);
  std::stringstream text;
  text << path << ' ' << s.st_mode << ' ' << s.st_uid << ' ' << s.st_nlink << ' ' << s.st_size << ' '
       << s.st_mtim.tv_sec << '.' << s.st_mtim.tv_nsec << ' ' << s.st_ctim.tv_sec << '.' << s.st_ctim.tv_nsec << ' '
       << flags << ' ' << std::string(attributes, static_cast<size_t>(std::max<ssize_t>(named, 0))) << '\n';
  return text.str();
}

/// Everything of this process, this user's files and this machine that an attacker might change, as text.
std::string outside(const AttackTarget& target) {
  std::stringstream text;
  text << file_state(target.folder.path());
  for (const auto& entry : fs::recursive_directory_iterator(target.folder.path()))
    text << file_state(entry.path()) << read_all(entry.path()) << '\n';
  for (int what = 0; what < 16; ++what) {
    rlimit limit{};
    getrlimit(static_cast<__rlimit_resource_t>(what), &limit);
    text << limit.rlim_cur << ' ' << limit.rlim_max << '\n';
  }
  cpu_set_t processors;
  CPU_ZERO(&processors);
  sched_getaffinity(0, sizeof processors, &processors);
  text << CPU_COUNT(&processors) << ' ' << sched_getscheduler(0) << ' ' << getpriority(PRIO_PROCESS, 0) << ' '
       << getpgrp() << ' ' << getsid(0) << ' ' << fs::current_path() << '\n';
  for (int fd = 0; fd < 3; ++fd) text << fcntl(fd, F_GETFL) << ' ' << fcntl(fd, F_GETOWN) << '\n';
  for (const char* file : {"/proc/sysvipc/shm", "/proc/sysvipc/msg", "/proc/sysvipc/sem", "/proc/self/mountinfo",
                           "/proc/sys/kernel/hostname", "/proc/sys/kernel/domainname"})
    text << read_all(file);
  text << fs::exists("/dev/mqueue/odograph-escape") << '\n';
  timespec real{}, steady{};
  clock_gettime(CLOCK_REALTIME, &real);
  clock_gettime(CLOCK_MONOTONIC, &steady);
  const int64_t between_ns = (real.tv_sec - steady.tv_sec) * INT64_C(1'000'000'000) + real.tv_nsec - steady.tv_nsec;
  text << "clock " << between_ns / INT64_C(8'000'000'000) << '\n';  // the fraction of a second is no change
  return text.str();
}

/// Reports of the attacker.
std::string attacked(const char* plugins_folder) {
  IsolatedPlugin plugin(kEscape, plugins_folder);
  for (int i = 0; i < 3; ++i) plugin.sample();
  return joined(plugin.said);
}

}  // namespace

TEST_CASE("no attempt on the host, its user's files or the machine succeeds") {
  const TestPlugins plugins{"escape"};
  const AttackTarget target("attempts");
  const std::string before = outside(target);
  const std::string said = in_a_process([&] {
    setenv("ODOGRAPH_TEST_HOST", std::to_string(getpid()).c_str(), 1);
    return attacked(plugins.path().c_str());
  });
  MESSAGE(said);
  CHECK(contains(said, "attempts: none"));
  CHECK(contains(said, "reads files, has threads"));
  CHECK(outside(target) == before);
}

TEST_CASE("without namespaces and Landlock that is reported, and nothing outside can be changed") {
  const TestPlugins plugins{"escape"};
  const AttackTarget target("attempts");
  const std::string before = outside(target);
  const std::string said = in_a_process([&] {
    setenv("ODOGRAPH_TEST_HOST", std::to_string(getpid()).c_str(), 1);
    refuse_calls({SYS_unshare}, EPERM);
    refuse_calls({444 /* landlock_create_ruleset */}, ENOSYS);
    return attacked(plugins.path().c_str());
  });
  CHECK_MESSAGE(contains(said, "no namespaces of users and processes (Operation not permitted)"), said);
  CHECK_MESSAGE(contains(said, "no Landlock"), said);
  std::string done = said.substr(std::min(said.size(), said.find("attempts: ")));
  done = done.substr(0, done.find('\n'));
  for (const char* looking : {"[open the host's memory]", "[open the host's environment]", "[open the host's maps]",
                              "[open the host's arguments]", "[open the host's descriptors]",
                              "[open the first process]", "[open a kernel's log]", "[a terminal]", "[a device]"})
    if (const auto at = done.find(looking); at != std::string::npos) done.erase(at, std::string(looking).size());
  CHECK_MESSAGE((done == "attempts: " || done == "attempts: none"), said);
  CHECK(outside(target) == before);
}

TEST_CASE("a second mount of the process file system is closed like the first, and its neighbours stay open") {
  const TestPlugins plugins{"escape"};
  const AttackTarget target("second names");
  for (const char* name : {"names", "beside"}) fs::create_directory(target.folder / name);
  write_text(target.folder / "beside/file", "a model");
  const std::string said = in_a_process([&]() -> std::string {
    if (unshare(CLONE_NEWNS) != 0 || mount("", "/", "", MS_REC | MS_PRIVATE, "") != 0 ||
        mount("proc", (target.folder / "names").c_str(), "proc", 0, "") != 0)
      return "not allowed to mount";
    return attacked(plugins.path().c_str());
  });
  if (said == "not allowed to mount") return;
  if (contains(said, "no Landlock")) return;
  CHECK_MESSAGE(contains(said, "opened: /file /beside/file \n"), said);
}

TEST_CASE("threads and the content of pipes are bounded") {
  const TestPlugins plugins{"escape"};
  for (const auto& [attack, what, most] : {std::tuple{"threads", " threads", 300}, {"pipes", " MiB in pipes", 32}}) {
    const AttackTarget target(attack);
    const std::string said = attacked(plugins.path().c_str());
    const auto end = said.find(what);
    REQUIRE_MESSAGE(end != std::string::npos, said);
    const auto digits = said.find_last_not_of("0123456789", end - 1);
    const int got = std::atoi(said.substr(digits == std::string::npos ? 0 : digits + 1).c_str());
    MESSAGE(got << std::string(what));
    CHECK(got > 2);
    CHECK(got <= most);
  }
}

TEST_CASE("a plugin that blocks every signal and thread ends with its host") {
  const TestPlugins plugins{"escape"};
  const AttackTarget target("outlive");
  const pid_t host = fork();
  if (host == 0) {
    IsolatedPlugin plugin("attitude: {plugin: test/escape, isolation: process, time_limit: 60 s}\n", plugins.path());
    plugin.sample();
    _exit(0);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(700));  // the attack is running
  const auto below = descendants(host);
  REQUIRE_FALSE(below.empty());
  kill(host, SIGKILL);
  waitpid(host, nullptr, 0);
  const auto some_live = [&] { return std::any_of(below.begin(), below.end(), is_alive); };
  for (int i = 0; i < 100 && some_live(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  std::string living;
  for (const pid_t each : below)
    if (is_alive(each)) living += read_all("/proc/" + std::to_string(each) + "/status");
  CHECK_MESSAGE(living.empty(), living);
  for (const pid_t each : below)
    if (is_alive(each)) kill(each, SIGKILL);
}

TEST_CASE("random system calls change nothing outside") {
  const TestPlugins plugins{"escape"};
  const AttackTarget target("");
  const char* wanted = std::getenv("ODOGRAPH_SYSTEM_CALLS");
  const long calls = wanted ? std::atol(wanted) : 1'000'000, a_sample = 5'000;
  setenv("ODOGRAPH_TEST_CALLS", std::to_string(a_sample).c_str(), 1);
  const std::string before = outside(target);
  IsolatedPlugin plugin(kEscape, plugins.path());
  long done = 0, samples = 0;
  for (; done < calls && samples < calls; ++samples) {
    if (plugin.sample() > 0)
      done += a_sample;
    else
      plugin.t_ns += 1'000'000'000;  // until it has disabled itself
  }
  MESSAGE(done << " calls, ended " << plugin.plugin->faults() << " times");
  CHECK(done >= calls);
  CHECK(outside(target) == before);
}
