// SPDX-License-Identifier: Apache-2.0
//
// JSON Lines: one object per line; columns are JSON pointers.
#include <cmath>
#include <fstream>
#include <limits>

#include <nlohmann/json.hpp>

#include "sdk/tools/recording/read_table.hpp"

namespace odograph::phone {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::json;
using Pointer = Json::json_pointer;
constexpr size_t kLongestObject = 1 << 20;

/// A table's columns as JSON pointers, parsed once.
struct Pointers {
  Pointer kind;
  std::string value;  ///< required value of that kind; empty: any
  std::vector<Pointer> time;
  std::vector<std::vector<Pointer>> columns;

  explicit Pointers(const Table& table) {
    const std::string text = table.kind;
    const size_t equals = text.find('=');
    kind = Pointer(text.substr(0, equals));
    if (equals != std::string::npos) value = text.substr(equals + 1);
    const auto all = [](const char* column) {
      std::vector<Pointer> pointers;
      for (const auto& name : alternatives(column)) pointers.emplace_back(name);
      return pointers;
    };
    time = all(table.time);
    for (const char* column : table.columns) columns.push_back(all(column));
  }

  bool fits(const Json& line) const {
    if (!line.contains(kind)) return false;
    return value.empty() || (line[kind].is_string() && line[kind].get_ref<const std::string&>() == value);
  }
};

const Json* first_of(const Json& line, const std::vector<Pointer>& pointers) {
  for (const Pointer& pointer : pointers)
    if (line.contains(pointer)) return &line[pointer];
  return nullptr;
}

Result<bool> take_line(const Json& line, const Pointers& pointers, Rows& rows, size_t number) {
  const Json* time = first_of(line, pointers.time);
  const auto t = time && time->is_number() ? time_of(time->get<double>(), rows.table->unit) : std::nullopt;
  if (!t) return wrong_in(rows.file, number, "no usable '" + std::string(rows.table->time) + "'");
  Row row{*t, 0, {}};
  row.v.fill(std::numeric_limits<double>::quiet_NaN());
  for (size_t i = 0; i < pointers.columns.size(); ++i) {
    const Json* value = first_of(line, pointers.columns[i]);
    if (value && value->is_number() && std::isfinite(value->get<double>())) {
      row.v[i] = value->get<double>();
    } else if (!is_optional(rows.table->columns[i])) {
      if (value && !value->is_null())
        return wrong_in(rows.file, number, "'" + std::string(rows.table->columns[i]) + "' is not a number");
      ++rows.incomplete;
      return true;
    }
  }
  rows.rows.push_back(row);
  return true;
}

}  // namespace

Result<bool> read_json_lines(const fs::path& path, std::span<Rows> tables) {
  std::vector<Pointers> pointers;
  for (const Rows& rows : tables) pointers.emplace_back(*rows.table);
  std::ifstream file(path, std::ios::binary);
  if (!file) return Failure{ODO_E_NOT_FOUND, path.string() + ": cannot be opened"};
  std::string text;
  for (size_t number = 1; std::getline(file, text); ++number) {
    if (text.size() > kLongestObject) return wrong_in(path, number, "the line is too long");
    if (text.find_first_not_of(" \t\r") == std::string::npos) continue;
    const Json line = Json::parse(text, nullptr, false);
    if (line.is_discarded() || !line.is_object()) {
      if (file.eof()) break;  // truncated
      return wrong_in(path, number, "not a JSON object");
    }
    for (size_t i = 0; i < tables.size(); ++i)
      if (pointers[i].fits(line))
        if (const auto taken = take_line(line, pointers[i], tables[i], number); !taken) return taken.failure();
  }
  return true;
}

}  // namespace odograph::phone
