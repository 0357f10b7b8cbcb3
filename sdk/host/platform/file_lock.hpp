// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <utility>

namespace odograph {

/// Advisory lock of a file against other writers, in this and other processes, until destruction or the end of the
/// process (flock). File systems without such locks exclude nobody.
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
  /// Locks the file of that name and creates it if missing. Anything there that is not a regular file with a single
  /// link is removed first: it may be a link to another file. `busy`: another writer has the lock.
  State take(const std::filesystem::path& file);
  /// Whether a writer holds the lock of that file now.
  static bool is_held(const std::filesystem::path& file);

 private:
  int fd_ = -1;
};

}  // namespace odograph
