// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/platform/crash.hpp"

#include <csignal>
#include <cstdlib>

#include <unistd.h>

namespace odograph {
namespace {

class SignalStack {
 public:
  SignalStack() {
    stack_t old{};
    if (sigaltstack(nullptr, &old) != 0 || (old.ss_flags & SS_DISABLE) == 0) return;
    memory_ = std::malloc(kSize);
    if (!memory_) return;
    stack_t mine{};
    mine.ss_sp = memory_, mine.ss_size = kSize;
    sigaltstack(&mine, nullptr);
  }
  ~SignalStack() {
    if (!memory_) return;
    stack_t none{};
    none.ss_flags = SS_DISABLE;
    sigaltstack(&none, nullptr);
    std::free(memory_);
  }

 private:
  static constexpr size_t kSize = 32 << 10;
  void* memory_ = nullptr;
};

constexpr int kSignals[] = {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT};
CrashHandler called{};
int exit_status = 0;

void on_signal(int signal_number) {
  switch (signal_number) {
    case SIGSEGV: called.name("segmentation fault"); break;
    case SIGBUS: called.name("bus error"); break;
    case SIGILL: called.name("illegal instruction"); break;
    case SIGFPE: called.name("arithmetic fault"); break;
    default: called.name("aborted");
  }
  raise(signal_number);  // SA_RESETHAND has restored the default disposition
}

void at_exit() {
  if (!called.exits_immediately()) return;
  called.name("exit() was called");
  _exit(exit_status);
}

}  // namespace

void set_crash_handler(const CrashHandler& handler, int status) {
  called = handler;
  exit_status = status;
  for (const int signal_number : kSignals) {
    struct sigaction old {};
    if (sigaction(signal_number, nullptr, &old) != 0 || (old.sa_flags & SA_SIGINFO) || old.sa_handler != SIG_DFL)
      continue;
    struct sigaction mine {};
    mine.sa_handler = on_signal;
    mine.sa_flags = SA_ONSTACK | static_cast<int>(SA_RESETHAND) | SA_NODEFER;
    sigemptyset(&mine.sa_mask);
    sigaction(signal_number, &mine, nullptr);
  }
  std::atexit(at_exit);
}

void ensure_signal_stack() { thread_local const SignalStack stack; }

void write_error(const char* text, size_t size) noexcept { (void)!write(STDERR_FILENO, text, size); }

}  // namespace odograph
