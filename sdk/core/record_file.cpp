// SPDX-License-Identifier: Apache-2.0
#include "sdk/core/record_file.hpp"

#include <array>
#include <cstring>

namespace odograph {
namespace {

constexpr char kMagic[8] = {'O', 'D', 'O', 'R', 'E', 'C', '1', '\n'};
constexpr uint32_t kRecord = 0x524F444F;  // "ODOR"
constexpr uint32_t kLargestPayload = 64u << 20;
constexpr uint32_t kVersion = 1, kMinor = 1;

struct RecordHead {
  uint32_t magic, type, size, crc;
};
static_assert(sizeof(RecordHead) == 16);

/// CRC-32 of ISO 3309 (as in PNG and zlib), byte by byte with a table.
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

/// Of the files of minor version 0, before events had a range of their own.
uint32_t renumbered(uint32_t type) { return type >= 16 && type <= 24 ? ODO_TYPE_ATTITUDE + (type - 16) : type; }

void forget_pointers(odo_frame& frame) {  // they mean nothing in a file
  for (auto& plane : frame.planes) plane = {};
  frame.mask = {};
  frame.owner = nullptr;
  frame.retain = nullptr;
  frame.release = nullptr;
  frame.header.flags &= ~ODO_FRAME_MASK;
}

}  // namespace

Result<RecordReader> RecordReader::open(const std::filesystem::path& file) {
  RecordReader reader;
  reader.in_.open(file, std::ios::binary);
  if (!reader.in_) return Failure{ODO_E_NOT_FOUND, file.string() + ": cannot be opened"};
  char magic[8] = {};
  uint32_t version[2] = {};
  reader.in_.read(magic, sizeof magic);
  reader.in_.read(reinterpret_cast<char*>(version), sizeof version);
  if (!reader.in_ || std::memcmp(magic, kMagic, sizeof magic) != 0)
    return Failure{ODO_E_DATA, file.string() + ": not an Odograph recording"};
  if (version[0] != kVersion)
    return Failure{ODO_E_VERSION, file.string() + ": recording version " + std::to_string(version[0]) +
                                      "; this program reads version " + std::to_string(kVersion)};
  reader.minor_ = version[1];
  return reader;
}

bool RecordReader::next() {
  RecordHead head{};
  in_.read(reinterpret_cast<char*>(&head), sizeof head);
  if (in_.gcount() == 0) return false;
  bool whole = in_.gcount() == sizeof head && head.magic == kRecord && head.size <= kLargestPayload;
  if (whole) {
    payload_.resize(head.size);
    in_.read(reinterpret_cast<char*>(payload_.data()), head.size);
    whole = in_.gcount() == static_cast<std::streamsize>(head.size) &&
            checksum(head.type, head.size, payload_, {}) == head.crc;
  }
  if (!whole) {
    damaged_at_ = offset_;
    return false;
  }
  type_ = head.type;
  payload_offset_ = offset_ + sizeof head;
  offset_ = payload_offset_ + head.size;
  return true;
}

void RecordReader::go_to(uint64_t payload_offset) {
  in_.clear();
  offset_ = payload_offset - sizeof(RecordHead);
  in_.seekg(static_cast<std::streamoff>(offset_));
}

bool RecordReader::message(AnyMessage& out, std::span<const unsigned char>& picture) const {
  odo_header head;
  if (payload_.size() < sizeof head) return false;
  std::memcpy(&head, payload_.data(), sizeof head);
  if (head.type != type_ || head.struct_size < sizeof head || head.struct_size > payload_.size()) return false;
  std::vector<uint64_t> aligned((head.struct_size + 7) / 8);
  std::memcpy(aligned.data(), payload_.data(), head.struct_size);
  auto& written = *reinterpret_cast<odo_header*>(aligned.data());
  if (minor_ == 0) written.type = renumbered(type_);
  if (!out.assign(written)) return false;
  if (written.type == ODO_TYPE_FRAME) forget_pointers(reinterpret_cast<odo_frame&>(out.header()));
  picture = std::span(payload_).subspan(head.struct_size);
  return true;
}

Result<RecordWriter> RecordWriter::create(const std::filesystem::path& file) {
  RecordWriter writer;
  writer.out_.open(file, std::ios::binary | std::ios::trunc);
  const uint32_t version[2] = {kVersion, kMinor};
  writer.out_.write(kMagic, sizeof kMagic);
  writer.out_.write(reinterpret_cast<const char*>(version), sizeof version);
  if (!writer.out_) return Failure{ODO_E_NOT_FOUND, file.string() + ": cannot be written"};
  return writer;
}

bool RecordWriter::write(uint32_t type, std::span<const unsigned char> head, std::span<const unsigned char> tail) {
  const auto size = static_cast<uint32_t>(head.size() + tail.size());
  const RecordHead record{kRecord, type, size, checksum(type, size, head, tail)};
  out_.write(reinterpret_cast<const char*>(&record), sizeof record);
  out_.write(reinterpret_cast<const char*>(head.data()), static_cast<std::streamsize>(head.size()));
  out_.write(reinterpret_cast<const char*>(tail.data()), static_cast<std::streamsize>(tail.size()));
  return static_cast<bool>(out_);
}

bool RecordWriter::write(const odo_header& message, std::span<const unsigned char> picture) {
  AnyMessage copy;
  if (message.type == 0 || !copy.assign(message)) return false;
  if (message.type == ODO_TYPE_FRAME) forget_pointers(reinterpret_cast<odo_frame&>(copy.header()));
  return write(message.type, copy.bytes(), picture);
}

}  // namespace odograph
