// SPDX-License-Identifier: Apache-2.0
//
// The papers' walk and drive rebuilt: Table 5 of Antigny et al. 2019, Figures 9 and 11 of Gakne & O'Keefe 2018.

#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/city/model_errors.hpp"
#include "sdk/tools/evaluation/start_alignment.hpp"
#include "sdk/tools/evaluation/walk_figures.hpp"
#include "sdk/tools/replay/replayed.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWalkers[] = {"W1", "M1", "W2"};
constexpr double kStart_m = 12;

/// The places evaluated in the paper, with its results: real walkers W1, M1, W2, adaptive and fixed step length, m.
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

std::string letter(size_t c) { return std::string(1, static_cast<char>('a' + c)); }

/// Alignment of a track with the truth. Known objects are surveyed in n, so a track positioned by them is not aligned
/// at its start. Without a camera, the heading of a pose differs from that of the path, so the alignment uses the path.
enum class Start { surveyed, by_pose, by_path };
Start start_of(const PipelineConfig& config) {
  for (const PluginChoice& fixer : config.fixers)
    if (fixer.manifest.id.starts_with("fix/known_object")) return Start::surveyed;
  return config.vo_frontends.empty() ? Start::by_path : Start::by_pose;
}

struct Walk700 : Benchmark {
  Walk700()
      : Benchmark("walk700",
                  "The 0.7 km walk of Antigny et al. 2019, simulated: their Table 5, adaptive beside fixed step length",
                  kConfigs | kQuick | kSimulated, {"antigny2019", "antigny2019_fixed_step", "phone_walk_camera"}) {
    options.scenarios.clear();
    for (const char* walker : kWalkers)
      options.scenarios.push_back(sample_file(text("scenarios/walk700_%s.yaml", walker)));
    quick_m = 120;
  }

  Result<bool> complete(BenchCase& one) const override {
    const std::string scenario = stem_of(one.scenario);
    one.labels["walker"] = scenario.substr(scenario.find('_') + 1), one.labels["seed"] = one.seed;
    // The paper's authors knew their walkers' heights, so the height is set if the config has one.
    if (const auto root = read_yaml(one.run.config); root && node_at(*root, "walker.height"))
      one.run.overrides.push_back({"walker.height", std::to_string(read_scenario(one.scenario)->walker.height_m)});
    return true;
  }

  /// Two starts: a fix of position and heading after 12 m, as an app gets from a known object, and the path of the
  /// first 12 m.
  Result<Json> measure_replay(const BenchCase& one, const Recording& recording,
                              const RunResult& result) const override {
    const StampedPoses& truth = recording.truth;
    std::vector<WalkedPlace> places;
    for (size_t k = 0; k < 3; ++k) places.push_back(place_walked_to(recording, kPlaces[k].walked_m));
    const auto errors = [&](const StampedPoses& track) {
      const PlaceErrors e = place_errors(truth, track, places);
      return Json{{"mean_m", e.mean_m}, {"error_m", e.error_m}, {"error_percent", e.error_percent}};
    };
    const Start start = start_of(*config_of(one.run));
    const StampedPoses by_path =
        start == Start::surveyed ? result.track : aligned_at_start(truth, result.track, kStart_m);
    const StampedPoses track = start == Start::by_pose ? aligned_by_pose(truth, result.track, kStart_m) : by_path;
    Json row = errors(track);
    for (const WalkedPlace& place : places) row["walked_m"].push_back(place.walked_m);
    row["by_path"] = errors(by_path);
    row["fixes"] = result.accepted().size();
    return row;
  }

  /// Table cell of a place for a start: the median over seeds.
  static std::string cell_of(const Rows& rows, const std::string& start, size_t place) {
    const auto median = [&](const std::string& key) { return percentile_at(rows, start + key, 0.5); };
    if (kPlaces[place].walked_m == 0) return text("%.2f m", median("mean_m"));
    return text("%.2f m (%.2f %%)", median(text("error_m/%zu", place)), median(text("error_percent/%zu", place)));
  }

  /// One line per place, one column per walker and config.
  BenchReport report(const Rows& rows) const override {
    Table table{"", {{"", "place"}}, {}};
    std::string head = "Positioning errors and percent of the distance walked, after Antigny et al. 2019, Table 5.\n";
    for (size_t c = 0; c < options.configs.size(); ++c) head += letter(c) + ": " + options.configs[c] + '\n';
    for (const auto& [walker, own] : groups_of(rows, "walker"))
      for (size_t c = 0; c < options.configs.size(); ++c)
        table.columns.push_back({walker, letter(c), walker.get<std::string>() + letter(c), 2, {}, options.configs[c]});
    head += text(
        "%zu seed%s (different walker, town and noise each), median. Start by a fix of position and heading after 12 "
        "m (without a\ncamera by the path); below it, by the path of the first 12 m.\n\n",
        options.seeds, options.seeds == 1 ? "" : "s");
    Rows lines;
    for (const char* start : {"", "by_path/"}) {
      if (*start) lines.push_back({{"_line", ""}});
      for (size_t k = 0; k < std::size(kPlaces); ++k) {
        if (options.quick && k > 0 && k < 3) continue;
        lines.push_back({{"place", kPlaces[k].name}});
        for (const Column& column : table.columns)
          lines.back()[column.key] =
              cell_of(rows_with(rows_with(rows, "walker", column.head), "config", column.from), start, k);
      }
    }
    Table paper{"\nAntigny et al. 2019, real walkers: adaptive and fixed step length, m", {{"", "place"}}, {}};
    Rows published;
    for (size_t w = 0; w < std::size(kWalkers); ++w)
      for (const char* kind : {"adaptive", "fixed"})
        paper.columns.push_back({kWalkers[w], kind, text("%s/%zu", kind, w)});
    for (const Place& place : kPlaces)
      published.push_back({{"place", place.name}, {"adaptive", place.adaptive_m}, {"fixed", place.fixed_m}});
    return {head + table_text(table, lines) + table_text(paper, published)};
  }
};

struct Drive : Benchmark {
  Drive()
      : Benchmark("drive",
                  "The downtown drive of Gakne & O'Keefe 2018, simulated: distribution of the horizontal error; the "
                  "first config is the baseline",
                  kConfigs | kQuick | kSimulated | kByConfig,
                  {"gakne2018_vo", "gakne2018", "monocular", "city_drive"}) {
    options.scenarios = {sample_file("scenarios/drive_downtown.yaml")};
    quick_m = 300;
  }
  void add_options(CLI::App& command) override {
    command.add_option("--missing", missing, "fraction of buildings missing in the city model, chosen by the seed")
        ->check(CLI::Range(0.0, 1.0));
    command.add_option("--start", start_m,
                       "start, heading and missing scale are fitted over this distance from the start, m");
  }

  /// The city model of the pipeline: the rendered one, or a subset of it.
  Result<bool> complete(BenchCase& one) const override {
    const fs::path whole = one.run.asset_path, less = whole.parent_path() / (whole.stem().string() + ".missing");
    std::error_code error;
    if (missing > 0) {
      fs::create_directories(less, error);
      const auto left =
          write_model_with_errors(whole / "city.json", less / "city.json", {.missing = missing, .seed = one.seed});
      if (!left) return left.failure();
      one.run.asset_path = less.string();
    }
    one.files.emplace_back(one.run.asset_path);
    return true;
  }

  Result<Json> measure_replay(const BenchCase&, const Recording& recording, const RunResult& result) const override {
    const StampedPoses& truth = recording.truth;
    StampedPoses track = result.track;
    if (result.fixes.empty()) {  // neither position, nor heading, nor (without a source) scale is known
      track = rotated_onto_first(truth, track);
      track = aligned_at_start(truth, result.scales.empty() ? scaled_by_start(truth, track, start_m) : track, start_m);
    }
    const PositionErrors e = position_errors(truth, track);
    const double end = 100 * e.horizontal_m.back() / path_length(truth);
    const Format range{.sign = true, .parts = {0, 1}};
    return row_of(
        {{"error", "m", "horizontal_m", 2, e.horizontal_m, {.parts = {0.10, 0.25, 0.50, 0.68, 0.75, 0.90, 0.95, 0.99}}},
         {"north", "m", "_north_m", 1, e.north_m, range},
         {"east", "m", "_east_m", 1, e.east_m, range},
         {"scale", "m", "scale_median_m", 3, e.displacement_m},
         {"end", "%", "_end_percent", 2, end},
         {"", "", "end_percent", -1, end, kAll},
         {"", "", "seeds", -1, 1, kSum}});
  }

  std::string heading(const Rows&) const override {
    return text(
        "Horizontal errors after Gakne & O'Keefe 2018, Figure 11; if a config has no fixes, start\nand heading (and "
        "the scale, if it has no source) are fitted over the first %.0f m.\n%zu seed%s, all frames; %.0f %% of the "
        "buildings are missing in the model.\n\n",
        start_m, options.seeds, options.seeds == 1 ? "" : "s", 100 * missing);
  }

  std::string notes(const Rows& rows) const override {
    std::string out =
        "\nerror: of this fraction of the frames; scale: |length of a frame's displacement - true one|, median (Figure "
        "9); end: error at the end of the path.\n";
    const auto by_config = groups_of(rows, "config");
    for (size_t c = 1; c < by_config.size(); ++c)
      out += text("%s is nearer to the truth than %s in %.0f %% of the frames.\n", options.configs[c].c_str(),
                  options.configs[0].c_str(),
                  100 * part_below(numbers_at(by_config[c].second, "_horizontal_m"),
                                   numbers_at(by_config[0].second, "_horizontal_m")));
    return out;
  }

  double start_m = 50, missing = 0;
};

}  // namespace

Benchmarks papers_benchmarks() { return {std::make_shared<Walk700>(), std::make_shared<Drive>()}; }

}  // namespace odograph
