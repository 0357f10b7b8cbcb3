// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <odograph/messages.h>

namespace odograph {

/// Properties of a message type known to the host: its name in files and its struct size, now and in version 1.0.
struct MessageInfo {
  uint32_t type;
  const char* name;
  size_t size;      // of the host's struct
  size_t min_size;  // of version 1.0: smaller structs are refused
};

/// Null for an unknown type.
const MessageInfo* message_info(uint32_t type);
/// Smaller structs are refused: the size of version 1.0, or the header size for an unknown type.
size_t min_size(uint32_t type);
/// "imu", "fix", or the number of an unknown type.
std::string message_name(uint32_t type);
/// Times further from the clock's zero are refused, so that the difference of two never overflows: 146 years, more than
/// any clock's epoch.
constexpr int64_t kFarthestTime_ns = int64_t(1) << 62;
constexpr bool is_plausible_time(int64_t t_ns) { return t_ns >= -kFarthestTime_ns && t_ns <= kFarthestTime_ns; }

/// Whether an app may push the type: everything but events and reserved numbers.
inline bool is_input(uint32_t type) { return !ODO_IS_EVENT(type) && !ODO_IS_RESERVED(type); }

/// Whether an input describes a sensor, an antenna or a map: it is kept for plugins that are reset.
inline bool is_description(const odo_header& input) {
  return input.type == ODO_TYPE_CALIBRATION || input.type == ODO_TYPE_IMU_NOISE || input.type == ODO_TYPE_EARTH_FIELD ||
         (input.flags & ODO_FLAG_DESCRIPTION) != 0;
}

/// Why a message is unusable, as "field = value; expected ...": a time out of range, a valid-flagged number that is not
/// finite or out of range, a quaternion whose norm differs from 1 by more than 1e-3. Empty if usable. Only for messages
/// known to be as large as the host's struct (AnyMessage).
std::string message_fault(const odo_header& message);
/// The same for a message in a recording, where a frame's size and pixels are its picture's, and events come from
/// another host.
std::string recorded_fault(const odo_header& message);
inline bool message_is_good(const odo_header& message) { return message_fault(message).empty(); }

/// A zero-initialised message with size, type and time set.
template <class Message>
Message make_message(uint32_t type, int64_t t_ns) {
  Message message;
  std::memset(static_cast<void*>(&message), 0, sizeof message);
  message.header.struct_size = sizeof(Message);
  message.header.type = type;
  message.header.t_ns = t_ns;
  return message;
}

/// The message behind a header whose type has been checked.
template <class Message>
const Message& as(const odo_header& header) {
  return reinterpret_cast<const Message&>(header);
}

/// A copy of the message with the host's struct size: excess fields are dropped, missing ones are zero.
template <class Message>
Message copy_as(const odo_header& header) {
  Message message{};
  std::memcpy(static_cast<void*>(&message), &header, std::min<size_t>(header.struct_size, sizeof message));
  message.header.struct_size = sizeof message;
  return message;
}

constexpr double kNanoseconds = 1e-9;

/// A message of any type by value, from any writer: a newer writer's extra fields are retained, an older writer's
/// missing fields are zero, and struct_size stays the writer's. There is always room for the host's struct. Messages
/// larger than the host's own are stored on the heap, in memory that the next one of the same object uses again.
class AnyMessage {
 public:
  /// Objects of one owner that keep this memory from sample to sample: 1 MiB of the largest messages.
  static constexpr size_t kKeptLarge = (1 << 20) / ODO_LARGEST_MESSAGE;

  AnyMessage() { std::memset(inside_, 0, sizeof(odo_header)); }
  explicit AnyMessage(const odo_header& message) : AnyMessage() { assign(message); }
  AnyMessage(const AnyMessage& other) { copy(other); }
  AnyMessage& operator=(const AnyMessage& other) {
    if (this != &other) copy(other);
    return *this;
  }
  AnyMessage(AnyMessage&& other) noexcept { take(other); }
  AnyMessage& operator=(AnyMessage&& other) noexcept {
    if (this != &other) take(other);
    return *this;
  }

  const odo_header& header() const { return *reinterpret_cast<const odo_header*>(data()); }
  odo_header& header() { return *reinterpret_cast<odo_header*>(data()); }
  /// The bytes as written.
  std::span<const unsigned char> bytes() const { return {data(), header().struct_size}; }
  /// False, and nothing done, if it is smaller than in version 1.0 or larger than any message may be.
  bool assign(const odo_header& message);
  /// Becomes empty and frees the memory of a large message.
  void release_memory() { *this = AnyMessage(), outside_.shrink_to_fit(); }

 private:
  static constexpr size_t kInside = 640;
  unsigned char* data() { return outside_.empty() ? inside_ : reinterpret_cast<unsigned char*>(outside_.data()); }
  const unsigned char* data() const { return const_cast<AnyMessage*>(this)->data(); }
  void copy(const AnyMessage& other) {
    capacity_ = other.capacity_;
    outside_ = other.outside_;
    if (outside_.empty()) std::memcpy(inside_, other.inside_, capacity_);
  }
  void take(AnyMessage& other) noexcept {
    capacity_ = other.capacity_;
    outside_ = std::move(other.outside_);
    if (outside_.empty()) std::memcpy(inside_, other.inside_, capacity_);
    other.capacity_ = sizeof(odo_header);
    other.outside_.clear();
  }

  alignas(8) unsigned char inside_[kInside];
  size_t capacity_ = sizeof(odo_header);
  std::vector<uint64_t> outside_;
};

/// A set of message types with fast lookup. [any, once built]
class TypeSet {
 public:
  static TypeSet all() {
    TypeSet set;
    set.all_ = true;
    return set;
  }
  void add(uint32_t type) {
    known_ |= bit(type);
    if (bit(type) == 0 && !has(type)) others_.push_back(type);
  }
  bool has(uint32_t type) const {
    if (all_) return true;
    if (const uint64_t own = bit(type)) return (known_ & own) != 0;
    return !others_.empty() && std::find(others_.begin(), others_.end(), type) != others_.end();
  }
  bool empty() const { return !all_ && known_ == 0 && others_.empty(); }

 private:
  /// Frames have bit 0; inputs below 32 and the first 32 events have one bit each.
  static uint64_t bit(uint32_t type) {
    if (type == ODO_TYPE_FRAME) return 1;
    if (type < 32) return type == 0 ? 0 : uint64_t(1) << type;
    return type - 0x1000 < 32 ? uint64_t(1) << (type - 0x1000 + 32) : 0;
  }

  bool all_ = false;
  uint64_t known_ = 0;
  std::vector<uint32_t> others_;
};

/// A message by value that owns the reference of its loan, if it is borrowed: the last owner releases it.
class OwnedMessage {
 public:
  OwnedMessage() = default;
  /// Takes ownership of the message and the reference of its loan.
  explicit OwnedMessage(AnyMessage&& message) : message_(std::move(message)) {}
  explicit OwnedMessage(const odo_header& message) : message_(message) {}
  OwnedMessage(OwnedMessage&& other) noexcept : message_(std::move(other.message_)) { other.header().type = 0; }
  OwnedMessage& operator=(OwnedMessage&& other) noexcept {
    if (this == &other) return *this;
    release();
    message_ = std::move(other.message_);
    other.header().type = 0;
    return *this;
  }
  ~OwnedMessage() { release(); }

  const odo_header& header() const { return message_.header(); }
  odo_header& header() { return message_.header(); }
  bool empty() const { return header().type == 0; }
  /// Copies a message into an empty one (AnyMessage::assign), which then owns the reference of its loan.
  bool assign(const odo_header& message) { return message_.assign(message); }
  /// Becomes empty without releasing the loan.
  void disown() { header().type = 0; }
  /// Releases the loan and becomes empty. Calls foreign code: hold no lock.
  void release() {
    if (ODO_IS_BORROWED(header().type)) {
      const odo_loan& loan = as<odo_borrowed>(header()).loan;
      if (loan.release) loan.release(loan.owner);
    }
    header().type = 0;
  }

 private:
  AnyMessage message_;
};

}  // namespace odograph
