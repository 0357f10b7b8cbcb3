// SPDX-License-Identifier: Apache-2.0
//
// Single process: writers exclude each other by file name.
#include "sdk/host/platform/file_lock.hpp"

#include <algorithm>
#include <fstream>
#include <mutex>
#include <vector>

namespace odograph {
namespace {

struct Locks {
  std::mutex mutex;
  std::vector<std::filesystem::path> held;  // indexed by lock number; an empty one is free
};

/// Never destroyed: sessions may end during program exit.
Locks& locks() {
  static auto* mine = new Locks;
  return *mine;
}

std::filesystem::path name_of(const std::filesystem::path& file) {
  std::error_code error;
  auto name = std::filesystem::weakly_canonical(file, error);
  return error ? file : name;
}

}  // namespace

FileLock::~FileLock() {
  if (fd_ < 0) return;
  const std::lock_guard lock(locks().mutex);
  locks().held[static_cast<size_t>(fd_)].clear();
}

FileLock::State FileLock::take(const std::filesystem::path& file) {
  if (!std::ofstream(file, std::ios::app)) return State::impossible;
  const auto name = name_of(file);
  const std::lock_guard lock(locks().mutex);
  auto& held = locks().held;
  if (std::find(held.begin(), held.end(), name) != held.end()) return State::busy;
  auto free = std::find(held.begin(), held.end(), std::filesystem::path());
  if (free == held.end()) free = held.emplace(held.end());
  *free = name;
  fd_ = static_cast<int>(free - held.begin());
  return State::held;
}

bool FileLock::is_held(const std::filesystem::path& file) {
  const std::lock_guard lock(locks().mutex);
  const auto& held = locks().held;
  return std::find(held.begin(), held.end(), name_of(file)) != held.end();
}

}  // namespace odograph
