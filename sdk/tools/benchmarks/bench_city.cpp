// SPDX-License-Identifier: Apache-2.0
//
// Drives and walks through real city models, drawn by seeds: how far off the pose is, how often the skyline tells a
// place, and how often it is wrong.
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/city/city_scenario.hpp"
#include "sdk/tools/city/street_route.hpp"
#include "sdk/tools/evaluation/fix_figures.hpp"
#include "sdk/tools/evaluation/start_alignment.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

constexpr int64_t kTold_ns = 3'000'000'000;  // a fix is told so late at most
constexpr uint64_t kOtherSky = 1000;         // added to a drive's seed for each sky after the first

struct City : Benchmark {
  City()
      : Benchmark("bench",
                  "Drives through the streets of city models, drawn and rendered by seeds: errors, fixes, integrity",
                  kConfigs, {"city_drive"}) {}
  void add_options(CLI::App& command) override {
    command.add_option("model", models, "city models; each takes the place of fix/skyline's")
        ->required()
        ->group(kCases);
    command.add_option("--skylines", skylines,
                       "database that takes the place of fix/skyline's; errors count from the first fix on");
    command.add_option("--lens", lenses, "wide and narrow look up from a car, forward ahead from a walker's hand")
        ->check(CLI::IsMember({"wide", "narrow", "forward"}));
    command.add_option("--drives", options.seeds, "in each model")->check(CLI::Range(1, 1000))->group(kCases);
    command.add_option("--first-seed", options.first_seed, "of route, sun, clouds and noise")->group(kCases);
    command.add_option("--skies", skies, "each route under that many suns and clouds")->check(CLI::Range(1, 100));
    command.add_option("--length", length_m, "of each drive, m");
  }

  Result<std::vector<BenchCase>> recordings() override {
    std::vector<BenchCase> all;
    for (const std::string& lens : lenses)
      for (const std::string& model : models)
        for (uint64_t k = 0; k < options.seeds * skies; ++k) {
          auto one = drive(lens, model, options.first_seed + k / skies, k % skies);
          if (!one) return one.failure();
          all.push_back(std::move(*one));
        }
    return all;
  }

  Result<Json> measure_replay(const BenchCase&, const Recording& recording, const RunResult& result) const override {
    const std::vector<odo_fix> accepted = result.accepted();
    const FixFigures f = fix_figures(recording, accepted);
    Trajectory scored = recording.truth;
    if (!skylines.empty() && !accepted.empty())
      std::erase_if(scored, [&](const StampedPose& p) { return p.t_ns < accepted.front().header.t_ns + kTold_ns; });
    const auto horizontal_m = horizontal_errors(scored, result.track);
    const auto first = [&](double x) { return accepted.empty() ? Json() : Json(x); };
    const As mostly{.parts = {0.5, 0.95}};
    Json row = row_of({{"error", "m", "horizontal_m", 2, horizontal_m, mostly},
                       {"error", "worst", "_horizontal_worst", 2, horizontal_m, kWorst},
                       {"fix", "m", "_fix_m", 2, f.error_m, mostly},
                       {"fixes", "used", "fixes/used", 0, accepted.size(), kSum},
                       {"fixes", "refused", "fixes/refused", 0, result.fixes.size() - accepted.size(), kSum},
                       {"", "", "fixes/beyond_3_sigma", -1, f.beyond, kSum},
                       {"> 3 sigma", "%", "_beyond_percent", 1, {f.beyond, accepted.size()}, kShare},
                       {"", "", "seconds_with_skyline", -1, f.seconds, kSum},
                       {"", "", "seconds_with_fix", -1, f.with_fix, kSum},
                       {"seconds", "with fix %", "_seconds_percent", 0, {f.with_fix, f.seconds}, kShare},
                       {"1st fix", "after m", "first_fix/after_m", 0, first(f.first_after_m), kFirst},
                       {"1st fix", "off m", "first_fix/off_m", 2, first(f.first_off_m), kFirst},
                       {"frame", "ms 99 %", "frame_ms_99", 1, percentile(result.frame_ms, 0.99), kWorst},
                       {"thread", "ms 99 %", "thread_ms_99", 1, percentile(result.frame_thread_ms, 0.99), kWorst},
                       {"tilt", "deg", "tilt_deg", 2, tilt_errors_deg(recording.truth, result.track), mostly}});
    std::string reasons;
    for (const auto& [key, notice] : result.notices)
      if (const auto at = key.find("no_fix_"); at != std::string::npos)
        reasons += ' ' + key.substr(at + 7) + ' ' + std::to_string(notice.count);
    row["_reasons"] = reasons;
    return row;
  }

  /// A line for each drive, and one for all of a lens and config.
  BenchReport report(const Rows& rows) const override {
    Table table{"", {{"model, lens, seed", "name"}}, columns_of(rows)};
    Rows lines;
    const auto add = [&](const Json& what, const Json& config, const Rows& of) {
      lines.push_back(summary_of({{"name", what}, {"config", config}}, of, table.columns));
    };
    for (const auto& [lens, own] : groups_of(rows, "lens")) {
      for (const Json& row : own) add(row["name"], row["config"], {row}), lines.back()["_reasons"] = row["_reasons"];
      for (const auto& [config, all] : groups_of(own, "config")) {
        add("all, " + lens.get<std::string>(), config, all);
        lines.back().erase("first_fix");
      }
    }
    if (options.configs.size() > 1) table.labels.push_back({"config", "config", true});
    table.columns.push_back({"no fix because of", "(frames)", "_reasons"});
    return {table_text(table, lines), printed(lines)};
  }

  /// Rendered now unless it is kept; the model and where it lies take the place of the config's.
  Result<BenchCase> drive(const std::string& lens, const std::string& model, uint64_t seed, uint64_t sky) const {
    const fs::path file = fs::absolute(model);
    const std::string city = file.stem().stem().string();
    std::error_code error;
    fs::create_directories(options.keep, error);
    const fs::path scenario =
        fs::path(options.keep) / ("city_" + city + '_' + lens + '_' + std::to_string(seed) + ".yaml");
    const auto origin =
        write_city_scenario({model, scenario.string(), lens, lens == "forward" ? "walker" : "car", seed, length_m});
    if (!origin) return origin.failure();
    const auto recording = kept(scenario, seed + kOtherSky * sky);
    if (!recording) return recording.failure();
    const std::string plus = sky > 0 ? '+' + std::to_string(sky) : "";
    BenchCase one{{{"name", city + ' ' + lens + ' ' + std::to_string(seed) + plus}, {"lens", lens}},
                  {*recording, file}};
    one.run.overrides = skyline_overrides(file, *origin, skylines);
    one.run.asset_path = file.parent_path().string();
    if (!skylines.empty()) one.files.emplace_back(skylines);
    return one;
  }

  std::vector<std::string> models, lenses = {"wide"};
  std::string skylines;
  uint64_t skies = 1;
  double length_m = 300;
};

}  // namespace

Benchmarks city_benchmarks() { return {std::make_shared<City>()}; }

}  // namespace odograph
