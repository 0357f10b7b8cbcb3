// SPDX-License-Identifier: Apache-2.0
// A horizontal attitude with one fault at one phase, both named by its file: abort__create.so. In process it occurs at
// the 40th sample after each start.
#define HOSTILE_ID "test/fault_phase"
#include <dlfcn.h>
#include <pthread.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <thread>

#include "tests/hostile/control.hpp"
#include "tests/hostile/horizontal_attitude.hpp"

namespace {

void here() {}

const std::string& name() {
  static const std::string mine = [] {
    Dl_info info{};
    dladdr(reinterpret_cast<const void*>(&here), &info);
    std::string path = info.dli_fname ? info.dli_fname : "";
    path = path.substr(path.rfind('/') + 1);
    return path.substr(0, path.rfind('.'));
  }();
  return mine;
}

int deep(volatile char* above) {
  volatile char storage[4096];
  storage[0] = above[0];
  return deep(storage) + storage[0];
}

/// The shortest complete answer: a status, without events and reports.
void forge(volatile odograph::wire::Control& shared) {
  for (size_t i = 0; i < sizeof(int32_t); ++i) shared.response[i] = 0;
  shared.response_size = sizeof(int32_t);
}

/// Answers ahead of every question, as many times as the socket holds, and reads none of them.
void answer_unrequested() {
  auto* shared = hostile::control();
  if (!shared) return;
  forge(*shared);
  std::thread([] {
    while (write(odograph::wire::kSocket, "a", 1) == 1) continue;
  }).detach();
  for (;;) forge(*shared);
}

/// Answers the question that it has read, and each further one in the socket without reading it, so that they fill the
/// socket.
void answer_without_reading() {
  auto* shared = hostile::control();
  if (!shared) return;
  for (int left = 0;; ++left) {
    for (int asked = 0; asked < left;)
      if (ioctl(odograph::wire::kSocket, FIONREAD, &asked) != 0) return;
    forge(*shared);
    if (write(odograph::wire::kSocket, "a", 1) != 1) return;
  }
}

/// Commits the fault named by the file if its phase has come.
void commit_fault(const char* phase) {
  const size_t gap = name().find("__");
  if (gap == std::string::npos || name().substr(gap + 2) != phase) return;
  const std::string fault = name().substr(0, gap);
  volatile char storage[1] = {1};
  if (fault == "abort") std::abort();
  if (fault == "exit") std::exit(0);
  if (fault == "quick_exit") _exit(0);
  if (fault == "segfault") *reinterpret_cast<volatile int*>(8) = 1;
  if (fault == "null_call") reinterpret_cast<void (*volatile)()>(0)();
  if (fault == "stack_overflow") std::exit(deep(storage));
  if (fault == "illegal_instruction") raise(SIGILL);
  if (fault == "arithmetic") raise(SIGFPE);
  if (fault == "kill") raise(SIGKILL);
  if (fault == "terminate") []() noexcept { throw std::runtime_error("nobody catches it"); }();
  if (fault == "throws") throw std::runtime_error("a bad day");
  if (fault == "throws_a_number") throw 42;
  if (fault == "thread_exit") pthread_exit(nullptr);
  if (fault == "hangs")
    for (volatile int i = 0;; i = i + 1) {
    }
  if (fault == "sleeps")
    for (;;) pause();
  if (fault == "closes_files")
    for (int fd = 3; fd < 1024; ++fd) close(fd);
  if (fault == "eats_memory")
    for (;;) {
      void* memory = std::malloc(1 << 20);
      if (!memory) std::abort();
      std::memset(memory, 1, 1 << 20);
    }
  if (fault == "answers_unasked") answer_unrequested();
  if (fault == "takes_no_question") answer_without_reading();
  if (fault == "scribbles") {  // over adjacent memory
    static int mine = 0;
    std::memset(static_cast<void*>(&mine), 0x5a, 1 << 24);
  }
}

}  // namespace

extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) {
  commit_fault("entry");
  odo_plugin t = hostile::table();
  HOSTILE_SERVES(t, ODO_INTERFACE_ATTITUDE);
  t.create = hostile::create_after<[] { commit_fault("create"), hostile::instance() = 0; }>;
  t.configure = [](odo_instance*, const odo_value*, uint32_t, uint32_t) -> int32_t {
    return commit_fault("configure"), ODO_OK;
  };
  t.activate = [](odo_instance*, const odo_sink* s) -> int32_t {
    commit_fault("activate");
    hostile::sink() = s;
    return ODO_OK;
  };
  t.destroy = [](odo_instance*) { commit_fault("destroy"); };
  t.process = [](odo_instance*, const odo_batch* batch) -> int32_t {
    if (batch->messages[0]->type != ODO_TYPE_IMU) return ODO_OK;
    if (++hostile::instance() == 40) commit_fault("process");
    return hostile::emit_horizontal_attitude(*batch->messages[0]);
  };
  return hostile::fill(out, t);
}
