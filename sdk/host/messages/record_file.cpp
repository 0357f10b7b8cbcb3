// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/messages/record_file.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>
#include <utility>

#include "sdk/host/platform/file_access.hpp"

namespace odograph {
namespace {

constexpr char kMagic[8] = {'O', 'D', 'O', 'R', 'E', 'C', '1', '\n'};
constexpr uint32_t kRecord = 0x524F444F;                   // "ODOR"
constexpr size_t kFirstChunk = 4096, kMaxChunk = 1 << 20;  // bytes read at once while scanning for the next record
constexpr uint64_t kMinCheckCost = 4096;                   // minimum cost of checking one offset, bytes
constexpr uint64_t kMinScanBudget = 16u << 20;             // minimum scan budget, for small files
constexpr uint32_t kEndMark = 0x1FFFF;
constexpr uint32_t kFormatVersion = 2, kMinor = 0;

struct RecordHead {
  uint32_t magic, type, size, crc;
};
static_assert(sizeof(RecordHead) == 16);

/// CRC-32 of ISO 3309 (as in PNG and zlib), table-driven, one byte at a time.
class Crc32 {
 public:
  void add(std::span<const unsigned char> bytes) {
    static const auto table = [] {
      std::array<uint32_t, 256> t{};
      for (uint32_t i = 0; i < 256; ++i) {
        uint32_t c = i;
        for (int k = 0; k < 8; ++k) c = c & 1 ? 0xEDB88320u ^ (c >> 1) : c >> 1;
        t[i] = c;
      }
      return t;
    }();
    for (const unsigned char byte : bytes) state_ = table[(state_ ^ byte) & 0xFF] ^ (state_ >> 8);
  }
  uint32_t value() const { return ~state_; }

 private:
  uint32_t state_ = 0xFFFFFFFFu;
};

uint32_t checksum(uint32_t type, uint32_t size, std::span<const unsigned char> head,
                  std::span<const unsigned char> tail) {
  const uint32_t numbers[2] = {type, size};
  Crc32 crc;
  crc.add({reinterpret_cast<const unsigned char*>(numbers), sizeof numbers});
  crc.add(head);
  crc.add(tail);
  return crc.value();
}

void clear_pointers(odo_frame& frame) {  // pointers are meaningless in a file
  for (auto& plane : frame.planes) plane = {};
  frame.mask = {};
  frame.loan = {};
  frame.header.flags &= ~ODO_FRAME_MASK;
}

}  // namespace

std::string RecordLoss::text() const {
  std::string said;
  const auto add = [&said](const std::string& more) { said += (said.empty() ? "" : "; ") + more; };
  if (bytes > 0)
    add("damaged at " + std::to_string(places) + (places == 1 ? " place" : " places") + " from byte " +
        std::to_string(first_at) + " on, " + std::to_string(bytes) + " bytes are unreadable");
  if (cut) add("cut off, or never closed: its end mark is missing");
  if (bytes > 0 || cut || records_lost.value_or(0) > 0)
    add(records_lost ? std::to_string(*records_lost) + " of " + std::to_string(records_read + *records_lost) +
                           " records are lost"
                     : std::to_string(records_read) + " records were read, the number lost is unknown");
  if (unreadable > 0)
    add(std::to_string(unreadable) + (unreadable == 1 ? " record" : " records") +
        " could be read when it was opened, but not later");
  return said;
}

bool RecordReader::has_signature(const std::filesystem::path& file) {
  char head[20] = {};
  std::ifstream(file, std::ios::binary).read(head, sizeof head);
  return std::memcmp(head, kMagic, sizeof kMagic - 2) == 0 || std::memcmp(head + 16, &kRecord, sizeof kRecord) == 0;
}

Result<RecordReader> RecordReader::open(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::exists(file, error) && !std::filesystem::is_regular_file(file, error))
    return Failure{ODO_E_IO, file.string() + ": not a file; a pipe or a device cannot be read as a recording"};
  RecordReader reader;
  reader.in_.open(file, std::ios::binary);
  if (!reader.in_)
    return Failure{std::filesystem::exists(file, error) ? ODO_E_IO : ODO_E_NOT_FOUND,
                   file.string() + ": cannot be opened"};
  reader.size_ = std::filesystem::file_size(file, error);
  reader.scan_budget_left_ = reader.parameters_.scan_budget * reader.size_ + kMinScanBudget;
  char magic[8] = {};
  uint32_t version[2] = {};
  reader.in_.read(magic, sizeof magic);
  reader.in_.read(reinterpret_cast<char*>(version), sizeof version);
  const bool damaged_head = std::memcmp(magic, kMagic, sizeof magic) != 0;
  if (!reader.in_ || (damaged_head && !reader.is_record_at(16)))
    return Failure{ODO_E_DATA, file.string() + ": not an Odograph recording"};
  if (!damaged_head && version[0] != kFormatVersion)
    return Failure{ODO_E_VERSION, file.string() + ": recording version " + std::to_string(version[0]) +
                                      (version[0] == 1 ? ", of a draft of the ABI" : "") +
                                      "; this program reads version " + std::to_string(kFormatVersion)};
  if (damaged_head) reader.loss_.bytes = sizeof magic, reader.loss_.places = 1;
  reader.in_.seekg(16);
  return reader;
}

RecordReader::Found RecordReader::read_here(uint32_t& type) {
  if (offset_ >= size_) return Found::end;  // what a file has gained since it was opened is not read
  RecordHead head{};
  in_.read(reinterpret_cast<char*>(&head), sizeof head);
  if (in_.gcount() == 0) return Found::end;
  if (in_.gcount() != sizeof head || head.magic != kRecord || head.size > parameters_.largest_payload ||
      head.size > size_ - std::min(size_, offset_ + sizeof head))
    return Found::damage;
  payload_.resize(head.size);
  in_.read(reinterpret_cast<char*>(payload_.data()), head.size);
  if (in_.gcount() != static_cast<std::streamsize>(head.size) ||
      checksum(head.type, head.size, payload_, {}) != head.crc)
    return Found::damage;
  type = head.type;
  return Found::record;
}

bool RecordReader::next() {
  for (;;) {
    uint32_t type = 0;
    const Found found = read_here(type);
    if (found == Found::damage) {
      skip_damage();
      continue;
    }
    if (found == Found::end) {
      finish();
      return false;
    }
    payload_offset_ = offset_ + sizeof(RecordHead);
    offset_ = payload_offset_ + payload_.size();
    if (type == kEndMark && payload_.size() >= sizeof(uint64_t)) {
      std::memcpy(&written_.emplace(), payload_.data(), sizeof(uint64_t));
      continue;
    }
    type_ = type;
    if (!finished_) ++loss_.records_read;
    return true;
  }
}

void RecordReader::finish() {
  if (std::exchange(finished_, true)) return;
  if (written_)
    loss_.records_lost = *written_ - std::min(*written_, loss_.records_read);
  else
    loss_.cut = true;
}

void RecordReader::skip_damage() {
  const uint64_t begin = offset_;
  offset_ = end_of_damage();
  in_.clear();
  in_.seekg(static_cast<std::streamoff>(offset_));
  if (finished_) return;
  if (loss_.places++ == 0) loss_.first_at = begin;
  loss_.bytes += offset_ - begin;
}

/// Whether a complete record begins at the offset. A failed check is charged to the scan budget.
bool RecordReader::is_record_at(uint64_t offset) {
  RecordHead head{};
  scan_budget_left_ -= std::min(scan_budget_left_, kMinCheckCost);
  in_.clear();
  in_.seekg(static_cast<std::streamoff>(offset));
  in_.read(reinterpret_cast<char*>(&head), sizeof head);
  if (in_.gcount() != sizeof head || head.magic != kRecord || head.size > parameters_.largest_payload ||
      head.size > size_ - std::min(size_, offset + sizeof head) || head.size > scan_budget_left_)
    return false;
  payload_.resize(head.size);
  in_.read(reinterpret_cast<char*>(payload_.data()), head.size);
  if (in_.gcount() == static_cast<std::streamsize>(head.size) &&
      checksum(head.type, head.size, payload_, {}) == head.crc)
    return true;
  scan_budget_left_ -= head.size;
  return false;
}

/// Offset of the next complete record, or the end of the file. If the damaged record's own size leads to a record, that
/// one is taken: anything inside the payload that resembles a record is not one.
uint64_t RecordReader::end_of_damage() {
  RecordHead head{};
  in_.clear();
  in_.seekg(static_cast<std::streamoff>(offset_));
  in_.read(reinterpret_cast<char*>(&head), sizeof head);
  const uint64_t by_size = offset_ + sizeof head + head.size;
  if (in_.gcount() == sizeof head && head.magic == kRecord && (by_size == size_ || is_record_at(by_size)))
    return by_size;
  constexpr std::string_view kMark("ODOR");
  std::vector<char> part(kFirstChunk);
  for (uint64_t at = offset_ + 1; at + sizeof head <= size_;) {
    in_.clear();
    in_.seekg(static_cast<std::streamoff>(at));
    in_.read(part.data(), static_cast<std::streamsize>(part.size()));
    const std::string_view text(part.data(), static_cast<size_t>(in_.gcount()));
    if (text.size() < kMark.size()) break;
    for (size_t found = text.find(kMark); found != text.npos; found = text.find(kMark, found + 1)) {
      if (scan_budget_left_ == 0) return size_;
      if (is_record_at(at + found)) return at + found;
    }
    at += text.size() - (kMark.size() - 1);
    part.resize(std::min(2 * part.size(), kMaxChunk));  // the next record is usually near
  }
  return size_;
}

bool RecordReader::read_at(uint64_t payload_offset) {
  in_.clear();
  offset_ = payload_offset - sizeof(RecordHead);
  in_.seekg(static_cast<std::streamoff>(offset_));
  ++loss_.unreadable;  // until it is read, also if memory runs out
  if (read_here(type_) != Found::record) return false;
  --loss_.unreadable;
  payload_offset_ = payload_offset;
  return true;
}

bool RecordReader::message(AnyMessage& out, std::span<const unsigned char>& picture) const {
  odo_header head;
  if (payload_.size() < sizeof head) return false;
  std::memcpy(&head, payload_.data(), sizeof head);
  if (head.type != type_ || head.struct_size < sizeof head || head.struct_size > payload_.size()) return false;
  std::vector<uint64_t> aligned((head.struct_size + 7) / 8);
  std::memcpy(aligned.data(), payload_.data(), head.struct_size);
  auto& written = *reinterpret_cast<odo_header*>(aligned.data());
  if (!out.assign(written)) return false;
  if (written.type == ODO_TYPE_FRAME) clear_pointers(reinterpret_cast<odo_frame&>(out.header()));
  picture = std::span(payload_).subspan(head.struct_size);
  return true;
}

Result<RecordWriter> RecordWriter::create(const std::filesystem::path& file) {
  auto out = OutputFile::create(file, OutputFile::PartFile::if_exists);
  if (!out) return out.failure();
  RecordWriter writer(std::move(*out));
  const uint32_t version[2] = {kFormatVersion, kMinor};
  writer.file_.stream().write(kMagic, sizeof kMagic);
  writer.file_.stream().write(reinterpret_cast<const char*>(version), sizeof version);
  return writer;
}

Result<bool> RecordWriter::finish() {
  const uint64_t records = records_;
  if (file_.stream()) write(kEndMark, {reinterpret_cast<const unsigned char*>(&records), sizeof records});
  return file_.commit();
}

bool RecordWriter::write(uint32_t type, std::span<const unsigned char> head, std::span<const unsigned char> tail) {
  const FileSizeLimit limit;
  auto& out = file_.stream();
  if (uint64_t(head.size()) + tail.size() > RecordReader::Parameters().largest_payload) return false;
  const auto size = static_cast<uint32_t>(head.size() + tail.size());
  const RecordHead record{kRecord, type, size, checksum(type, size, head, tail)};
  out.write(reinterpret_cast<const char*>(&record), sizeof record);
  out.write(reinterpret_cast<const char*>(head.data()), static_cast<std::streamsize>(head.size()));
  out.write(reinterpret_cast<const char*>(tail.data()), static_cast<std::streamsize>(tail.size()));
  ++records_;
  return static_cast<bool>(out);
}

bool RecordWriter::flush() {
  const FileSizeLimit limit;
  return static_cast<bool>(file_.stream().flush());
}

bool RecordWriter::write(const odo_header& message, std::span<const unsigned char> picture) {
  AnyMessage copy;
  if (message.type == 0 || !copy.assign(message)) return false;
  if (message.type == ODO_TYPE_FRAME) clear_pointers(reinterpret_cast<odo_frame&>(copy.header()));
  return write(message.type, copy.bytes(), picture);
}

}  // namespace odograph
