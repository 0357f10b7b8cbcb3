// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace odograph {

using Json = nlohmann::ordered_json;
using Rows = std::vector<Json>;  ///< keys that begin with '_' are not printed as JSON: samples for summaries

/// Aggregation of the rows' values in a summary. Values are numbers or lists of numbers, which are concatenated; for
/// `share`, pairs of part and whole, whose sums give a percentage (0 for none). `all`: the values themselves.
enum class Aggregate { percentile, mean, sum, first, share, all };

/// Format of a figure in tables and summaries.
struct Format {
  bool sign = false;
  Aggregate aggregate = Aggregate::percentile;
  double part = 0.5;            ///< of a percentile: 0.5 the median, 1 the worst
  bool absolute = false;        ///< aggregates absolute values
  std::vector<double> parts{};  ///< a column for each of these percentiles: KEY/median, KEY/p90, KEY/worst
};
inline const Format kSigned{.sign = true}, kMean{.aggregate = Aggregate::mean}, kSum{.aggregate = Aggregate::sum},
    kFirst{.aggregate = Aggregate::first}, kShare{.aggregate = Aggregate::share}, kAll{.aggregate = Aggregate::all},
    kWorst{.part = 1};

/// A named figure of a table. `key` and `from` may be nested: "count_percent/median". With negative digits, it appears
/// only in summaries and JSON.
struct Column {
  std::string head, unit, key;
  int digits = 2;
  Format format{};
  std::string from{};  ///< source in a row, for summaries; empty: `key`
};

/// A named figure with its value: the single definition for table, summary, JSON and kept row.
struct Figure {
  std::string head, unit, key;
  int digits;
  Json value;
  Format format{};
};
/// The figures' values by key, and in `_TABLE` their columns in that table.
Json row_of(const std::vector<Figure>& figures, const std::string& table = "figures");
/// The columns of that table, from the first row that has them.
std::vector<Column> columns_of(const Rows& rows, const std::string& table = "figures");

/// A key that identifies a row.
struct Label {
  std::string head, key;
  bool stem = false;  ///< the last part of a path, without extension
};

struct Table {
  std::string title;
  std::vector<Label> labels;
  std::vector<Column> columns;
};

/// NaN if missing or not a number.
double number_at(const Json& row, const std::string& key);
/// All numbers of the rows under the key.
std::vector<double> numbers_at(const Rows& rows, const std::string& key, bool absolute = false);
double percentile_at(const Rows& rows, const std::string& key, double part, bool absolute = false);

/// Aggregates each column over all rows, after the labels.
Json summary_of(Json labels, const Rows& rows, const std::vector<Column>& columns);
/// One summary for each distinct value of `by`, in order, with the value as label.
Rows summaries_of(const Rows& rows, const std::string& by, const std::vector<Column>& columns);
Rows rows_with(const Rows& rows, const std::string& key, const Json& value);
/// The distinct values under a key, in order, each with its rows.
std::vector<std::pair<Json, Rows>> groups_of(const Rows& rows, const std::string& key);

/// A title, two header lines, one line per row; '-' for missing numbers. A row {"_line": TEXT} is printed as that text.
std::string table_text(const Table& table, const Rows& rows);

/// percentile(), or NaN for no values.
double percentile_or_nan(const std::vector<double>& values, double part);

/// The rows without keys that begin with '_'.
Json visible_rows(const Rows& rows);

}  // namespace odograph
