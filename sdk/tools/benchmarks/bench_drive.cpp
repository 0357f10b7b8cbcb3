// SPDX-License-Identifier: Apache-2.0
//
// The drive of Gakne & O'Keefe 2018 rebuilt: `odograph bench drive` prints its error distribution (Figures 9 and 11).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/city/thinned_model.hpp"
#include "sdk/tools/console/console.hpp"
#include "sdk/tools/plot/plot.hpp"
#include "sdk/tools/replay/kept_recordings.hpp"
#include "sdk/tools/replay/runner.hpp"

namespace odograph {
namespace {

struct DriveArguments {
  std::vector<std::string> configs = {"samples/configs/gakne2018_vo.yaml", "samples/configs/gakne2018.yaml",
                                      "samples/configs/monocular.yaml", "samples/configs/city_drive.yaml"};
  std::string scenario = "samples/scenarios/drive_downtown.yaml", keep = "out/bench", plot;
  uint64_t seeds = 1, first_seed = 1;
  double start_m = 50, missing = 0;
  bool quick = false, json = false;
};

/// Errors of one config over all its runs, frame by frame.
struct DriveErrors {
  std::vector<double> horizontal_m, north_m, east_m;
  std::vector<double> scale_m;  ///< of each frame's displacement: its length less the true one
  std::vector<double> end_percent;
};

double length_of(const Trajectory& t) {
  double sum = 0;
  for (size_t i = 1; i < t.size(); ++i) sum += (t[i].p - t[i - 1].p).norm();
  return sum;
}

/// The track in metres: by its own scale where the config has a scale source, else by the true length of the first
/// metres, as a car knows it from its wheels when it pulls away.
Trajectory in_metres(const Trajectory& truth, const Trajectory& track, double over_m) {
  const auto from = truth.front().t_ns;
  int64_t until = from;
  double driven = 0;
  for (size_t i = 1; i < truth.size() && driven < over_m; ++i)
    driven += (truth[i].p - truth[i - 1].p).norm(), until = truth[i].t_ns;
  Trajectory head;
  for (const StampedPose& pose : track)
    if (pose.t_ns >= from && pose.t_ns <= until) head.push_back(pose);
  Trajectory scaled = track;
  if (const double own = length_of(head); own > 1e-9)
    for (StampedPose& pose : scaled) pose.p *= driven / own;
  return scaled;
}

/// Turned so that its first pose is the true one: a camera alone does not know what is up.
Trajectory levelled(const Trajectory& truth, const Trajectory& track) {
  if (track.empty()) return track;
  size_t same = 0;
  while (same + 1 < truth.size() && truth[same].t_ns < track.front().t_ns) ++same;
  const Eigen::Quaterniond rotation = truth[same].q * track.front().q.conjugate();
  Trajectory out = track;
  for (StampedPose& pose : out) pose.p = rotation * pose.p, pose.q = rotation * pose.q;
  return out;
}

/// The folder of the city model that the pipeline is given: what was rendered, or less of it.
Result<std::filesystem::path> model_for(const DriveArguments& a, const std::filesystem::path& recording,
                                        uint64_t seed) {
  const auto whole = assets_of(recording);
  if (a.missing <= 0) return whole;
  const auto folder = recording.parent_path() / (recording.stem().string() + ".missing");
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  const auto left = write_thinned_model(whole / "city.json", folder / "city.json", a.missing, seed);
  if (!left) return left.failure();
  return folder;
}

Result<bool> add_run(const DriveArguments& a, const std::string& config, uint64_t seed, DriveErrors& errors) {
  const auto file = kept_recording(a.scenario, seed, a.keep, a.quick ? 300.0 : 0.0);
  if (!file) return file.failure();
  const auto recording = open_recording(*file);
  if (!recording) return recording.failure();
  Progress progress("run " + config + " seed " + std::to_string(seed));
  RunOptions options;
  options.config = config;
  const auto assets = model_for(a, *file, seed);
  if (!assets) return assets.failure();
  options.asset_path = assets->string();
  options.progress = [&](size_t i, size_t n) { progress.show(i, n); };
  const auto result = replay(*recording, options);
  if (!result) return result.failure();
  const Trajectory& truth = recording->truth;
  Trajectory track = result->track;
  if (result->fixes.empty()) {  // it knows neither where it is nor what is north
    track = levelled(truth, track);
    track = started(truth, result->scales.empty() ? in_metres(truth, track, a.start_m) : track, a.start_m);
  }
  Eigen::Vector3d estimate_before = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < truth.size(); ++i) {
    const Eigen::Vector3d estimate = position_at(track, truth[i].t_ns), d = estimate - truth[i].p;
    errors.horizontal_m.push_back(d.head<2>().norm());
    errors.north_m.push_back(d.x()), errors.east_m.push_back(d.y());
    if (i > 0)
      errors.scale_m.push_back(std::abs((estimate - estimate_before).norm() - (truth[i].p - truth[i - 1].p).norm()));
    estimate_before = estimate;
  }
  errors.end_percent.push_back(100 * errors.horizontal_m.back() / length_of(truth));
  return true;
}

constexpr std::array<double, 8> kParts = {0.10, 0.25, 0.50, 0.68, 0.75, 0.90, 0.95, 0.99};

void print(const DriveArguments& a, const std::vector<DriveErrors>& all) {
  std::printf(
      "Horizontal errors after Gakne & O'Keefe 2018, Figure 11; where a config has no fixes, start\n"
      "and heading (and the scale, where it has no source of it) are from the first %.0f m.\n",
      a.start_m);
  std::printf("%llu seed%s, all frames; %.0f %% of the buildings are missing in the model.\n\n%-44s",
              static_cast<unsigned long long>(a.seeds), a.seeds == 1 ? "" : "s", 100 * a.missing,
              "error in m of this part of the frames:");
  for (const double p : kParts) std::printf(" %6.0f%%", 100 * p);
  std::printf("  %-15s %-15s %9s %9s\n", "north", "east", "scale", "end");
  for (size_t c = 0; c < all.size(); ++c) {
    const DriveErrors& e = all[c];
    std::printf("%-44s", a.configs[c].c_str());
    for (const double p : kParts) std::printf(" %7.2f", percentile(e.horizontal_m, p));
    const auto range = [](const std::vector<double>& v) {
      char text[40];
      std::snprintf(text, sizeof text, "%+.1f..%+.1f", *std::min_element(v.begin(), v.end()),
                    *std::max_element(v.begin(), v.end()));
      return std::string(text);
    };
    std::printf("  %-15s %-15s %7.3f m %7.2f %%\n", range(e.north_m).c_str(), range(e.east_m).c_str(),
                percentile(e.scale_m, 0.5), percentile(e.end_percent, 0.5));
  }
  std::printf(
      "\nscale: |length of a frame's displacement - true one|, median (Figure 9); end: error at the end of the "
      "path.\n");
  if (all.size() < 2) return;
  for (size_t c = 1; c < all.size(); ++c) {
    size_t better = 0;
    for (size_t i = 0; i < all[0].horizontal_m.size(); ++i) better += all[c].horizontal_m[i] < all[0].horizontal_m[i];
    std::printf("%s is nearer to the truth than %s in %.0f %% of the frames.\n", a.configs[c].c_str(),
                a.configs[0].c_str(),
                100.0 * static_cast<double>(better) / static_cast<double>(all[0].horizontal_m.size()));
  }
}

Result<bool> plot(const DriveArguments& a, const std::vector<DriveErrors>& all) {
  Plot plot{.title = "Horizontal error", .x_label = "m", .y_label = "part of the frames"};
  for (size_t c = 0; c < all.size(); ++c) {
    PlotSeries series{.name = a.configs[c], .style = "lines"};
    for (int p = 0; p <= 100; ++p) series.points.emplace_back(percentile(all[c].horizontal_m, 0.01 * p), 0.01 * p);
    plot.series.push_back(std::move(series));
  }
  return write_svg(plot, a.plot);
}

int drive(const DriveArguments& a) {
  std::vector<DriveErrors> all(a.configs.size());
  for (size_t c = 0; c < a.configs.size(); ++c)
    for (uint64_t seed = a.first_seed; seed < a.first_seed + a.seeds; ++seed)
      if (const auto done = add_run(a, a.configs[c], seed, all[c]); !done) return complain(done.failure());
  if (!a.plot.empty())
    if (const auto done = plot(a, all); !done) return complain(done.failure());
  if (!a.json) {
    print(a, all);
    return kDone;
  }
  nlohmann::ordered_json rows = nlohmann::json::array();
  for (size_t c = 0; c < all.size(); ++c) {
    nlohmann::ordered_json parts;
    for (const double p : kParts)
      parts[std::to_string(static_cast<int>(100 * p + 0.5))] = percentile(all[c].horizontal_m, p);
    rows.push_back({{"config", a.configs[c]},
                    {"seeds", a.seeds},
                    {"horizontal_m", parts},
                    {"scale_median_m", percentile(all[c].scale_m, 0.5)},
                    {"end_percent", all[c].end_percent}});
  }
  std::printf("%s\n", rows.dump(2).c_str());
  return kDone;
}

}  // namespace

void add_bench_drive(CLI::App& bench, int& status) {
  auto a = std::make_shared<DriveArguments>();
  auto* command = bench.add_subcommand(
      "drive", "The downtown drive of Gakne & O'Keefe 2018, simulated: distribution of the horizontal error");
  command->add_option("-c,--config", a->configs, "pipeline configs to compare, the first the one to beat")
      ->capture_default_str();
  command->add_option("--seeds", a->seeds, "how many")->capture_default_str()->check(CLI::Range(1, 1000));
  command->add_option("--first-seed", a->first_seed, "the first of them")->capture_default_str();
  command->add_flag("--quick", a->quick, "the first 300 m alone");
  command->add_option("--scenario", a->scenario, "the drive")->capture_default_str();
  command->add_option("--missing", a->missing, "part of the buildings that the city model lacks, drawn by the seed")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1.0));
  command->add_option("--start", a->start_m, "start, heading and missing scale are fitted over these first metres")
      ->capture_default_str();
  command->add_option("--keep", a->keep, "recordings are kept here and rendered once")->capture_default_str();
  command->add_option("--plot", a->plot, "write the distributions as SVG");
  command->add_flag("--json", a->json, "print one JSON array, an entry for each config");
  command->callback([a, &status] { status = drive(*a); });
}

}  // namespace odograph
