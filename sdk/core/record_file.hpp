// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "sdk/base/result.hpp"
#include "sdk/core/messages.hpp"

namespace odograph {

/// The file format of recordings, *.odo: a file header and then records, each with its size and a checksum, so that
/// after a crash everything up to the last whole record is there. Little-endian.
///
///   header  "ODOREC1\n", u32 version = 1, u32 minor = 1 (0: events were numbered from 16)
///   record  u32 "ODOR", u32 type, u32 payload size, u32 CRC-32 of type, size and payload; payload
class RecordReader {
 public:
  static Result<RecordReader> open(const std::filesystem::path& file);

  /// The next whole record, or false at the end of what can be read; damaged() says which of the two ends it is.
  bool next();
  uint32_t type() const { return type_; }
  std::span<const unsigned char> payload() const { return payload_; }
  /// Of the payload, in the file.
  uint64_t payload_offset() const { return payload_offset_; }
  /// The record as a message: its writer's struct, renumbered where the file is of minor version 0, and behind it, of a
  /// frame, the picture. False when the record is none.
  bool message(AnyMessage& out, std::span<const unsigned char>& picture) const;
  /// Byte at which the file is damaged or cut off, or 0.
  uint64_t damaged_at() const { return damaged_at_; }
  /// Goes on at a payload_offset() of before.
  void go_to(uint64_t payload_offset);

 private:
  std::ifstream in_;
  uint32_t minor_ = 0, type_ = 0;
  uint64_t offset_ = 16, payload_offset_ = 0, damaged_at_ = 0;
  std::vector<unsigned char> payload_;
};

class RecordWriter {
 public:
  static Result<RecordWriter> create(const std::filesystem::path& file);

  /// False when it could not be written.
  bool write(uint32_t type, std::span<const unsigned char> head, std::span<const unsigned char> tail = {});
  /// A message without the pointers of a frame, and its picture. False also for one that is no message.
  bool write(const odo_header& message, std::span<const unsigned char> picture);
  /// True when everything has reached the operating system.
  bool flush() { return static_cast<bool>(out_.flush()); }

 private:
  std::ofstream out_;
};

}  // namespace odograph
