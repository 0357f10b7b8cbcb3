// SPDX-License-Identifier: Apache-2.0
//
// wiki.ros.org/Bags/Format/2.0, mcap.dev/spec.
#include "sdk/tools/recording/message_log.hpp"

#include <algorithm>
#include <cstring>
#include <optional>

#include "sdk/tools/recording/archive.hpp"

namespace odograph {
namespace fs = std::filesystem;

namespace {

constexpr char kBagMagic[] = "#ROSBAG V2.0\n", kMcapMagic[] = "\x89MCAP0\r\n";
constexpr uint64_t kLargestHeader = 1 << 20;  // of a bag's record, and of what precedes a chunk's bytes in MCAP
enum BagOp : uint8_t { kBagMessage = 2, kBagChunk = 5, kBagConnection = 7 };
enum McapOp : uint8_t { kMcapSchema = 3, kMcapChannel = 4, kMcapMessage = 5, kMcapChunk = 6, kMcapDataEnd = 15 };

/// Little-endian numbers and counted strings; reading past the end yields 0 and makes good() false.
class Fields {
 public:
  explicit Fields(Bytes bytes) : bytes_(bytes) {}
  template <class Number>
  Number number() {
    Number value{};
    if (const Bytes raw = take(sizeof value); raw.size() == sizeof value) std::memcpy(&value, raw.data(), sizeof value);
    return value;
  }
  Bytes take(uint64_t size) {
    if (size > bytes_.size() - at_) {
      good_ = false, at_ = bytes_.size();
      return {};
    }
    at_ += size;
    return bytes_.subspan(at_ - size, size);
  }
  std::string text() {
    const Bytes raw = take(number<uint32_t>());
    return {reinterpret_cast<const char*>(raw.data()), raw.size()};
  }
  bool good() const { return good_; }
  bool more() const { return good_ && at_ < bytes_.size(); }
  size_t at() const { return at_; }

 private:
  Bytes bytes_;
  size_t at_ = 0;
  bool good_ = true;
};

/// A bag's header: "name=value" fields, each preceded by its length.
std::map<std::string, std::string> named_fields(Bytes bytes) {
  std::map<std::string, std::string> named;
  for (Fields fields(bytes); fields.more();) {
    const std::string field = fields.text();
    if (const size_t equals = field.find('='); equals != std::string::npos)
      named[field.substr(0, equals)] = field.substr(equals + 1);
  }
  return named;
}

template <class Number>
std::optional<Number> number_of(const std::map<std::string, std::string>& named, const char* name) {
  const auto found = named.find(name);
  if (found == named.end() || found->second.size() != sizeof(Number)) return std::nullopt;
  Number value{};
  std::memcpy(&value, found->second.data(), sizeof value);
  return value;
}

/// Converts ROS 2's "sensor_msgs/msg/Imu" to ROS 1's "sensor_msgs/Imu".
std::string short_type(std::string type) {
  if (const size_t msg = type.find("/msg/"); msg != std::string::npos) type.erase(msg, 4);
  return type;
}

}  // namespace

/// One record, in the file or within a chunk.
struct MessageLog::Record {
  uint8_t op = 0;
  std::map<std::string, std::string> header;  ///< of a bag
  Bytes data;                                 ///< the part in memory
  uint64_t at = 0, size = 0;                  ///< of the data, in the file or the chunk
  std::optional<uint32_t> chunk{};            ///< that contains it
};

bool MessageLog::has_signature(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return false;
  char head[16]{};
  std::ifstream(file, std::ios::binary).read(head, sizeof head);
  return std::memcmp(head, kBagMagic, 13) == 0 || std::memcmp(head, kMcapMagic, 8) == 0;
}

Failure MessageLog::wrong(const std::string& text) const { return {ODO_E_DATA, path_.string() + ": " + text}; }

bool MessageLog::read_at(uint64_t at, uint64_t size, std::vector<unsigned char>& bytes) {
  if (at > size_ || size > size_ - at) return false;
  bytes.resize(size);
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(at));
  return size == 0 || file_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
}

Result<std::shared_ptr<MessageLog>> MessageLog::read(const fs::path& file, const Visit& visit, const Limits& limits) {
  std::shared_ptr<MessageLog> log(new MessageLog(file, limits));
  std::error_code error;
  log->size_ = fs::file_size(file, error);
  log->file_.open(file, std::ios::binary);
  std::vector<unsigned char> head;
  if (error || !log->read_at(0, 13, head)) return log->wrong("neither a ROS bag nor MCAP");
  log->bag_ = std::memcmp(head.data(), kBagMagic, 13) == 0;
  if (!log->bag_ && std::memcmp(head.data(), kMcapMagic, 8) != 0) return log->wrong("neither a ROS bag nor MCAP");
  if (const auto done = log->scan(visit); !done) return done.failure();
  if (log->messages_ == 0) return log->wrong(log->flaw_.empty() ? "no messages in it" : log->flaw_);
  return log;
}

/// Scans the records of the file. Only chunks and messages are read whole; indexes are skipped.
Result<bool> MessageLog::scan(const Visit& visit) {
  std::vector<unsigned char> bytes;
  const auto cut = [&](uint64_t at) {
    flaw_ = "cut off or damaged after " + std::to_string(at) + " of " + std::to_string(size_) + " bytes";
    return true;
  };
  for (uint64_t at = bag_ ? 13 : 8; at < size_;) {
    Record record;
    const uint64_t begin = at;
    if (bag_) {
      if (!read_at(at, 4, bytes)) return cut(begin);
      const uint64_t header = Fields(bytes).number<uint32_t>();
      if (header > kLargestHeader || !read_at(at + 4, header + 4, bytes)) return cut(begin);
      record.header = named_fields(Bytes(bytes).first(header));
      record.op = number_of<uint8_t>(record.header, "op").value_or(0);
      record.size = Fields(Bytes(bytes).subspan(header)).number<uint32_t>();
      at += 8 + header;
    } else {
      if (!read_at(at, 9, bytes)) return cut(begin);
      record.op = bytes[0];
      record.size = Fields(Bytes(bytes).subspan(1)).number<uint64_t>();
      at += 9;
    }
    record.at = at;
    if (record.size > size_ - at) return cut(begin);
    at += record.size;
    if (!bag_ && record.op == kMcapDataEnd) return true;
    const bool chunk = record.op == (bag_ ? uint8_t(kBagChunk) : uint8_t(kMcapChunk));
    const bool wanted = bag_ ? record.op == kBagConnection || record.op == kBagMessage
                             : record.op == kMcapSchema || record.op == kMcapChannel || record.op == kMcapMessage;
    if (!chunk && !wanted) continue;
    if (!chunk && record.size > limits_.chunk_bytes)
      return wrong("a record of " + std::to_string(record.size) + " bytes");
    if (!read_at(record.at, chunk ? std::min(record.size, kLargestHeader) : record.size, bytes)) return cut(begin);
    record.data = bytes;
    if (const auto taken = take(record, visit); !taken) {
      if (taken.failure().status != ODO_E_DISCARD) return taken.failure();
      return cut(begin);
    }
  }
  if (!bag_) flaw_ = "its end is missing: the recording was cut off";
  return true;
}

/// Treats a message outside a chunk as a separate chunk.
Result<bool> MessageLog::take(Record record, const Visit& visit) {
  if (!record.chunk && record.op == (bag_ ? uint8_t(kBagMessage) : uint8_t(kMcapMessage))) {
    record.chunk = static_cast<uint32_t>(chunks_.size());
    chunks_.push_back({record.at, record.size, record.size, ""});
    record.at = 0;
  }
  return bag_ ? take_bag(record, visit) : take_mcap(record, visit);
}

Result<bool> MessageLog::take_bag(const Record& record, const Visit& visit) {
  const Failure damaged{ODO_E_DISCARD, ""};
  if (record.op == kBagChunk) {
    const auto compression = record.header.find("compression");
    const auto size = number_of<uint32_t>(record.header, "size");
    if (record.chunk || compression == record.header.end() || !size) return damaged;
    return take_chunk({record.at, record.size, *size, compression->second == "none" ? "" : compression->second}, visit);
  }
  const auto connection = number_of<uint32_t>(record.header, "conn");
  if (record.op != kBagConnection && record.op != kBagMessage) return true;
  if (!connection) return damaged;
  if (record.op == kBagConnection) {
    const auto named = named_fields(record.data);
    const auto topic = record.header.find("topic"), type = named.find("type");
    if (topic == record.header.end() || type == named.end() || topics_.size() >= limits_.topics) return damaged;
    topics_[*connection] = {topic->second, type->second, "ros1"};
    return true;
  }
  const auto time = record.header.find("time");
  if (time == record.header.end() || time->second.size() != 8) return damaged;
  uint32_t t[2];
  std::memcpy(t, time->second.data(), 8);
  return take_message(*connection, int64_t(t[0]) * 1'000'000'000 + t[1], record.data,
                      {record.chunk.value_or(0), uint32_t(record.at), uint32_t(record.size)}, visit);
}

Result<bool> MessageLog::take_mcap(const Record& record, const Visit& visit) {
  const Failure damaged{ODO_E_DISCARD, ""};
  Fields fields(record.data);
  if (record.op == kMcapChunk) {
    fields.take(16);  // first and last time
    Chunk chunk;
    chunk.unpacked = fields.number<uint64_t>();
    fields.take(4);  // CRC-32
    chunk.compression = fields.text();
    chunk.packed = fields.number<uint64_t>();
    chunk.at = record.at + fields.at();
    if (record.chunk || !fields.good() || chunk.packed > record.size - fields.at()) return damaged;
    return take_chunk(chunk, visit);
  }
  if (record.op == kMcapSchema) {
    const auto id = fields.number<uint16_t>();
    const std::string name = fields.text(), encoding = fields.text();
    if (!fields.good()) return damaged;
    schemas_[id] = {name, encoding};
  } else if (record.op == kMcapChannel) {
    const auto id = fields.number<uint16_t>();
    const auto schema = schemas_.find(fields.number<uint16_t>());
    const std::string topic = fields.text(), encoding = fields.text();
    if (!fields.good()) return damaged;
    topics_[id] = {topic, schema == schemas_.end() ? "" : short_type(schema->second.first), encoding};
  } else if (record.op == kMcapMessage) {
    const auto id = fields.number<uint16_t>();
    fields.take(4);  // sequence number
    const auto t_ns = fields.number<uint64_t>();
    fields.take(8);  // publish time
    if (!fields.good()) return damaged;
    const size_t head = fields.at();
    return take_message(id, static_cast<int64_t>(std::min<uint64_t>(t_ns, INT64_MAX)), record.data.subspan(head),
                        {record.chunk.value_or(0), uint32_t(record.at + head), uint32_t(record.size - head)}, visit);
  }
  return true;
}

Result<bool> MessageLog::take_message(uint64_t topic, int64_t t_ns, Bytes data, LogPlace place, const Visit& visit) {
  const auto found = topics_.find(topic);
  if (found == topics_.end()) return Failure{ODO_E_DISCARD, ""};
  if (++messages_ > limits_.messages) return wrong("more than " + std::to_string(limits_.messages) + " messages");
  return visit(found->second, t_ns, place, data);
}

/// Scans all records of a chunk.
Result<bool> MessageLog::take_chunk(Chunk chunk, const Visit& visit) {
  const auto number = static_cast<uint32_t>(chunks_.size());
  chunks_.push_back(chunk);
  std::vector<unsigned char> bytes;
  if (const auto unpacked = unpack(chunk, bytes); !unpacked) return unpacked.failure();
  Fields fields{Bytes(bytes)};
  while (fields.more()) {
    Record record;
    record.chunk = number;
    if (bag_) {
      record.header = named_fields(fields.take(fields.number<uint32_t>()));
      record.op = number_of<uint8_t>(record.header, "op").value_or(0);
      record.size = fields.number<uint32_t>();
    } else {
      record.op = fields.number<uint8_t>();
      record.size = fields.number<uint64_t>();
    }
    record.at = fields.at();
    record.data = fields.take(record.size);
    if (!fields.good()) return Failure{ODO_E_DISCARD, ""};
    if (const auto taken = take(record, visit); !taken) return taken.failure();
  }
  return true;
}

Result<bool> MessageLog::unpack(const Chunk& chunk, std::vector<unsigned char>& bytes) {
  if (chunk.unpacked > limits_.chunk_bytes || chunk.packed > limits_.chunk_bytes)
    return wrong("a chunk of " + std::to_string(std::max(chunk.unpacked, chunk.packed) >> 20) + " MB; expected " +
                 std::to_string(limits_.chunk_bytes >> 20) + " at most");
  if (chunk.compression.empty())
    return read_at(chunk.at, chunk.packed, bytes) ? Result<bool>(true) : Failure{ODO_E_DISCARD, ""};
  if (chunk.compression != "bz2" && chunk.compression != "lz4" && chunk.compression != "zstd")
    return wrong("chunks compressed by '" + chunk.compression.substr(0, 40) + "'; expected bz2, lz4 or zstd");
  std::vector<unsigned char> packed;
  if (!read_at(chunk.at, chunk.packed, packed)) return Failure{ODO_E_DISCARD, ""};
  return unpack_bytes(packed, chunk.unpacked, bytes) ? Result<bool>(true) : Failure{ODO_E_DISCARD, ""};
}

Result<std::vector<unsigned char>> MessageLog::at(LogPlace place) {
  const std::lock_guard lock(mutex_);
  const Failure gone = wrong("a message can no longer be read");
  std::vector<unsigned char> bytes;
  if (place.chunk >= chunks_.size()) return gone;
  const Chunk& chunk = chunks_[place.chunk];
  if (chunk.compression.empty())
    return read_at(chunk.at + place.offset, place.size, bytes) ? Result<std::vector<unsigned char>>(bytes) : gone;
  if (unpacked_chunk_ != place.chunk) {
    unpacked_chunk_ = UINT32_MAX;
    if (!unpack(chunk, unpacked_)) return gone;
    unpacked_chunk_ = place.chunk;
  }
  if (place.offset > unpacked_.size() || place.size > unpacked_.size() - place.offset) return gone;
  return std::vector<unsigned char>(unpacked_.begin() + place.offset, unpacked_.begin() + place.offset + place.size);
}

}  // namespace odograph
