// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>

#include "sdk/host/base/result.hpp"
#include "sdk/tools/recording/phone_format.hpp"

namespace odograph::phone {

/// A row of a table in its own units: a value that is optional and not there is NaN.
struct Row {
  int64_t t_ns;
  int64_t unix_ns;  ///< 0: not known
  std::array<double, 7> v;
};

/// What a file held for one table.
struct Rows {
  const Table* table;
  std::filesystem::path file;
  std::vector<Row> rows;
  size_t incomplete = 0;         ///< rows that lack a value, left out
  std::string missing_column{};  ///< a column that the file has not; then there are no rows
};

/// Reads one file for all tables that are of it. Failures name file, line and column (ODO_E_DATA): what is no number,
/// times that have lost digits, lines without end. A last line that is cut off is left out.
Result<bool> read_tables(Layout layout, const std::filesystem::path& file, std::span<Rows> tables);

/// What is wrong with a line of a file.
Failure wrong_in(const std::filesystem::path& file, size_t line, const std::string& text);

/// A time in its unit as nanoseconds; with a decimal point and at most eleven digits before it a count of nanoseconds
/// can only be one of seconds. Nothing where it is no time.
std::optional<int64_t> time_of(std::string_view text, TimeUnit unit);
std::optional<int64_t> time_of(double value, TimeUnit unit);

/// "a|b|c" apart, and without the leading '?' that makes it optional.
std::vector<std::string> alternatives(const char* column);
inline bool is_optional(const char* column) { return *column == '?'; }

// One for each layout; read_tables calls them.
Result<bool> read_csv(const std::filesystem::path& file, Rows& rows);
Result<bool> read_named_rows(const std::filesystem::path& file, std::span<Rows> tables);
Result<bool> read_json_lines(const std::filesystem::path& file, std::span<Rows> tables);
Result<bool> read_protobuf(const std::filesystem::path& file, std::span<Rows> tables);

}  // namespace odograph::phone
