// SPDX-License-Identifier: Apache-2.0
//
// Tables with named columns: CSV, and GnssLogger's rows of several kinds.
#include "sdk/tools/recording/read_table.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>

#include "sdk/host/messages/messages.hpp"
#include "sdk/math/number_text.hpp"
#include "sdk/tools/recording/trajectory.hpp"

namespace odograph::phone {
namespace fs = std::filesystem;

namespace {

constexpr size_t kLongestLine = 1 << 16;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::string_view trimmed(std::string_view text) {
  const auto space = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '"'; };
  while (!text.empty() && space(text.front())) text.remove_prefix(1);
  while (!text.empty() && space(text.back())) text.remove_suffix(1);
  return text;
}

/// Of a line: tab or semicolon, beside which a comma is a decimal one; comma; space.
char separator_of(std::string_view line) {
  for (const char each : {'\t', ';', ','})
    if (line.find(each) != std::string_view::npos) return each;
  return ' ';
}

void split_fields(std::string_view line, char separator, std::vector<std::string_view>& fields) {
  fields.clear();
  for (size_t at = 0; at <= line.size();) {
    const size_t end = std::min(line.find(separator, at), line.size());
    fields.push_back(trimmed(line.substr(at, end - at)));
    at = end + 1;
  }
}

/// A column's name without its unit, in lower case: "Timestamp[nanosec]", "gyro_x (rad/s)".
std::string plain_name(std::string_view name) {
  if (!name.empty() && (name.front() == '#')) name.remove_prefix(1);
  if (name.starts_with('(')) name.remove_prefix(name.find(')') + 1);  // "(UTC)TimeInMs"
  name = trimmed(name.substr(0, std::min(name.find('['), name.find('('))));
  std::string plain(name);
  if (plain.starts_with("\xEF\xBB\xBF")) plain.erase(0, 3);  // byte order mark of a spreadsheet
  std::transform(plain.begin(), plain.end(), plain.begin(), [](unsigned char c) { return std::tolower(c); });
  return plain;
}

std::optional<double> number_of(std::string_view text) {
  if (!text.empty() && text[0] == '+') text.remove_prefix(1);
  const auto value = parse_number(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

/// Placeholders that apps write for a missing value.
bool is_missing_value(std::string_view text) {
  return text.empty() || text == "null" || text == "NaN" || text == "nan" || text == "-" || text == "undefined";
}

/// Column indices of a table in a file's head.
struct Places {
  int time = -1, unix_time = -1;
  std::vector<int> columns;

  /// The name of a required column that is missing, or nothing.
  std::string find(const Table& table, const std::vector<std::string>& head) {
    const auto place = [&](const char* column) {
      for (const std::string& name : alternatives(column)) {
        if (name[0] == '#' && name.size() > 1) {  // by position, without a head
          if (head.empty()) return std::atoi(name.c_str() + 1) - 1;
          continue;
        }
        const auto found = std::find(head.begin(), head.end(), plain_name(name));
        if (found != head.end()) return static_cast<int>(found - head.begin());
      }
      return -1;
    };
    time = place(table.time);
    if (time < 0) return table.time;
    unix_time = *table.unix_time ? place(table.unix_time) : -1;
    columns.clear();
    for (const char* column : table.columns) {
      columns.push_back(place(column));
      if (columns.back() < 0 && !is_optional(column)) return column;
    }
    return "";
  }
};

/// The values of a row; nothing, without a failure, if one is missing.
Result<bool> take_row(Rows& rows, const Places& places, const std::vector<std::string_view>& fields, size_t line) {
  const auto field = [&](int place) {
    return place >= 0 && static_cast<size_t>(place) < fields.size() ? fields[static_cast<size_t>(place)]
                                                                    : std::string_view();
  };
  Row row{0, 0, {kNone, kNone, kNone, kNone, kNone, kNone, kNone}};
  const std::string_view time = field(places.time);
  if (is_missing_value(time)) {
    ++rows.incomplete;
    return true;
  }
  const auto t = time_of(time, rows.table->unit);
  if (!t)
    return wrong_in(rows.file, line,
                    "column '" + std::string(rows.table->time) + "': '" + std::string(time.substr(0, 40)) +
                        "' is no time" +
                        (time.find_first_of("eE") != std::string_view::npos
                             ? "; a spreadsheet has taken its digits: export the recording again"
                             : ""));
  row.t_ns = *t;
  if (const auto unix_ns = time_of(field(places.unix_time), rows.table->unix_unit); unix_ns) row.unix_ns = *unix_ns;
  for (size_t i = 0; i < places.columns.size(); ++i) {
    const std::string_view text = field(places.columns[i]);
    const bool optional = is_optional(rows.table->columns[i]);
    if (is_missing_value(text)) {
      if (optional) continue;
      ++rows.incomplete;
      return true;
    }
    const auto value = number_of(text);
    if (!value && optional) continue;
    if (!value)
      return wrong_in(rows.file, line,
                      "column '" + std::string(rows.table->columns[i]) + "': '" + std::string(text.substr(0, 40)) +
                          "' is not a number");
    row.v[i] = *value;
  }
  rows.rows.push_back(row);
  return true;
}

/// Calls `take` for each line, with whether more lines follow.
Result<bool> each_line(const fs::path& path,
                       const std::function<Result<bool>(std::string_view text, size_t line, bool whole)>& take) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return Failure{ODO_E_NOT_FOUND, path.string() + ": not a file"};
  std::ifstream file(path, std::ios::binary);
  if (!file) return Failure{ODO_E_NOT_FOUND, path.string() + ": cannot be opened"};
  std::string text;
  for (size_t line = 1; std::getline(file, text); ++line) {
    if (text.size() > kLongestLine) return wrong_in(path, line, "the line is too long for a table");
    if (const auto taken = take(text, line, !file.eof()); !taken) return taken.failure();
  }
  return true;
}

}  // namespace

Failure wrong_in(const fs::path& file, size_t line, const std::string& text) {
  return {ODO_E_DATA, file.string() + ":" + std::to_string(line) + ": " + text};
}

std::vector<std::string> alternatives(const char* column) {
  std::string text = is_optional(column) ? column + 1 : column;
  std::vector<std::string> names;
  for (size_t at = 0; at <= text.size();) {
    const size_t end = std::min(text.find('|', at), text.size());
    names.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return names;
}

std::optional<int64_t> time_of(std::string_view text, TimeUnit unit) {
  const size_t point = text.find('.');
  const bool decimal = point != std::string_view::npos;
  if (unit == TimeUnit::seconds || (unit == TimeUnit::nanoseconds && decimal && point <= 11)) {
    const auto t = parse_seconds(text);
    return t && is_plausible_time(*t) ? std::optional(*t) : std::nullopt;
  }
  int64_t value = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  if (parsed.ec != std::errc() || (parsed.ptr != text.data() + text.size() && *parsed.ptr != '.')) return std::nullopt;
  const int64_t scale = unit == TimeUnit::milliseconds ? 1'000'000 : 1;
  if (value > kFarthestTime_ns / scale || value < -kFarthestTime_ns / scale) return std::nullopt;
  return value * scale;
}

std::optional<int64_t> time_of(double value, TimeUnit unit) {
  const double ns = value * (unit == TimeUnit::seconds ? 1e9 : unit == TimeUnit::milliseconds ? 1e6 : 1);
  if (!(std::abs(ns) < static_cast<double>(kFarthestTime_ns))) return std::nullopt;
  return std::llround(ns);
}

Result<bool> read_csv(const fs::path& file, Rows& rows) {
  Places places;
  std::vector<std::string_view> fields;
  bool has_places = false;
  size_t widest = 0;
  char separator = 0;
  std::string with_points;  // a line whose decimal commas became points
  return each_line(file, [&](std::string_view text, size_t line, bool whole) -> Result<bool> {
    if (trimmed(text).empty() || !rows.missing_column.empty()) return true;
    if (separator == 0) separator = separator_of(text);
    if ((separator == ';' || separator == '\t') && text.find(',') != std::string_view::npos) {
      with_points = text;
      std::replace(with_points.begin(), with_points.end(), ',', '.');
      text = with_points;
    }
    split_fields(text, separator, fields);
    const bool is_head = !number_of(fields[0]) && !time_of(fields[0], TimeUnit::nanoseconds);
    if (!has_places) {
      std::vector<std::string> head;
      if (is_head)
        for (const auto field : fields) head.push_back(plain_name(field));
      rows.missing_column = places.find(*rows.table, head);
      has_places = true;
      if (is_head || !rows.missing_column.empty()) return true;
    }
    if (text[0] == '#') return true;
    if (!whole && fields.size() < widest) return true;  // truncated
    widest = std::max(widest, fields.size());
    const auto taken = take_row(rows, places, fields, line);
    return !taken && !whole ? Result<bool>(true) : taken;
  });
}

Result<bool> read_named_rows(const fs::path& file, std::span<Rows> tables) {
  std::vector<Places> places(tables.size());
  std::vector<bool> has_places(tables.size());
  std::vector<std::string_view> fields;
  return each_line(file, [&](std::string_view text, size_t line, bool whole) -> Result<bool> {
    const bool comment = text.starts_with("#");
    split_fields(comment ? text.substr(1) : text, ',', fields);
    for (size_t i = 0; i < tables.size(); ++i) {
      if (fields[0] != tables[i].table->kind) continue;
      if (comment) {
        std::vector<std::string> head;
        for (const auto field : fields) head.push_back(plain_name(field));
        tables[i].missing_column = places[i].find(*tables[i].table, head);
        has_places[i] = true;
      } else if (!has_places[i]) {
        return wrong_in(file, line,
                        "a row '" + std::string(fields[0]) + "' and no line '# " + std::string(fields[0]) +
                            ",...' before it that names its columns");
      } else if (tables[i].missing_column.empty()) {
        if (const auto taken = take_row(tables[i], places[i], fields, line); !taken && whole) return taken.failure();
      }
    }
    return true;
  });
}

Result<bool> read_tables(Layout layout, const fs::path& file, std::span<Rows> tables) {
  for (Rows& rows : tables) rows.file = file;
  switch (layout) {
    case Layout::csv:
      for (Rows& rows : tables)
        if (const auto done = read_csv(file, rows); !done) return done.failure();
      return true;
    case Layout::named_rows: return read_named_rows(file, tables);
    case Layout::json_lines: return read_json_lines(file, tables);
    case Layout::protobuf: return read_protobuf(file, tables);
  }
  return true;
}

}  // namespace odograph::phone
