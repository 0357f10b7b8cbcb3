// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/platform/file_access.hpp"

#include <csignal>

namespace odograph {
namespace fs = std::filesystem;

namespace {

sigset_t too_large() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGXFSZ);
  return set;
}

bool is_pending() {
  sigset_t pending;
  sigemptyset(&pending);
  return sigpending(&pending) == 0 && sigismember(&pending, SIGXFSZ) == 1;
}

}  // namespace

bool is_world_writable(const fs::path& path, bool owners_only_is_safe) {
  std::error_code error;
  const auto permissions = fs::status(path, error).permissions();
  if (error || (permissions & fs::perms::others_write) == fs::perms::none) return false;
  return !owners_only_is_safe || (permissions & fs::perms::sticky_bit) == fs::perms::none;
}

FileSizeLimit::FileSizeLimit() : was_pending_(is_pending()) {
  const sigset_t set = too_large();
  sigset_t before;
  sigemptyset(&before);
  was_blocked_ = pthread_sigmask(SIG_BLOCK, &set, &before) != 0 || sigismember(&before, SIGXFSZ) == 1;
}

FileSizeLimit::~FileSizeLimit() {
  const sigset_t set = too_large();
  int taken = 0;
  if (!was_pending_ && is_pending()) sigwait(&set, &taken);
  if (!was_blocked_) pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

}  // namespace odograph
