// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/recording/text_rows.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include "sdk/host/messages/messages.hpp"
#include "sdk/math/number_text.hpp"
#include "sdk/tools/recording/recording.hpp"

namespace odograph {
namespace {

constexpr size_t kLongestLine = 1 << 16;

constexpr std::string_view kBlank = " \t\r";
const std::string kPoint = " (a decimal comma is to be a point)";

std::string_view trimmed(std::string_view text) {
  const size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) + 1 - first);
}

/// The separator of a line's fields; ' ' stands for any white space.
char separator_of(std::string_view line) {
  for (const char each : {';', ','})
    if (line.find(each) != std::string_view::npos) return each;
  return ' ';
}

/// Removes the next field from the line: a cell, which may be empty or quoted, or a word. False if a quote is not
/// closed.
bool take_field(std::string_view& line, char separator, std::string_view& field) {
  if (separator == ' ') {
    const size_t end = std::min(line.find_first_of(kBlank), line.size());
    field = line.substr(0, end);
    line = trimmed(line.substr(end));
    return true;
  }
  line = line.substr(std::min(line.find_first_not_of(kBlank), line.size()));
  size_t end = 0;
  if (!line.empty() && line[0] == '"') {
    end = line.find('"', 1);
    if (end == std::string_view::npos) return false;
    ++end;
  }
  end = std::min(line.find(separator, end), line.size());
  field = trimmed(line.substr(0, end));
  if (field.size() >= 2 && field.front() == '"' && field.back() == '"') field = field.substr(1, field.size() - 2);
  line.remove_prefix(std::min(end + 1, line.size()));
  return true;
}

/// Splits a table's lines into fields. The first line with fields, including a head, determines the separator; with
/// commas or semicolons, every line must have the same number of cells.
class Splitter {
 public:
  /// A comment before the first line may be its head: twice as many cells mean that decimal commas split the numbers.
  void note_comment(std::string_view line) {
    std::vector<std::string_view> fields;
    Splitter head;
    if (cells_ == 0 && head.split(line, 0, fields).empty()) head_ = {head.separator_, fields.size()};
  }
  /// Empty for an empty line; otherwise the fault, or no text.
  std::string split(std::string_view line, int number, std::vector<std::string_view>& fields) {
    fields.clear();
    line = trimmed(line);
    if (line.empty()) return "";
    if (separator_ == 0) separator_ = separator_of(line);
    while (!line.empty()) {
      if (!take_field(line, separator_, fields.emplace_back()))
        return "field " + std::to_string(fields.size()) + " begins with a quote that does not end";
    }
    if (separator_ == ' ') return "";
    if (cells_ == 0) {
      cells_ = fields.size(), first_ = number;
      if (head_.first == separator_ && head_.second > 1 &&
          (cells_ == 2 * head_.second || cells_ == 2 * head_.second - 1))
        return std::to_string(cells_) + " fields, the head has " + std::to_string(head_.second) + kPoint;
    }
    if (fields.size() == cells_) return "";
    return std::to_string(fields.size()) + " fields separated by '" + std::string(1, separator_) + "', line " +
           std::to_string(first_) + " has " + std::to_string(cells_) + "; expected as many" + kPoint;
  }

 private:
  char separator_ = 0;
  size_t cells_ = 0;
  int first_ = 0;
  std::pair<char, size_t> head_{0, 0};
};

std::string shown(std::string_view text) { return "'" + std::string(text.substr(0, 40)) + "'"; }

}  // namespace

Failure TextRow::wrong(const std::string& text) const {
  return {ODO_E_DATA, path->string() + ":" + std::to_string(line) + ": " + text};
}

Result<double> TextRow::number(size_t field) const {
  if (field >= fields.size()) return wrong("expected at least " + std::to_string(field + 1) + " fields");
  std::string_view text = fields[field];
  if (text.empty()) return wrong("field " + std::to_string(field + 1) + " is empty; expected a number");
  if (text[0] == '+') text.remove_prefix(1);
  const auto value = parse_number(text);
  if (!value || !std::isfinite(*value))
    return wrong("field " + std::to_string(field + 1) + " " + shown(text) + " is not a number" +
                 (text.find(',') != std::string_view::npos ? "; expected a decimal point" : ""));
  return *value;
}

Result<int64_t> TextRow::integer(size_t field) const {
  if (field >= fields.size()) return wrong("expected at least " + std::to_string(field + 1) + " fields");
  int64_t value = 0;
  const std::string_view text = fields[field];
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size())
    return wrong("field " + std::to_string(field + 1) + " '" + std::string(text.substr(0, 40)) +
                 "' is not a whole number");
  return value;
}

Result<int64_t> TextRow::time_ns(size_t field) const {
  const auto value = integer(field);
  if (!value || is_plausible_time(*value)) return value;
  return wrong("field " + std::to_string(field + 1) + " '" + std::string(fields[field].substr(0, 40)) +
               "' is no time; expected at most 2^62 ns from the clock's zero");
}

Result<std::vector<double>> numbers(const TextRow& row, size_t least) {
  if (row.fields.size() < least)
    return row.wrong("expected at least " + std::to_string(least) + " fields, found " +
                     std::to_string(row.fields.size()));
  std::vector<double> values;
  for (size_t i = 0; i < row.fields.size(); ++i) {
    const auto value = row.number(i);
    if (!value) {
      if (i >= least) break;  // trailing text is ignored
      return value.failure();
    }
    values.push_back(*value);
  }
  return values;
}

Result<std::filesystem::path> picture_of(const TextRow& row, const std::filesystem::path& folder,
                                         const ReadOptions& options) {
  if (row.fields.size() < 2) return row.wrong("expected a time and the name of a picture");
  const std::filesystem::path name = std::string(row.fields[1]), plain = name.lexically_normal();
  if (!options.pictures_outside && (plain.is_absolute() || (!plain.empty() && *plain.begin() == "..")))
    return row.wrong("'" + name.string() + "' leads out of the recording's folder; --pictures-outside allows it");
  return folder / name;
}

namespace {
Result<bool> read_lines(const std::filesystem::path& path, bool may_have_head,
                        const std::function<Result<bool>(const TextRow&)>& take) {
  std::error_code error;
  if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error))
    return Failure{ODO_E_NOT_FOUND, path.string() + ": not a file; a pipe or a device cannot be read as a table"};
  std::ifstream file(path, std::ios::binary);
  if (!file) return Failure{ODO_E_NOT_FOUND, path.string() + ": cannot be opened"};
  std::string line;
  Splitter splitter;
  bool first = true;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.size() > kLongestLine)
      return Failure{ODO_E_DATA, path.string() + ":" + std::to_string(number) + ": the line is too long for a table"};
    if (line.empty()) continue;
    if (line[0] == '#') {
      splitter.note_comment(std::string_view(line).substr(1));
      continue;
    }
    TextRow row{{}, &path, number};
    if (const auto fault = splitter.split(line, number, row.fields); !fault.empty()) return row.wrong(fault);
    if (row.fields.empty()) continue;
    const char head = row.fields[0].empty() ? '0' : row.fields[0][0];
    const bool is_head =
        may_have_head && first && !(head == '-' || head == '+' || head == '.' || (head >= '0' && head <= '9'));
    first = false;
    if (is_head) continue;
    if (const auto taken = take(row); !taken) return taken.failure();
  }
  return true;
}
}  // namespace

Result<bool> read_rows(const std::filesystem::path& path, const std::function<Result<bool>(const TextRow&)>& take) {
  return read_lines(path, true, take);
}

Result<bool> read_rows_with_names(const std::filesystem::path& path,
                                  const std::function<Result<bool>(const TextRow&)>& take) {
  return read_lines(path, false, take);
}

Result<std::vector<int64_t>> read_times(const std::filesystem::path& path) {
  std::vector<int64_t> times;
  const auto done = read_rows(path, [&](const TextRow& row) -> Result<bool> {
    const auto t = parse_seconds(row.fields[0]);
    if (!t) return row.wrong(t.failure().text);
    times.push_back(*t);
    return true;
  });
  if (!done) return done.failure();
  return times;
}

}  // namespace odograph
