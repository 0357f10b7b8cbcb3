// SPDX-License-Identifier: Apache-2.0
//
// Absolute fixes: GNSS positions between houses, known objects.
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/evaluation/degrade.hpp"
#include "sdk/tools/evaluation/fix_figures.hpp"
#include "sdk/tools/replay/known_object_runner.hpp"
#include "sdk/tools/simulation/simulate.hpp"
#include "sdk/tools/simulation/walk_scenarios.hpp"

namespace odograph {
namespace {

struct Canyon : Benchmark {
  Canyon()
      : Benchmark("canyon", "Simulated walks with GNSS positions whose errors are correlated and jump",
                  kConfigs | kSeeds | kByConfig) {
    options.seeds = 10;
  }
  void add_options(CLI::App& command) override {
    command.add_option("--sigma", sigma_m, "standard deviation of each component, m");
    command.add_option("--reflection", reflection_m, "offset of the positions for one minute, m");
    command.add_option("--velocity-sigma", velocity_sigma_mps,
                       "velocity error of the receiver in each component, m/s; 0: no velocities");
  }

  Result<Recording> recording_of(const BenchCase& one) const override {
    auto recording = simulated(canyon_walk(sigma_m), one.seed);
    if (!recording) return recording.failure();
    const CanyonParameters p;
    shift_gnss(*recording, p.reflection_from_s, p.reflection_to_s, reflection_m);
    if (velocity_sigma_mps > 0) add_gnss_velocities(*recording, velocity_sigma_mps, one.seed);
    return recording;
  }

  Result<Json> measure_replay(const BenchCase&, const Recording& recording, const RunResult& result) const override {
    const CanyonFigures f = canyon_figures(recording.true_states, result.track);
    const Format parts{.parts = {0.5, 1}};
    return row_of({{"heading, 100 m", "deg", "heading_after_100_m_deg", 1, f.yaw_deg, parts},
                   {"position", "m", "position_m", 1, f.median_m, parts},
                   {"largest error", "m", "largest_m", 1, f.largest_m, parts},
                   {"in reflection", "m", "largest_in_reflection_m", 1, f.in_reflection_m, parts}});
  }

  std::string heading(const Rows&) const override {
    return text(
        "%zu walks of 200 m, a position each second with an error of %g m that is alike for 20 s, and off by "
        "%g m from 60 to 120 s.\n\n",
        options.seeds, sigma_m, reflection_m);
  }

  double sigma_m = 12, reflection_m = 40, velocity_sigma_mps = 0;
};

using namespace known_object_scene;

struct KnownObjects : Benchmark {
  KnownObjects() : Benchmark("known-object", "fix/known_object on posters, boards, tags and look-alikes", 0) {}
  void add_options(CLI::App& command) override {
    command.add_option("--scenes", scenes, "number of scenes for each distance, obliqueness and object");
    command.add_option("--look-alikes", lookalike_frames, "number of frames with look-alikes");
    command.add_option("--kind", only, "only this kind of look-alike, by its row in the table, from 0")
        ->check(CLI::Range(0, 7));
    command.add_option("--seed", seed, "seed of pictures, positions and light");
    command.add_option("--keep", folder, "folder for sample frames");
  }

  Result<std::vector<BenchCase>> recordings() override {
    std::error_code error;
    if (!folder.empty()) std::filesystem::create_directories(folder, error);
    options.fresh |= !folder.empty();
    const auto config = Fixer::config();
    if (!config) return config.failure();
    const std::filesystem::path plugin = config->fixers.at(0).manifest.library;
    std::vector<BenchCase> all;
    for (size_t i = 0; scenes > 0 && i < std::size(kTargets) * std::size(kCells); ++i) {
      const Cell& c = kCells[i % std::size(kCells)];
      all.push_back({{{"target", kTargets[i / std::size(kCells)].id},
                      {"standing", c.standing},
                      {"from_m", c.from_m},
                      {"to_m", c.to_m},
                      {"from_deg", c.from_deg},
                      {"to_deg", c.to_deg}},
                     {plugin},
                     {},
                     i});
    }
    if (lookalike_frames > 0) all.push_back({{{"target", "look-alikes"}}, {plugin}});
    return all;
  }

  Result<Json> measure(const BenchCase& one) const override {
    if (one.labels["target"] == "look-alikes") {
      const auto kinds = look_alikes(lookalike_frames, only, seed, folder, one.run.progress);
      if (!kinds) return kinds.failure();
      Json row;
      for (size_t i = 0; i < kinds->size(); ++i) {
        const LookAlikeFigures& f = (*kinds)[i];
        row["_kinds"].push_back({{"kind", kLookAlikes[i]}});
        row["_kinds"].back().update(row_of({{"", "frames", "frames", 0, f.frames, kSum},
                                            {"", "fixes", "fixes", 0, f.fixes, kSum},
                                            {"", "wrong", "wrong", 0, f.wrong, kSum},
                                            {"largest", "m", "_worst_m", 2, f.worst_m, kWorst}}));
      }
      return row;
    }
    const auto f = scenes_of(kTargets[one.seed / std::size(kCells)], one.seed % std::size(kCells), scenes, seed, folder,
                             one.run.progress);
    if (!f) return f.failure();
    const auto inside = std::count_if(f->nis.begin(), f->nis.end(), [](double nis) { return nis < 5.99; });
    return row_of({{"", "scenes", "scenes", 0, f->scenes, kSum},
                   {"", "fixes", "fixes", 0, f->nis.size(), kSum},
                   {"mean", "m", "mean_m", 3, f->error_m, kMean},
                   {"90 %", "m", "_p90", 3, f->error_m, {.part = 0.9}},
                   {"max", "m", "_max", 3, f->error_m, kWorst},
                   {"rotation", "deg", "_rotation", 2, f->rotation_deg, kMean},
                   {"in 95 %", "%", "_inside", 0, {inside, f->nis.size()}, kShare}});
  }

  BenchReport report(const Rows& rows) const override {
    BenchReport report;
    report.json = Json::object();
    report.text =
        "Frames of 640x480, 500 px (pinhole, radial-tangential, Kannala-Brandt in turn), 10 Hz, rolling shutter of 14 "
        "ms; horizontal error of the last fix of each scene.\n";
    for (const Target& target : kTargets) {
      Rows lines;
      for (const Json& row : rows_with(rows, "target", target.id)) {
        lines.push_back(summary_of(row, {row}, columns_of(rows)));
        report.json["accuracy"].push_back(visible_rows({lines.back()})[0]);
        lines.back()["_name"] = text("%s %g-%g m, %g to %g deg", row["standing"].get<bool>() ? "standing" : "walking",
                                     number_at(row, "from_m"), number_at(row, "to_m"), number_at(row, "from_deg"),
                                     number_at(row, "to_deg"));
      }
      if (!lines.empty())
        report.text += text("\n%s, %.1f x %.1f m\n", target.id.c_str(), target.width_m, target.height_m) +
                       table_text({"", {{"", "_name"}}, columns_of(rows)}, lines);
    }
    for (const Json& row : rows_with(rows, "target", "look-alikes")) {
      Rows kinds(row["_kinds"].begin(), row["_kinds"].end());
      report.json["look_alikes"] = visible_rows(kinds);
      kinds.push_back(summary_of({{"kind", "all"}}, kinds, columns_of(kinds)));
      report.text += '\n' + table_text({"", {{"look-alikes", "kind"}}, columns_of(kinds)}, kinds);
    }
    return report;
  }

  uint64_t scenes = 20, lookalike_frames = 10000, seed = 1;
  std::string folder;
  int only = -1;  // kind of look-alikes; negative: all in turn
};

}  // namespace

Benchmarks fixes_benchmarks() { return {std::make_shared<Canyon>(), std::make_shared<KnownObjects>()}; }

}  // namespace odograph
