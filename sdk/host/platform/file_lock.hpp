// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <utility>

namespace odograph {

/// A file held against other writers that ask for it in the same way, in this process and in others, until it is
/// destroyed or the process ends (flock). File systems that know no such locks exclude nobody.
class FileLock {
 public:
  FileLock() = default;
  FileLock(FileLock&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  FileLock& operator=(FileLock&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~FileLock();

  enum class State { held, busy, impossible };
  /// Holds the file of that name, which is made where it is missing. What lies there and is no plain file of one name
  /// alone is removed first: it may be a link to somebody's file. `busy`: another writer has it.
  State take(const std::filesystem::path& file);
  /// Whether a writer holds what lies there now.
  static bool is_held(const std::filesystem::path& file);

 private:
  int fd_ = -1;
};

}  // namespace odograph
