// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>

#include "sdk/cli/commands.hpp"
#include "sdk/sim/simulate.hpp"

namespace odograph {
namespace {

struct SimArguments {
  std::string scenario, output;
  uint64_t seed = 1;
};

int sim(const SimArguments& a) {
  const auto scenario = read_scenario(a.scenario);
  if (!scenario) return std::fprintf(stderr, "%s\n", scenario.failure().text.c_str()), kBadUsage;
  Progress progress("sim");
  const auto done = simulate(*scenario, a.seed, a.output, [&](size_t i, size_t n) { progress.show(i, n); });
  if (!done) return complain(done.failure());
  std::error_code error;
  std::printf("%s: %.1f MB\n", a.output.c_str(),
              static_cast<double>(std::filesystem::file_size(a.output, error)) / 1e6);
  return kDone;
}

}  // namespace

void add_sim(CLI::App& app, int& status) {
  auto* command =
      app.add_subcommand("sim", "Simulate a walk with camera, IMU, magnetometer, GNSS, barometer and exact truth");
  auto a = std::make_shared<SimArguments>();
  command->add_option("scenario", a->scenario, "scenario file (YAML); keys: odograph config schema scenario")
      ->required();
  command->add_option("-o,--output", a->output, "recording to write (*.odo)")->required();
  command->add_option("--seed", a->seed, "another seed: another world, tremor and noise")->capture_default_str();
  command->callback([a, &status] { status = sim(*a); });
}

}  // namespace odograph
