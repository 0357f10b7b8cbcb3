// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstring>
#include <memory>
#include <span>

#include "sdk/host/messages/messages.hpp"

namespace odograph {

/// A message by value like AnyMessage, but of its actual size: recordings hold a hundred thousand messages, most of
/// them a seventh of the largest. There is always room for the host's struct. Allocates; a moved-from object may only
/// be assigned or destroyed.
class StoredMessage {
 public:
  StoredMessage() : StoredMessage(sizeof(odo_header)) {}
  StoredMessage(const StoredMessage& other) : StoredMessage(other.capacity_) {
    std::memcpy(words_.get(), other.words_.get(), capacity_);
  }
  StoredMessage& operator=(const StoredMessage& other) {
    if (this != &other) *this = StoredMessage(other);
    return *this;
  }
  StoredMessage(StoredMessage&&) noexcept = default;
  StoredMessage& operator=(StoredMessage&&) noexcept = default;

  const odo_header& header() const { return *reinterpret_cast<const odo_header*>(words_.get()); }
  odo_header& header() { return *reinterpret_cast<odo_header*>(words_.get()); }
  /// The bytes as written.
  std::span<const unsigned char> bytes() const {
    return {reinterpret_cast<const unsigned char*>(words_.get()), header().struct_size};
  }
  /// False, and nothing done, if it is smaller than in version 1.0 or larger than any message may be.
  bool assign(const odo_header& message) {
    AnyMessage whole;
    if (!whole.assign(message)) return false;
    const MessageInfo* info = message_info(message.type);
    StoredMessage fitting(std::max<size_t>(message.struct_size, info ? info->size : 0));
    std::memcpy(fitting.words_.get(), whole.bytes().data(), message.struct_size);
    *this = std::move(fitting);
    return true;
  }

 private:
  explicit StoredMessage(size_t capacity)
      : words_(std::make_unique<uint64_t[]>((capacity + 7) / 8)), capacity_(capacity) {}

  std::unique_ptr<uint64_t[]> words_;
  size_t capacity_;
};

}  // namespace odograph
