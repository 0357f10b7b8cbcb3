// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sdk/host/base/output_file.hpp"
#include "sdk/host/base/result.hpp"
#include "sdk/host/messages/messages.hpp"

namespace odograph {

/// What a recording lacks of what was written.
struct RecordLoss {
  uint64_t records_read = 0;
  std::optional<uint64_t> records_lost;  ///< where the end mark is there to tell
  uint64_t bytes = 0;                    ///< that belong to no whole record
  uint64_t places = 0;                   ///< separate stretches of them
  uint64_t first_at = 0;                 ///< byte at which the first one begins
  bool cut = false;                      ///< it ends without the end mark that its writer would have set

  bool any() const { return bytes > 0 || cut || records_lost.value_or(0) > 0; }
  /// "damaged at 2 places from byte 4711 on, 320 bytes; 2 of 400 records are lost", or empty.
  std::string text() const;
};

/// The file format of recordings, *.odo: a file header and then records, each with its size and a checksum. Behind
/// damage reading goes on at the next whole record; an end mark tells a recording that was closed from one that was cut
/// off. Little-endian.
///
///   header  "ODOREC1\n", u32 version = 2, u32 minor = 0
///   record  u32 "ODOR", u32 type, u32 payload size, u32 CRC-32 of type, size and payload; payload
///   end     a record of type 0x1FFFF: u64 number of records before it
class RecordReader {
 public:
  struct Parameters {
    /// Larger payloads are damage. Judgement: four times an uncompressed picture of 16 megapixels.
    uint32_t largest_payload = 64u << 20;
    /// How many times the file's size may be spent on checksums of what only looks like a record, so that no file takes
    /// quadratic time. Natural damage needs less than one.
    uint64_t effort = 8;
  };

  static Result<RecordReader> open(const std::filesystem::path& file);
  /// Whether a file begins like a recording, be its header damaged.
  static bool looks_like_one(const std::filesystem::path& file);

  /// The next whole record, or false at the end of the file.
  bool next();
  uint32_t type() const { return type_; }
  std::span<const unsigned char> payload() const { return payload_; }
  /// Of the payload, in the file.
  uint64_t payload_offset() const { return payload_offset_; }
  /// The record as a message: its writer's struct, and behind it, of a
  /// frame, the picture. False when the record is none.
  bool message(AnyMessage& out, std::span<const unsigned char>& picture) const;
  /// What has been found missing; complete once next() has returned false.
  const RecordLoss& loss() const { return loss_; }
  /// Goes on at a payload_offset() of before.
  void go_to(uint64_t payload_offset);

 private:
  enum class Found { record, end, damage };
  Found read_here(uint32_t& type);
  bool is_record_at(uint64_t offset);
  uint64_t end_of_damage();
  void skip_damage();
  void finish();

  Parameters parameters_;
  std::ifstream in_;
  uint64_t size_ = 0;
  uint32_t type_ = 0;
  uint64_t offset_ = 16, payload_offset_ = 0;
  uint64_t effort_left_ = 0;
  std::optional<uint64_t> written_;  // as the end mark says
  bool finished_ = false;
  RecordLoss loss_;
  std::vector<unsigned char> payload_;
};

class RecordWriter {
 public:
  /// A file that is there already stays until finish().
  static Result<RecordWriter> create(const std::filesystem::path& file);

  /// False when it could not be written.
  bool write(uint32_t type, std::span<const unsigned char> head, std::span<const unsigned char> tail = {});
  /// A message without the pointers of a frame, and its picture. False also for one that is no message.
  bool write(const odo_header& message, std::span<const unsigned char> picture);
  /// Hands what has been written to the operating system: it outlives a crash of the program.
  bool flush() { return static_cast<bool>(file_.stream().flush()); }
  /// Sets the end mark and puts the file in its place. A failure of this or of a write leaves there what was there.
  Result<bool> finish();
  /// Leaves what has been written without an end mark, where it lies.
  void abandon() { file_.abandon(); }

 private:
  explicit RecordWriter(OutputFile file) : file_(std::move(file)) {}

  OutputFile file_;
  uint64_t records_ = 0;
};

}  // namespace odograph
