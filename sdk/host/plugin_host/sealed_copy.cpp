// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/plugin_host/sealed_copy.hpp"

#include "sdk/host/platform/file_access.hpp"
#include "sdk/host/plugin_host/library.hpp"

#if defined(__linux__)
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <cerrno>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

namespace odograph {
namespace fs = std::filesystem;

Result<bool> has_hash_of(const Manifest& manifest, const fs::path& copy) {
  const auto hash = sha256_of(copy);
  if (!hash)
    return Failure{ODO_E_NOT_FOUND,
                   manifest.library.string() + ": cannot be opened (named by " + manifest.path.string() + ")"};
  // Format first: "truncated" is more specific than "hash differs".
  const auto file = check_shared_library(copy, manifest.library);
  if (!file) return file.failure();
  if (!manifest.sha256.empty() && *hash != manifest.sha256)
    return Failure{ODO_E_DATA, manifest.library.string() + ": its hash differs from the manifest's (" +
                                   manifest.path.string() + "); `odograph plugin manifest` writes a new one"};
  return true;
}

#if defined(__linux__)
namespace {

constexpr size_t kCopiedAtOnce = 1 << 20;
constexpr size_t kLargestLibrary = size_t(1) << 30;  // bytes; limit for a file that grows while it is read

/// A descriptor closed at the end of its scope.
struct Descriptor {
  int fd;
  ~Descriptor() {
    if (fd >= 0) close(fd);
  }
  int keep() { return std::exchange(fd, -1); }
};

bool write_all(int fd, const char* bytes, size_t size) {
  const FileSizeLimit limit;
  while (size > 0) {
    const ssize_t written = write(fd, bytes, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes += written;
    size -= static_cast<size_t>(written);
  }
  return true;
}

bool copy_all(int from, int to) {
  std::vector<char> chunk(kCopiedAtOnce);
  for (size_t total = 0; total <= kLargestLibrary;) {
    const ssize_t got = read(from, chunk.data(), chunk.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return got == 0;
    if (!write_all(to, chunk.data(), static_cast<size_t>(got))) return false;
    total += static_cast<size_t>(got);
  }
  return false;
}

/// A file in memory, under the number of its descriptor.
struct Copy {
  int fd;
  dev_t device;
  ino_t file;
};

/// False once somebody has closed the descriptor: its number may be another file's.
bool is_there(const Copy& copy) {
  struct stat now {};
  return fstat(copy.fd, &now) == 0 && now.st_dev == copy.device && now.st_ino == copy.file;
}

fs::path path_of(const Copy& copy) { return "/proc/self/fd/" + std::to_string(copy.fd); }

}  // namespace

Result<fs::path> sealed_copy(const Manifest& manifest) {
  static std::mutex mutex;
  static std::map<std::string, Copy> copies;  // by hash
  static std::set<int> used;                  // numbers: the loader knows a library by its path
  const std::lock_guard lock(mutex);
  if (const auto known = copies.find(manifest.sha256); known != copies.end() && is_there(known->second))
    return path_of(known->second);
  const std::string who = manifest.library.string();
  const Descriptor file{open(manifest.library.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};  // a pipe would block
  struct stat kind {};
  if (file.fd < 0 || fstat(file.fd, &kind) != 0 || !S_ISREG(kind.st_mode))
    return Failure{ODO_E_NOT_FOUND, who + ": cannot be opened (named by " + manifest.path.string() + ")"};
  // The name appears in debuggers and /proc/self/maps.
  Descriptor memory{
      memfd_create(manifest.library.filename().string().substr(0, 200).c_str(), MFD_CLOEXEC | MFD_ALLOW_SEALING)};
  if (memory.fd < 0 || !copy_all(file.fd, memory.fd) ||
      fcntl(memory.fd, F_ADD_SEALS, F_SEAL_WRITE | F_SEAL_GROW | F_SEAL_SHRINK | F_SEAL_SEAL) != 0)
    return Failure{ODO_E_EXHAUSTED,
                   who + ": no sealed copy could be made, which plugins allowed by hash or signature require"};
  while (used.count(memory.fd) != 0) {
    const int other = fcntl(memory.fd, F_DUPFD_CLOEXEC, memory.fd + 1);
    if (other < 0) return Failure{ODO_E_EXHAUSTED, who + ": no descriptor is left"};
    close(std::exchange(memory.fd, other));
  }
  if (fstat(memory.fd, &kind) != 0) return Failure{ODO_E_IO, who + ": its sealed copy cannot be read"};
  const Copy copy{memory.fd, kind.st_dev, kind.st_ino};
  if (const auto same = has_hash_of(manifest, path_of(copy)); !same) return same.failure();
  used.insert(memory.keep());  // permanently: the loader would mistake another library under this number for this one
  copies.insert_or_assign(manifest.sha256, copy);
  return path_of(copy);
}
#else
Result<fs::path> sealed_copy(const Manifest& manifest) {
  if (const auto same = has_hash_of(manifest, manifest.library); !same) return same.failure();
  return manifest.library;
}
#endif

}  // namespace odograph
