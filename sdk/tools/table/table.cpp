// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/table/table.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

/// "a/b" is b within a, unless the key itself contains the slash, such as a file name.
const Json* value_at(const Json& row, const std::string& key) {
  if (const auto whole = row.find(key); whole != row.end()) return &*whole;
  const Json::json_pointer at('/' + key);
  return row.contains(at) ? &row.at(at) : nullptr;
}

/// Without json_pointer, which would treat "real/0" as a list item.
void put_at(Json& row, const std::string& key, Json value) {
  const size_t end = key.find('/');
  if (end == std::string::npos)
    row[key] = std::move(value);
  else
    put_at(row[key.substr(0, end)], key.substr(end + 1), std::move(value));
}

Json aggregate(const Format& format, const std::vector<double>& values) {
  double sum = 0, whole = 0;
  for (size_t i = 0; i < values.size(); ++i)
    (format.aggregate == Aggregate::share && i % 2 == 1 ? whole : sum) += values[i];
  switch (format.aggregate) {
    case Aggregate::sum: return sum;
    case Aggregate::mean: return sum / static_cast<double>(values.size());
    case Aggregate::first: return values.empty() ? std::nan("") : values.front();
    case Aggregate::share: return whole > 0 ? 100 * sum / whole : 0.0;
    case Aggregate::all: return values;
    case Aggregate::percentile: break;
  }
  return percentile_or_nan(values, format.part);
}

/// Suffix of a figure's key and heading for a percentile column.
std::string part_key(double part, bool sign) {
  if (part == 0.5) return "median";
  if (part == 1 || part == 0) return part == 0 ? "least" : sign ? "most" : "worst";
  return text("p%.0f", 100 * part);
}
std::string part_head(double part, bool sign) {
  const std::string key = part_key(part, sign);
  return key[0] == 'p' ? key.substr(1) + " %" : key;
}

std::string cell(const Json& row, const Column& column) {
  const Json* value = value_at(row, column.key);
  if (value && value->is_string()) return value->get<std::string>();
  const double x = number_at(row, column.key);
  if (!std::isfinite(x)) return "-";
  return text(column.format.sign ? "%+.*f" : "%.*f", column.digits, x);
}

std::string cell(const Json& row, const Label& label) {
  const Json* value = value_at(row, label.key);
  if (!value || value->is_null()) return "";
  const std::string all = value->is_string() ? value->get<std::string>() : value->dump();
  if (!label.stem) return all;
  const size_t query = std::min(all.find('?'), all.size());
  return std::filesystem::path(all.substr(0, query)).stem().string() + all.substr(query);
}

/// Counts characters, not bytes.
size_t width_of(const std::string& s) {
  return static_cast<size_t>(std::count_if(s.begin(), s.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

}  // namespace

double number_at(const Json& row, const std::string& key) {
  const Json* value = value_at(row, key);
  if (value && value->is_boolean()) return value->get<bool>();
  return value && value->is_number() ? value->get<double>() : std::nan("");
}

std::vector<double> numbers_at(const Rows& rows, const std::string& key, bool absolute) {
  std::vector<double> all;
  const auto add = [&](double x) {
    if (std::isfinite(x)) all.push_back(absolute ? std::abs(x) : x);
  };
  for (const Json& row : rows) {
    const Json* value = value_at(row, key);
    if (value && value->is_array())
      for (const Json& item : *value) add(item.is_number() ? item.get<double>() : std::nan(""));
    else
      add(number_at(row, key));
  }
  return all;
}

double percentile_at(const Rows& rows, const std::string& key, double part, bool absolute) {
  return percentile_or_nan(numbers_at(rows, key, absolute), part);
}

Json summary_of(Json labels, const Rows& rows, const std::vector<Column>& columns) {
  for (const Column& column : columns)
    put_at(labels, column.key,
           aggregate(column.format,
                     numbers_at(rows, column.from.empty() ? column.key : column.from, column.format.absolute)));
  return labels;
}

Rows rows_with(const Rows& rows, const std::string& key, const Json& value) {
  Rows out;
  for (const Json& row : rows)
    if (const Json* own = value_at(row, key); own ? *own == value : value.is_null()) out.push_back(row);
  return out;
}

std::vector<std::pair<Json, Rows>> groups_of(const Rows& rows, const std::string& key) {
  std::vector<std::pair<Json, Rows>> groups;
  for (const Json& row : rows) {
    const Json* own = value_at(row, key);
    const Json value = own ? *own : Json();
    auto at = std::find_if(groups.begin(), groups.end(), [&](const auto& group) { return group.first == value; });
    if (at == groups.end()) at = groups.emplace(at, value, Rows());
    at->second.push_back(row);
  }
  return groups;
}

Rows summaries_of(const Rows& rows, const std::string& by, const std::vector<Column>& columns) {
  Rows out;
  for (const auto& [value, own] : groups_of(rows, by)) out.push_back(summary_of(Json{{by, value}}, own, columns));
  return out;
}

Json row_of(const std::vector<Figure>& figures, const std::string& table) {
  Json row, columns = Json::array();
  for (const Figure& f : figures) {
    const std::string from = f.format.parts.empty() ? f.key : '_' + f.key;
    put_at(row, from, f.value);
    const auto add = [&](const std::string& unit, const std::string& key, double part) {
      columns.push_back(
          {f.head, unit, key, f.digits, f.format.sign, f.format.aggregate, part, f.format.absolute, from});
    };
    if (f.format.parts.empty()) add(f.unit, f.key, f.format.part);
    for (const double part : f.format.parts)
      add((part == f.format.parts.front() && !f.unit.empty() ? f.unit + ' ' : "") + part_head(part, f.format.sign),
          f.key + '/' + part_key(part, f.format.sign), part);
  }
  row['_' + table] = columns;
  return row;
}

std::vector<Column> columns_of(const Rows& rows, const std::string& table) {
  std::vector<Column> columns;
  for (const Json& row : rows)
    if (const auto own = row.find('_' + table); own != row.end() && columns.empty())
      for (const Json& c : *own) columns.push_back({c[0], c[1], c[2], c[3], {c[4], c[5], c[6], c[7]}, c[8]});
  return columns;
}

std::string table_text(const Table& given, const Rows& rows) {
  Table table = given;
  std::erase_if(table.columns, [](const Column& column) { return column.digits < 0; });
  const size_t labels = table.labels.size(), all = labels + table.columns.size();
  std::vector<std::vector<std::string>> lines(2, std::vector<std::string>(all));
  for (size_t i = 0; i < labels; ++i) lines[1][i] = table.labels[i].head;
  for (size_t i = labels; i < all; ++i)
    lines[0][i] = table.columns[i - labels].head, lines[1][i] = table.columns[i - labels].unit;
  for (const Json& row : rows) {
    auto& line = lines.emplace_back();
    if (row.contains("_line")) {
      line.push_back(row["_line"].get<std::string>());
      continue;
    }
    for (const Label& label : table.labels) line.push_back(cell(row, label));
    for (const Column& column : table.columns) line.push_back(cell(row, column));
  }
  std::vector<size_t> width(all);
  for (const auto& line : lines)
    for (size_t i = 0; line.size() == all && i < all; ++i) width[i] = std::max(width[i], width_of(line[i]));
  std::string out = table.title.empty() ? "" : table.title + '\n';
  for (const auto& line : lines) {
    std::string one;
    for (size_t i = 0; i < line.size(); ++i) {
      const std::string space(line.size() == all ? width[i] - width_of(line[i]) : 0, ' ');
      one += (i == 0 ? "" : "  ") + (i < labels ? line[i] + space : space + line[i]);
    }
    one.erase(one.find_last_not_of(' ') + 1);
    out += one + '\n';
  }
  return out;
}

double percentile_or_nan(const std::vector<double>& values, double part) {
  return values.empty() ? std::nan("") : percentile(values, part);
}

Json visible_rows(const Rows& rows) {
  Json out = Json::array();
  for (Json row : rows) {
    for (auto it = row.begin(); it != row.end();) it = it.key()[0] == '_' ? row.erase(it) : std::next(it);
    out.push_back(std::move(row));
  }
  return out;
}

}  // namespace odograph
