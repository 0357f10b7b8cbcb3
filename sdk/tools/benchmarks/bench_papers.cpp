// SPDX-License-Identifier: Apache-2.0
//
// The papers' drive rebuilt: Figures 9 and 11 of Gakne & O'Keefe 2018. Their walk is bench_walk700.

#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/city/model_errors.hpp"
#include "sdk/tools/evaluation/start_alignment.hpp"
#include "sdk/tools/replay/replayed.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

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

Benchmarks papers_benchmarks() { return {walk700_benchmark(), std::make_shared<Drive>()}; }

}  // namespace odograph
