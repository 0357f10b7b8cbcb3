// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sdk/host/base/output_file.hpp"

namespace odograph {

/// Writes MCAP (mcap.dev/spec): uncompressed chunks with indexes, and a summary at the end for random access. An
/// existing file remains until finish().
class McapWriter {
 public:
  static Result<std::unique_ptr<McapWriter>> create(const std::filesystem::path& file, const std::string& profile);

  /// A topic: its messages have the encoding `encoding` ("json", "cdr") and the schema `schema` (in "jsonschema",
  /// "ros2msg") named `type`.
  struct Topic {
    std::string name, encoding, type, schema_encoding, schema;
  };
  uint16_t add(const Topic& topic);
  void write(uint16_t topic, int64_t t_ns, std::string_view data);
  Result<bool> finish();

 private:
  struct Index {
    uint64_t first_ns = 0, last_ns = 0, at = 0, size = 0, indexes_size = 0, bytes = 0;
    std::map<uint16_t, uint64_t> indexes_at;
  };
  explicit McapWriter(OutputFile file) : file_(std::move(file)) {}
  void put(std::string_view bytes);
  void end_chunk();

  OutputFile file_;
  uint64_t at_ = 0;
  std::string head_;   // all schemas and channels, repeated in the summary
  std::string chunk_;  // records of the current chunk
  std::map<uint16_t, std::vector<std::pair<uint64_t, uint64_t>>> entries_;  // per topic: time, offset in the chunk
  uint64_t first_ns_ = UINT64_MAX, last_ns_ = 0;                            // of the chunk
  std::vector<Index> chunks_;
  std::vector<uint64_t> counts_;  // of messages, by topic
};

}  // namespace odograph
