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

/// RecordFields of a record, little-endian; strings and maps are preceded by their length.
class RecordFields {
 public:
  template <class Number>
  RecordFields& number(std::type_identity_t<Number> value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  RecordFields& text(std::string_view text) {
    number<uint32_t>(static_cast<uint32_t>(text.size()));
    bytes_.append(text);
    return *this;
  }
  RecordFields& map(const std::map<uint16_t, uint64_t>& map) {
    number<uint32_t>(static_cast<uint32_t>(10 * map.size()));
    for (const auto& [key, value] : map) number<uint16_t>(key).number<uint64_t>(value);
    return *this;
  }
  RecordFields& raw(std::string_view bytes) {
    bytes_.append(bytes);
    return *this;
  }
  std::string record(Op op) const {
    const uint64_t size = bytes_.size();
    std::string out(1, static_cast<char>(op));
    out.append(reinterpret_cast<const char*>(&size), sizeof size);
    return out + bytes_;
  }

 private:
  std::string bytes_;
};

}  // namespace

Result<std::unique_ptr<McapWriter>> McapWriter::create(const std::filesystem::path& file, const std::string& profile) {
  auto out = OutputFile::create(file);
  if (!out) return out.failure();
  std::unique_ptr<McapWriter> writer(new McapWriter(std::move(*out)));
  writer->put(std::string_view(kMagic, 8));
  writer->put(RecordFields().text(profile).text("odograph").record(kHeader));
  return writer;
}

void McapWriter::put(std::string_view bytes) {
  file_.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  at_ += bytes.size();
}

uint16_t McapWriter::add(const Topic& topic) {
  const auto id = static_cast<uint16_t>(counts_.size());
  const auto schema = static_cast<uint16_t>(id + 1);  // 0 means no schema
  const std::string records = RecordFields()
                                  .number<uint16_t>(schema)
                                  .text(topic.type)
                                  .text(topic.schema_encoding)
                                  .text(topic.schema)
                                  .record(kSchema) +
                              RecordFields()
                                  .number<uint16_t>(id)
                                  .number<uint16_t>(schema)
                                  .text(topic.name)
                                  .text(topic.encoding)
                                  .map({})
                                  .record(kChannel);
  head_ += records, chunk_ += records;
  counts_.push_back(0);
  return id;
}

void McapWriter::write(uint16_t topic, int64_t t_ns, std::string_view data) {
  const auto time = static_cast<uint64_t>(std::max<int64_t>(t_ns, 0));
  entries_[topic].emplace_back(time, chunk_.size());
  first_ns_ = std::min(first_ns_, time), last_ns_ = std::max(last_ns_, time);
  chunk_ += RecordFields()
                .number<uint16_t>(topic)
                .number<uint32_t>(static_cast<uint32_t>(counts_[topic]++))
                .number<uint64_t>(time)
                .number<uint64_t>(time)
                .raw(data)
                .record(kMessage);
  if (chunk_.size() >= kChunkBytes) end_chunk();
}

void McapWriter::end_chunk() {
  if (chunk_.empty()) return;
  Index index{entries_.empty() ? 0 : first_ns_, last_ns_, at_, 0, 0, chunk_.size(), {}};
  put(RecordFields()
          .number<uint64_t>(index.first_ns)
          .number<uint64_t>(index.last_ns)
          .number<uint64_t>(chunk_.size())
          .number<uint32_t>(0)  // no CRC
          .text("")
          .number<uint64_t>(chunk_.size())
          .raw(chunk_)
          .record(kChunk));
  index.size = at_ - index.at;
  for (const auto& [topic, entries] : entries_) {
    index.indexes_at[topic] = at_;
    RecordFields record;
    record.number<uint16_t>(topic).number<uint32_t>(static_cast<uint32_t>(16 * entries.size()));
    for (const auto& [time, place] : entries) record.number<uint64_t>(time).number<uint64_t>(place);
    put(record.record(kMessageIndex));
  }
  index.indexes_size = at_ - index.at - index.size;
  chunks_.push_back(std::move(index));
  chunk_.clear(), entries_.clear();
  first_ns_ = UINT64_MAX, last_ns_ = 0;
}

Result<bool> McapWriter::finish() {
  end_chunk();
  put(RecordFields().number<uint32_t>(0).record(kDataEnd));
  const uint64_t summary = at_;
  put(head_);
  RecordFields statistics;
  uint64_t messages = 0, first_ns = UINT64_MAX, last_ns = 0;
  std::map<uint16_t, uint64_t> counts;
  for (size_t i = 0; i < counts_.size(); ++i) messages += counts[static_cast<uint16_t>(i)] = counts_[i];
  for (const Index& chunk : chunks_)
    first_ns = std::min(first_ns, chunk.first_ns), last_ns = std::max(last_ns, chunk.last_ns);
  put(statistics.number<uint64_t>(messages)
          .number<uint16_t>(static_cast<uint16_t>(counts_.size()))
          .number<uint32_t>(static_cast<uint32_t>(counts_.size()))
          .number<uint32_t>(0)  // attachments
          .number<uint32_t>(0)  // metadata
          .number<uint32_t>(static_cast<uint32_t>(chunks_.size()))
          .number<uint64_t>(chunks_.empty() ? 0 : first_ns)
          .number<uint64_t>(last_ns)
          .map(counts)
          .record(kStatistics));
  for (const Index& chunk : chunks_)
    put(RecordFields()
            .number<uint64_t>(chunk.first_ns)
            .number<uint64_t>(chunk.last_ns)
            .number<uint64_t>(chunk.at)
            .number<uint64_t>(chunk.size)
            .map(chunk.indexes_at)
            .number<uint64_t>(chunk.indexes_size)
            .text("")
            .number<uint64_t>(chunk.bytes)
            .number<uint64_t>(chunk.bytes)
            .record(kChunkIndex));
  put(RecordFields().number<uint64_t>(summary).number<uint64_t>(0).number<uint32_t>(0).record(kFooter));
  put(std::string_view(kMagic, 8));
  return file_.commit();
}

}  // namespace odograph
