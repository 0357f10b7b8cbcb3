// SPDX-License-Identifier: Apache-2.0
//
// Walks with waypoints, many of them: `odograph bench walks`.
#include <algorithm>
#include <cmath>

#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/evaluation/walk_figures.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

const std::vector<Column> kColumns = {
    {"walks", "", "walks", 0, false, "_one", Over::sum},
    {"", "", "reference_m", 1, false, "_reference_m", Over::sum},
    {"", "", "_estimate_m", 1, false, "_estimate_m", Over::sum},
    {"distance error", "% median", "distance_percent/median", 2, false, "_distance_percent", Over::percentile, 0.5,
     true},
    {"", "90 %", "distance_percent/p90", 2, false, "_distance_percent", Over::percentile, 0.9, true},
    {"position error", "m median", "position_m/median", 2, false, "_position_m"},
    {"", "90 %", "position_m/p90", 2, false, "_position_m", Over::percentile, 0.9},
    {"heading", "deg/min median", "heading_drift_deg_min/median", 1, false, "_drift_deg_min", Over::percentile, 0.5,
     true},
    {"", "90 %", "heading_drift_deg_min/p90", 1, false, "_drift_deg_min", Over::percentile, 0.9, true},
    {"", "", "position_walk_median_m/median", 2, false, "_position_median_m"},
    {"", "", "position_walk_median_m/p90", 2, false, "_position_median_m", Over::percentile, 0.9}};

std::string oracles_of(const Rows& rows) {
  const auto line = [&](const char* name, const char* key, double factor, const char* unit) {
    return text("  %-60s %9.2f %9.2f %s\n", name, factor * percentile_at(rows, key, 0.5, true),
                factor * percentile_at(rows, key, 0.9, true), unit);
  };
  return line("position, were each leg's heading true: median, 90 %", "_true_headings_m", 1, "m") +
         line("position, were each leg's length true", "_true_lengths_m", 1, "m") +
         line("heading of a leg, its walk's mean taken off", "_leg_heading_rad", 180 / EIGEN_PI, "deg") +
         line("length of a leg", "_leg_length", 100, "%");
}

struct Walks : Benchmark {
  Walks() : Benchmark("walks", "Distance and position errors over a folder of walks with waypoints", kConfigs) {}
  void add_options(CLI::App& command) override {
    command.add_option("data", data, "folder of Indoor Location Competition traces or of recordings with marks")
        ->required()
        ->group(kCases);
    command.add_option("--align-first", align_first_m, "the heading is fitted over these first metres");
    command.add_flag("--each", each, "a line for each walk")->group(kOutput);
    command.add_flag("--oracles", oracles, "what is left were the legs' headings true, or their lengths")
        ->group(kOutput);
  }

  Result<std::vector<BenchCase>> cases() override {
    options.recordings.clear();
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(data, error))
      if (entry.path().extension() == ".txt" || entry.path().extension() == ".odo")
        options.recordings.push_back(entry.path());
    std::sort(options.recordings.begin(), options.recordings.end());
    if (options.recordings.empty()) return Failure{ODO_E_NOT_FOUND, data + ": no walks (*.txt, *.odo) in this folder"};
    return Benchmark::cases();
  }

  Result<Json> measure(const BenchCase& one, const ShowProgress& progress) const override {
    BenchCase attitudes = one;
    attitudes.run.collect_attitudes = true;
    return replayed(attitudes, progress, [&](const Recording& recording, const RunResult& result) -> Result<Json> {
      const auto waypoints = recording.waypoints();
      const double yaw = heading_offset(result.track, waypoints, align_first_m);
      WaypointErrors e = waypoint_errors(lay_over(result.track, waypoints, yaw), waypoints);
      // Where the truth is there its own path is the reference, not the polyline.
      if (!recording.truth.empty()) e.reference_m = waypoint_errors(recording.truth, waypoints).estimate_m;
      const LegOracles legs = leg_oracles(result.track, waypoints, align_first_m);
      return Json{{"_one", 1},
                  {"_reference_m", e.reference_m},
                  {"_estimate_m", e.estimate_m},
                  {"_distance_percent", 100 * e.distance_error()},
                  {"_position_median_m", percentile(e.position_m, 0.5)},
                  {"_position_m", e.position_m},
                  {"_steps", result.statistics.steps},
                  {"_drift_deg_min", heading_drift(result.attitudes, recording.phone_attitudes)},
                  {"_true_headings_m", legs.true_headings_m},
                  {"_true_lengths_m", legs.true_lengths_m},
                  {"_leg_heading_rad", legs.heading_rad},
                  {"_leg_length", legs.length}};
    });
  }

  BenchReport report(const Rows& rows) const override {
    Rows summaries = summaries_of(rows, "config", kColumns);
    std::vector<Column> shown(kColumns.begin() + 3, kColumns.end() - 2);
    shown.insert(shown.begin(), {"total", "%", "total_percent", 2, true});
    for (Json& s : summaries) {
      const double reference_m = number_at(s, "reference_m");
      s["total_percent"] = 100 * (number_at(s, "_estimate_m") - reference_m) / reference_m;
    }
    std::string out = text("%zu walks from %s; heading fitted over the first %.0f m\n\n", options.recordings.size(),
                           data.c_str(), align_first_m) +
                      table_text({"", {{"config", "config"}}, shown}, summaries);
    const Table walks{"",
                      {{"walk", "recording"}},
                      {{"distance", "%", "_distance_percent", 2, true},
                       {"", "m", "_estimate_m"},
                       {"of", "m", "_reference_m"},
                       {"", "steps", "_steps", 0},
                       {"waypoints", "m", "_position_median_m"},
                       {"heading", "deg/min", "_drift_deg_min", 1, true}}};
    for (const Json& config : values_of(rows, "config")) {
      if (each || oracles) out += '\n' + config.get<std::string>() + '\n';
      if (each) out += table_text(walks, rows_with(rows, "config", config));
      if (oracles) out += oracles_of(rows_with(rows, "config", config));
    }
    return {out, printed(summaries), {}};
  }

  std::string data;
  double align_first_m = 10;
  bool each = false, oracles = false;
};

}  // namespace

std::shared_ptr<Benchmark> bench_walks() { return std::make_shared<Walks>(); }

}  // namespace odograph
