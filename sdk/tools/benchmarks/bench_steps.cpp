// SPDX-License-Identifier: Apache-2.0
//
// Steps without a camera: on simulated walkers, whose true steps are known, and on real walks.
#include <algorithm>
#include <map>
#include <string_view>

#include "sdk/math/time.hpp"
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/benchmarks/step_data.hpp"
#include "sdk/tools/evaluation/walk_figures.hpp"
#include "sdk/tools/simulation/simulate.hpp"
#include "sdk/tools/simulation/walk_scenarios.hpp"

namespace odograph {
namespace {

struct Steps : Benchmark {
  Steps()
      : Benchmark(
            "steps",
            "Step estimators and attitude on simulated walkers: counts, times, modes, lengths, false steps, drift",
            kConfigs | kSeeds | kByConfig, {"phone_walk"}) {
    options.seeds = 10;
  }
  void add_options(CLI::App& command) override {
    command
        .add_option("--walkers", walkers,
                    "brisk surveyors, viewers who look through the phone, or pockets: people with the phone against a "
                    "thigh, in a bag, in a pocket")
        ->check(CLI::IsMember({"surveyors", "viewers", "pockets"}));
    command
        .add_option("--data", data,
                    "folders of real walks, instead of simulated ones: RIDI, IPIN, Oxford, trundle wheel, "
                    "Indoor Location Competition, *.odo")
        ->group(kCases);
    command.add_flag("--each", each, "with --data: one line per walk")->group(kOutput);
  }

  Result<std::vector<BenchCase>> recordings() override {
    return data.empty() ? Benchmark::recordings() : step_data_cases(data);
  }

  Result<Recording> recording_of(const BenchCase& one) const override {
    if (!one.files.empty()) return read_recording(one.files.front());
    if (walkers == "pockets") return simulated(pocket_walk(one.seed), one.seed);
    return simulated(is_viewer() ? viewer_walk(one.seed) : surveyor_walk(one.seed), one.seed);
  }

  Result<Json> measure_replay(const BenchCase& one, const Recording& recording, const RunResult& r) const override {
    if (!one.files.empty()) return step_data_row(recording, r);
    std::map<std::string, double> false_in_10_min;
    for (const char* what : {"handle", "turn", "lift", "car"}) {
      const auto steps = false_steps(what, one);
      if (!steps) return steps.failure();
      false_in_10_min[what] = *steps;
    }
    const WalkFigures f = walk_figures(recording, {r.steps, r.modes, r.attitudes});
    const Format mostly{.parts = {0.5, 0.9}}, size_mostly{.absolute = true, .parts = {0.5, 0.9}};
    return row_of({{"count", "%", "count_percent", 2, f.count_percent, {.absolute = true, .parts = {0.5, 1}}},
                   {"", "", "count_percent/signed", -1, f.count_percent, kAll},
                   {"times", "ms start", "start_ms", 0, f.start_ms},
                   {"times", "ms end", "end_ms", 0, f.end_ms},
                   {"latency", "ms", "latency_ms", 0, f.latency_ms, mostly},
                   {"mode", "%", "mode_percent", 1, {f.mode_right_s, f.mode_all_s}, kShare},
                   {"distance", "%", "distance_percent", 2, f.distance_percent, size_mostly},
                   {"NEES", "", "normalised_error_squared", 2, f.normalised_error, kMean},
                   {"false steps", "typing", "false_steps_in_10_min/handling", 1, false_in_10_min["handle"], kMean},
                   {"in ten minutes", "turns", "false_steps_in_10_min/turning", 1, false_in_10_min["turn"], kMean},
                   {"", "lifts", "false_steps_in_10_min/lifts", 1, false_in_10_min["lift"], kMean},
                   {"", "car", "false_steps_in_10_min/car", 1, false_in_10_min["car"], kMean},
                   {"tilt", "deg", "tilt_rms_deg", 2, f.tilt_deg},
                   {"drift", "deg/min", "drift_deg_per_min", 2, f.drift_deg_min},
                   {"stray", "deg", "heading_wander_deg", 2, f.heading_error_deg}});
  }

  BenchReport report(const Rows& rows) const override {
    if (data.empty()) return Benchmark::report(rows);
    return {step_data_report(rows) + (each ? '\n' + cases_text(rows) : ""), visible_rows(rows)};
  }

  std::string heading(const Rows&) const override {
    return text(
        "%zu simulated %s; ten minutes each of typing and gestures, of turning on the spot, in lifts and in a car.\n\n",
        options.seeds,
        is_viewer() ? "users of 1.55 to 1.92 m who look through the phone, 70 m each at 0.5 to 1.2 m/s with stops,\n"
                      "looking around, turning, small steps, steps to the side and backwards"
        : walkers == "pockets"
            ? "walkers of 1.55 to 1.92 m, 195 m each with stops, the phone against a thigh, in a bag and in a pocket"
            : "walkers of 1.55 to 1.92 m, 175 m each with stops, looking around, evading, the phone held, "
              "swung\nand in a pocket");
  }

 private:
  bool is_viewer() const { return walkers == "viewers"; }

  /// Steps in ten minutes beyond the true ones: the metre walked to the place has true steps.
  Result<double> false_steps(const char* what, const BenchCase& one) const {
    const bool drives = std::string_view(what) == "car";
    const auto stood = simulated(drives ? car_ride(one.seed) : standing(what, is_viewer()), one.seed);
    if (!stood) return stood.failure();
    const auto result = replay(*stood, one.run);
    if (!result) return result.failure();
    const double too_many =
        std::max(0.0, static_cast<double>(result->steps.size()) - static_cast<double>(stood->true_steps.size()));
    return drives ? 600 * too_many / seconds(stood->true_states.back().t_ns - stood->true_states.front().t_ns)
                  : too_many;
  }

  std::string walkers = "surveyors";
  std::vector<std::string> data;
  bool each = false;
};

const Format kTotal{.sign = true, .aggregate = Aggregate::share};

std::string leg_errors_text(const Rows& rows) {
  const auto line = [&](const char* name, const char* key, double factor, const char* unit) {
    return text("  %-60s %9.2f %9.2f %s\n", name, factor * percentile_at(rows, key, 0.5, true),
                factor * percentile_at(rows, key, 0.9, true), unit);
  };
  return line("position, were each leg's heading true: median, 90 %", "_true_headings_m", 1, "m") +
         line("position, were each leg's length true", "_true_lengths_m", 1, "m") +
         line("heading of a leg, its walk's mean taken off", "_leg_heading_rad", 180 / EIGEN_PI, "deg") +
         line("length of a leg", "_leg_length", 100, "%");
}

struct Walks : Benchmark {
  Walks()
      : Benchmark("walks", "Distance and position errors over a folder of walks with waypoints",
                  kConfigs | kFolder | kByConfig) {}
  void add_options(CLI::App& command) override {
    command.add_option("--align-first", align_first_m, "the heading is fitted over this distance from the start, m");
    command.add_flag("--each", each, "one line per walk")->group(kOutput);
    command.add_flag("--oracles", oracles, "remaining errors with the true heading, or the true length, of each leg")
        ->group(kOutput);
  }

  Result<Json> measure_replay(const BenchCase&, const Recording& recording, const RunResult& result) const override {
    const auto waypoints = recording.waypoints();
    const double yaw = heading_offset(result.track, waypoints, align_first_m);
    WaypointErrors e = waypoint_errors(align_to_waypoints(result.track, waypoints, yaw), waypoints);
    // With a true trajectory, the reference is its path, not the polyline of the waypoints.
    if (!recording.truth.empty()) e.reference_m = waypoint_errors(recording.truth, waypoints).estimate_m;
    const LegErrors legs = leg_errors(result.track, waypoints, align_first_m);
    const double drift = heading_drift(result.attitudes, recording.phone_attitudes);
    const Format mostly{.parts = {0.5, 0.9}}, size_mostly{.absolute = true, .parts = {0.5, 0.9}};
    Json row = row_of({{"total", "%", "total_percent", 2, {e.estimate_m - e.reference_m, e.reference_m}, kTotal},
                       {"distance error", "%", "distance_percent", 2, 100 * e.distance_error(), size_mostly},
                       {"position error", "m", "position_m", 2, e.position_m, mostly},
                       {"heading", "deg/min", "heading_drift_deg_min", 1, drift, size_mostly},
                       {"", "", "walks", -1, 1, kSum},
                       {"", "", "reference_m", -1, e.reference_m, kSum},
                       {"", "", "position_walk_median_m", -1, percentile(e.position_m, 0.5), mostly}});
    row.update(Json{{"_estimate_m", e.estimate_m},
                    {"_steps", result.statistics.steps},
                    {"_true_headings_m", legs.true_headings_m},
                    {"_true_lengths_m", legs.true_lengths_m},
                    {"_leg_heading_rad", legs.heading_rad},
                    {"_leg_length", legs.length}});
    return row;
  }

  std::string heading(const Rows& rows) const override {
    return text("%zu walks from %s; heading fitted over the first %.0f m\n\n", groups_of(rows, "recording").size(),
                options.folder.c_str(), align_first_m);
  }

  std::string notes(const Rows& rows) const override {
    const Table walks{"",
                      {{"walk", "recording"}},
                      {{"distance", "%", "_distance_percent", 2, kSigned},
                       {"", "m", "_estimate_m"},
                       {"of", "m", "reference_m"},
                       {"", "steps", "_steps", 0},
                       {"waypoints", "m", "_position_walk_median_m"},
                       {"heading", "deg/min", "_heading_drift_deg_min", 1, kSigned}}};
    std::string out;
    for (const auto& [config, own] : groups_of(rows, "config")) {
      if (each || oracles) out += '\n' + config.get<std::string>() + '\n';
      if (each) out += table_text(walks, own);
      if (oracles) out += leg_errors_text(own);
    }
    return out;
  }

  double align_first_m = 10;
  bool each = false, oracles = false;
};

}  // namespace

Benchmarks steps_benchmarks() { return {std::make_shared<Steps>(), std::make_shared<Walks>()}; }

}  // namespace odograph
