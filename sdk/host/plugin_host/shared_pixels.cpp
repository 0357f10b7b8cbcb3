// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/plugin_host/shared_pixels.hpp"

#include <algorithm>
#include <cerrno>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "sdk/host/plugin_host/shared_memory.hpp"

namespace odograph {
namespace {

constexpr size_t kPageBytes = 4096;

}  // namespace

SharedPixels::~SharedPixels() {
  if (memory_) munmap(memory_, kBytes);
  if (fd_ >= 0) close(fd_);
}

void SharedPixels::open() {
  const int fd = shared_memory("odograph-pixels", 0);
  memory_ = static_cast<uint8_t*>(map_shared(fd, kBytes));
#if defined(F_SEAL_FUTURE_WRITE)
  if (memory_ && fcntl(fd, F_ADD_SEALS, F_SEAL_FUTURE_WRITE) == 0) fd_ = fd;
#endif
  if (fd_ >= 0) return;
  const int why = errno;
  if (memory_) munmap(memory_, kBytes);
  memory_ = nullptr;
  if (fd >= 0) close(fd);
  errno = why;
}

int SharedPixels::descriptor() {
  const std::lock_guard lock(opening_);
  if (fd_ < 0) open();
  return fd_;
}

std::span<uint8_t> SharedPixels::take(size_t bytes) {
  if (bytes == 0 || bytes > kBytes || descriptor() < 0) return {};
  const std::lock_guard lock(mutex_);
  Place* best = nullptr;
  for (Place& place : places_)
    if (!place.taken && place.bytes >= bytes && (!best || place.bytes < best->bytes)) best = &place;
  if (!best) {
    if (std::none_of(places_.begin(), places_.end(), [](const Place& place) { return place.taken; })) places_.clear();
    const size_t end = places_.empty() ? 0 : places_.back().offset + places_.back().bytes;
    const size_t whole = (bytes + kPageBytes - 1) / kPageBytes * kPageBytes;
    if (whole > kBytes - end) return {};
    if (end + whole > size_ && ftruncate(fd_, static_cast<off_t>(end + whole)) != 0) return {};
    size_ = std::max(size_, end + whole);
    places_.push_back({end, whole, false});
    best = &places_.back();
  }
  best->taken = true;
  return {memory_ + best->offset, best->bytes};
}

void SharedPixels::give_back(std::span<uint8_t> place) {
  const auto offset = offset_of(place.data());
  if (!offset) return;
  const std::lock_guard lock(mutex_);
  for (Place& each : places_)
    if (each.offset == *offset) each.taken = false;
}

size_t SharedPixels::reserved() const {
  const std::lock_guard lock(mutex_);
  return size_;
}

std::optional<uint64_t> SharedPixels::offset_of(const uint8_t* at) const {
  if (!at || !memory_ || at < memory_ || at >= memory_ + kBytes) return std::nullopt;
  return static_cast<uint64_t>(at - memory_);
}

}  // namespace odograph
