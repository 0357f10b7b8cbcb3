// SPDX-License-Identifier: Apache-2.0
//
// Files of messages by topic: ROS 1 bags (format 2.0) and MCAP. Both are sequences of records, with messages in chunks
// that may be compressed.
//
// ROS 1's own library is not used: it links the Python interpreter, loads a plugin named in the bag's header, does not
// check offsets and sizes from the file, and its messages do not compile as C++20. Debian has no MCAP library.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "sdk/host/base/result.hpp"

namespace odograph {

using Bytes = std::span<const unsigned char>;

/// Type and encoding of the messages of one topic.
struct LogTopic {
  std::string name;
  std::string type;      ///< "sensor_msgs/Imu": in ROS 1's form, also for ROS 2's "sensor_msgs/msg/Imu"
  std::string encoding;  ///< "ros1", "cdr", "json", or an unsupported one
};

/// Position of a message: its chunk, and the offset in it.
struct LogPlace {
  uint32_t chunk = 0, offset = 0, size = 0;
};

class MessageLog {
 public:
  struct Limits {
    uint64_t chunk_bytes = 1ull << 29;  ///< of a chunk, unpacked; writers use about 1 MB
    size_t topics = 10'000;
    size_t messages = 100'000'000;
  };
  /// Called for each message in the file's order; a failure ends the reading.
  using Visit = std::function<Result<bool>(const LogTopic&, int64_t t_ns, LogPlace, Bytes)>;

  static bool has_signature(const std::filesystem::path& file);

  /// Reads all messages once. A truncated or damaged file yields the messages before the damage; `flaw` describes it.
  /// Failures name the file (ODO_E_DATA).
  static Result<std::shared_ptr<MessageLog>> read(const std::filesystem::path& file, const Visit& visit,
                                                  const Limits& limits);
  static Result<std::shared_ptr<MessageLog>> read(const std::filesystem::path& file, const Visit& visit) {
    return read(file, visit, Limits());
  }

  /// Reads a message's bytes again. [any thread]
  Result<std::vector<unsigned char>> at(LogPlace place);

  const char* format() const { return bag_ ? "ROS 1 bag" : "MCAP"; }
  const std::string& flaw() const { return flaw_; }
  const std::filesystem::path& path() const { return path_; }

 private:
  struct Chunk {
    uint64_t at = 0, packed = 0, unpacked = 0;  ///< in the file, bytes
    std::string compression;                    ///< "": none
  };
  struct Record;

  MessageLog(std::filesystem::path file, const Limits& limits) : path_(std::move(file)), limits_(limits) {}
  Failure wrong(const std::string& text) const;
  Result<bool> scan(const Visit& visit);
  Result<bool> take(Record record, const Visit& visit);
  Result<bool> take_bag(const Record& record, const Visit& visit);
  Result<bool> take_mcap(const Record& record, const Visit& visit);
  Result<bool> take_chunk(Chunk chunk, const Visit& visit);
  Result<bool> take_message(uint64_t topic, int64_t t_ns, Bytes data, LogPlace place, const Visit& visit);
  bool read_at(uint64_t at, uint64_t size, std::vector<unsigned char>& bytes);
  Result<bool> unpack(const Chunk& chunk, std::vector<unsigned char>& bytes);

  std::filesystem::path path_;
  Limits limits_;
  std::ifstream file_;
  uint64_t size_ = 0;
  bool bag_ = false;
  std::string flaw_;
  std::map<uint64_t, LogTopic> topics_;
  std::map<uint64_t, std::pair<std::string, std::string>> schemas_;  // name and encoding
  std::vector<Chunk> chunks_;
  size_t messages_ = 0;
  std::mutex mutex_;
  uint32_t unpacked_chunk_ = UINT32_MAX;  // chunk in `unpacked_`
  std::vector<unsigned char> unpacked_;
};

}  // namespace odograph
