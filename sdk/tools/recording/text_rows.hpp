// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "sdk/host/base/result.hpp"

namespace odograph {

struct ReadOptions;

/// One line of a text table: its fields and position, for messages.
struct TextRow {
  std::vector<std::string_view> fields;
  const std::filesystem::path* path;
  int line;

  /// Parses a field as a finite number. Failure: "file:line: field 3 'x' is not a number".
  Result<double> number(size_t field) const;
  /// Parses a field as an integer.
  Result<int64_t> integer(size_t field) const;
  /// Parses a field as integer nanoseconds, not further from the clock's zero than kFarthestTime_ns.
  Result<int64_t> time_ns(size_t field) const;
  Failure wrong(const std::string& text) const;
};

/// Reads a table line by line; skips comments ('#'), empty lines and a first line that does not start with a number (a
/// CSV head). The first line, including a head, determines the separator: semicolons, else commas, else white space.
/// With semicolons or commas, cells may be empty or quoted, and each line must have as many as the first; otherwise the
/// failure states line and field. `take` returns a failure to stop.
Result<bool> read_rows(const std::filesystem::path& path, const std::function<Result<bool>(const TextRow&)>& take);

/// As read_rows(), for tables whose lines start with a name: no line is treated as a head.
Result<bool> read_rows_with_names(const std::filesystem::path& path,
                                  const std::function<Result<bool>(const TextRow&)>& take);

/// Times in seconds, one per line, in ns.
Result<std::vector<int64_t>> read_times(const std::filesystem::path& path);

/// Path of a picture named in a table's row after its time. A name that leads out of the folder, absolute or through
/// "..", is refused unless the options allow it; read_recording() checks links.
Result<std::filesystem::path> picture_of(const TextRow& row, const std::filesystem::path& folder,
                                         const ReadOptions& options);

/// All fields of a row as numbers, at least `least`.
Result<std::vector<double>> numbers(const TextRow& row, size_t least);

}  // namespace odograph
