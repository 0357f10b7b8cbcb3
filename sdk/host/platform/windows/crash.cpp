// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/platform/crash.hpp"

#include <csignal>
#include <cstdlib>

#include <windows.h>

namespace odograph {
namespace {

CrashHandler called{};
int exit_status = 0;
LPTOP_LEVEL_EXCEPTION_FILTER before = nullptr;

LONG WINAPI on_exception(EXCEPTION_POINTERS* exception) {
  switch (exception->ExceptionRecord->ExceptionCode) {
    case EXCEPTION_ACCESS_VIOLATION:
    case EXCEPTION_STACK_OVERFLOW: called.name("segmentation fault"); break;
    case EXCEPTION_IN_PAGE_ERROR:
    case EXCEPTION_DATATYPE_MISALIGNMENT: called.name("bus error"); break;
    case EXCEPTION_ILLEGAL_INSTRUCTION:
    case EXCEPTION_PRIV_INSTRUCTION: called.name("illegal instruction"); break;
    case EXCEPTION_INT_DIVIDE_BY_ZERO:
    case EXCEPTION_INT_OVERFLOW: called.name("arithmetic fault"); break;
    default: break;
  }
  return before ? before(exception) : EXCEPTION_CONTINUE_SEARCH;
}

void on_abort(int signal_number) {
  called.name("aborted");
  raise(signal_number);  // the default handler is active again
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
  before = SetUnhandledExceptionFilter(on_exception);
  const auto other = std::signal(SIGABRT, on_abort);
  if (other != SIG_DFL && other != SIG_ERR) std::signal(SIGABRT, other);
  std::atexit(at_exit);
}

void ensure_signal_stack() {
  ULONG size = 32 << 10;
  SetThreadStackGuarantee(&size);
}

void write_error(const char* text, size_t size) noexcept {
  DWORD written = 0;
  WriteFile(GetStdHandle(STD_ERROR_HANDLE), text, static_cast<DWORD>(size), &written, nullptr);
}

}  // namespace odograph
