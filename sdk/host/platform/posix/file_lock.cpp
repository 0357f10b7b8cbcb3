// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/platform/file_lock.hpp"

#include <cerrno>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace odograph {
namespace {

constexpr int kTries = 100;  // others may replace the file meanwhile

bool is_same_file(int fd, const std::filesystem::path& file) {
  struct stat opened {
  }, named{};
  return fstat(fd, &opened) == 0 && lstat(file.c_str(), &named) == 0 && opened.st_dev == named.st_dev &&
         opened.st_ino == named.st_ino;
}

bool is_ours_alone(int fd) {
  struct stat opened {};
  return fstat(fd, &opened) == 0 && S_ISREG(opened.st_mode) && opened.st_nlink == 1;
}

}  // namespace

FileLock::~FileLock() {
  if (fd_ < 0) return;
  flock(fd_, LOCK_UN);  // a forked child has it open, too
  close(fd_);
}

FileLock::State FileLock::take(const std::filesystem::path& file) {
  for (int i = 0; i < kTries; ++i) {
    const int fd = open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    if (fd < 0) {
      if (errno == ENOENT || unlink(file.c_str()) != 0) return State::impossible;
      continue;
    }
    if (flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      const bool still_there = is_same_file(fd, file);
      close(fd);
      if (still_there) return State::busy;
      continue;
    }
    if (is_same_file(fd, file) && is_ours_alone(fd)) {
      fd_ = fd;
      return State::held;
    }
    if (is_same_file(fd, file)) unlink(file.c_str());
    close(fd);
  }
  return State::impossible;
}

bool FileLock::is_held(const std::filesystem::path& file) {
  const int fd = open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (fd < 0) return false;
  const bool held = flock(fd, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  close(fd);
  return held;
}

}  // namespace odograph
