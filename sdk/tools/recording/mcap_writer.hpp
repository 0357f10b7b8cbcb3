// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sdk/host/base/output_file.hpp"

namespace odograph {

/// Writes MCAP (mcap.dev/spec): chunks that are not compressed, each with its index, and a summary at the end, so that
/// viewers can jump. A file that is there already stays until finish().
class McapWriter {
 public:
  static Result<std::unique_ptr<McapWriter>> create(const std::filesystem::path& file, const std::string& profile);

  /// A topic whose messages are encoded as `encoding` ("json", "cdr") and described by `schema` (in "jsonschema",
  /// "ros2msg") under `type`.
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
  std::string head_;   // of all schemas and channels, which the summary repeats
  std::string chunk_;  // records of the chunk that is being filled
  std::map<uint16_t, std::vector<std::pair<uint64_t, uint64_t>>> entries_;  // of each topic: time, place in the chunk
  uint64_t first_ns_ = UINT64_MAX, last_ns_ = 0;                            // of the chunk
  std::vector<Index> chunks_;
  std::vector<uint64_t> counts_;  // of messages, by topic
};

}  // namespace odograph
