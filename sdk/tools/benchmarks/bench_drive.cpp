// SPDX-License-Identifier: Apache-2.0
//
// The drive of Gakne & O'Keefe 2018 rebuilt: `odograph bench drive` prints its error distribution (Figures 9 and 11).
#include <cmath>

#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/city/thinned_model.hpp"
#include "sdk/tools/evaluation/start_alignment.hpp"
#include "sdk/tools/replay/kept_recordings.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

constexpr double kParts[] = {0.10, 0.25, 0.50, 0.68, 0.75, 0.90, 0.95, 0.99};

struct Drive : Benchmark {
  Drive()
      : Benchmark("drive",
                  "The downtown drive of Gakne & O'Keefe 2018, simulated: distribution of the horizontal error; the "
                  "first config is the one to beat",
                  kConfigs | kSeeds | kQuick | kPlot) {
    options.configs = {"samples/configs/gakne2018_vo.yaml", "samples/configs/gakne2018.yaml",
                       "samples/configs/monocular.yaml", "samples/configs/city_drive.yaml"};
    quick_m = 300;
  }
  void add_options(CLI::App& command) override {
    command.add_option("--scenario", scenario, "the drive");
    command.add_option("--missing", missing, "part of the buildings that the city model lacks, drawn by the seed")
        ->check(CLI::Range(0.0, 1.0));
    command.add_option("--start", start_m, "start, heading and missing scale are fitted over these first metres");
  }

  Result<std::vector<BenchCase>> cases() override {
    std::vector<BenchCase> all;
    for (const std::string& config : options.configs)
      for (uint64_t seed = options.first_seed; seed < options.first_seed + options.seeds; ++seed) {
        const auto file = kept(scenario, seed);
        if (!file) return file.failure();
        const auto model = model_for(*file, seed);
        if (!model) return model.failure();
        auto run = run_of(config);
        if (!run) return run.failure();
        run->asset_path = model->string();
        all.push_back({{{"config", config}, {"seed", seed}}, {*file, *model}, *run, seed});
      }
    return all;
  }

  Result<Json> measure(const BenchCase& one, const ShowProgress& progress) const override {
    return replayed(one, progress, [&](const Recording& recording, const RunResult& result) -> Result<Json> {
      const Trajectory& truth = recording.truth;
      Trajectory track = result.track;
      if (result.fixes.empty()) {  // it knows neither where it is nor what is north, nor without a source its scale
        track = turned_onto_first(truth, track);
        track = started(truth, result.scales.empty() ? scaled_by_start(truth, track, start_m) : track, start_m);
      }
      std::vector<double> north_m, east_m, scale_m;
      for (size_t i = 0; i < truth.size(); ++i) {
        const Eigen::Vector3d estimate = position_at(track, truth[i].t_ns), d = estimate - truth[i].p;
        north_m.push_back(d.x()), east_m.push_back(d.y());
        if (i == 0) continue;
        const Eigen::Vector3d before = position_at(track, truth[i - 1].t_ns);
        scale_m.push_back(std::abs((estimate - before).norm() - (truth[i].p - truth[i - 1].p).norm()));
      }
      const auto horizontal_m = horizontal_errors(truth, track);
      return Json{{"_horizontal_m", horizontal_m},
                  {"_north_m", north_m},
                  {"_east_m", east_m},
                  {"_scale_m", scale_m},
                  {"end_percent", 100 * horizontal_m.back() / path_length(truth)}};
    });
  }

  BenchReport report(const Rows& rows) const override {
    std::vector<Column> columns;
    for (const double part : kParts)
      columns.push_back({"error m", text("%.0f %%", 100 * part), text("horizontal_m/%.0f", 100 * part), 2, false,
                         "_horizontal_m", Over::percentile, part});
    for (const char* axis : {"north", "east"})
      for (const double part : {0.0, 1.0})
        columns.push_back({axis, part > 0 ? "to m" : "from m", std::string("_") + axis + (part > 0 ? "/to" : "/from"),
                           1, true, std::string("_") + axis + "_m", Over::percentile, part});
    columns.push_back({"scale", "m", "scale_median_m", 3, false, "_scale_m"});
    columns.push_back({"end", "%", "_end_percent", 2, false, "end_percent"});
    Rows summaries = summaries_of(rows, "config", columns);
    BenchReport report;
    report.text = text(
        "Horizontal errors after Gakne & O'Keefe 2018, Figure 11; where a config has no fixes, start\n"
        "and heading (and the scale, where it has no source of it) are from the first %.0f m.\n"
        "%zu seed%s, all frames; %.0f %% of the buildings are missing in the model.\n\n",
        start_m, options.seeds, options.seeds == 1 ? "" : "s", 100 * missing);
    report.text += table_text({"", {{"config", "config"}}, columns}, summaries);
    report.text +=
        "\nerror: of this part of the frames; scale: |length of a frame's displacement - true one|, median (Figure "
        "9); end: error at the end of the path.\n";
    report.plot = {.title = "Horizontal error", .x_label = "m", .y_label = "part of the frames"};
    const auto first = numbers_at(rows_with(rows, "config", options.configs[0]), "_horizontal_m");
    for (Json& summary : summaries) {
      const Rows own = rows_with(rows, "config", summary["config"]);
      const auto errors = numbers_at(own, "_horizontal_m");
      PlotSeries series{.name = summary["config"].get<std::string>(), .style = "lines"};
      for (int p = 0; p <= 100; ++p) series.points.emplace_back(percentile(errors, 0.01 * p), 0.01 * p);
      report.plot.series.push_back(std::move(series));
      summary["seeds"] = options.seeds, summary["end_percent"] = numbers_at(own, "end_percent");
      if (summary["config"] == options.configs[0]) continue;
      size_t better = 0;
      for (size_t i = 0; i < first.size(); ++i) better += errors[i] < first[i];
      report.text += text("%s is nearer to the truth than %s in %.0f %% of the frames.\n",
                          summary["config"].get<std::string>().c_str(), options.configs[0].c_str(),
                          100.0 * static_cast<double>(better) / static_cast<double>(first.size()));
    }
    report.json = printed(summaries);
    return report;
  }

  /// The folder of the city model that the pipeline is given: what was rendered, or less of it.
  Result<fs::path> model_for(const fs::path& recording, uint64_t seed) const {
    const auto whole = assets_of(recording);
    if (missing <= 0) return whole;
    const auto folder = recording.parent_path() / (recording.stem().string() + ".missing");
    std::error_code error;
    fs::create_directories(folder, error);
    const auto left = write_thinned_model(whole / "city.json", folder / "city.json", missing, seed);
    return left ? Result<fs::path>(folder) : left.failure();
  }

  std::string scenario = "samples/scenarios/drive_downtown.yaml";
  double start_m = 50, missing = 0;
};

}  // namespace

std::shared_ptr<Benchmark> bench_drive() { return std::make_shared<Drive>(); }

}  // namespace odograph
