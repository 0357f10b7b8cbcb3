// SPDX-License-Identifier: Apache-2.0
//
// `odograph bench steps`: step estimators and attitude on simulated walkers, where every foot's fall is known.
#include <algorithm>

#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/evaluation/walk_figures.hpp"
#include "sdk/tools/simulation/walk_scenarios.hpp"

namespace odograph {
namespace {

const std::vector<Column> kColumns = {
    {"count", "% median", "count_percent/median", 2, false, "count_percent", Over::percentile, 0.5, true},
    {"count", "% worst", "count_percent/worst", 2, false, "count_percent", Over::percentile, 1, true},
    {"times", "ms start", "start_ms", 0, false, "_start_ms"},
    {"times", "ms end", "end_ms", 0, false, "_end_ms"},
    {"latency", "ms median", "latency_ms/median", 0, false, "_latency_ms"},
    {"latency", "ms 90 %", "latency_ms/p90", 0, false, "_latency_ms", Over::percentile, 0.9},
    {"", "", "_mode_right_s", 0, false, "mode_right_s", Over::sum},
    {"", "", "_mode_all_s", 0, false, "mode_all_s", Over::sum},
    {"mode", "%", "mode_percent", 1, false, "_none"},
    {"distance", "% median", "distance_percent/median", 2, false, "distance_percent", Over::percentile, 0.5, true},
    {"distance", "% 90 %", "distance_percent/p90", 2, false, "distance_percent", Over::percentile, 0.9, true},
    {"NEES", "", "normalised_error_squared", 2, false, "_normalised_error", Over::mean},
    {"false steps", "typing", "false_steps_in_10_min/handling", 1, false, "false_handling", Over::mean},
    {"false steps", "turns", "false_steps_in_10_min/turning", 1, false, "false_turning", Over::mean},
    {"tilt", "deg", "tilt_rms_deg", 2, false, "_tilt_deg"},
    {"drift", "deg/min", "drift_deg_per_min", 2, false, "_drift_deg_min"},
    {"stray", "deg", "heading_wander_deg", 2, false, "_wander_deg"}};

struct Walked {
  Recording recording;
  RunResult result;
};

Result<Walked> walked(const Scenario& scenario, uint64_t seed, RunOptions run) {
  auto recording = simulated(scenario, seed);
  if (!recording) return recording.failure();
  run.collect_attitudes = true;
  auto result = replay(*recording, run);
  if (!result) return result.failure();
  return Walked{std::move(*recording), std::move(*result)};
}

/// Steps beyond the true ones: the path to the place is a metre, its own steps are no mistake.
Result<double> false_steps(const char* what, bool viewer, uint64_t seed, const RunOptions& run) {
  const auto stood = walked(standing(what, viewer), seed, run);
  if (!stood) return stood.failure();
  return std::max(
      0.0, static_cast<double>(stood->result.steps.size()) - static_cast<double>(stood->recording.true_steps.size()));
}

std::string confusion_of(const std::string& config, const Rows& rows) {
  std::map<std::pair<uint32_t, uint32_t>, double> modes_s;
  for (const Json& row : rows)
    for (const Json& one : row["_modes"])
      modes_s[{one[0].get<uint32_t>(), one[1].get<uint32_t>()}] += one[2].get<double>();
  std::string out = '\n' + config + ": seconds in which the true mode was taken for\n";
  for (const auto& [modes, s] : modes_s)
    out += text("  %-18s %-18s %9.1f\n", odo_mode_text(modes.first), odo_mode_text(modes.second), s);
  return out;
}

struct Steps : Benchmark {
  Steps()
      : Benchmark(
            "steps",
            "Step estimators and attitude on simulated walkers: counts, times, modes, lengths, false steps, drift",
            kConfigs | kSeeds) {
    options.configs = {"samples/configs/phone_walk.yaml"};
    options.seeds = 10;
  }
  void add_options(CLI::App& command) override {
    command.add_option("--walkers", walkers, "brisk surveyors, or viewers who look through the phone")
        ->check(CLI::IsMember({"surveyors", "viewers"}));
    command.add_flag("--confusion", confusion, "print what modes were taken for")->group(kOutput);
  }

  Result<Json> measure(const BenchCase& one, const ShowProgress&) const override {
    const bool viewer = walkers == "viewers";
    const auto walk = walked(viewer ? viewer_walk(one.seed) : surveyor_walk(one.seed), one.seed, one.run);
    if (!walk) return walk.failure();
    const auto handling = false_steps("handle", viewer, one.seed, one.run),
               turning = false_steps("turn", viewer, one.seed, one.run);
    if (!handling || !turning) return handling ? turning.failure() : handling.failure();
    const RunResult& r = walk->result;
    const WalkFigures f = walk_figures(walk->recording, {r.steps, r.modes, r.attitudes});
    Json modes = Json::array();
    for (const auto& [pair, seconds] : f.modes_s) modes.push_back({pair.first, pair.second, seconds});
    return Json{{"count_percent", f.count_percent}, {"distance_percent", f.distance_percent},
                {"_start_ms", f.start_ms},          {"_end_ms", f.end_ms},
                {"_latency_ms", f.latency_ms},      {"_normalised_error", f.normalised_error},
                {"mode_right_s", f.mode_right_s},   {"mode_all_s", f.mode_all_s},
                {"false_handling", *handling},      {"false_turning", *turning},
                {"_tilt_deg", f.tilt_deg},          {"_drift_deg_min", f.drift_deg_min},
                {"_wander_deg", f.wander_deg},      {"_modes", modes}};
  }

  BenchReport report(const Rows& rows) const override {
    Rows summaries = summaries_of(rows, "config", kColumns);
    for (Json& s : summaries) {
      s["mode_percent"] = 100 * number_at(s, "_mode_right_s") / std::max(1e-9, number_at(s, "_mode_all_s"));
      s["count_percent"]["signed"] = numbers_at(rows_with(rows, "config", s["config"]), "count_percent");
    }
    std::vector<Column> shown;
    for (const Column& column : kColumns)
      if (column.key[0] != '_') shown.push_back(column);
    std::string out =
        text("%llu simulated %s; ten minutes each of typing and gestures, and of turning on the spot.\n\n",
             static_cast<unsigned long long>(options.seeds),
             walkers == "viewers"
                 ? "users of 1.55 to 1.92 m who look through the phone, 70 m each at 0.5 to 1.2 m/s with stops,\n"
                   "looking around, turning, small steps, steps to the side and backwards"
                 : "walkers of 1.55 to 1.92 m, 175 m each with stops, looking around, evading, the phone held, swung\n"
                   "and in a pocket") +
        table_text({"", {{"config", "config"}}, shown}, summaries);
    for (const Json& config : values_of(rows, "config"))
      if (confusion) out += confusion_of(config.get<std::string>(), rows_with(rows, "config", config));
    return {out, printed(summaries), {}};
  }

  std::string walkers = "surveyors";
  bool confusion = false;
};

}  // namespace

std::shared_ptr<Benchmark> bench_steps() { return std::make_shared<Steps>(); }

}  // namespace odograph
