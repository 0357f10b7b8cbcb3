// SPDX-License-Identifier: Apache-2.0
//
// Drives and walks through real city models, drawn by seeds: `odograph city bench` prints how far off the pose is, how
// often the skyline tells a place, and how often it is wrong.
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

const std::vector<Column> kColumns = {
    {"error", "m median", "horizontal_m/50", 2, false, "_horizontal_m"},
    {"error", "95 %", "horizontal_m/95", 2, false, "_horizontal_m", Over::percentile, 0.95},
    {"error", "most", "_horizontal_most", 2, false, "_horizontal_m", Over::percentile, 1},
    {"fix", "m 50 %", "_fix_50", 2, false, "_fix_m"},
    {"fix", "95 %", "_fix_95", 2, false, "_fix_m", Over::percentile, 0.95},
    {"fixes", "used", "fixes/used", 0, false, "_accepted", Over::sum},
    {"fixes", "refused", "fixes/refused", 0, false, "_refused", Over::sum},
    {"> 3 sigma", "%", "_beyond_percent", 1},
    {"seconds", "with fix %", "_seconds_percent", 0},
    {"", "", "fixes/beyond_3_sigma", 0, false, "_beyond", Over::sum},
    {"", "", "seconds_with_skyline", 0, false, "_seconds", Over::sum},
    {"", "", "seconds_with_fix", 0, false, "_with_fix", Over::sum},
    {"1st fix", "after m", "first_fix/after_m", 0, false, "_first_after_m", Over::first},
    {"1st fix", "off m", "first_fix/off_m", 2, false, "_first_off_m", Over::first},
    {"frame", "ms 99 %", "frame_ms_99", 1, false, "_frame_ms_99", Over::percentile, 1},
    {"thread", "ms 99 %", "thread_ms_99", 1, false, "_thread_ms_99", Over::percentile, 1},
    {"tilt", "deg", "tilt_deg/50", 2, false, "_tilt_deg"},
    {"tilt", "95 %", "tilt_deg/95", 2, false, "_tilt_deg", Over::percentile, 0.95}};

/// Part of what is there, %; 0 of nothing.
double percent_of(const Json& row, const char* part, const char* all) {
  return number_at(row, all) > 0 ? 100 * number_at(row, part) / number_at(row, all) : 0.0;
}

Json line_of(const Json& labels, const Rows& rows) {
  Json line = summary_of(labels, rows, kColumns);
  line["_beyond_percent"] = percent_of(line, "fixes/beyond_3_sigma", "fixes/used");
  line["_seconds_percent"] = percent_of(line, "seconds_with_fix", "seconds_with_skyline");
  return line;
}

struct City : Benchmark {
  City()
      : Benchmark("bench",
                  "Drives through the streets of city models, drawn and rendered by seeds: errors, fixes, integrity",
                  kConfigs) {
    options.configs = {"samples/configs/city_drive.yaml"};
  }
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

  Result<std::vector<BenchCase>> cases() override {
    std::vector<BenchCase> all;
    for (const std::string& lens : lenses)
      for (const std::string& model : models)
        for (uint64_t k = 0; k < options.seeds * skies; ++k)
          if (const auto added = add(lens, model, options.first_seed + k / skies, k % skies, all); !added)
            return added.failure();
    return all;
  }

  Result<Json> measure(const BenchCase& one, const ShowProgress& progress) const override {
    return replayed(one, progress, [&](const Recording& recording, const RunResult& result) -> Result<Json> {
      std::vector<odo_fix> accepted;
      for (const auto& [fix, taken] : result.fixes)
        if (taken) accepted.push_back(fix);
      const FixFigures f = fix_figures(recording, accepted);
      Trajectory scored;
      for (const StampedPose& truth : recording.truth)
        if (skylines.empty() || accepted.empty() || truth.t_ns >= accepted.front().header.t_ns + kTold_ns)
          scored.push_back(truth);
      std::vector<double> horizontal_m;
      for (const StampedPose& truth : scored)
        horizontal_m.push_back((position_at(result.track, truth.t_ns) - truth.p).head<2>().norm());
      Json notices = Json::object();
      for (const auto& [key, notice] : result.notices)
        if (const auto at = key.find("no_fix_"); at != std::string::npos) notices[key.substr(at + 7)] = notice.count;
      Json row = {{"_horizontal_m", horizontal_m},
                  {"_tilt_deg", tilt_errors_deg(recording.truth, result.track)},
                  {"_fix_m", f.error_m},
                  {"_accepted", accepted.size()},
                  {"_refused", result.fixes.size() - accepted.size()},
                  {"_beyond", f.beyond},
                  {"_seconds", f.seconds},
                  {"_with_fix", f.with_fix},
                  {"_frame_ms_99", percentile(result.frame_ms, 0.99)},
                  {"_thread_ms_99", percentile(result.frame_thread_ms, 0.99)},
                  {"_notices", notices}};
      if (!accepted.empty()) row["_first_after_m"] = f.first_after_m, row["_first_off_m"] = f.first_off_m;
      return row;
    });
  }

  BenchReport report(const Rows& rows) const override {
    Rows lines;
    for (const Json& lens : values_of(rows, "lens")) {
      const Rows own = rows_with(rows, "lens", lens);
      for (const Json& row : own) {
        Json line = line_of({{"name", row["name"]}, {"config", row["config"]}}, {row});
        std::string reasons;
        for (const auto& [reason, frames] : row["_notices"].items()) reasons += ' ' + reason + ' ' + frames.dump();
        line["_reasons"] = reasons;
        lines.push_back(std::move(line));
      }
      for (const Json& config : values_of(own, "config")) {
        lines.push_back(line_of({{"name", "all, " + lens.get<std::string>()}, {"config", config}},
                                rows_with(own, "config", config)));
        lines.back().erase("first_fix");
      }
    }
    Table table{"", {{"model, lens, seed", "name"}}, {}};
    for (const Column& column : kColumns)
      if (!column.unit.empty()) table.columns.push_back(column);
    if (options.configs.size() > 1) table.labels.push_back({"config", "config", true});
    table.columns.push_back({"no fix because of", "(frames)", "_reasons"});
    return {table_text(table, lines), printed(lines), {}};
  }

  Result<bool> add(const std::string& lens, const std::string& model, uint64_t seed, uint64_t sky,
                   std::vector<BenchCase>& all) {
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
    for (const std::string& config : options.configs) {
      auto run = run_of(config);
      if (!run) return run.failure();
      const std::string skyline = "absolute_fixers.fix/skyline.parameters.";
      run->overrides.push_back({skyline + "model", file.filename().string()});
      run->overrides.push_back(
          {skyline + "model_origin", text("[%.4f m, %.4f m, %.4f m]", origin->x(), origin->y(), origin->z())});
      if (!skylines.empty()) run->overrides.push_back({skyline + "skylines", fs::absolute(skylines).string()});
      run->asset_path = file.parent_path().string();
      BenchCase one{
          {{"name", city + ' ' + lens + ' ' + std::to_string(seed) + (sky > 0 ? '+' + std::to_string(sky) : "")},
           {"lens", lens},
           {"config", config}},
          {*recording, file},
          *run};
      if (!skylines.empty()) one.files.emplace_back(skylines);
      all.push_back(std::move(one));
    }
    return true;
  }

  std::vector<std::string> models, lenses = {"wide"};
  std::string skylines;
  uint64_t skies = 1;
  double length_m = 300;
};

}  // namespace

std::shared_ptr<Benchmark> bench_city() { return std::make_shared<City>(); }

}  // namespace odograph
