// SPDX-License-Identifier: Apache-2.0
//
// `odograph bench steps --data`: step estimators on real walks, by data set, carrying place, pace and person.
#include <algorithm>
#include <cmath>

#include "sdk/tools/benchmarks/step_data.hpp"
#include "sdk/tools/evaluation/walk_truth.hpp"
#include "sdk/tools/simulation/random.hpp"

namespace odograph {
namespace fs = std::filesystem;

namespace {

std::vector<std::string> walks_in(const fs::path& folder) {
  std::vector<std::string> walks;
  for (const std::string& file : files_in(folder, "", {".txt", ".csv", ".odo"})) {
    const std::string name = fs::path(file).filename().string();
    if (name != "index.csv" && !name.ends_with("_stepcounter.csv")) walks.push_back(file);
  }
  return walks;
}

/// Half-width of the 95 % interval of the means of resampled people; NaN for one person.
double half_interval(const Rows& rows, const std::string& key, bool absolute) {
  constexpr int kDraws = 1000;
  std::vector<std::vector<double>> people;
  for (const auto& [person, own] : groups_of(rows, "person"))
    if (auto values = numbers_at(own, key, absolute); !values.empty()) people.push_back(std::move(values));
  if (people.size() < 2) return std::nan("");
  Random random(1, 0);
  std::vector<double> means;
  for (int draw = 0; draw < kDraws; ++draw) {
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < people.size(); ++i) {
      const auto& values = people[random.next() % people.size()];
      for (const double x : values) sum += x;
      count += values.size();
    }
    means.push_back(sum / static_cast<double>(count));
  }
  return 0.5 * (percentile_or_nan(means, 0.975) - percentile_or_nan(means, 0.025));
}

/// Percentage of the walks whose value is below a limit; NaN without values.
double share_below(const Rows& rows, const std::string& key, double limit) {
  const auto values = numbers_at(rows, key, false);
  const auto below = std::count_if(values.begin(), values.end(), [&](double x) { return x < limit; });
  return values.empty() ? std::nan("") : 100 * static_cast<double>(below) / static_cast<double>(values.size());
}

/// Percentage of the distance on walks whose error exceeds three stated standard deviations.
double share_beyond_3_sigma(const Rows& rows) {
  double all_m = 0, beyond_m = 0;
  for (const Json& row : rows) {
    const double true_m = number_at(row, "true_m"), nees = number_at(row, "_walk_nees");
    if (!(true_m > 0) || !std::isfinite(nees)) continue;
    all_m += true_m, beyond_m += nees > 9 ? true_m : 0;
  }
  return all_m > 0 ? 100 * beyond_m / all_m : std::nan("");
}

/// By the true speed while walking, where a distance is known, m/s; about two thirds of people choose a usual one.
std::string pace_of(const WalkTruthFigures& f) {
  constexpr double kSlow_mps = 1.05, kFast_mps = 1.45;
  if (!(f.true_m > 0 && f.walked_s > 0)) return "unknown";
  const double speed_mps = f.true_m / f.walked_s;
  return speed_mps < kSlow_mps ? "slow" : speed_mps < kFast_mps ? "usual" : "fast";
}

Json line_of(const Json& labels, const Rows& rows) {
  const auto sizes = [&](const char* key, double part) { return percentile_at(rows, key, part, true); };
  const auto mean = [&](const char* key, bool absolute = false) {
    const auto values = numbers_at(rows, key, absolute);
    double sum = 0;
    for (const double x : values) sum += x;
    return values.empty() ? std::nan("") : sum / static_cast<double>(values.size());
  };
  double stepless = 0, floors = 0, wrong = 0, places = 0, right = 0;
  for (const Json& row : rows)
    stepless += row["steps"].get<double>() == 0, floors += number_at(row, "floors"),
        wrong += number_at(row, "wrong_floors"), places += number_at(row, "_floor_places"),
        right += number_at(row, "_floor_right");
  Json line = labels;
  line.update(Json{{"walks", rows.size()},
                   {"stepless", stepless},
                   {"count", mean("count_percent", true)},
                   {"count_worst", sizes("count_percent", 1)},
                   {"peaks", mean("peaks_percent", true)},
                   {"distance_mean", mean("distance_percent")},
                   {"distance_median", sizes("distance_percent", 0.5)},
                   {"distance_p90", sizes("distance_percent", 0.9)},
                   {"distance_interval", half_interval(rows, "distance_percent", true)},
                   {"position_mean", mean("position_m")},
                   {"position_median", sizes("position_m", 0.5)},
                   {"position_interval", half_interval(rows, "position_m", false)},
                   {"heading", sizes("_heading_deg", 0.5)},
                   {"heading_p90", sizes("_heading_deg", 0.9)},
                   {"nees", mean("_normalised_error")},
                   {"walk_nees", mean("_walk_nees")},
                   {"within_sigma", share_below(rows, "_walk_nees", 1)},
                   {"beyond_3_sigma", share_beyond_3_sigma(rows)},
                   {"floors", floors > 0 ? floors : std::nan("")},
                   {"wrong_floors", floors > 0 ? wrong : std::nan("")},
                   {"floor_right", places > 0 ? 100 * right / places : std::nan("")},
                   {"floor_probability", 100 * mean("_floor_probability")}});
  return line;
}

double percent(double estimate, double truth) { return 100 * (estimate / truth - 1); }

/// Adds to each walk the distance from a fixed step length: a common one, and the walker's, calibrated on the walker's
/// other walks.
Rows with_fixed_steps(Rows rows) {
  for (Json& row : rows) {
    const auto of = [](const Json& one, const char* key) { return number_at(one, key); };
    double others_m = 0, others = 0;
    for (const Json& other : rows)
      if (other["data"] == row["data"] && other["config"] == row["config"] && other["person"] == row["person"] &&
          other["recording"] != row["recording"] && of(other, "_counted") > 0)
        others_m += of(other, "true_m"), others += of(other, "_counted");
    const double counted = of(row, "_counted"), true_m = of(row, "true_m");
    row["_fixed_percent"] = percent(kFixedStep_m * counted, true_m);
    row["_own_percent"] = others > 0 ? percent(others_m / others * counted, true_m) : std::nan("");
    row["_gain_m"] = of(row, "_fixed_mean_m") - of(row, "_mean_m");
    row["_end_percent"] = 100 * of(row, "_end_m") / true_m;
    row["_fixed_end_percent"] = 100 * of(row, "_fixed_end_m") / true_m;
  }
  return rows;
}

/// Antigny et al. 2019, Table 5, on these walks.
std::string adaptive_against_fixed(const Rows& all) {
  Rows lines;
  for (const auto& [set, of_set] : groups_of(with_fixed_steps(all), "data"))
    for (const auto& [config, rows] : groups_of(of_set, "config")) {
      Json line{{"data", set}, {"config", config}};
      for (const char* key : {"_end_percent", "_fixed_end_percent", "_mean_m", "_fixed_mean_m", "distance_percent",
                              "_fixed_percent", "_own_percent"})
        line[key] = percentile_at(rows, key, 0.5, true);
      const auto gains = numbers_at(rows, "_gain_m", false);
      double sum = 0, better = 0;
      for (const double gain : gains) sum += gain, better += gain > 0;
      const auto n = static_cast<double>(gains.size());
      line.update(Json{{"gain", n > 0 ? sum / n : std::nan("")},
                       {"interval", half_interval(rows, "_gain_m", false)},
                       {"better", n > 0 ? 100 * better / n : std::nan("")}});
      if (percentile_at(rows, "true_m", 0.5, true) > 0) lines.push_back(line);
    }
  const Table table{
      "adaptive against fixed step length (0.41 of 1.70 m), the same steps and headings; medians of walks",
      {{"data", "data"}, {"config", "config", true}},
      {{"at the end", "%", "_end_percent", 1},
       {"", "fixed %", "_fixed_end_percent", 1},
       {"mean error", "m", "_mean_m", 2},
       {"", "fixed m", "_fixed_mean_m", 2},
       {"gain", "mean m", "gain", 2, kSigned},
       {"people", "+- m", "interval", 2},
       {"better", "% of walks", "better", 0},
       {"distance", "%", "distance_percent", 1},
       {"", "fixed %", "_fixed_percent", 1},
       {"", "own fixed %", "_own_percent", 1}}};
  return table_text(table, lines);
}

std::string table_by(const Rows& rows, const std::string& by) {
  Rows lines;
  const auto add = [&](const Json& set, const Rows& of_set) {
    for (const auto& [value, own] : groups_of(of_set, by))
      for (const auto& [config, of_config] : groups_of(own, "config")) {
        Json labels{{"data", set}};
        if (by != "data") labels[by] = value;
        labels["config"] = config;
        lines.push_back(line_of(labels, of_config));
      }
  };
  for (const auto& [set, of_set] : groups_of(rows, "data")) add(set, of_set);
  if (by == "pace") add("all", rows);
  Table table{by == "data" ? "" : "by " + by, {{"data", "data"}}, {}};
  if (by != "data") table.labels.push_back({by, by});
  table.labels.push_back({"config", "config", true});
  table.columns = {{"walks", "", "walks", 0},
                   {"none", "", "stepless", 0},
                   {"count", "%", "count", 1},
                   {"worst", "%", "count_worst", 1},
                   {"peaks", "%", "peaks", 1},
                   {"distance", "mean %", "distance_mean", 1, kSigned},
                   {"size", "median %", "distance_median", 1},
                   {"", "90 %", "distance_p90", 1},
                   {"mean", "+- %", "distance_interval", 1},
                   {"position", "mean m", "position_mean", 2},
                   {"", "median m", "position_median", 2},
                   {"mean", "+- m", "position_interval", 2},
                   {"heading", "deg", "heading", 1},
                   {"", "90 %", "heading_p90", 1},
                   {"NEES", "", "nees", 2},
                   {"of walks", "", "walk_nees", 2},
                   {"in sigma", "%", "within_sigma", 0},
                   {"beyond 3", "% of m", "beyond_3_sigma", 1},
                   {"floors", "", "floors", 0},
                   {"wrong", "", "wrong_floors", 0},
                   {"number", "right %", "floor_right", 1},
                   {"", "stated %", "floor_probability", 1}};
  return table_text(table, lines);
}

}  // namespace

Result<std::vector<BenchCase>> step_data_cases(const std::vector<std::string>& folders) {
  std::vector<BenchCase> all;
  for (const std::string& folder : folders) {
    auto walks = walks_in(folder);
    std::error_code error;
    if (walks.empty())
      for (const auto& entry : fs::directory_iterator(folder, error))
        for (std::string& walk : walks_in(entry.path())) walks.push_back(std::move(walk));
    if (walks.empty()) return Failure{ODO_E_NOT_FOUND, folder + ": no walks (*.txt, *.csv, *.odo) in this folder"};
    std::sort(walks.begin(), walks.end());
    for (const std::string& walk : walks)
      all.push_back({{{"data", stem_of(folder)}, {"recording", stem_of(walk)}}, {walk}});
  }
  return all;
}

Json step_data_row(const Recording& recording, const RunResult& result) {
  const WalkTruthFigures f = walk_truth_figures(recording, result.steps, result.track);
  const WalkerName name = walker_name(recording);
  const Format none{.aggregate = Aggregate::all};
  Json row = row_of({{"steps", "", "steps", 0, result.steps.size(), none},
                     {"true", "", "true_steps", 0, f.true_steps, none},
                     {"peaks", "", "peaks", 0, f.peaks, none},
                     {"count", "%", "count_percent", 1, f.count_percent, kSigned},
                     {"peaks", "%", "peaks_percent", 1, f.peaks_percent, kSigned},
                     {"true", "m", "true_m", 1, f.true_m, none},
                     {"distance", "%", "distance_percent", 1, percent(f.estimated_m, f.true_m), kSigned},
                     {"position", "m", "position_m", 2, f.position_m, none},
                     {"floors", "", "floors", 0, f.floors, none},
                     {"wrong", "", "wrong_floors", 0, f.wrong_floors, none}});
  row.update(Json{{"person", name.person},
                  {"place", name.place},
                  {"pace", pace_of(f)},
                  {"_heading_deg", f.heading_deg},
                  {"_normalised_error", f.normalised_error},
                  {"_walk_nees", f.sigma_m > 0 ? std::pow((f.estimated_m - f.true_m) / f.sigma_m, 2) : std::nan("")},
                  {"_counted", f.counted},
                  {"from_ns", f.from_ns},
                  {"to_ns", f.to_ns},
                  {"_floor_places", f.floor_places},
                  {"_floor_right", f.floor_right},
                  {"_floor_probability", f.floor_probability},
                  {"_end_m", f.adaptive.end_m},
                  {"_mean_m", f.adaptive.mean_m},
                  {"_fixed_end_m", f.fixed.end_m},
                  {"_fixed_mean_m", f.fixed.mean_m}});
  return row;
}

std::string step_data_report(const Rows& rows) {
  return table_by(rows, "data") + '\n' + table_by(rows, "place") + '\n' + table_by(rows, "pace") + '\n' +
         table_by(rows, "person") + '\n' + adaptive_against_fixed(rows);
}

}  // namespace odograph
