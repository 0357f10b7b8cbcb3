// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/recording/mcap_writer.hpp"

#include <algorithm>
#include <type_traits>

namespace odograph {
namespace {

constexpr size_t kChunkBytes = 1 << 20;
constexpr char kMagic[] = "\x89MCAP0\r\n";
enum Op : uint8_t {
  kHeader = 1,
  kFooter,
  kSchema,
  kChannel,
  kMessage,
  kChunk,
  kMessageIndex,
  kChunkIndex,
  kStatistics = 11,
  kDataEnd = 15
};

/// Bytes without their length before them.
struct Raw {
  std::string_view bytes;
};

void append(std::string& to, const Raw& raw) { to.append(raw.bytes); }
template <class Number>
requires std::is_arithmetic_v<Number>
void append(std::string& to, Number value) { to.append(reinterpret_cast<const char*>(&value), sizeof value); }
void append(std::string& to, std::string_view text) { append(to, static_cast<uint32_t>(text.size())), to.append(text); }
void append(std::string& to, const std::map<uint16_t, uint64_t>& map) {
  append(to, static_cast<uint32_t>(10 * map.size()));
  for (const auto& [key, value] : map) append(to, key), append(to, value);
}

/// A record with these fields: numbers little-endian by their types; texts and maps after their length.
template <class... Fields>
std::string record(Op op, const Fields&... fields) {
  std::string content, head(1, static_cast<char>(op));
  (append(content, fields), ...);
  append(head, uint64_t{content.size()});
  return head + content;
}

}  // namespace

Result<std::unique_ptr<McapWriter>> McapWriter::create(const std::filesystem::path& file, const std::string& profile) {
  auto out = OutputFile::create(file);
  if (!out) return out.failure();
  std::unique_ptr<McapWriter> writer(new McapWriter(std::move(*out)));
  writer->put(std::string_view(kMagic, 8));
  writer->put(record(kHeader, profile, "odograph"));
  return writer;
}

void McapWriter::put(std::string_view bytes) {
  file_.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  at_ += bytes.size();
}

uint16_t McapWriter::add(const Topic& topic) {
  const auto id = static_cast<uint16_t>(counts_.size());
  const auto schema = static_cast<uint16_t>(id + 1);  // 0 means no schema
  const std::string records = record(kSchema, schema, topic.type, topic.schema_encoding, topic.schema) +
                              record(kChannel, id, schema, topic.name, topic.encoding, std::map<uint16_t, uint64_t>());
  head_ += records, chunk_ += records;
  counts_.push_back(0);
  return id;
}

void McapWriter::write(uint16_t topic, int64_t t_ns, std::string_view data) {
  const auto time = static_cast<uint64_t>(std::max<int64_t>(t_ns, 0));
  entries_[topic].emplace_back(time, chunk_.size());
  first_ns_ = std::min(first_ns_, time), last_ns_ = std::max(last_ns_, time);
  chunk_ += record(kMessage, topic, static_cast<uint32_t>(counts_[topic]++), time, time, Raw{data});
  if (chunk_.size() >= kChunkBytes) end_chunk();
}

void McapWriter::end_chunk() {
  if (chunk_.empty()) return;
  Index index{entries_.empty() ? 0 : first_ns_, last_ns_, at_, 0, 0, chunk_.size(), {}};
  const uint64_t size = chunk_.size();
  const uint32_t no_crc = 0;
  put(record(kChunk, index.first_ns, index.last_ns, size, no_crc, std::string_view(), size, Raw{chunk_}));
  index.size = at_ - index.at;
  for (const auto& [topic, entries] : entries_) {
    index.indexes_at[topic] = at_;
    std::string places;
    for (const auto& [time, place] : entries) append(places, time), append(places, place);
    put(record(kMessageIndex, topic, std::string_view(places)));
  }
  index.indexes_size = at_ - index.at - index.size;
  chunks_.push_back(std::move(index));
  chunk_.clear(), entries_.clear();
  first_ns_ = UINT64_MAX, last_ns_ = 0;
}

Result<bool> McapWriter::finish() {
  end_chunk();
  put(record(kDataEnd, uint32_t{0}));
  const uint64_t summary = at_;
  put(head_);
  uint64_t messages = 0, first_ns = UINT64_MAX, last_ns = 0;
  std::map<uint16_t, uint64_t> counts;
  for (size_t i = 0; i < counts_.size(); ++i) messages += counts[static_cast<uint16_t>(i)] = counts_[i];
  for (const Index& chunk : chunks_)
    first_ns = std::min(first_ns, chunk.first_ns), last_ns = std::max(last_ns, chunk.last_ns);
  const auto topics = static_cast<uint16_t>(counts_.size());
  const uint32_t schemas = topics, attachments = 0, metadata = 0;
  put(record(kStatistics, messages, topics, schemas, attachments, metadata, static_cast<uint32_t>(chunks_.size()),
             chunks_.empty() ? 0 : first_ns, last_ns, counts));
  for (const Index& chunk : chunks_)
    put(record(kChunkIndex, chunk.first_ns, chunk.last_ns, chunk.at, chunk.size, chunk.indexes_at, chunk.indexes_size,
               std::string_view(), chunk.bytes, chunk.bytes));
  put(record(kFooter, summary, uint64_t{0}, uint32_t{0}));
  put(std::string_view(kMagic, 8));
  return file_.commit();
}

}  // namespace odograph
