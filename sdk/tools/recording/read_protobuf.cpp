// SPDX-License-Identifier: Apache-2.0
//
// A Protocol Buffers message whose repeated fields are the rows; columns are field numbers.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <map>

#include "sdk/tools/recording/protobuf_fields.hpp"
#include "sdk/tools/recording/read_table.hpp"

namespace odograph::phone {
namespace fs = std::filesystem;

namespace {

constexpr uint64_t kLargest = 2ull << 30;

/// All numbers of a row's message by field and index (from 1): "2.3" is the third value of field 2. Floats, integers,
/// packed floats.
std::map<std::pair<uint32_t, uint32_t>, double> values_of(std::span<const unsigned char> message, bool& damaged) {
  std::map<std::pair<uint32_t, uint32_t>, double> values;
  std::map<uint32_t, uint32_t> count;
  ProtobufReader reader(message);
  while (const auto field = reader.next()) {
    if (count[field->number] > 16) continue;
    const auto add = [&](double value) { values[{field->number, ++count[field->number]}] = value; };
    if (field->kind == ProtobufField::Kind::varint) add(static_cast<double>(static_cast<int64_t>(field->value)));
    if (field->kind == ProtobufField::Kind::fixed32) add(field->as_float());
    if (field->kind == ProtobufField::Kind::bytes && field->bytes.size() % 4 == 0 && field->bytes.size() <= 64)
      for (size_t at = 0; at < field->bytes.size(); at += 4) {
        ProtobufField one;
        std::memcpy(&one.value, field->bytes.data() + at, 4);
        add(one.as_float());
      }
  }
  damaged = damaged || reader.damaged();
  return values;
}

/// An integer with all digits, which a double would lose.
std::optional<int64_t> whole_number(std::span<const unsigned char> message, uint32_t number) {
  ProtobufReader reader(message);
  while (const auto field = reader.next())
    if (field->number == number && field->kind == ProtobufField::Kind::varint)
      return static_cast<int64_t>(field->value);
  return std::nullopt;
}

void take_message(Rows& rows, std::span<const unsigned char> message, bool& damaged) {
  const auto t = whole_number(message, static_cast<uint32_t>(std::atoi(rows.table->time)));
  const auto values = values_of(message, damaged);
  if (!t) {
    ++rows.incomplete;
    return;
  }
  Row row{*t, 0, {}};
  row.v.fill(std::numeric_limits<double>::quiet_NaN());
  for (size_t i = 0; i < rows.table->columns.size(); ++i) {
    const std::string column = alternatives(rows.table->columns[i]).front();
    const size_t point = column.find('.');
    const auto found = point == std::string::npos
                           ? values.end()
                           : values.find({static_cast<uint32_t>(std::atoi(column.c_str())),
                                          static_cast<uint32_t>(std::atoi(column.c_str() + point + 1))});
    if (found != values.end() && std::isfinite(found->second)) {
      row.v[i] = found->second;
    } else if (!is_optional(rows.table->columns[i])) {
      ++rows.incomplete;
      return;
    }
  }
  rows.rows.push_back(row);
}

}  // namespace

Result<bool> read_protobuf(const fs::path& path, std::span<Rows> tables) {
  std::error_code error;
  if (fs::file_size(path, error) > kLargest || error)
    return Failure{ODO_E_DATA, path.string() + ": cannot be read, or is larger than any recording"};
  std::ifstream file(path, std::ios::binary);
  std::vector<unsigned char> bytes(fs::file_size(path, error));
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!file) return Failure{ODO_E_NOT_FOUND, path.string() + ": cannot be opened"};
  ProtobufReader reader(bytes);
  bool damaged = false;
  size_t messages = 0;
  while (const auto field = reader.next()) {
    if (field->kind != ProtobufField::Kind::bytes) continue;
    ++messages;
    for (Rows& rows : tables)
      if (field->number == static_cast<uint32_t>(std::atoi(rows.table->kind)))
        take_message(rows, field->bytes, damaged);
  }
  if (messages == 0 || (damaged && tables[0].rows.empty()))
    return Failure{ODO_E_DATA, path.string() + ": not the app's format (VideoCaptureData)"};
  return true;
}

}  // namespace odograph::phone
