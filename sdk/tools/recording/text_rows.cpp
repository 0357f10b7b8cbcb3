// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/recording/text_rows.hpp"

#include <charconv>
#include <cmath>
#include <fstream>

#include "sdk/host/messages/messages.hpp"
#include "sdk/tools/recording/recording.hpp"

namespace odograph {
namespace {

constexpr size_t kLongestLine = 1 << 16;

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  const auto separates = [](char c) { return c == ' ' || c == '\t' || c == ',' || c == ';' || c == '\r'; };
  size_t i = 0;
  while (i < line.size()) {
    while (i < line.size() && separates(line[i])) ++i;
    const size_t begin = i;
    while (i < line.size() && !separates(line[i])) ++i;
    if (i > begin) fields.push_back(line.substr(begin, i - begin));
  }
  return fields;
}

}  // namespace

Failure TextRow::wrong(const std::string& text) const {
  return {ODO_E_DATA, path->string() + ":" + std::to_string(line) + ": " + text};
}

Result<double> TextRow::number(size_t field) const {
  if (field >= fields.size()) return wrong("expected at least " + std::to_string(field + 1) + " fields");
  double value = 0;
  std::string_view text = fields[field];
  if (!text.empty() && text[0] == '+') text.remove_prefix(1);
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size() || !std::isfinite(value))
    return wrong("field " + std::to_string(field + 1) + " '" + std::string(text.substr(0, 40)) + "' is not a number");
  return value;
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
      if (i >= least) break;  // trailing text is nobody's business
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
  bool first = true;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.size() > kLongestLine)
      return Failure{ODO_E_DATA, path.string() + ":" + std::to_string(number) + ": the line is too long for a table"};
    if (line.empty() || line[0] == '#') continue;
    const TextRow row{fields_of(line), &path, number};
    if (row.fields.empty()) continue;
    const char head = row.fields[0][0];
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

}  // namespace odograph
