// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace odograph {

using Json = nlohmann::ordered_json;
using Rows = std::vector<Json>;  ///< keys that begin with '_' are not printed as JSON: samples for summaries

/// How the value of a summary comes from the rows'. Values are numbers or lists of them, which are put together; of
/// `share` pairs of a part and a whole, whose sums give a percentage, 0 of nothing. `all`: the values themselves.
enum class Over { percentile, mean, sum, first, share, all };

/// How tables and summaries have a figure.
struct As {
  bool sign = false;
  Over over = Over::percentile;
  double part = 0.5;            ///< of a percentile: 0.5 the median, 1 the worst
  bool absolute = false;        ///< sizes are summed up, not values
  std::vector<double> parts{};  ///< a column for each of these percentiles: KEY/median, KEY/p90, KEY/worst
};
inline const As kSigned{.sign = true}, kMean{.over = Over::mean}, kSum{.over = Over::sum}, kFirst{.over = Over::first},
    kShare{.over = Over::share}, kAll{.over = Over::all}, kWorst{.part = 1};

/// A named figure of a table. `key` and `from` may lead into objects: "count_percent/median". Below 0 digits it is in
/// summaries and JSON alone.
struct Column {
  std::string head, unit, key;
  int digits = 2;
  As as{};
  std::string from{};  ///< of a row, for summaries; empty: `key`
};

/// A named figure with its value: the one place that says what table, summary, JSON and kept row have of it.
struct Figure {
  std::string head, unit, key;
  int digits;
  Json value;
  As as{};
};
/// The figures' values by key, and in `_TABLE` the columns that they are of that table.
Json row_of(const std::vector<Figure>& figures, const std::string& table = "figures");
/// The columns of that table, by the first row that has them.
std::vector<Column> columns_of(const Rows& rows, const std::string& table = "figures");

/// A key that says what a row is.
struct Label {
  std::string head, key;
  bool stem = false;  ///< of a path the last part, without extension
};

struct Table {
  std::string title;
  std::vector<Label> labels;
  std::vector<Column> columns;
};

/// NaN where there is none, or no number.
double number_at(const Json& row, const std::string& key);
/// All numbers of the rows under the key.
std::vector<double> numbers_at(const Rows& rows, const std::string& key, bool absolute = false);
double percentile_at(const Rows& rows, const std::string& key, double part, bool absolute = false);

/// Each of the columns over all rows, after the labels.
Json summary_of(Json labels, const Rows& rows, const std::vector<Column>& columns);
/// One summary for each different value of `by`, in order, which is its label.
Rows summaries_of(const Rows& rows, const std::string& by, const std::vector<Column>& columns);
Rows rows_with(const Rows& rows, const std::string& key, const Json& value);
/// The different values under a key, in order, each with its rows.
std::vector<std::pair<Json, Rows>> groups_of(const Rows& rows, const std::string& key);

/// A title, two lines of heads, a line for each row; '-' where there is no number. A row {"_line": TEXT} is that text.
std::string table_text(const Table& table, const Rows& rows);

/// percentile(), NaN of nothing.
double part_of(const std::vector<double>& values, double part);

/// The rows without keys that begin with '_'.
Json printed(const Rows& rows);

}  // namespace odograph
