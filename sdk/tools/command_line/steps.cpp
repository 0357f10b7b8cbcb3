// SPDX-License-Identifier: Apache-2.0
//
// `odograph steps`: output of a step estimator on a recording, as text.
#include <cstdio>

#include <nlohmann/json.hpp>

#include "sdk/host/base/output_file.hpp"
#include "sdk/host/base/printable.hpp"
#include "sdk/host/platform/temporary_folder.hpp"
#include "sdk/math/scalar.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/command_line/commands.hpp"
#include "sdk/tools/replay/outcome.hpp"

namespace odograph {
namespace {

struct StepsArguments {
  std::string recording, config;
  bool json = false, each = false;
};

double seconds_since(int64_t start_ns, int64_t t_ns) { return seconds(t_ns - start_ns); }

/// A part of the walk in one mode.
struct Stretch {
  uint32_t mode;
  double from_s, to_s, length_m;
  size_t steps;
};

std::vector<Stretch> stretches_of(const RunResult& result, int64_t start_ns, int64_t end_ns) {
  std::vector<Stretch> all;
  for (size_t i = 0; i < result.modes.size(); ++i) {
    const int64_t from = result.modes[i].header.t_ns;
    const int64_t to = i + 1 < result.modes.size() ? result.modes[i + 1].header.t_ns : end_ns;
    Stretch s{result.modes[i].mode, seconds_since(start_ns, from), seconds_since(start_ns, to), 0, 0};
    for (const odo_step& step : result.steps)
      if (step.t_end_ns > from && step.t_end_ns <= to) s.length_m += step.length_m, ++s.steps;
    all.push_back(s);
  }
  return all;
}

/// Attitude and steps only, aligned with waypoints if there are any: samples/configs/phone_walk_odograph.yaml.
constexpr const char* kStepsAlone =
    "odograph: 1\nwalker: {height: 1.70 m}\nattitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/odograph}\n"
    "replay: {start_at_first_waypoint: true, align_heading_over: 10 m}\n";

int steps(const StepsArguments& a) {
  const auto recording = open_recording(a.recording);
  if (!recording) return print_failure(recording.failure());
  Progress progress("steps");
  RunOptions options;
  const TemporaryFolder folder;
  options.config = a.config.empty() ? (folder / "steps.yaml").string() : a.config;
  if (a.config.empty())
    if (const auto written = write_whole_file(options.config, kStepsAlone); !written)
      return print_failure(written.failure());
  options.progress = [&](size_t i, size_t n) { progress.show(i, n); };
  const auto result = replay(*recording, options);
  if (!result) return print_failure(result.failure());
  const int64_t start = recording->messages.front().message.header().t_ns,
                end = recording->messages.back().message.header().t_ns;
  const auto stretches = stretches_of(*result, start, end);
  std::vector<double> lengths;
  double distance = 0, variance = 0;
  for (const odo_step& step : result->steps)
    lengths.push_back(step.length_m), distance += step.length_m, variance += step.sigma_m;
  if (a.json) {
    nlohmann::ordered_json out = {{"steps", result->steps.size()}, {"distance_m", distance}};
    for (const Stretch& s : stretches)
      out["modes"].push_back({{"mode", odo_mode_text(s.mode)},
                              {"from_s", s.from_s},
                              {"to_s", s.to_s},
                              {"steps", s.steps},
                              {"length_m", s.length_m}});
    std::printf("%s\n", out.dump(2).c_str());
  } else {
    std::printf("%-20s %9s %9s %7s %9s\n", "mode", "from (s)", "to (s)", "steps", "m");
    for (const Stretch& s : stretches)
      std::printf("%-20s %9.2f %9.2f %7zu %9.2f\n", odo_mode_text(s.mode), s.from_s, s.to_s, s.steps, s.length_m);
    if (a.each) {
      std::printf("\n%9s %9s %9s %9s %9s %9s\n", "from (s)", "to (s)", "m", "sigma (m)", "Hz", "heading");
      for (const odo_step& s : result->steps)
        std::printf("%9.2f %9.2f %9.3f %9.3f %9.2f %8.0f\n", seconds_since(start, s.t_start_ns),
                    seconds_since(start, s.t_end_ns), s.length_m, s.sigma_m, s.frequency_hz, s.heading_rad * 180 / kPi);
    }
    // The walker's factor is common to all steps, so their standard deviations add linearly.
    std::printf("\n%zu steps (a step: from one foot's contact to the other's), %.1f m +- %.1f m", result->steps.size(),
                distance, variance);
    if (!lengths.empty())
      std::printf("; length 25 %%: %.2f m, 50 %%: %.2f m, 75 %%: %.2f m", percentile(lengths, 0.25),
                  percentile(lengths, 0.5), percentile(lengths, 0.75));
    std::printf("\n");
    if (!recording->true_steps.empty()) {
      double walked = 0;
      for (const odo_step& step : recording->true_steps) walked += step.length_m;
      std::printf("truth: %zu steps, %.1f m\n", recording->true_steps.size(), walked);
    }
  }
  for (const auto& report : result->reports) std::fprintf(stderr, "%s\n", printable(report).c_str());
  return exit_status(*result);
}

}  // namespace

void add_steps(CLI::App& app, int& status) {
  auto* command = app.add_subcommand(
      "steps", "Motion modes, steps, their lengths and the dead-reckoned path from the IMU of a recording");
  auto a = std::make_shared<StepsArguments>();
  command->add_option("recording", a->recording, "any recording with an IMU")->required();
  command->add_option(
      "-c,--config", a->config,
      "pipeline config with a step estimator; default: attitude/vqf and step/odograph, walker height 1.70 m");
  command->add_flag("--each", a->each, "one line per step");
  command->add_flag("--json", a->json, "print one JSON object");
  command->callback([a, &status] { status = steps(*a); });
}

}  // namespace odograph
