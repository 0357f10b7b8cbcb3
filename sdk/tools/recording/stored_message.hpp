// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstring>
#include <memory>
#include <span>

#include "sdk/host/messages/messages.hpp"

namespace odograph {

/// A message by value as AnyMessage, but as large as it is: recordings hold a hundred thousand of them, and most are a
/// seventh of the largest. There is always room for the host's struct. Allocates; a moved-from one is to be assigned or
/// destroyed only.
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
  /// As its writer had it.
  std::span<const unsigned char> bytes() const {
    return {reinterpret_cast<const unsigned char*>(words_.get()), header().struct_size};
  }
  /// False, and nothing done, when it is smaller than version 1.0 of it or larger than any message may be.
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
