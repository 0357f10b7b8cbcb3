// SPDX-License-Identifier: Apache-2.0
//
// `odograph bench steps`: step estimators and attitude on simulated walkers, where every foot's fall is known.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/console/console.hpp"
#include "sdk/tools/replay/runner.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "sdk/tools/simulation/simulate.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

struct StepArguments {
  std::vector<std::string> configs = {"samples/configs/phone_walk.yaml"};
  uint64_t seeds = 10, first_seed = 1;
  std::string walkers = "surveyors";
  bool json = false, confusion = false;
};

/// What one config did over all walkers.
struct StepFigures {
  std::vector<double> count_percent, distance_percent, start_ms, end_ms, latency_ms, normalised_error;
  double mode_right_s = 0, mode_all_s = 0;
  std::map<std::pair<uint32_t, uint32_t>, double> modes_s;  ///< true and estimated
  double false_handling = 0, false_turning = 0;             ///< steps in ten minutes
  std::vector<double> tilt_deg, drift_deg_min, wander_deg;
};

/// A walk with all that people do: stops, looking around, evading, other ways to carry the phone.
Scenario walk_of(uint64_t seed) {
  Random random(seed, 130);
  Scenario s;
  s.walker.height_m = random.uniform(1.55, 1.92), s.walker.speed_mps = random.uniform(1.05, 1.55);
  s.walker.stand_s = 4;
  s.route = {{0, 0, 0}, {60, 0, 0}, {60, 45, 0}, {-10, 45, 0}};
  s.events = {{30, "stand", 8}, {45, "evade", 4},  {75, "look_around", 8}, {100, "swinging"},
              {125, "texting"}, {140, "stand", 5}, {150, "pocket"},        {168, "texting"}};
  return s;
}

/// Somebody who looks at the world through the phone: slow and gentle, with stops, turns, small steps, steps to the
/// side and backwards.
Scenario viewing_of(uint64_t seed) {
  Random random(seed, 131);
  Scenario s;
  s.walker.gait = "viewing";
  s.walker.height_m = random.uniform(1.55, 1.92), s.walker.speed_mps = random.uniform(0.5, 1.2);
  s.walker.stand_s = 4;
  s.route = {{0, 0, 0}, {25, 0, 0}, {25, 20, 0}, {0, 20, 0}};
  s.events = {{8, "look_around", 6},  {15, "speed"},        {20, "shuffle", 4}, {28, "sidestep", 3},
              {34, "stand", 8},       {40, "backwards", 4}, {46, "turn", 8},    {50, "speed"},
              {55, "look_around", 5}, {60, "handle", 6},    {64, "sidestep", 3}};
  for (auto& event : s.events) event.speed_mps = random.uniform(0.5, 1.2);
  return s;
}

Scenario rest_of(const char* what, const std::string& walkers) {
  Scenario s;
  if (walkers == "viewers") s.walker.gait = "viewing", s.walker.speed_mps = 0.8;
  s.walker.stand_s = 1;
  s.route = {{0, 0, 0}, {1, 0, 0}};
  for (int k = 0; k < (std::string_view(what) == "turn" ? 60 : 1); ++k)
    s.events.push_back({0.0, what, std::string_view(what) == "turn" ? 10.0 : 600.0});
  return s;
}

Result<Recording> recording_of(const Scenario& scenario, uint64_t seed) {
  const fs::path file = fs::temp_directory_path() / ("odograph-steps-" + std::to_string(getpid()) + ".odo");
  const auto made = simulate(scenario, seed, file, {.threads = 1, .frames = false});
  if (!made) return made.failure();
  auto recording = open_recording(file);
  std::error_code error;
  fs::remove(file, error);
  return recording;
}

Result<RunResult> run(const Recording& recording, const std::string& config) {
  RunOptions options;
  options.config = config;
  options.collect_attitudes = true;
  return replay(recording, options);
}

double percent(double estimate, double truth) { return truth > 0 ? 100 * (estimate - truth) / truth : 0.0; }

void score_steps(const Recording& recording, const RunResult& result, StepFigures& f) {
  const auto& truth = recording.true_steps;
  double walked = 0, estimated = 0;
  for (const odo_step& step : truth) walked += step.length_m;
  for (const odo_step& step : result.steps) estimated += step.length_m;
  f.count_percent.push_back(percent(static_cast<double>(result.steps.size()), static_cast<double>(truth.size())));
  f.distance_percent.push_back(percent(estimated, walked));
  for (const odo_step& step : result.steps) {
    const auto nearest = std::min_element(truth.begin(), truth.end(), [&](const odo_step& a, const odo_step& b) {
      return std::abs(a.t_end_ns - step.t_end_ns) < std::abs(b.t_end_ns - step.t_end_ns);
    });
    if (nearest == truth.end() || std::abs(nearest->t_end_ns - step.t_end_ns) > 350'000'000) continue;
    f.start_ms.push_back(std::abs(static_cast<double>(step.t_start_ns - nearest->t_start_ns)) * 1e-6);
    f.end_ms.push_back(std::abs(static_cast<double>(step.t_end_ns - nearest->t_end_ns)) * 1e-6);
    f.latency_ms.push_back(static_cast<double>(step.header.t_ns - step.t_end_ns) * 1e-6);
    if (step.sigma_m > 0) f.normalised_error.push_back(std::pow((step.length_m - nearest->length_m) / step.sigma_m, 2));
  }
}

void score_modes(const Recording& recording, const RunResult& result, StepFigures& f) {
  size_t at = 0;
  const double dt = recording.true_states.size() > 1
                        ? static_cast<double>(recording.true_states[1].t_ns - recording.true_states[0].t_ns) * 1e-9
                        : 0.0;
  for (const TrueState& state : recording.true_states) {
    while (at + 1 < result.modes.size() && result.modes[at + 1].header.t_ns <= state.t_ns) ++at;
    const uint32_t seen =
        result.modes.empty() || result.modes[0].header.t_ns > state.t_ns ? ODO_MODE_UNKNOWN : result.modes[at].mode;
    f.mode_all_s += dt;
    if (seen == state.mode) f.mode_right_s += dt;
    f.modes_s[{state.mode, seen}] += dt;
  }
}

/// Inclination over the whole walk, how fast the heading leaves the truth after half a minute, and how far it strays
/// (95 % of the time) from north, or without a magnetometer from what it was then.
void score_attitude(const Recording& recording, const RunResult& result, StepFigures& f) {
  size_t at = 0;
  double squares = 0;
  size_t n = 0;
  std::vector<double> strays;
  double first_deg = 0, last_deg = 0, first_s = -1, last_s = 0, before = 0, rotations = 0;
  for (const odo_attitude& a : result.attitudes) {
    while (at + 1 < recording.true_states.size() && recording.true_states[at].t_ns < a.header.t_ns) ++at;
    const Eigen::Quaterniond q(a.q_n_b[0], a.q_n_b[1], a.q_n_b[2], a.q_n_b[3]), &truth = recording.true_states[at].q;
    const Eigen::Vector3d down = q * (truth.conjugate() * Eigen::Vector3d::UnitZ());
    const double t = static_cast<double>(a.header.t_ns - recording.true_states.front().t_ns) * 1e-9;
    if (t < 10) continue;
    squares += std::pow(std::atan2(down.head<2>().norm(), down.z()) * 180 / EIGEN_PI, 2), ++n;
    const Eigen::Quaterniond error = q * truth.conjugate();
    double heading = 2 * std::atan2(error.z(), error.w()) * 180 / EIGEN_PI;
    heading = std::remainder(heading, 360.0);
    if (t >= 30) {
      if (first_s < 0) first_s = t, first_deg = heading, before = heading;
      rotations += std::remainder(heading - before, 360.0);
      before = heading, last_s = t, last_deg = first_deg + rotations;
      strays.push_back(std::abs((a.header.flags & ODO_ATTITUDE_NORTH) ? first_deg + rotations : rotations));
    }
  }
  if (n > 0) f.tilt_deg.push_back(std::sqrt(squares / static_cast<double>(n)));
  if (!strays.empty()) f.wander_deg.push_back(percentile(strays, 0.95));
  if (last_s > first_s + 30) f.drift_deg_min.push_back(std::abs(last_deg - first_deg) / (last_s - first_s) * 60);
}

nlohmann::ordered_json summary(const std::string& config, const StepFigures& f, uint64_t seeds) {
  std::vector<double> count, distance;
  for (const double x : f.count_percent) count.push_back(std::abs(x));
  for (const double x : f.distance_percent) distance.push_back(std::abs(x));
  double normalised = 0;
  for (const double x : f.normalised_error) normalised += x / static_cast<double>(f.normalised_error.size());
  return {{"config", config},
          {"count_percent",
           {{"median", percentile(count, 0.5)}, {"worst", percentile(count, 1.0)}, {"signed", f.count_percent}}},
          {"start_ms", percentile(f.start_ms, 0.5)},
          {"end_ms", percentile(f.end_ms, 0.5)},
          {"latency_ms", {{"median", percentile(f.latency_ms, 0.5)}, {"p90", percentile(f.latency_ms, 0.9)}}},
          {"mode_percent", 100 * f.mode_right_s / std::max(1e-9, f.mode_all_s)},
          {"distance_percent", {{"median", percentile(distance, 0.5)}, {"p90", percentile(distance, 0.9)}}},
          {"normalised_error_squared", normalised},
          {"false_steps_in_10_min",
           {{"handling", f.false_handling / static_cast<double>(seeds)},
            {"turning", f.false_turning / static_cast<double>(seeds)}}},
          {"tilt_rms_deg", percentile(f.tilt_deg, 0.5)},
          {"drift_deg_per_min", percentile(f.drift_deg_min, 0.5)},
          {"heading_wander_deg", percentile(f.wander_deg, 0.5)}};
}

int steps(const StepArguments& a) {
  std::vector<StepFigures> all(a.configs.size());
  Progress progress("bench steps");
  for (uint64_t k = 0; k < a.seeds; ++k) {
    progress.show(k, a.seeds);
    const uint64_t seed = a.first_seed + k;
    const auto walk = recording_of(a.walkers == "viewers" ? viewing_of(seed) : walk_of(seed), seed),
               handling = recording_of(rest_of("handle", a.walkers), seed),
               turning = recording_of(rest_of("turn", a.walkers), seed);
    for (const auto* r : {&walk, &handling, &turning})
      if (!*r) return complain(r->failure());
    for (size_t c = 0; c < a.configs.size(); ++c) {
      const auto walked = run(*walk, a.configs[c]), handled = run(*handling, a.configs[c]),
                 turned = run(*turning, a.configs[c]);
      for (const auto* r : {&walked, &handled, &turned})
        if (!*r) return complain(r->failure());
      StepFigures& f = all[c];
      score_steps(*walk, *walked, f);
      score_modes(*walk, *walked, f);
      score_attitude(*walk, *walked, f);
      // The path to the place is a metre: its own steps are no mistake.
      const auto extra = [](const Recording& r, const RunResult& x) {
        return std::max(0.0, static_cast<double>(x.steps.size()) - static_cast<double>(r.true_steps.size()));
      };
      f.false_handling += extra(*handling, *handled), f.false_turning += extra(*turning, *turned);
    }
  }
  progress.show(a.seeds, a.seeds);
  nlohmann::ordered_json rows = nlohmann::json::array();
  for (size_t c = 0; c < a.configs.size(); ++c) rows.push_back(summary(a.configs[c], all[c], a.seeds));
  if (a.json) {
    std::printf("%s\n", rows.dump(2).c_str());
    return kDone;
  }
  std::printf("%llu simulated %s; ten minutes each of typing and gestures, and of turning on the spot.\n\n",
              static_cast<unsigned long long>(a.seeds),
              a.walkers == "viewers"
                  ? "users of 1.55 to 1.92 m who look through the phone, 70 m each at 0.5 to 1.2 m/s with stops,\n"
                    "looking around, turning, small steps, steps to the side and backwards"
                  : "walkers of 1.55 to 1.92 m, 175 m each with stops, looking around, evading, the phone held, swung\n"
                    "and in a pocket");
  std::printf(
      "%-42s %15s %15s %14s %6s %15s %6s %13s %6s %7s %6s\n%-42s %7s %7s %7s %7s %6s %7s %6s %7s %7s %6s %6s %6s %6s "
      "%7s %6s\n",
      "", "count (%)", "times (ms)", "latency (ms)", "mode", "distance (%)", "NEES", "false steps", "tilt", "drift",
      "stray", "config", "median", "worst", "start", "end", "median", "90 %", "(%)", "median", "90 %", "", "typing",
      "turns", "deg", "deg/min", "deg");
  for (const auto& r : rows)
    std::printf("%-42s %7.2f %7.2f %7.0f %7.0f %6.0f %7.0f %6.1f %7.2f %7.2f %6.2f %6.1f %6.1f %6.2f %7.2f %6.2f\n",
                r["config"].get<std::string>().c_str(), r["count_percent"]["median"].get<double>(),
                r["count_percent"]["worst"].get<double>(), r["start_ms"].get<double>(), r["end_ms"].get<double>(),
                r["latency_ms"]["median"].get<double>(), r["latency_ms"]["p90"].get<double>(),
                r["mode_percent"].get<double>(), r["distance_percent"]["median"].get<double>(),
                r["distance_percent"]["p90"].get<double>(), r["normalised_error_squared"].get<double>(),
                r["false_steps_in_10_min"]["handling"].get<double>(),
                r["false_steps_in_10_min"]["turning"].get<double>(), r["tilt_rms_deg"].get<double>(),
                r["drift_deg_per_min"].get<double>(), r["heading_wander_deg"].get<double>());
  if (!a.confusion) return kDone;
  for (size_t c = 0; c < a.configs.size(); ++c) {
    std::printf("\n%s: seconds in which the true mode was taken for\n", a.configs[c].c_str());
    for (const auto& [modes, s] : all[c].modes_s)
      std::printf("  %-18s %-18s %9.1f\n", odo_mode_text(modes.first), odo_mode_text(modes.second), s);
  }
  return kDone;
}

}  // namespace

void add_bench_steps(CLI::App& bench, int& status) {
  auto a = std::make_shared<StepArguments>();
  auto* command = bench.add_subcommand(
      "steps", "Step estimators and attitude on simulated walkers: counts, times, modes, lengths, false steps, drift");
  command->add_option("-c,--config", a->configs, "pipeline configs to compare")->capture_default_str();
  command->add_option("--seeds", a->seeds, "how many walkers")->capture_default_str()->check(CLI::Range(1, 1000));
  command->add_option("--first-seed", a->first_seed, "the first of them")->capture_default_str();
  command->add_option("--walkers", a->walkers, "brisk surveyors, or viewers who look through the phone")
      ->capture_default_str()
      ->check(CLI::IsMember({"surveyors", "viewers"}));
  command->add_flag("--confusion", a->confusion, "print what modes were taken for");
  command->add_flag("--json", a->json, "print one JSON array, an entry for each config");
  command->callback([a, &status] { status = steps(*a); });
}

}  // namespace odograph
