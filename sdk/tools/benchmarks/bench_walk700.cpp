// SPDX-License-Identifier: Apache-2.0
//
// The walk of Antigny et al. 2019 rebuilt: their Tables 4 and 5, Figures 9, 11 and 12.
#include <algorithm>

#include "sdk/host/base/output_file.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/evaluation/start_alignment.hpp"
#include "sdk/tools/evaluation/walk_figures.hpp"
#include "sdk/tools/replay/replayed.hpp"

namespace odograph {
namespace {

constexpr const char* kWalkers[] = {"W1", "M1", "W2"};
constexpr double kStart_m = 12;

/// The places evaluated in the paper, with its results: real walkers W1, M1, W2, adaptive and fixed step length, m.
struct Place {
  const char* name;
  double walked_m;  ///< 0: the mean over all frames
  double adaptive_m[3], fixed_m[3];
};
constexpr Place kPlaces[] = {
    {"after 120 m", 120, {2.84, 3.58, 4.46}, {27.97, 13.17, 35.16}},
    {"after 550 m", 550, {6.60, 21.10, 15.11}, {101.06, 78.74, 167.7}},
    {"finish, 700 m", 1e9, {22.43, 11.77, 52.56}, {54.96, 49.80, 89.19}},
    {"mean error", 0, {16.59, 7.33, 12.58}, {26.58, 20.59, 45.09}},
};
/// Table 4.
constexpr double kStepMedian_m[] = {1.06, 1.18, 0.99}, kStepDeviation_m[] = {0.20, 0.14, 0.29};

std::string letter(size_t c) { return std::string(1, static_cast<char>('a' + c)); }

bool has(const std::vector<PluginChoice>& plugins, const char* id) {
  return std::any_of(plugins.begin(), plugins.end(), [&](const auto& p) { return p.manifest.id == id; });
}

/// A picture of gnuplot: its data blocks, then its commands.
struct Plotted {
  std::string data, plots;
  void add(const std::string& name, const std::string& style, const Json& points) {
    const std::string block = text("$d%zu", count_++);
    data += block + " << EOD\n";
    for (const Json& point : points) data += text("%.3f %.4f\n", point[0].get<double>(), point[1].get<double>());
    data += "EOD\n";
    plots += text("%s %s with %s title '%s'", plots.empty() ? "plot" : ",", block.c_str(), style.c_str(), name.c_str());
  }
  std::string script(const std::string& file, const std::string& x, const std::string& y,
                     const std::string& more) const {
    return "reset\n" + data +
           text(
               "set terminal svg size 900,420 background 'white'\nset output '%s.svg'\nset xlabel '%s'\nset ylabel "
               "'%s'\n"
               "set grid\nset key outside right noenhanced\n%s%s\nunset output\n",
               file.c_str(), x.c_str(), y.c_str(), more.c_str(), plots.c_str());
  }

 private:
  size_t count_ = 0;
};

struct Walk700 : Benchmark {
  Walk700()
      : Benchmark("walk700",
                  "The 0.7 km walk of Antigny et al. 2019, simulated: their Tables 4 and 5, adaptive beside fixed step "
                  "length",
                  kConfigs | kQuick | kSimulated, {"antigny2019", "antigny2019_fixed_step", "phone_walk_camera"}) {
    options.scenarios.clear();
    for (const char* walker : kWalkers)
      options.scenarios.push_back(sample_file(text("scenarios/walk700_%s.yaml", walker)));
    quick_m = 120;
  }
  void add_options(CLI::App& command) override {
    command
        .add_option("--plot", plot, "gnuplot script to write, which draws Figures 9a, 9b, 11 and 12 of the first seed")
        ->group(kOutput);
  }

  Result<bool> complete(BenchCase& one) const override {
    const std::string scenario = stem_of(one.scenario);
    one.labels["walker"] = scenario.substr(scenario.find('_') + 1), one.labels["seed"] = one.seed;
    // The paper's authors knew their walkers' heights, so the height is set if the config has one.
    if (const auto root = read_yaml(one.run.config); root && node_at(*root, "walker.height"))
      one.run.overrides.push_back({"walker.height", std::to_string(read_scenario(one.scenario)->walker.height_m)});
    for (const char* file : {"ground.obj", "objects.yaml"})
      if (const std::filesystem::path path = std::filesystem::path(one.run.asset_path) / file;
          std::filesystem::exists(path))
        one.files.push_back(path);
    return true;
  }

  /// Two starts: a fix of position and heading after 12 m, and the path of the first 12 m (the only one without a
  /// camera, where a pose's heading is not that of the path). Known objects are surveyed in n: from the first of them
  /// on, nothing is aligned, and the second start is the config's own.
  Result<Json> measure_replay(const BenchCase& one, const Recording& recording,
                              const RunResult& result) const override {
    const StampedPoses& truth = recording.truth;
    const auto config = config_of(one.run);
    const bool surveyed = has(config->fixers, "fix/known_object");
    const auto objects = object_fixes(result.accepted());
    std::vector<WalkedPlace> places;
    for (size_t k = 0; k < 3; ++k)
      places.push_back(before_objects(place_walked_to(recording, kPlaces[k].walked_m), objects));
    const auto errors = [&](const StampedPoses& track) {
      const PlaceErrors e = place_errors(truth, track, places);
      return Json{{"mean_m", e.mean_m}, {"error_m", e.error_m}, {"error_percent", e.error_percent}};
    };
    const StampedPoses by_path = surveyed ? result.track : aligned_at_start(truth, result.track, kStart_m);
    StampedPoses track = config->vo_frontends.empty() ? by_path : aligned_by_pose(truth, result.track, kStart_m);
    if (surveyed && !objects.empty()) track = joined(track, result.track, objects.front());
    Json row = errors(track);
    for (const WalkedPlace& place : places) row["walked_m"].push_back(place.walked_m);
    row["by_path"] = errors(by_path);
    row["object_fixes"] = objects.size();
    std::vector<double> lengths;
    for (const odo_step& step : result.steps) lengths.push_back(step.length_m);
    if (!lengths.empty()) {
      const Statistics of_lengths = statistics_of(lengths);
      row["step_median_m"] = of_lengths.median, row["step_deviation_m"] = of_lengths.std;
    }
    add_samples(truth, track, result, row);
    return row;
  }

  BenchReport report(const Rows& rows) const override {
    if (!plot.empty()) {
      if (const auto written = write_whole_file(plot, figures(rows)); !written)
        return {written.failure().text + "\n", {}};
    }
    return {positions_text(rows) + steps_text(rows)};
  }

 private:
  static void add_samples(const StampedPoses& truth, const StampedPoses& track, const RunResult& result, Json& row) {
    const int64_t start_ns = truth.front().t_ns;
    int64_t next_ns = start_ns;
    Json errors = Json::array(), lengths = Json::array(), modes = Json::array();
    for (const StampedPose& pose : truth) {
      if (pose.t_ns < next_ns) continue;
      next_ns += 1'000'000'000;
      errors.push_back({seconds(pose.t_ns - start_ns), horizontal_error(truth, track, pose.t_ns)});
    }
    for (const odo_step& step : result.steps) lengths.push_back({seconds(step.t_end_ns - start_ns), step.length_m});
    for (const odo_motion_mode& mode : result.modes) modes.push_back({seconds(mode.header.t_ns - start_ns), mode.mode});
    if (!modes.empty()) modes.push_back({seconds(truth.back().t_ns - start_ns), modes.back()[1]});
    row["_errors"] = errors, row["_lengths"] = lengths, row["_modes"] = modes;
  }

  Rows rows_of_config(const Rows& rows, const Json& walker, const std::string& config) const {
    return rows_with(rows_with(rows, "walker", walker), "config", config);
  }

  /// Table 5: the paper's figures beside the medians over seeds.
  std::string positions_text(const Rows& rows) const {
    std::string head = "Positioning errors and percent of the distance walked, as Antigny et al. 2019, Table 5.\n";
    for (size_t c = 0; c < options.configs.size(); ++c) head += letter(c) + ": " + options.configs[c] + '\n';
    head += text(
        "%zu seed%s (different walker, town and noise each), median. Start by a fix of position and heading after 12 "
        "m (without a\ncamera by the path), with known objects until the first; below it, by the path of the first 12 "
        "m, or the config's own\nstart with known objects. Marks before the known object beside them.\n\n",
        options.seeds, options.seeds == 1 ? "" : "s");
    Table table{
        "", {{"place", "place"}, {"walker", "walker"}}, {{"paper", "adaptive", "adaptive"}, {"", "fixed", "fixed"}}};
    for (size_t c = 0; c < options.configs.size(); ++c) table.columns.push_back({letter(c), "", letter(c)});
    Rows lines;
    for (const char* start : {"", "by_path/"}) {
      if (*start) lines.push_back({{"_line", ""}});
      for (size_t k = 0; k < std::size(kPlaces); ++k) {
        if (options.quick && k > 0 && k < 3) continue;
        const Place& place = kPlaces[k];
        for (const auto& [walker, own] : groups_of(rows, "walker")) {
          const auto w =
              static_cast<size_t>(std::find(kWalkers, std::end(kWalkers), walker.get<std::string>()) - kWalkers);
          lines.push_back({{"place", place.name}, {"walker", walker}});
          if (w < std::size(kWalkers))
            lines.back()["adaptive"] = place.adaptive_m[w], lines.back()["fixed"] = place.fixed_m[w];
          for (size_t c = 0; c < options.configs.size(); ++c)
            lines.back()[letter(c)] = cell_of(rows_with(own, "config", options.configs[c]), start, k);
        }
      }
    }
    return head + table_text(table, lines);
  }

  /// Table cell of a place for a start: the median over seeds.
  static std::string cell_of(const Rows& rows, const std::string& start, size_t place) {
    const auto median = [&](const std::string& key) { return percentile_at(rows, start + key, 0.5); };
    if (kPlaces[place].walked_m == 0) return text("%.2f m", median("mean_m"));
    return text("%.2f m (%.2f %%)", median(text("error_m/%zu", place)), median(text("error_percent/%zu", place)));
  }

  /// Table 4, of the first config; the paper's steps are from a foot to the same foot.
  std::string steps_text(const Rows& rows) const {
    const Table table{"\nStep lengths of a (ours from one foot to the other), as Table 4",
                      {{"walker", "walker"}},
                      {{"median", "m", "step_median_m"},
                       {"", "paper", "median"},
                       {"deviation", "m", "step_deviation_m"},
                       {"", "paper", "deviation"}}};
    Rows lines;
    for (size_t w = 0; w < std::size(kWalkers); ++w) {
      const Rows own = rows_of_config(rows, kWalkers[w], options.configs.front());
      if (own.empty()) continue;
      lines.push_back({{"walker", kWalkers[w]}, {"median", kStepMedian_m[w]}, {"deviation", kStepDeviation_m[w]}});
      for (const char* key : {"step_median_m", "step_deviation_m"}) lines.back()[key] = percentile_at(own, key, 0.5);
    }
    return table_text(table, lines);
  }

  std::string figures(const Rows& rows) const {
    Plotted modes, lengths, errors, distribution;
    for (const auto& [walker, of_walker] : groups_of(rows, "walker"))
      for (const std::string& config : options.configs) {
        const Rows own = rows_with(of_walker, "config", config);
        if (own.empty()) continue;
        const Json& row = own.front();
        const std::string who = walker.get<std::string>(), both = who + ", " + stem_of(config);
        if (config == options.configs.front()) {
          modes.add(who, "steps", row["_modes"]);
          lengths.add(who, "points", row["_lengths"]);
        }
        errors.add(both, "lines", row["_errors"]);
        std::vector<double> sorted;
        for (const Json& point : row["_errors"]) sorted.push_back(point[1].get<double>());
        std::sort(sorted.begin(), sorted.end());
        Json share = Json::array();
        for (size_t i = 0; i < sorted.size(); ++i)
          share.push_back({sorted[i], 100.0 * static_cast<double>(i + 1) / static_cast<double>(sorted.size())});
        distribution.add(both, "lines", share);
      }
    const std::string named = text("set yrange [0.5:3.5]\nset ytics ('static' %u, 'texting' %u, 'swinging' %u)\n",
                                   ODO_MODE_STATIC, ODO_MODE_WALKING_TEXTING, ODO_MODE_WALKING_SWINGING);
    return modes.script("figure_9a", "time (s)", "mode", named) +
           lengths.script("figure_9b", "time (s)", "step length (m)", "") +
           errors.script("figure_11", "time (s)", "horizontal error (m)", "") +
           distribution.script("figure_12", "horizontal error (m)", "% of the time", "");
  }

  std::string plot;
};

}  // namespace

std::shared_ptr<Benchmark> walk700_benchmark() { return std::make_shared<Walk700>(); }

}  // namespace odograph
