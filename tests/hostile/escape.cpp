// SPDX-License-Identifier: Apache-2.0
// An attitude source that attacks its host, its user and its machine once, as selected by ODOGRAPH_TEST_ATTACK, and
// reports the attacks that succeeded.
#define HOSTILE_ID "test/escape"
#include <csignal>
#include <string>
#include <thread>

#include <dirent.h>
#include <fcntl.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <odograph/attitude.h>

#include "tests/hostile/attacks.hpp"
#include "tests/hostile/control.hpp"
#include "tests/hostile/horizontal_attitude.hpp"
#include "tests/hostile/random_calls.hpp"
#include "tests/hostile/table.hpp"

namespace {

const odo_host* host = nullptr;

void report(const std::string& what, const std::string& said) {
  const auto* reports = static_cast<const odo_report_service*>(
      host->get_service(host, ODO_SERVICE_REPORT, sizeof(ODO_SERVICE_REPORT) - 1));
  const odo_string key{what.data(), what.size()}, text{said.data(), said.size()};
  reports->report(host, 1, ODO_SEVERITY_WARNING, &key, &text);
}

/// Name of each successful attempt.
std::string attempts() {
  std::string done;
  unsigned long count = 0;
  for (const hostile::Attempts all : {hostile::on_processes(), hostile::on_files()})
    for (unsigned long i = 0; i < all.count; ++i, ++count)
      if (all.first[i].done()) done += std::string("[") + all.first[i].name + "]";
  return "of " + std::to_string(count) + " attempts: " + (done.empty() ? "none" : done);
}

/// What the plugin needs for its work.
std::string needs() {
  bool ran = false;
  std::thread([&] { ran = true; }).join();
  return std::string(open("/proc/self/maps", O_RDONLY) >= 0 ? "reads files, " : "reads none, ") +
         (ran ? "has threads" : "has none");
}

/// Threads with a stack of two pages each.
std::string threads() {
  int made = 0;
  for (; made < 6000; ++made) {
    auto* stack = static_cast<char*>(mmap(nullptr, 8192, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    if (stack == MAP_FAILED) break;
    const auto sleep = [](void*) -> int {
      for (;;) syscall(SYS_ppoll, nullptr, 0, nullptr, nullptr, 0);
    };
    constexpr int kThread = CLONE_VM | CLONE_FS | CLONE_FILES | CLONE_SIGHAND | CLONE_THREAD | CLONE_SYSVSEM;
    if (clone(sleep, stack + 8192, kThread, nullptr) < 0) break;
  }
  return std::to_string(made) + " threads";
}

/// Memory outside its address space: as many full pipes as possible.
std::string pipes() {
  static char block[1 << 16];
  long held = 0;
  for (int ends[2]; pipe2(ends, O_NONBLOCK) == 0;)
    for (ssize_t written; (written = write(ends[1], block, sizeof block)) > 0;) held += written;
  return std::to_string(held >> 20) + " MiB in pipes";
}

/// Blocks every thread of its process in a signal handler forever.
[[noreturn]] void outlive() {
  struct sigaction stuck {};
  stuck.sa_handler = [](int) {
    for (;;) syscall(SYS_ppoll, nullptr, 0, nullptr, nullptr, 0);
  };
  for (int signal = 1; signal < 32; ++signal) sigaction(signal, &stuck, nullptr);
  DIR* tasks = opendir("/proc/self/task");
  while (const dirent* entry = tasks ? readdir(tasks) : nullptr)
    if (const int task = std::atoi(entry->d_name); task > 0 && task != gettid())
      syscall(SYS_tgkill, getpid(), task, SIGUSR1);
  stuck.sa_handler(0);
  for (;;) {
  }
}

/// Writes forever, in lines whose length divides no buffer size.
[[noreturn]] void chatter() {
  const std::string much = std::string(997, 'x') + "\n";
  for (;;)
    for (const int fd : {1, 2}) (void)!write(fd, much.data(), much.size());
}

/// Reports that forge log lines, move a terminal's cursor, are not text, or are cut within a character.
void forge_reports() {
  report("line\nfeed", "all is well\n2026-01-01 host: nothing is wrong");
  report("escape", "a\x1b[2J\xc2\x9b\x7f\r\tb");
  report("bytes", "\xff\xc0\xaf\xed\xa0\x80");
  std::string letters;
  for (int i = 0; i < 2049; ++i) letters += "\xc3\xa4";
  report("cut", "x" + letters);
}

/// What it can open in the target's folder through a second mount of the process file system as `names`.
std::string second_names() {
  const std::string folder = hostile::target_folder();
  std::string opened;
  for (const char* name : {"/names/version", "/names/self/environ", "/names/1/status", "/file", "/beside/file"})
    if (const int fd = open((folder + name).c_str(), O_RDONLY); fd >= 0) opened += name + std::string(" "), close(fd);
  return "opened: " + opened;
}

std::string ordered() {
  const char* what = std::getenv("ODOGRAPH_TEST_ATTACK");
  return what ? what : "";
}

/// Runs before any function of the library: answers success in the host's place and never returns.
__attribute__((constructor)) void forge_start() {
  if (ordered() != "forge the start") return;
  auto* shared = hostile::control();
  if (!shared) return;
  constexpr size_t kBytes = 40;  // status, reason, types, flags and missing features: all empty
  for (size_t i = 0; i < kBytes; ++i) shared->response[i] = 0;
  shared->response_size = kBytes;
  (void)!write(odograph::wire::kSocket, "a", 1);
  for (;;) pause();
}

void attack() {
  const std::string what = ordered();
  if (what == "chatter") chatter();
  if (what == "lie") forge_reports();
  if (what == "attempts") report(what, attempts()), report("needs", needs());
  if (what == "second names") report(what, second_names());
  if (what == "threads") report(what, threads());
  if (what == "pipes") report(what, pipes());
  if (what == "outlive") outlive();
}

}  // namespace

HOSTILE_PLUGIN {
  HOSTILE_SERVES(t, ODO_INTERFACE_ATTITUDE);
  t.create = [](const odo_host* given, uint32_t, const odo_string*, odo_instance** instance) -> int32_t {
    host = given;
    *instance = reinterpret_cast<odo_instance*>(&hostile::instance());
    return ODO_OK;
  };
  t.process = [](odo_instance*, const odo_batch* batch) -> int32_t {
    static bool done = false;
    const char* calls = std::getenv("ODOGRAPH_TEST_CALLS");
    if (calls) hostile::random_calls(std::atol(calls));
    if (!done && !calls) attack();
    done = true;
    for (uint32_t i = 0; i < batch->count; ++i)
      if (batch->messages[i]->type == ODO_TYPE_IMU) hostile::emit_horizontal_attitude(*batch->messages[i]);
    return ODO_OK;
  };
}
