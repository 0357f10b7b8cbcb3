// SPDX-License-Identifier: Apache-2.0
//
// The 0.7 km walk of Antigny et al. 2019 rebuilt: `odograph bench walk700` prints its Table 5.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <regex>

#include <nlohmann/json.hpp>
#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/console/console.hpp"
#include "sdk/tools/replay/kept_recordings.hpp"
#include "sdk/tools/replay/runner.hpp"
#include "sdk/tools/simulation/scenario.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWalkers[] = {"W1", "M1", "W2"};

struct Walk700Arguments {
  std::vector<std::string> configs = {"samples/configs/antigny2019.yaml", "samples/configs/antigny2019_fixed_step.yaml",
                                      "samples/configs/phone_walk_camera.yaml"};
  std::string scenarios = "samples/scenarios", keep = "out/bench";
  uint64_t seeds = 1, first_seed = 1;
  bool quick = false, json = false;
};

/// Errors at the scored places, and the mean over all frames, m.
struct Errors {
  std::array<double, 3> at_m{};
  double mean_m = 0;
};

/// One run, by two starts: a fix of position and heading after 12 m, as an app has it from a known object, and the path
/// of the first 12 m.
struct Walk700Row {
  Errors by_pose, by_path;
  std::array<double, 3> walked_m{};  ///< until the scored places
  size_t fixes = 0;                  ///< accepted
};

/// The config with the walker's height in it, if it asks for one, as the paper's authors knew their walkers'.
Result<fs::path> config_of(const Walk700Arguments& a, const std::string& config, const std::string& walker,
                           double height_m) {
  const auto text = text_of(config);
  if (!text) return text.failure();
  const std::regex height("(walker:\\s*\\n\\s+height:)[^\\n]*");
  if (!std::regex_search(*text, height)) return fs::path(config);  // it knows no walker
  const fs::path file = fs::path(a.keep) / (fs::path(config).stem().string() + "-" + walker + ".yaml");
  std::ofstream(file) << std::regex_replace(*text, height, "$1 " + std::to_string(height_m));
  return file;
}

/// What a track is laid by. Known objects are surveyed in n: one that is put in place by them is not laid over the
/// start. Without a camera the heading of a pose is not the path's: the path alone tells that.
enum class Start { surveyed, by_pose, by_path };
Result<Start> start_of(const RunOptions& options) {
  const auto text = text_of(options.config);
  if (!text) return text.failure();
  const auto config = read_pipeline_config(*text, options.config, plugin_directories({}));
  if (!config) return config.failure();
  if (std::any_of(config->fixers.begin(), config->fixers.end(),
                  [](const auto& fixer) { return fixer.manifest.id.starts_with("fix/known_object"); }))
    return Start::surveyed;
  return config->vo_frontends.empty() ? Start::by_path : Start::by_pose;
}

Errors errors_of(const Trajectory& track, const Trajectory& truth, const std::array<int64_t, 3>& scored_ns) {
  const auto error_at = [&](int64_t t) { return (position_at(track, t) - position_at(truth, t)).head<2>().norm(); };
  Errors errors;
  for (const StampedPose& pose : truth) errors.mean_m += error_at(pose.t_ns);
  errors.mean_m /= static_cast<double>(std::max<size_t>(1, truth.size()));
  for (size_t k = 0; k < 3; ++k) errors.at_m[k] = error_at(scored_ns[k]);
  return errors;
}

Result<Walk700Row> run(const Walk700Arguments& a, const std::string& config, const std::string& walker, uint64_t seed) {
  const auto file =
      kept_recording(fs::path(a.scenarios) / ("walk700_" + walker + ".yaml"), seed, a.keep, a.quick ? 120.0 : 0.0);
  if (!file) return file.failure();
  const auto recording = open_recording(*file);
  if (!recording) return recording.failure();
  const auto scenario = read_scenario((fs::path(a.scenarios) / ("walk700_" + walker + ".yaml")).string());
  const auto own_config = config_of(a, config, walker, scenario->walker.height_m);
  if (!own_config) return own_config.failure();
  Progress progress("run " + walker + " seed " + std::to_string(seed));
  RunOptions options;
  options.config = own_config->string();
  options.asset_path = assets_of(*file).string();
  options.progress = [&](size_t i, size_t n) { progress.show(i, n); };
  const auto result = replay(*recording, options);
  if (!result) return result.failure();
  const auto start = start_of(options);
  if (!start) return start.failure();
  const auto walked_until = [&](int64_t t) {
    double sum = 0;
    for (const odo_step& step : recording->true_steps) sum += step.t_end_ns <= t ? step.length_m : 0.0;
    return sum;
  };
  Walk700Row row;
  row.fixes = static_cast<size_t>(std::count_if(result->fixes.begin(), result->fixes.end(),
                                                [](const RunResult::Fix& fix) { return fix.accepted; }));
  const auto marks = recording->waypoints();
  const int64_t end = recording->truth.back().t_ns;
  const std::array<double, 3> wanted = {120, 550, 1e9};
  std::array<int64_t, 3> scored{};
  for (size_t k = 0; k < 3; ++k) {
    scored[k] = end;
    for (const Waypoint& mark : marks)
      if (std::abs(walked_until(mark.t_ns) - wanted[k]) < std::abs(walked_until(scored[k]) - wanted[k]))
        scored[k] = mark.t_ns;
    row.walked_m[k] = walked_until(scored[k]);
  }
  const Trajectory& truth = recording->truth;
  constexpr double kStart_m = 12;
  const Trajectory by_path = *start == Start::surveyed ? result->track : started(truth, result->track, kStart_m);
  row.by_path = errors_of(by_path, truth, scored);
  row.by_pose = *start == Start::by_pose ? errors_of(started_by_pose(truth, result->track, kStart_m), truth, scored)
                                         : row.by_path;
  return row;
}

double median_of(const std::vector<Walk700Row>& rows, const std::function<double(const Walk700Row&)>& value) {
  std::vector<double> values;
  for (const Walk700Row& row : rows) values.push_back(value(row));
  return percentile(values, 0.5);
}

using Table = std::vector<std::vector<std::vector<Walk700Row>>>;  // config, walker, seed

constexpr const char* kPlaces[] = {"On waypoint (after 120 m)", "On waypoint (after 550 m)", "On finish (after 700 m)",
                                   "Mean positioning error"};

void print_rows(const Walk700Arguments& a, const Table& table, Errors Walk700Row::*start) {
  for (size_t k = 0; k < 4; ++k) {
    if (a.quick && k > 0 && k < 3) continue;
    std::printf("\n%-28s", kPlaces[k]);
    for (size_t w = 0; w < 3; ++w) {
      std::printf("  ");
      for (const auto& config : table) {
        char cell[40];
        if (k < 3)
          std::snprintf(
              cell, sizeof cell, "%6.2f m (%5.2f %%)",
              median_of(config[w], [&](const auto& row) { return (row.*start).at_m[k]; }),
              median_of(config[w], [&](const auto& row) { return 100 * (row.*start).at_m[k] / row.walked_m[k]; }));
        else
          std::snprintf(cell, sizeof cell, "%6.2f m",
                        median_of(config[w], [&](const auto& row) { return (row.*start).mean_m; }));
        std::printf("%-20s", cell);
      }
    }
  }
}

void print(const Walk700Arguments& a, const Table& table) {
  std::printf("Positioning errors and percent of the distance walked, after Antigny et al. 2019, Table 5.\n");
  for (size_t c = 0; c < a.configs.size(); ++c)
    std::printf("%c: %s\n", static_cast<char>('a' + c), a.configs[c].c_str());
  std::printf(
      "%llu seed%s (each another individual, town and noise), median. Start by a fix of position and heading "
      "after 12 m (without a\ncamera by the path); below it, by the path of the first 12 m.\n\n",
      static_cast<unsigned long long>(a.seeds), a.seeds == 1 ? "" : "s");
  std::printf("%-28s", "");
  for (const char* walker : kWalkers) std::printf("  %-*s", static_cast<int>(20 * a.configs.size()), walker);
  std::printf("\n%-28s", "");
  for (size_t w = 0; w < 3; ++w) {
    std::printf("  ");
    for (size_t c = 0; c < a.configs.size(); ++c) std::printf("%-20c", static_cast<char>('a' + c));
  }
  print_rows(a, table, &Walk700Row::by_pose);
  std::printf("\n");
  print_rows(a, table, &Walk700Row::by_path);
  std::printf(
      "\n\nAntigny et al. 2019, real walkers (adaptive / fixed step length):\n"
      "%-28s  W1 2.84 m / 27.97 m (2.3 / 23.3 %%)   M1 3.58 m / 13.17 m (2.9 / 10.9 %%)   W2 4.46 m / 35.16 m (3.7 / "
      "29.3 "
      "%%)\n"
      "%-28s  W1 6.60 m / 101.1 m (1.2 / 18.3 %%)   M1 21.1 m / 78.74 m (3.8 / 14.3 %%)   W2 15.1 m / 167.7 m (2.7 / "
      "30.5 "
      "%%)\n"
      "%-28s  W1 22.4 m / 54.96 m (3.2 / 7.8 %%)    M1 11.8 m / 49.80 m (1.6 / 7.1 %%)    W2 52.6 m / 89.19 m (7.5 / "
      "12.7 "
      "%%)\n"
      "%-28s  W1 16.59 m / 26.58 m                 M1 7.33 m / 20.59 m                  W2 12.58 m / 45.09 m\n",
      kPlaces[0], kPlaces[1], kPlaces[2], kPlaces[3]);
}

int walk700(const Walk700Arguments& a) {
  Table table(a.configs.size(), std::vector<std::vector<Walk700Row>>(3));
  nlohmann::ordered_json all = nlohmann::json::array();
  for (uint64_t seed = a.first_seed; seed < a.first_seed + a.seeds; ++seed)
    for (size_t w = 0; w < 3; ++w)
      for (size_t c = 0; c < a.configs.size(); ++c) {
        const auto row = run(a, a.configs[c], kWalkers[w], seed);
        if (!row) return complain(row.failure());
        table[c][w].push_back(*row);
        all.push_back({{"config", a.configs[c]},
                       {"walker", kWalkers[w]},
                       {"seed", seed},
                       {"error_m", row->by_pose.at_m},
                       {"walked_m", row->walked_m},
                       {"fixes", row->fixes},
                       {"mean_m", row->by_pose.mean_m},
                       {"by_path", {{"error_m", row->by_path.at_m}, {"mean_m", row->by_path.mean_m}}}});
      }
  if (a.json)
    std::printf("%s\n", all.dump(2).c_str());
  else
    print(a, table);
  return kDone;
}

}  // namespace

void add_bench_walk700(CLI::App& bench, int& status) {
  auto a = std::make_shared<Walk700Arguments>();
  auto* command = bench.add_subcommand(
      "walk700", "The 0.7 km walk of Antigny et al. 2019, simulated: their Table 5, adaptive beside fixed step length");
  command->add_option("-c,--config", a->configs, "pipeline configs to compare")->capture_default_str();
  command->add_option("--seeds", a->seeds, "how many")->capture_default_str()->check(CLI::Range(1, 1000));
  command->add_option("--first-seed", a->first_seed, "the first of them")->capture_default_str();
  command->add_flag("--quick", a->quick, "the first 120 m alone");
  command->add_option("--scenarios", a->scenarios, "folder of walk700_{W1,M1,W2}.yaml")->capture_default_str();
  command->add_option("--keep", a->keep, "recordings are kept here and rendered once")->capture_default_str();
  command->add_flag("--json", a->json, "print one JSON array, an entry for each run");
  command->callback([a, &status] { status = walk700(*a); });
}

}  // namespace odograph
