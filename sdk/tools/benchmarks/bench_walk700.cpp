// SPDX-License-Identifier: Apache-2.0
//
// The 0.7 km walk of Antigny et al. 2019 rebuilt: `odograph bench walk700` prints its Table 5.
#include <algorithm>
#include <array>
#include <cmath>

#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/evaluation/start_alignment.hpp"
#include "sdk/tools/replay/kept_recordings.hpp"
#include "sdk/tools/replay/replayed.hpp"
#include "sdk/tools/simulation/scenario.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWalkers[] = {"W1", "M1", "W2"};
constexpr double kStart_m = 12;

/// Where the paper scores, with its figures: real walkers W1, M1, W2, adaptive and fixed step length, m.
struct Place {
  const char* name;
  double walked_m;  ///< 0: the mean over all frames
  double adaptive_m[3], fixed_m[3];
};
constexpr Place kPlaces[] = {
    {"On waypoint (after 120 m)", 120, {2.84, 3.58, 4.46}, {27.97, 13.17, 35.16}},
    {"On waypoint (after 550 m)", 550, {6.60, 21.1, 15.1}, {101.1, 78.74, 167.7}},
    {"On finish (after 700 m)", 1e9, {22.4, 11.8, 52.6}, {54.96, 49.80, 89.19}},
    {"Mean positioning error", 0, {16.59, 7.33, 12.58}, {26.58, 20.59, 45.09}},
};

/// What a track is laid by. Known objects are surveyed in n: one that is put in place by them is not laid over the
/// start. Without a camera the heading of a pose is not the path's: the path alone tells that.
enum class Start { surveyed, by_pose, by_path };
Start start_of(const PipelineConfig& config) {
  for (const PluginChoice& fixer : config.fixers)
    if (fixer.manifest.id.starts_with("fix/known_object")) return Start::surveyed;
  return config.vo_frontends.empty() ? Start::by_path : Start::by_pose;
}

/// Errors at the scored places, and the mean over all frames, m.
Json errors_of(const Trajectory& truth, const Trajectory& track, const std::array<int64_t, 3>& scored_ns) {
  Json at = Json::array();
  for (const int64_t t_ns : scored_ns) at.push_back(horizontal_error(truth, track, t_ns));
  return {{"error_m", at}, {"mean_m", statistics_of(horizontal_errors(truth, track)).mean}};
}

struct Walk700 : Benchmark {
  Walk700()
      : Benchmark("walk700",
                  "The 0.7 km walk of Antigny et al. 2019, simulated: their Table 5, adaptive beside fixed step length",
                  kConfigs | kSeeds | kQuick) {
    options.configs = {"samples/configs/antigny2019.yaml", "samples/configs/antigny2019_fixed_step.yaml",
                       "samples/configs/phone_walk_camera.yaml"};
    quick_m = 120;
  }
  void add_options(CLI::App& command) override {
    command.add_option("--scenarios", scenarios, "folder of walk700_{W1,M1,W2}.yaml")->group(kCases);
  }

  Result<std::vector<BenchCase>> cases() override {
    std::vector<BenchCase> all;
    for (uint64_t seed = options.first_seed; seed < options.first_seed + options.seeds; ++seed)
      for (const char* walker : kWalkers) {
        const fs::path scenario = fs::path(scenarios) / ("walk700_" + std::string(walker) + ".yaml");
        const auto file = kept(scenario, seed);
        if (!file) return file.failure();
        for (const std::string& config : options.configs) {
          auto run = run_of(config);
          if (!run) return run.failure();
          // The height is known, as the paper's authors knew their walkers', where the config asks for one.
          if (const auto root = read_yaml(run->config); root && node_at(*root, "walker.height"))
            run->overrides.push_back(
                {"walker.height", std::to_string(read_scenario(scenario.string())->walker.height_m)});
          run->asset_path = assets_of(*file).string();
          all.push_back({{{"config", config}, {"walker", walker}, {"seed", seed}}, {*file}, *run, seed});
        }
      }
    return all;
  }

  /// Two starts: a fix of position and heading after 12 m, as an app has it from a known object, and the path of the
  /// first 12 m.
  Result<Json> measure(const BenchCase& one, const ShowProgress& progress) const override {
    return replayed(one, progress, [&](const Recording& recording, const RunResult& result) -> Result<Json> {
      const auto config = config_of(one.run);
      const auto walked_until = [&](int64_t t_ns) {
        double sum = 0;
        for (const odo_step& step : recording.true_steps) sum += step.t_end_ns <= t_ns ? step.length_m : 0.0;
        return sum;
      };
      const Trajectory& truth = recording.truth;
      std::array<int64_t, 3> scored{};
      std::array<double, 3> walked_m{};
      for (size_t k = 0; k < 3; ++k) {
        const auto off_m = [&](int64_t t_ns) { return std::abs(walked_until(t_ns) - kPlaces[k].walked_m); };
        scored[k] = truth.back().t_ns;
        for (const Waypoint& mark : recording.waypoints())
          if (off_m(mark.t_ns) < off_m(scored[k])) scored[k] = mark.t_ns;
        walked_m[k] = walked_until(scored[k]);
      }
      const Start start = start_of(*config);
      const Json by_path =
          errors_of(truth, start == Start::surveyed ? result.track : started(truth, result.track, kStart_m), scored);
      const Json by_pose =
          start == Start::by_pose ? errors_of(truth, started_by_pose(truth, result.track, kStart_m), scored) : by_path;
      const auto fixes = std::count_if(result.fixes.begin(), result.fixes.end(),
                                       [](const RunResult::Fix& fix) { return fix.accepted; });
      return Json{{"error_m", by_pose["error_m"]},
                  {"walked_m", walked_m},
                  {"fixes", fixes},
                  {"mean_m", by_pose["mean_m"]},
                  {"by_path", by_path}};
    });
  }

  /// A line for each place, a column for each walker and config: medians over seeds.
  void add_places(const Rows& rows, const std::string& start, Rows& lines) const {
    for (size_t k = 0; k < std::size(kPlaces); ++k) {
      if (options.quick && k > 0 && k < 3) continue;
      Json line = {{"place", kPlaces[k].name}};
      for (const char* walker : kWalkers)
        for (const std::string& config : options.configs) {
          std::vector<double> metres, percent;
          for (const Json& row : rows_with(rows_with(rows, "walker", walker), "config", config)) {
            const Json& errors = start.empty() ? row : row[start];
            metres.push_back((k < 3 ? errors["error_m"][k] : errors["mean_m"]).get<double>());
            percent.push_back(100 * metres.back() / row["walked_m"][std::min<size_t>(k, 2)].get<double>());
          }
          line[walker + config] =
              text("%.2f m", percentile(metres, 0.5)) + (k < 3 ? text(" (%.2f %%)", percentile(percent, 0.5)) : "");
        }
      lines.push_back(line);
    }
  }

  BenchReport report(const Rows& rows) const override {
    Table table{"", {{"", "place"}}, {}};
    std::string head = "Positioning errors and percent of the distance walked, after Antigny et al. 2019, Table 5.\n";
    for (size_t c = 0; c < options.configs.size(); ++c)
      head += text("%c: %s\n", static_cast<char>('a' + c), options.configs[c].c_str());
    for (const char* walker : kWalkers)
      for (size_t c = 0; c < options.configs.size(); ++c)
        table.columns.push_back({walker, std::string(1, static_cast<char>('a' + c)), walker + options.configs[c]});
    head += text(
        "%llu seed%s (each another individual, town and noise), median. Start by a fix of position and heading after "
        "12 m (without a\ncamera by the path); below it, by the path of the first 12 m.\n\n",
        static_cast<unsigned long long>(options.seeds), options.seeds == 1 ? "" : "s");
    Rows lines;
    add_places(rows, "", lines);
    lines.push_back({{"_line", ""}});
    add_places(rows, "by_path", lines);
    Table paper{"\nAntigny et al. 2019, real walkers: adaptive and fixed step length, m", {{"", "place"}}, {}};
    Rows published;
    for (const char* walker : kWalkers)
      for (const char* kind : {"adaptive", "fixed"})
        paper.columns.push_back({walker, kind, std::string(walker) + '/' + kind});
    for (const Place& place : kPlaces) {
      Json line = {{"place", place.name}};
      for (size_t w = 0; w < std::size(kWalkers); ++w)
        line[kWalkers[w]] = {{"adaptive", place.adaptive_m[w]}, {"fixed", place.fixed_m[w]}};
      published.push_back(line);
    }
    return {head + table_text(table, lines) + table_text(paper, published)};
  }

  std::string scenarios = "samples/scenarios";
};

}  // namespace

std::shared_ptr<Benchmark> bench_walk700() { return std::make_shared<Walk700>(); }

}  // namespace odograph
