// SPDX-License-Identifier: Apache-2.0
//
// Visual odometries side by side: `odograph bench vo`.
#include <algorithm>
#include <cstdio>

#include "sdk/tools/benchmarks/bench_vo_reference.hpp"
#include "sdk/tools/benchmarks/bench_vo_row.hpp"
#include "sdk/tools/benchmarks/bench_vo_table.hpp"
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/console/console.hpp"
#include "sdk/tools/evaluation/degrade.hpp"
#include "sdk/tools/replay/kept_recordings.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kQuick_m = 120;  // as `bench walk700 --quick`, which keeps the same recordings

struct VoArguments {
  std::vector<std::string> configs = {"samples/configs/monocular.yaml", "samples/configs/monocular_antigny2019.yaml",
                                      "samples/configs/monocular_gakne2018.yaml",
                                      "samples/configs/monocular_odograph.yaml",
                                      "samples/configs/inertial_odograph.yaml"};
  std::vector<std::string> scenarios = {"samples/scenarios/street_short.yaml"}, recordings;
  std::string keep = "out/bench", reference, reference_frame = "camera", plot, gap, dark;
  uint64_t seeds = 1, first_seed = 1, sensor_seed = 1;
  double cut_s = 0;
  bool quick = false, stress = false, sensors = false, json = false;
};

Result<std::vector<fs::path>> recordings_of(const VoArguments& a) {
  std::vector<fs::path> files(a.recordings.begin(), a.recordings.end());
  if (!files.empty()) return files;
  std::vector<fs::path> scenarios(a.scenarios.begin(), a.scenarios.end());
  if (a.stress) {
    scenarios.clear();
    for (const auto& entry : fs::directory_iterator(fs::path(a.scenarios.front()).parent_path()))
      if (entry.path().filename().string().rfind("stress_", 0) == 0) scenarios.push_back(entry.path());
    std::sort(scenarios.begin(), scenarios.end());
  }
  for (const fs::path& scenario : scenarios)
    for (uint64_t seed = a.first_seed; seed < a.first_seed + a.seeds; ++seed) {
      auto file = kept_recording(scenario, seed, a.keep, a.quick ? kQuick_m : 0);
      if (!file) return file.failure();
      files.push_back(*file);
    }
  return files;
}

/// "FROM:FOR" in s.
Result<bool> parse_interval(const std::string& text, const char* option, double& from_s, double& for_s) {
  if (text.empty()) return true;
  int end = 0;
  if (std::sscanf(text.c_str(), "%lf:%lf%n", &from_s, &for_s, &end) == 2 && text[static_cast<size_t>(end)] == 0 &&
      from_s >= 0 && for_s > 0)
    return true;
  return Failure{ODO_E_ARGUMENT, std::string(option) + " " + text + ": expected FROM:FOR in seconds, such as 10:2"};
}

/// What each recording is run as.
Result<std::vector<Degradation>> variants_of(const VoArguments& a) {
  std::vector<Degradation> all = a.sensors ? sensor_qualities() : std::vector<Degradation>{{}};
  for (Degradation& d : all) {
    d.cut_s = a.cut_s;
    if (auto ok = parse_interval(a.gap, "--gap", d.gap_from_s, d.gap_for_s); !ok) return ok.failure();
    if (auto ok = parse_interval(a.dark, "--dark", d.dark_from_s, d.dark_for_s); !ok) return ok.failure();
  }
  return all;
}

Result<Recording> read_with_reference(const fs::path& file, const VoArguments& a) {
  auto recording = open_recording(file);
  if (!recording) return recording.failure();
  if (!recording->has(ODO_TYPE_FRAME)) return Failure{ODO_E_DATA, file.string() + ": no camera frames"};
  if (a.reference.empty()) return recording;
  auto poses = read_reference(a.reference, a.reference_frame, *recording);
  if (!poses) return poses.failure();
  recording->truth = std::move(*poses);
  return recording;
}

std::string name_of(const fs::path& file) {
  const fs::path path = file.has_filename() ? file : file.parent_path();  // FOLDER/
  return path.stem().string();
}

struct Benchmark {
  std::vector<Json> rows;
  Plot plot{.title = "Scale along the path", .x_label = "m", .y_label = "odometry by truth"};
};

Result<bool> run_one(const Recording& recording, const std::string& name, const std::string& config,
                     const Degradation& variant, Benchmark& out) {
  const std::string what = name + " " + fs::path(config).stem().string();
  Progress progress(variant.name.empty() ? what : what + ", " + variant.name);
  RunOptions options;
  options.config = config;
  options.progress = [&](size_t i, size_t n) { progress.show(i, n); };
  const auto result = replay(recording, options);
  if (!result) return result.failure();
  Json row = {{"recording", name}, {"config", config}};
  if (!variant.name.empty()) row["sensors"] = variant.name;
  row.update(vo_row(recording, *result));
  out.rows.push_back(std::move(row));
  if (!recording.truth.empty()) {
    auto series = scale_series(recording, *result, variant.name.empty() ? what : what + " " + variant.name);
    if (!series.points.empty()) out.plot.series.push_back(std::move(series));
  }
  return true;
}

int bench_vo(const VoArguments& a) {
  const auto variants = variants_of(a);
  if (!variants) return complain(variants.failure());
  const auto files = recordings_of(a);
  if (!files) return complain(files.failure());
  if (!a.reference.empty() && files->size() != 1)
    return complain(
        {ODO_E_ARGUMENT, "--reference is for one recording, and there are " + std::to_string(files->size())});
  Benchmark out;
  for (const fs::path& file : *files) {
    const auto recording = read_with_reference(file, a);
    if (!recording) return complain(recording.failure());
    for (const Degradation& variant : *variants) {
      const Recording worse = degraded(*recording, variant, a.sensor_seed);
      for (const std::string& config : a.configs)
        if (const auto done = run_one(worse, name_of(file), config, variant, out); !done)
          return complain(done.failure());
    }
  }
  if (a.json)
    std::printf("%s\n", Json(out.rows).dump(2).c_str());
  else
    print_vo_tables(out.rows);
  if (a.plot.empty()) return kDone;
  if (out.plot.series.empty()) {
    std::fprintf(stderr, "%s: nothing to plot, no path is long enough to have a scale\n", a.plot.c_str());
    return kDone;
  }
  const auto written = write_svg(out.plot, a.plot);
  return written ? kDone : complain(written.failure());
}

}  // namespace

void add_bench_vo(CLI::App& bench, int& status) {
  auto a = std::make_shared<VoArguments>();
  auto* command = bench.add_subcommand("vo", "Visual odometries side by side, on simulated walks or recordings");
  command->add_option("recordings", a->recordings, "recordings with a camera; none: simulated ones");
  command->add_option("-c,--config", a->configs, "pipeline configs to compare")->capture_default_str();
  command->add_option("--reference", a->reference, "TUM poses to measure against, instead of the recording's truth")
      ->check(CLI::ExistingFile);
  command->add_option("--reference-frame", a->reference_frame, "whose poses those are: camera, or body (the IMU)")
      ->capture_default_str()
      ->check(CLI::IsMember({"camera", "body"}));
  command->add_option("--scenario", a->scenarios, "what is simulated")->capture_default_str();
  command->add_flag("--stress", a->stress, "the stress_*.yaml beside the scenario instead");
  command->add_option("--seeds", a->seeds, "how many of each")->capture_default_str()->check(CLI::Range(1, 1000));
  command->add_option("--first-seed", a->first_seed, "the first of them")->capture_default_str();
  command->add_flag("--quick", a->quick, "simulate the first 120 m of a walk alone");
  command->add_option("--keep", a->keep, "recordings are kept here and rendered once")->capture_default_str();
  command->add_flag("--sensors", a->sensors,
                    "each recording as it is and with one fault of the sensors after the other");
  command->add_option("--sensor-seed", a->sensor_seed, "of the faults' random numbers")->capture_default_str();
  command->add_option("--cut", a->cut_s, "begin so many seconds after the first frame")->check(CLI::NonNegativeNumber);
  command->add_option("--gap", a->gap, "FROM:FOR in seconds after the first frame: frames are missing");
  command->add_option("--dark", a->dark, "FROM:FOR in seconds after the first frame: frames are black");
  command->add_option("--plot", a->plot, "write the scale along the path as SVG");
  command->add_flag("--json", a->json, "print one JSON array, an entry for each run");
  command->callback([a, &status] { status = bench_vo(*a); });
}

}  // namespace odograph
