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

/// One line of a text table: its fields and where it stands, for messages.
struct TextRow {
  std::vector<std::string_view> fields;
  const std::filesystem::path* path;
  int line;

  /// A field as a finite number. Failure: "file:line: field 3 'x' is not a number".
  Result<double> number(size_t field) const;
  /// A field as a whole number.
  Result<int64_t> integer(size_t field) const;
  /// A field as a time in whole nanoseconds, not further from the clock's zero than kFarthestTime_ns.
  Result<int64_t> time_ns(size_t field) const;
  Failure wrong(const std::string& text) const;
};

/// Reads a table line by line: comments ('#'), empty lines and a first line that does not start with a number (a CSV
/// head) are skipped. The first line, a head included, settles what separates fields: semicolons, or else commas, or
/// else white space. Between semicolons or commas there are cells: they may be empty or stand in quotes, and each line
/// has as many as the first; otherwise it is a failure with line and field. `take` returns a failure to stop.
Result<bool> read_rows(const std::filesystem::path& path, const std::function<Result<bool>(const TextRow&)>& take);

/// As read_rows, for tables whose lines start with a name: no line is taken for a head.
Result<bool> read_rows_with_names(const std::filesystem::path& path,
                                  const std::function<Result<bool>(const TextRow&)>& take);

/// Where a picture lies that a table's row names behind its time. A name that leads out of the folder, absolute or by
/// "..", is refused unless the options allow it; where links lead read_recording looks.
Result<std::filesystem::path> picture_of(const TextRow& row, const std::filesystem::path& folder,
                                         const ReadOptions& options);

/// All fields of a row as numbers, at least `least`.
Result<std::vector<double>> numbers(const TextRow& row, size_t least);

}  // namespace odograph
