// SPDX-License-Identifier: Apache-2.0
//
// Visual odometries side by side: `odograph bench vo`.
#include <algorithm>
#include <cstdio>

#include "sdk/tools/benchmarks/bench_vo_row.hpp"
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/evaluation/degrade.hpp"
#include "sdk/tools/evaluation/reference_poses.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMetreNote =
    "From the motions alone, one after the other. placed: frames with a displacement, not lost; metric: in metres; "
    "before: not in\nmetres while the metre came later. longest: scale group. start: from the first frame to the first "
    "metric motion; moving:\nfrom the camera's first 5 cm. true, own: path of the metric frames. SE3, yaw: rms "
    "displacement after alignment; tracked: the worst\nSE3 of a metric stretch that says it is tracked, of its path. "
    "scale: |own by true - 1| of the Sim(3) alignment. jump: the worst\nchange of scale within a group from the 10 m "
    "before a stop to the 10 m after. drift: while standing. wrong: part of the time (by\nplaces 5 m apart) in which "
    "the scale is off by more than 3 of its own sigmas; NEES: (log scale / sigma)^2, mean; 1 is\nconsistent.\n\n";

constexpr const char* kShapeNote =
    "APE: after Sim(3), of the path. true scale: error at the end when each frame's displacement, or each 10 m of the "
    "path, is given its\ntrue length. scale: how much it changes from one half of such a stretch to the other. "
    "rotation: error of a frame, median. NEES:\nnormalised error squared of a frame's rotation and of its direction, "
    "by degree of freedom; 1 is consistent.\n";

/// "FROM:FOR" in s.
Result<bool> parse_interval(const std::string& given, const char* option, double& from_s, double& for_s) {
  int end = 0;
  if (given.empty() || (std::sscanf(given.c_str(), "%lf:%lf%n", &from_s, &for_s, &end) == 2 &&
                        given[static_cast<size_t>(end)] == 0 && from_s >= 0 && for_s > 0))
    return true;
  return Failure{ODO_E_ARGUMENT, std::string(option) + " " + given + ": expected FROM:FOR in seconds, such as 10:2"};
}

struct Vo : Benchmark {
  Vo()
      : Benchmark("vo", "Visual odometries side by side, on simulated walks or recordings",
                  kConfigs | kSeeds | kQuick | kPlot | kSimulated | kRecordings) {
    for (const char* config :
         {"monocular", "monocular_antigny2019", "monocular_gakne2018", "monocular_odograph", "inertial_odograph"})
      options.configs.push_back(std::string("samples/configs/") + config + ".yaml");
    options.scenarios = {"samples/scenarios/street_short.yaml"};
    quick_m = 120;  // as `bench walk700 --quick`, which keeps the same recordings
  }
  void add_options(CLI::App& command) override {
    command.add_option("--reference", reference, "TUM poses to measure against, instead of the recording's truth")
        ->check(CLI::ExistingFile);
    command.add_option("--reference-frame", reference_frame, "whose poses those are: camera, or body (the IMU)")
        ->check(CLI::IsMember({"camera", "body"}));
    command.add_flag("--stress", stress, "the stress_*.yaml beside the scenario instead")->group(kCases);
    command.add_flag("--sensors", sensors, "each recording as it is and with one fault of the sensors after the other")
        ->group(kCases);
    command.add_option("--sensor-seed", sensor_seed, "of the faults' random numbers");
    command.add_option("--cut", cut_s, "begin so many seconds after the first frame")->check(CLI::NonNegativeNumber);
    command.add_option("--gap", gap, "FROM:FOR in seconds after the first frame: frames are missing");
    command.add_option("--dark", dark, "FROM:FOR in seconds after the first frame: frames are black");
  }

  Result<std::vector<BenchCase>> cases() override {
    worse = sensors ? sensor_qualities() : std::vector<Degradation>{{}};
    for (Degradation& d : worse) {
      d.cut_s = cut_s;
      if (auto ok = parse_interval(gap, "--gap", d.gap_from_s, d.gap_for_s); !ok) return ok.failure();
      if (auto ok = parse_interval(dark, "--dark", d.dark_from_s, d.dark_for_s); !ok) return ok.failure();
    }
    variants = names_of(worse);
    if (stress) {
      const fs::path folder = fs::path(options.scenarios.front()).parent_path();
      options.scenarios.clear();
      for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().filename().string().starts_with("stress_")) options.scenarios.push_back(entry.path());
      std::sort(options.scenarios.begin(), options.scenarios.end());
    }
    auto all = Benchmark::cases();
    if (!all || reference.empty()) return all;
    const size_t recordings = all->size() / (options.configs.size() * variants.size());
    if (recordings != 1)
      return Failure{ODO_E_ARGUMENT, "--reference is for one recording, and there are " + std::to_string(recordings)};
    for (BenchCase& one : *all) one.files.emplace_back(reference);
    return all;
  }

  Result<Json> measure(const BenchCase& one, const ShowProgress& progress) const override {
    auto recording = read_recording(one.files.front());
    if (!recording) return recording.failure();
    if (!recording->has(ODO_TYPE_FRAME)) return Failure{ODO_E_DATA, one.files.front().string() + ": no camera frames"};
    if (!reference.empty()) {
      auto poses = read_reference(reference, reference_frame, *recording);
      if (!poses) return poses.failure();
      recording->truth = std::move(*poses);
    }
    *recording = degraded(*recording, worse[one.variant], sensor_seed);
    RunOptions run = one.run;
    run.progress = progress;
    const auto result = replay(*recording, run);
    return result ? Result<Json>(vo_row(*recording, *result)) : result.failure();
  }

  BenchReport report(const Rows& rows) const override {
    BenchReport report{table_with_medians("Metre", "metre", rows) + kMetreNote +
                           table_with_medians("Shape and cost", "shape", rows) + kShapeNote,
                       {},
                       {.title = "Scale along the path", .x_label = "m", .y_label = "odometry by truth"}};
    for (const Json& row : rows) {
      const std::string run_name = row["recording"].get<std::string>() + ' ' +
                                   stem_of(row["config"].get<std::string>()) +
                                   (row.contains("sensors") ? ' ' + row["sensors"].get<std::string>() : "");
      if (const auto refined = row.find("refined"); refined != row.end())
        report.text += text("%s: refined to f %.1f %.1f, centre %.1f %.1f px, time offset %.2f ms, line time %.2f us\n",
                            run_name.c_str(), number_at(*refined, "fx_px"), number_at(*refined, "fy_px"),
                            number_at(*refined, "cx_px"), number_at(*refined, "cy_px"),
                            number_at(*refined, "time_offset_ms"), number_at(*refined, "line_time_us"));
      PlotSeries series{.name = run_name, .style = "lines"};
      for (const Json& point : row.value("_scale", Json::array()))
        if (point[1].is_number()) series.points.emplace_back(point[0].get<double>(), point[1].get<double>());
      if (!series.points.empty()) report.plot.series.push_back(std::move(series));
    }
    return report;
  }

  /// The rows, and below them medians over recordings where a config has several.
  static std::string table_with_medians(const char* title, const std::string& table, const Rows& rows) {
    Rows lines = rows, medians;
    for (const Json& config : values_of(rows, "config"))
      for (Json& median : summaries_of(rows_with(rows, "config", config), "sensors", columns_of(rows, table)))
        median["config"] = config, median["recording"] = "median", medians.push_back(std::move(median));
    if (medians.size() < rows.size()) lines.insert(lines.end(), medians.begin(), medians.end());
    return recordings_text(lines, table, title);
  }

  std::string reference, reference_frame = "camera", gap, dark;
  std::vector<Degradation> worse;
  uint64_t sensor_seed = 1;
  double cut_s = 0;
  bool stress = false, sensors = false;
};

}  // namespace

std::shared_ptr<Benchmark> bench_vo() { return std::make_shared<Vo>(); }

}  // namespace odograph
