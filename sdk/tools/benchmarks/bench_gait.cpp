// SPDX-License-Identifier: Apache-2.0
//
// How simulated walkers compare with real ones: `odograph bench gait`.
#include <algorithm>
#include <cmath>

#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/evaluation/gait_figures.hpp"
#include "sdk/tools/simulation/random.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

/// Walkers of all sizes and paces, on a piece of the route that has no long stop.
GaitSeries walked(Scenario scenario, uint64_t seed) {
  Random size(seed, 6);
  scenario.events.clear();
  scenario.walk_m = 80;
  scenario.walker.height_m = size.uniform(1.55, 1.90);
  scenario.walker.speed_mps = size.uniform(1.05, 1.45);
  return gait_series(scenario, seed);
}

Json figures_of(const GaitSeries& series) {
  const GaitFigures f = gait_figures(series);
  Json row =
      row_of("gait", {{"step frequency (Hz)", "", "frequency_hz", 4, f.frequency_hz},
                      {"acceleration, std of the norm (m/s^2)", "", "acceleration_std", 4, f.acceleration_std},
                      {"acceleration, 95 % of |norm - mean| (m/s^2)", "", "acceleration_p95", 4, f.acceleration_p95},
                      {"rotation rate, rms (rad/s)", "", "rotation_rms", 4, f.rotation_rms},
                      {"horizontal acceleration, rms (m/s^2)", "", "horizontal_rms", 4, f.horizontal_rms},
                      {"stride's power over step's", "", "stride_part", 4, f.stride_part},
                      {"power above 8 Hz over all", "", "shock_part", 4, f.shock_part}});
  row["_spectrum"] = f.spectrum;
  return row;
}

struct Gait : Benchmark {
  Gait() : Benchmark("gait", "How simulated walkers compare with a folder of real walks", kPlot) { options.seeds = 40; }
  void add_options(CLI::App& command) override {
    command.add_option("data", data, "folder of Indoor Location Competition traces")->required()->group(kCases);
    command.add_option("--scenario", scenario, "where the walkers walk");
    command.add_option("--seeds", options.seeds, "how many walkers")->check(CLI::Range(4, 1000))->group(kCases);
  }

  Result<std::vector<BenchCase>> cases() override {
    std::vector<BenchCase> all;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(data, error))
      if (entry.path().extension() == ".txt")
        all.push_back({{{"group", "real"}, {"walk", entry.path().filename().string()}}, {entry.path()}});
    if (all.empty()) return Failure{ODO_E_NOT_FOUND, data + ": no walks (*.txt) in this folder"};
    std::sort(all.begin(), all.end(), [](const BenchCase& x, const BenchCase& y) { return x.files < y.files; });
    for (uint64_t seed = 1; seed <= options.seeds; ++seed)
      all.push_back({{{"group", "simulated"}, {"walk", seed}}, {scenario}, {}, seed});
    return all;
  }

  Result<Json> measure(const BenchCase& one, const ShowProgress&) const override {
    if (one.labels["group"] == "simulated") {
      const auto read = read_scenario(scenario);
      return read ? Result<Json>(figures_of(walked(*read, one.seed))) : read.failure();
    }
    const auto recording = read_recording(one.files.front());
    if (!recording) return recording.failure();
    const GaitSeries series = gait_series(*recording);
    const bool enough = series.acceleration.size() >= static_cast<size_t>(10 * kGaitRate_hz);
    return enough ? figures_of(series) : Json{{"group", "too short"}};
  }

  BenchReport report(const Rows& rows) const override {
    const Rows real = rows_with(rows, "group", "real"), made = rows_with(rows, "group", "simulated");
    Table table{"", {{"", "figure"}}, {}};
    const std::pair<const Rows*, std::vector<double>> groups[] = {{&real, {0, 0.25, 0.75, 1}},
                                                                  {&made, {0.25, 0.5, 0.75}}};
    for (const auto& [group, parts] : groups)
      for (const double part : parts) {
        const std::string group_name = group == &real ? "real" : "simulated";
        table.columns.push_back({group_name,
                                 part == 0   ? "min"
                                 : part == 1 ? "max"
                                             : text("%.0f %%", 100 * part),
                                 text("%s/%.0f", group_name.c_str(), 100 * part), 4});
      }
    table.columns.push_back({"", "", "outside"});
    Rows lines;
    bool all_inside = true;
    for (const Column& figure : columns_of(rows, "gait")) {
      const std::string& key = figure.key;
      Json line = {{"figure", figure.head}};
      for (const auto& [group, parts] : groups)
        for (const double part : parts)
          line[group == &real ? "real" : "simulated"][text("%.0f", 100 * part)] = percentile_at(*group, key, part);
      const bool inside = percentile_at(made, key, 0.25) >= percentile_at(real, key, 0) &&
                          percentile_at(made, key, 0.75) <= percentile_at(real, key, 1);
      line["outside"] = inside ? "" : "outside";
      all_inside = all_inside && inside;
      lines.push_back(line);
    }
    return {
        text("%zu real walks, %zu simulated walkers; samples at %.0f Hz\n\n", real.size(), made.size(), kGaitRate_hz) +
            table_text(table, lines) +
            text("\nEvery quartile of the simulation lies inside the real range: %s\n", all_inside ? "yes" : "no"),
        printed(lines), spectra(real, made)};
  }

  static Plot spectra(const Rows& real, const Rows& made) {
    Plot plot{.title = "Acceleration's norm", .x_label = "Hz", .y_label = "log10 (m/s^2)^2/Hz"};
    for (const auto* group : {&real, &made})
      for (const double p : {0.25, 0.5, 0.75}) {
        PlotSeries series{
            .name = std::string(group == &real ? "real" : "simulated") + (p == 0.5 ? ", median" : ", quartile"),
            .style = group == &real ? "lines lc rgb '#1f77b4'" : "lines lc rgb '#d62728'"};
        for (size_t k = 3; k < 240; ++k) {
          std::vector<double> values;
          for (const Json& row : *group) values.push_back(row["_spectrum"][k].get<double>());
          series.points.emplace_back(0.1 * static_cast<double>(k), std::log10(percentile(values, p) + 1e-9));
        }
        plot.series.push_back(std::move(series));
      }
    return plot;
  }

  std::string data, scenario = "samples/scenarios/walk700_M1.yaml";
};

}  // namespace

std::shared_ptr<Benchmark> bench_gait() { return std::make_shared<Gait>(); }

}  // namespace odograph
