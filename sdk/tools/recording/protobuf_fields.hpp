// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <span>

namespace odograph::phone {

/// A field of an encoded Protocol Buffers message (protobuf.dev/programming-guides/encoding).
struct ProtobufField {
  uint32_t number = 0;
  enum class Kind { varint, fixed64, bytes, fixed32 } kind = Kind::varint;
  uint64_t value = 0;                      ///< of a varint or a fixed-size field
  std::span<const unsigned char> bytes{};  ///< of a message, a string, packed values

  float as_float() const {
    const auto bits = static_cast<uint32_t>(value);
    float number_of_bits = 0;
    std::memcpy(&number_of_bits, &bits, sizeof bits);
    return number_of_bits;
  }
};

/// Iterates over a message's fields, up to the last one or damage.
class ProtobufReader {
 public:
  explicit ProtobufReader(std::span<const unsigned char> bytes) : left_(bytes) {}
  bool damaged() const { return damaged_; }

  std::optional<ProtobufField> next() {
    if (left_.empty() || damaged_) return std::nullopt;
    const auto key = varint();
    if (!key) return broken();
    ProtobufField field;
    field.number = static_cast<uint32_t>(*key >> 3);
    switch (*key & 7) {
      case 0: {
        const auto value = varint();
        if (!value) return broken();
        field.value = *value;
        return field;
      }
      case 1: field.kind = ProtobufField::Kind::fixed64; return fixed(field, 8);
      case 2: {
        field.kind = ProtobufField::Kind::bytes;
        const auto size = varint();
        if (!size || *size > left_.size()) return broken();
        field.bytes = left_.first(static_cast<size_t>(*size));
        left_ = left_.subspan(static_cast<size_t>(*size));
        return field;
      }
      case 5: field.kind = ProtobufField::Kind::fixed32; return fixed(field, 4);
      default: return broken();
    }
  }

 private:
  std::optional<ProtobufField> broken() {
    damaged_ = true;
    return std::nullopt;
  }
  std::optional<ProtobufField> fixed(ProtobufField& field, size_t size) {
    if (left_.size() < size) return broken();
    std::memcpy(&field.value, left_.data(), size);
    left_ = left_.subspan(size);
    return field;
  }
  std::optional<uint64_t> varint() {
    uint64_t value = 0;
    for (int shift = 0; shift < 64 && !left_.empty(); shift += 7) {
      const unsigned char byte = left_.front();
      left_ = left_.subspan(1);
      value |= static_cast<uint64_t>(byte & 0x7F) << shift;
      if (!(byte & 0x80)) return value;
    }
    return std::nullopt;
  }

  std::span<const unsigned char> left_;
  bool damaged_ = false;
};

}  // namespace odograph::phone
