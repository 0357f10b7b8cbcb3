// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>

#include "sdk/host/base/result.hpp"
#include "sdk/tools/recording/phone_format.hpp"

namespace odograph::phone {

/// A row of a table in its own units; missing optional values are NaN.
struct Row {
  int64_t t_ns;
  int64_t unix_ns;  ///< 0: unknown
  std::array<double, 7> v;
};

/// The rows of one table from a file.
struct Rows {
  const Table* table;
  std::filesystem::path file;
  std::vector<Row> rows;
  size_t incomplete = 0;         ///< rows with missing values, skipped
  std::string missing_column{};  ///< a required column that the file lacks; then there are no rows
};

/// Reads one file for all its tables. Failures state file, line and column (ODO_E_DATA): text instead of a number,
/// times that have lost digits, overlong lines. A truncated last line is skipped.
Result<bool> read_tables(Layout layout, const std::filesystem::path& file, std::span<Rows> tables);

/// A failure about a line of a file.
Failure wrong_in(const std::filesystem::path& file, size_t line, const std::string& text);

/// Parses a time in its unit to nanoseconds. A number of nanoseconds with a decimal point and at most eleven digits
/// before it is taken as seconds. Nothing if it is not a time.
std::optional<int64_t> time_of(std::string_view text, TimeUnit unit);
std::optional<int64_t> time_of(double value, TimeUnit unit);

/// Splits "a|b|c", without the leading '?' that marks it optional.
std::vector<std::string> alternatives(const char* column);
inline bool is_optional(const char* column) { return *column == '?'; }

// One reader per layout, called by read_tables().
Result<bool> read_csv(const std::filesystem::path& file, Rows& rows);
Result<bool> read_named_rows(const std::filesystem::path& file, std::span<Rows> tables);
Result<bool> read_json_lines(const std::filesystem::path& file, std::span<Rows> tables);
Result<bool> read_protobuf(const std::filesystem::path& file, std::span<Rows> tables);

}  // namespace odograph::phone
