// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstring>

#include <odograph/types.h>

namespace odograph {

/// What the host knows of a message type: its name in files, how large version 1.0 of it is, and where its numbers are.
struct MessageInfo {
  uint32_t type;
  const char* name;
  size_t size;  // of the host's struct, which is version 1.0
  bool is_input;
};

/// Null for a type the host does not know.
const MessageInfo* message_info(uint32_t type);

/// True when every number whose validity bit is set is finite, and quaternions are of unit length within 1e-3.
bool message_is_finite(const odo_header& message);

/// A zeroed message with its size, type and time filled in.
template <class Message>
Message make_message(uint32_t type, int64_t t_ns) {
  Message message;
  std::memset(static_cast<void*>(&message), 0, sizeof message);
  message.header.struct_size = sizeof(Message);
  message.header.type = type;
  message.header.t_ns = t_ns;
  return message;
}

/// The message behind a header whose type has been looked at.
template <class Message>
const Message& as(const odo_header& header) {
  return reinterpret_cast<const Message&>(header);
}

constexpr size_t kLargestMessage = 640;
constexpr double kNanoseconds = 1e-9;

/// A message by value, whatever its type.
struct AnyMessage {
  alignas(8) unsigned char bytes[kLargestMessage];
  const odo_header& header() const { return *reinterpret_cast<const odo_header*>(bytes); }
  odo_header& header() { return *reinterpret_cast<odo_header*>(bytes); }
  /// Copies what both sides know of the message and zeroes the rest. False when it is smaller than version 1.0.
  bool assign(const odo_header& message);
};

/// A message by value that owns the hold of its frame, if it is one: whoever has it last gives the frame back.
class OwnedMessage {
 public:
  OwnedMessage() { message_.header().type = 0; }
  /// Copies the message (of a type the host knows) and takes over the hold of a frame.
  explicit OwnedMessage(const odo_header& message) {
    if (!message_.assign(message)) message_.header().type = 0;
  }
  OwnedMessage(OwnedMessage&& other) noexcept { take(other); }
  OwnedMessage& operator=(OwnedMessage&& other) noexcept {
    if (this == &other) return *this;
    release();
    take(other);
    return *this;
  }
  ~OwnedMessage() { release(); }

  const odo_header& header() const { return message_.header(); }
  odo_header& header() { return message_.header(); }
  bool empty() const { return header().type == 0; }
  /// Gives the frame back and is empty. Calls out of the host: hold no lock.
  void release() {
    if (header().type == ODO_TYPE_FRAME) {
      const auto& frame = as<odo_frame>(header());
      if (frame.release) frame.release(&frame);
    }
    header().type = 0;
  }

 private:
  void take(OwnedMessage& other) {
    if (!other.empty()) std::memcpy(message_.bytes, other.message_.bytes, other.header().struct_size);
    header().type = other.empty() ? 0 : header().type;
    other.header().type = 0;
  }

  AnyMessage message_;
};

}  // namespace odograph
