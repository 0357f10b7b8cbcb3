// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <odograph/recording.h>

#include "sdk/host/base/output_file.hpp"
#include "sdk/host/base/result.hpp"
#include "sdk/host/messages/messages.hpp"

namespace odograph {

/// What was lost from a recording.
struct RecordLoss {
  uint64_t records_read = 0;
  std::optional<uint64_t> records_lost;  ///< known only if the end mark is present
  uint64_t bytes = 0;                    ///< that belong to no complete record
  uint64_t places = 0;                   ///< number of separate damaged stretches
  uint64_t first_at = 0;                 ///< offset of the first one
  bool cut = false;                      ///< it lacks the end mark that its writer would have set
  uint64_t unreadable = 0;               ///< records that could be read once, but not again

  bool any() const { return bytes > 0 || cut || records_lost.value_or(0) > 0 || unreadable > 0; }
  /// "damaged at 2 places from byte 4711 on, 320 bytes; 2 of 400 records are lost", or empty.
  std::string text() const;
};

/// Reader of the recording file format, *.odo: a file header, then records with size and checksum. After damage,
/// reading continues at the next complete record; an end mark distinguishes a closed recording from a truncated one.
/// Little-endian.
///
///   header  "ODOREC1\n", u32 version = 2, u32 minor = 0
///   record  u32 "ODOR", u32 type, u32 payload size, u32 CRC-32 of type, size and payload; payload
///   end     a record of type 0x1FFFF: u64 number of records before it
class RecordReader {
 public:
  struct Parameters {
    /// Larger payloads count as damage.
    uint32_t largest_payload = ODO_LARGEST_MESSAGE + ODO_LARGEST_PICTURE;
    /// Scan budget in multiples of the file size: checksums of false record starts cost at most this much, so that no
    /// file takes quadratic time. Natural damage needs less than one.
    uint64_t scan_budget = 8;
  };

  static Result<RecordReader> open(const std::filesystem::path& file);
  /// Whether a file begins like a recording, even with a damaged header.
  static bool has_signature(const std::filesystem::path& file);

  /// Advances to the next complete record; false at the end of the file.
  bool next();
  uint32_t type() const { return type_; }
  std::span<const unsigned char> payload() const { return payload_; }
  /// Offset of the payload in the file.
  uint64_t payload_offset() const { return payload_offset_; }
  /// The record as a message: its writer's struct, followed by the picture of a frame. False if the record is not a
  /// message.
  bool message(AnyMessage& out, std::span<const unsigned char>& picture) const;
  /// The losses found so far; complete once next() has returned false.
  const RecordLoss& loss() const { return loss_; }
  /// Reads the record at a payload_offset() returned before. False if it is not readable any more, which is a loss.
  bool read_at(uint64_t payload_offset);

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
  uint64_t scan_budget_left_ = 0;
  std::optional<uint64_t> written_;  // from the end mark
  bool finished_ = false;
  RecordLoss loss_;
  std::vector<unsigned char> payload_;
};

class RecordWriter {
 public:
  /// An existing file remains until finish().
  static Result<RecordWriter> create(const std::filesystem::path& file);

  /// False if writing failed, or if the payload is larger than a reader accepts.
  bool write(uint32_t type, std::span<const unsigned char> head, std::span<const unsigned char> tail = {});
  /// Writes a message, without the pointers of a frame, and its picture. False also for an invalid message.
  bool write(const odo_header& message, std::span<const unsigned char> picture);
  /// Flushes to the operating system: the data survives a crash of the program.
  bool flush();
  /// Writes the end mark and moves the file to its path. If this or an earlier write fails, the previous file remains.
  Result<bool> finish();
  /// Leaves the incomplete file in place, without an end mark.
  void abandon() { file_.abandon(); }

 private:
  explicit RecordWriter(OutputFile file) : file_(std::move(file)) {}

  OutputFile file_;
  uint64_t records_ = 0;
};

}  // namespace odograph
