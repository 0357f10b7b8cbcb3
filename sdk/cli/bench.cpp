// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "sdk/cli/commands.hpp"
#include "sdk/cli/runner.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

struct WalkArguments {
  std::vector<std::string> configs;
  std::string data;
  double align_first_m = 10;
  bool each = false, json = false;
};

struct WalkRow {
  std::string name;
  double reference_m, estimate_m, distance_percent, position_median_m;
  std::vector<double> position_m;
  uint64_t steps;
};

Result<std::vector<WalkRow>> run_walks(const std::string& config, const std::vector<fs::path>& files,
                                       double align_first_m) {
  Progress progress(config);
  std::vector<WalkRow> rows;
  for (size_t i = 0; i < files.size(); ++i) {
    progress.show(i, files.size());
    const auto recording = read_recording(files[i]);
    if (!recording) return recording.failure();
    RunOptions options;
    options.config = config;
    const auto result = replay(*recording, options);
    if (!result) return result.failure();
    const auto waypoints = recording->waypoints();
    const double turn = heading_offset(result->track, waypoints, align_first_m);
    const WaypointErrors e = waypoint_errors(lay_over(result->track, waypoints, turn), waypoints);
    rows.push_back({files[i].filename().string(), e.reference_m, e.estimate_m, 100 * e.distance_error(),
                    percentile(e.position_m, 0.5), e.position_m, result->statistics.steps});
  }
  return rows;
}

nlohmann::ordered_json summary(const std::string& config, const std::vector<WalkRow>& rows) {
  std::vector<double> distance, medians, all;
  double reference = 0, estimate = 0;
  for (const WalkRow& row : rows) {
    distance.push_back(std::abs(row.distance_percent));
    medians.push_back(row.position_median_m);
    all.insert(all.end(), row.position_m.begin(), row.position_m.end());
    reference += row.reference_m, estimate += row.estimate_m;
  }
  return {{"config", config},
          {"walks", rows.size()},
          {"reference_m", reference},
          {"total_percent", 100 * (estimate - reference) / reference},
          {"distance_percent", {{"median", percentile(distance, 0.5)}, {"p90", percentile(distance, 0.9)}}},
          {"position_m", {{"median", percentile(all, 0.5)}, {"p90", percentile(all, 0.9)}}},
          {"position_walk_median_m", {{"median", percentile(medians, 0.5)}, {"p90", percentile(medians, 0.9)}}}};
}

int walks(const WalkArguments& a) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(a.data, error))
    if (entry.path().extension() == ".txt") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty()) return complain({ODO_E_NOT_FOUND, a.data + ": no walks (*.txt) in this folder"});
  nlohmann::ordered_json all = nlohmann::json::array();
  if (!a.json)
    std::printf(
        "%zu walks from %s; heading fitted over the first %.0f m\n\n%-44s %9s %19s %19s\n%-44s %9s %9s %9s %9s %9s\n",
        files.size(), a.data.c_str(), a.align_first_m, "", "total", "distance error (%)", "position error (m)",
        "config", "(%)", "median", "90 %", "median", "90 %");
  for (const auto& config : a.configs) {
    const auto rows = run_walks(config, files, a.align_first_m);
    if (!rows) return complain(rows.failure());
    const auto s = summary(config, *rows);
    all.push_back(s);
    if (a.json) continue;
    if (a.each)
      for (const WalkRow& row : *rows)
        std::printf("  %-42s %+8.2f  %7.2f m of %7.2f m, %4llu steps, waypoints %.2f m\n", row.name.c_str(),
                    row.distance_percent, row.estimate_m, row.reference_m, static_cast<unsigned long long>(row.steps),
                    row.position_median_m);
    std::printf("%-44s %+9.2f %9.2f %9.2f %9.2f %9.2f\n", config.c_str(), s["total_percent"].get<double>(),
                s["distance_percent"]["median"].get<double>(), s["distance_percent"]["p90"].get<double>(),
                s["position_m"]["median"].get<double>(), s["position_m"]["p90"].get<double>());
  }
  if (a.json) std::printf("%s\n", all.dump(2).c_str());
  return kDone;
}

}  // namespace

void add_bench(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("bench", "Run configs over many recordings and print a table");
  command->require_subcommand(1);
  auto a = std::make_shared<WalkArguments>();
  auto* walks_command =
      command->add_subcommand("walks", "Distance and position errors over a folder of walks with waypoints");
  walks_command->add_option("data", a->data, "folder of Indoor Location Competition traces")->required();
  walks_command->add_option("-c,--config", a->configs, "pipeline configs to compare")->required();
  walks_command->add_option("--align-first", a->align_first_m, "the heading is fitted over these first metres")
      ->capture_default_str();
  walks_command->add_flag("--each", a->each, "a line for each walk");
  walks_command->add_flag("--json", a->json, "print one JSON object");
  walks_command->callback([a, &status] { status = walks(*a); });
  add_bench_walk700(*command, status);
  add_bench_allan(*command, status);
  add_bench_calibrate(*command, status);
  add_bench_drive(*command, status);
  add_bench_gait(*command, status);
  add_bench_vo(*command, status);
  add_bench_steps(*command, status);
  add_bench_tracks(*command, status);
}

}  // namespace odograph
