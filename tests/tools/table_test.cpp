// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/table/table.hpp"
#include "sdk/tools/text/text.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("table");

TEST_CASE("a table has a line for each row, and a dash where a row has no number") {
  const Table table{"Title",
                    {{"recording", "recording"}, {"config", "config", true}},
                    {{"error", "m", "error/median", 1, kSigned}, {"", "state", "state"}, {"", "", "hidden", -1}}};
  const Rows rows = {{{"recording", "a"}, {"config", "x/walk.yaml"}, {"error", {{"median", 1.26}}}, {"state", "good"}},
                     {{"_line", "and then"}},
                     {{"recording", "long name"}, {"config", "b.yaml"}, {"error", {{"median", nullptr}}}}};
  CHECK(table_text(table, rows) ==
        "Title\n"
        "                   error\n"
        "recording  config      m  state\n"
        "a          walk     +1.3   good\n"
        "and then\n"
        "long name  b           -      -\n");
  const Table by_config{"", {}, {{"W1", "a", "W1configs/walk.yaml"}}};
  CHECK(contains(table_text(by_config, {{{"W1configs/walk.yaml", "0.17 m"}}}), "0.17 m"));
}

TEST_CASE("a summary combines numbers and lists of all rows") {
  const Rows rows = {{{"config", "a"}, {"x", {1, -2, nullptr}}, {"y", 1.0}, {"pair", {1, 4}}},
                     {{"config", "b"}, {"x", {9}}, {"y", 5.0}},
                     {{"config", "a"}, {"x", {3}}, {"y", 3.0}, {"pair", {2, 2}}}};
  const std::vector<Column> columns = {{"", "", "x/worst", 0, Format{.part = 1, .absolute = true}, "x"},
                                       {"", "", "x/median", 0, Format{}, "x"},
                                       {"", "", "mean", 0, kMean, "y"},
                                       {"", "", "sum", 0, kSum, "y"},
                                       {"", "", "share", 0, kShare, "pair"},
                                       {"", "", "all", -1, kAll, "y"},
                                       {"", "", "none", 0, Format{}, "z"}};
  const Rows summaries = summaries_of(rows, "config", columns);
  REQUIRE(summaries.size() == 2);
  CHECK(summaries[0]["config"] == "a");
  CHECK(summaries[0]["x"]["worst"] == 3);
  CHECK(summaries[0]["x"]["median"] == 1);
  CHECK(summaries[0]["mean"] == 2);
  CHECK(summaries[0]["sum"] == 4);
  CHECK(summaries[0]["share"] == 50);  // 3 of 6
  CHECK(summaries[1]["share"] == 0);
  CHECK(summaries[0]["all"] == Json{1.0, 3.0});
  CHECK(contains(Json(summaries[0]).dump(), "\"none\":null"));
  CHECK(summaries[1]["x"]["worst"] == 9);
  CHECK(visible_rows({{{"x", 1}, {"_y", 2}}}).dump() == R"([{"x":1}])");
}

TEST_CASE("a figure is described once, for rows, tables and summaries") {
  const auto row = [](double x, const Json& samples) {
    return row_of({{"head", "m", "x", 2, x, kSigned},
                   {"", "", "hidden/deep", -1, 3},
                   {"error", "m", "error", 1, samples, {.parts = {0.5, 0.9, 1}}}});
  };
  const Rows rows = {row(1.5, {1, 2}), row(2.5, {3})};
  CHECK(rows[0]["x"] == 1.5);
  CHECK(rows[0]["hidden"]["deep"] == 3);
  CHECK(visible_rows({rows[0]}).dump() == R"([{"x":1.5,"hidden":{"deep":3}}])");
  const auto columns = columns_of({Json::object(), rows[0]});
  REQUIRE(columns.size() == 5);
  CHECK(columns[0].format.sign);
  CHECK(columns[2].unit == "m median");
  CHECK(columns[3].unit == "90 %");
  CHECK(columns[4].key == "error/worst");
  const Json summary = summary_of(Json::object(), rows, columns);
  CHECK(summary["x"] == 2);
  CHECK(summary["error"]["median"] == 2);
  CHECK(summary["error"]["p90"] == doctest::Approx(2.8));
  CHECK(summary["error"]["worst"] == 3);
}

TEST_CASE("rows are grouped by their value under a key, null included, in order of appearance") {
  const Rows rows = {{{"name", "b"}, {"x", 1}}, {{"x", 2}}, {{"name", "a"}, {"x", 3}}, {{"name", "b"}, {"x", 4}}};
  const auto groups = groups_of(rows, "name");
  REQUIRE(groups.size() == 3);
  CHECK(groups[0].first == "b");
  CHECK(numbers_at(groups[0].second, "x") == std::vector<double>{1, 4});
  CHECK(groups[1].first.is_null());
  CHECK(groups[2].first == "a");
  CHECK(numbers_at(rows_with(rows, "name", Json()), "x") == std::vector<double>{2});
  CHECK(percentile_at(rows, "x", 0.5) == 2.5);
  CHECK(std::isnan(percentile_at(rows, "y", 0.5)));
}

TEST_CASE("a formatted text has its full length and may be empty") {
  CHECK(text("%s", "").empty());
  CHECK(text("%d %.2f %s", 7, 1.25, "x") == "7 1.25 x");
  CHECK(text("%s.", std::string(5000, 'a').c_str()) == std::string(5000, 'a') + '.');
}
