// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/plugin_host/shared_memory.hpp"

#include <cerrno>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

namespace odograph {
namespace {

constexpr int kFirstDescriptor = 64;

}  // namespace

int high_descriptor(int fd) {
  if (fd < 0) return fd;
  const int high = fcntl(fd, F_DUPFD_CLOEXEC, kFirstDescriptor);
  if (high < 0) errno = EMFILE;  // it returns EINVAL if the limit is below the first
  const int why = errno;
  close(fd);
  errno = why;
  return high;
}

int shared_memory(const char* name, size_t bytes) {
  const int fd = high_descriptor(memfd_create(name, MFD_CLOEXEC | MFD_ALLOW_SEALING));
  if (fd >= 0 && ftruncate(fd, static_cast<off_t>(bytes)) != 0) return close(fd), -1;
  if (fd >= 0) fcntl(fd, F_ADD_SEALS, F_SEAL_SHRINK);
  return fd;
}

void* map_shared(int fd, size_t bytes) {
  void* memory = fd < 0 ? MAP_FAILED : mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  return memory == MAP_FAILED ? nullptr : memory;
}

}  // namespace odograph
