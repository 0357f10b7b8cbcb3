// SPDX-License-Identifier: Apache-2.0
//
// The simulator compared with real recordings and data sheets: IMU, walkers, pictures.
#include <algorithm>
#include <cmath>

#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/evaluation/excitation.hpp"
#include "sdk/tools/evaluation/gait_figures.hpp"
#include "sdk/tools/evaluation/imu_at_rest.hpp"
#include "sdk/tools/replay/picture_source.hpp"
#include "sdk/tools/simulation/walk_scenarios.hpp"

namespace odograph {
namespace {

struct Allan : Benchmark {
  Allan() : Benchmark("allan", "Allan deviation of the simulated IMU at rest, compared with the specified one", kPlot) {
    plot = {.title = "Allan deviation at rest", .x_label = "log10 s", .y_label = "log10 (rad/s or m/s^2)"};
  }
  void add_options(CLI::App& command) override {
    command.add_option("--scenario", scenario, "scenario with the IMU");
    command.add_option("--seed", seed, "seed of bias and noise");
    command.add_option("--hours", hours, "duration, h")->check(CLI::Range(0.1, 24.0));
  }

  Result<std::vector<BenchCase>> recordings() override {
    return std::vector<BenchCase>{{{{"sensor", "gyroscope"}}, {scenario}}, {{{"sensor", "accelerometer"}}, {scenario}}};
  }

  Result<Json> measure(const BenchCase& one) const override {
    const auto street = read_scenario(scenario);
    if (!street) return street.failure();
    const std::string sensor = one.labels["sensor"];
    Json row{{"rate_hz", street->imu.rate_hz}};
    for (const AllanPoint& p : imu_at_rest(street->imu, sensor == "gyroscope", hours, seed)) {
      row["points"].push_back({{"averaging_s", p.averaging_s},
                               {"simulated", p.simulated},
                               {"asked_for", p.expected},
                               {"ratio", p.simulated / p.expected}});
      row["_lines"][sensor + ", specified"].push_back({std::log10(p.averaging_s), std::log10(p.expected)});
      row["_points"][sensor + ", simulated"].push_back({std::log10(p.averaging_s), std::log10(p.simulated)});
    }
    return row;
  }

  BenchReport report(const Rows& rows) const override {
    Rows lines;
    for (const Json& row : rows)
      for (const Json& point : row["points"]) {
        lines.push_back({{"sensor", row["sensor"]}, {"point", point}});
        for (const char* key : {"simulated", "asked_for"}) lines.back()[key] = text("%.3e", number_at(point, key));
      }
    return {text("%.1f hours at rest, %.0f Hz, mean of three axes; quantisation included.\n\n", hours,
                 number_at(rows[0], "rate_hz")) +
            table_text({"",
                        {{"sensor", "sensor"}},
                        {{"averaging", "s", "point/averaging_s"},
                         {"", "simulated", "simulated"},
                         {"", "specified", "asked_for"},
                         {"", "ratio", "point/ratio", 3}}},
                       lines)};
  }

  std::string scenario = "samples/scenarios/street_short.yaml";
  uint64_t seed = 1;
  double hours = 3;
};

Json figures_of(const GaitSeries& series) {
  const GaitFigures f = gait_figures(series);
  Json row = row_of({{"step frequency (Hz)", "", "frequency_hz", 4, f.frequency_hz},
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
  Gait() : Benchmark("gait", "How simulated walkers compare with a folder of real walks", kPlot | kFolder) {
    options.seeds = 40;
    plot = {.title = "Acceleration's norm", .x_label = "Hz", .y_label = "log10 (m/s^2)^2/Hz"};
  }
  void add_options(CLI::App& command) override {
    command.add_option("--scenario", scenario, "scenario of the walkers");
    command.add_option("--seeds", options.seeds, "number of walkers")->check(CLI::Range(4, 1000))->group(kCases);
  }

  Result<std::vector<BenchCase>> recordings() override {
    auto all = Benchmark::recordings();
    if (!all) return all;
    for (BenchCase& real : *all) real.labels = {{"group", "real"}, {"walk", real.files[0].filename().string()}};
    for (uint64_t seed = 1; seed <= options.seeds; ++seed)
      all->push_back({{{"group", "simulated"}, {"walk", seed}}, {scenario}, {}, seed});
    return all;
  }

  Result<Json> measure(const BenchCase& one) const override {
    if (one.labels["group"] == "real") return Benchmark::measure(one);
    const auto street = read_scenario(scenario);
    return street ? Result<Json>(figures_of(gait_series(any_walker(*street, one.seed), one.seed))) : street.failure();
  }
  Result<Json> measure_recording(const BenchCase&, const Recording& recording) const override {
    const GaitSeries series = gait_series(recording);
    const bool enough = series.acceleration.size() >= static_cast<size_t>(10 * kGaitRate_hz);
    return enough ? figures_of(series) : Json{{"group", "too short"}};
  }

  BenchReport report(const Rows& rows) const override {
    const Rows real = rows_with(rows, "group", "real"), made = rows_with(rows, "group", "simulated");
    Table table{"",
                {{"", "figure"}},
                {{"real", "min", "real/0", 4, {.part = 0}},
                 {"real", "25 %", "real/25", 4, {.part = 0.25}},
                 {"real", "75 %", "real/75", 4, {.part = 0.75}},
                 {"real", "max", "real/100", 4, {.part = 1}},
                 {"simulated", "25 %", "simulated/25", 4, {.part = 0.25}},
                 {"simulated", "50 %", "simulated/50", 4, {.part = 0.5}},
                 {"simulated", "75 %", "simulated/75", 4, {.part = 0.75}}}};
    Rows lines;
    bool all_inside = true;
    for (const Column& figure : columns_of(rows)) {
      Json line = {{"figure", figure.head}};
      for (Column& column : table.columns) {
        column.from = figure.key;
        line = summary_of(line, column.head == "real" ? real : made, {column});
      }
      const bool inside = number_at(line, "simulated/25") >= number_at(line, "real/0") &&
                          number_at(line, "simulated/75") <= number_at(line, "real/100");
      line["outside"] = inside ? "" : "outside";
      all_inside = all_inside && inside;
      lines.push_back(line);
    }
    table.columns.push_back({"", "", "outside"});
    return {
        text("%zu real walks, %zu simulated walkers; samples at %.0f Hz\n\n", real.size(), made.size(), kGaitRate_hz) +
            table_text(table, lines) +
            text("\nEvery quartile of the simulation lies inside the real range: %s\n", all_inside ? "yes" : "no"),
        visible_rows(lines)};
  }

  void draw(const Rows& rows, Plot& into) const override {
    for (const std::string group : {"real", "simulated"}) {
      std::vector<std::vector<double>> spectra;
      for (const Json& row : rows_with(rows, "group", group)) spectra.push_back(row["_spectrum"]);
      for (const double p : {0.25, 0.5, 0.75})
        add_line(into, group + (p == 0.5 ? ", median" : ", quartile"), spectra_percentile(spectra, p),
                 group == "real" ? "lines lc rgb '#1f77b4'" : "lines lc rgb '#d62728'");
    }
  }

  std::string scenario = "samples/scenarios/walk700_M1.yaml";
};

constexpr double kWindows_s[] = {4, 8};

struct Tracks : Benchmark {
  Tracks()
      : Benchmark("tracks", "Tracking of corners through recordings: track lengths, inliers, flow",
                  kConfigs | kPlot | kRecordings, {"monocular_odograph"}) {
    plot = {.title = "Corners still tracked", .x_label = "frames", .y_label = "fraction"};
  }
  void add_options(CLI::App& command) override {
    command.add_option("--frames", frames, "number of frames of each recording");
    command.add_flag("--excitation-only", excitation_only,
                     "only S, N and the pull: rms of the true motion about a quadratic in time, rms error of a visual "
                     "trajectory (of the first config; vision only) after Sim(3), and S^2/(S^2+N^2), in windows of 4 "
                     "and 8 s (medians; overlapping by half; without windows below 0.25 m/s)");
  }

  Result<std::vector<BenchCase>> recordings() override {
    options.configs.resize(1);
    std::error_code error;
    with_error = std::filesystem::exists(options.configs.front().substr(0, options.configs.front().find('?')), error);
    return Benchmark::recordings();
  }
  Result<bool> complete(BenchCase& one) const override {
    if (!with_error) one.run.config.clear();
    return true;
  }

  Result<Json> measure_recording(const BenchCase& one, const Recording& recording) const override {
    Json row = Json::object();
    if (recording.truth.size() >= 10) {
      Pairs pairs{recording.truth, recording.truth};
      if (with_error) {
        const auto result = replay(recording, one.run);
        if (!result) return result.failure();
        // If a recording does not state its camera's clock offset, the offset may exceed the tolerance of an
        // evaluation.
        pairs = associate(recording.truth, result->track, 0.045);
      }
      std::vector<Figure> figures;
      for (const double window_s : kWindows_s) {
        const Excitation e = excitation_of(pairs, {.window_s = window_s});
        const std::string key = text("window_%.0f_s/", window_s), head = text("%.0f s windows", window_s);
        figures.push_back({head, "S mm", key + "motion_mm", 1, 1e3 * e.motion_m});
        figures.push_back({"", "N mm", key + "error_mm", 1, with_error ? Json(1e3 * e.error_m) : Json()});
        figures.push_back({"", "pull", key + "pull", 2, with_error ? Json(e.attenuation) : Json()});
        figures.push_back({"", "n", key + "windows", 0, e.windows});
      }
      row = row_of(figures);
    }
    if (excitation_only) return row;
    const auto tracks = measure_corner_flow(recording, frames, one.run.progress);
    if (!tracks) return tracks.failure();
    row.update(row_of({{"", "frames", "frames", 0, tracks->frames},
                       {"", "Hz", "rate_hz", 1, tracks->rate_hz},
                       {"track length", "", "_lengths", 0, tracks->lengths, {.parts = {0.25, 0.5, 0.75}}},
                       {"found again", "", "_kept", 3, tracks->kept, {.parts = {0.5, 0.1}}},
                       {"one motion", "", "_inliers", 3, tracks->inliers, {.parts = {0.5, 0.1}}},
                       {"flow px", "", "_flow_px", 2, tracks->flow_px, {.parts = {0.5, 0.9}}}},
                      "tracks"));
    row["_lines"][one.labels["recording"].get<std::string>()] = tracks->survival();
    return row;
  }

  std::string heading(const Rows& rows) const override {
    const auto columns = columns_of(rows, "tracks");
    std::string out;
    if (!excitation_only)
      out = text(
                "Up to %d corners, pyramidal Lucas-Kanade with a forward-backward check of 0.7 px, five-point RANSAC "
                "within 1 px; lengths in frames.\n\n",
                kMaxCorners) +
            table_text({"", {{"recording", "recording"}}, columns}, summaries_of(rows, "recording", columns)) + '\n';
    out += text(
        "S: rms of the true motion about the best-fitting quadratic in time of a window; N: the same for the error of "
        "%s\nafter Sim(3) in that window. Medians over windows that overlap by half, without those at rest.\nPull: S^2 "
        "/ (S^2 + N^2).\n\n",
        options.configs.front().c_str());
    if (with_error) return out;
    return out + options.configs.front() +
           ": no such file (run from the source folder, or give its path), so there is no N.\n\n";
  }

  size_t frames = 200;
  bool excitation_only = false, with_error = false;
};

}  // namespace

Benchmarks simulator_benchmarks() {
  return {std::make_shared<Allan>(), std::make_shared<Gait>(), std::make_shared<Tracks>()};
}

}  // namespace odograph
