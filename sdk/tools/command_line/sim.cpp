// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>

#include "sdk/host/base/printable.hpp"
#include "sdk/tools/command_line/commands.hpp"
#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/simulation/simulate.hpp"

namespace odograph {
namespace {

struct SimArguments {
  std::string scenario, output, city, walk, camera_profile, objects;
  uint64_t seed = 1;
  double first_m = 0;
  unsigned threads = 0;
  bool colour = false;
};

int sim(const SimArguments& a) {
  auto scenario = read_scenario(a.scenario, a.camera_profile);
  if (!scenario) return std::fprintf(stderr, "%s\n", printable(scenario.failure().text).c_str()), kBadUsage;
  if (a.first_m > 0) scenario->walk_m = a.first_m;
  scenario->camera.colour = a.colour;
  std::optional<Recording> walk;
  if (!a.walk.empty()) {
    auto recording = open_recording(a.walk);
    if (!recording) return print_failure(recording.failure());
    walk = std::move(*recording);
  }
  Progress progress("sim");
  SimulationOptions options{.threads = a.threads, .city = a.city, .walk = walk ? &*walk : nullptr};
  options.progress = [&](size_t i, size_t n) { progress.show(i, n); };
  const auto done = simulate(*scenario, a.seed, a.output, options);
  if (!done) return print_failure(done.failure());
  if (!a.objects.empty())
    if (const auto written = write_known_objects(*scenario, a.seed, a.objects); !written)
      return print_failure(written.failure());
  std::error_code error;
  std::printf("%s: %.1f MB\n", a.output.c_str(),
              static_cast<double>(std::filesystem::file_size(a.output, error)) / 1e6);
  const auto& t = done->times;
  const double all = std::max(1e-9, t.render_s + t.develop_s + t.encode_s), frames = static_cast<double>(done->frames);
  std::printf(
      "%zu frames in %.1f s, %.1f a second on %u threads; rays and shading %.0f %%, sensor %.0f %%, coding %.0f %%\n",
      done->frames, done->seconds, frames / std::max(1e-9, done->seconds), done->threads, 100 * t.render_s / all,
      100 * t.develop_s / all, 100 * t.encode_s / all);
  if (done->moving_parts.empty()) return kDone;
  const std::vector<double> moving(done->moving_parts.begin(), done->moving_parts.end());
  std::printf("people and cars that pass cover %.0f %% of a frame in the median, %.0f %% in the fullest tenth\n",
              100 * percentile(moving, 0.5), 100 * percentile(moving, 0.9));
  return kDone;
}

}  // namespace

void add_sim(CLI::App& app, int& status) {
  auto* command = app.add_subcommand(
      "sim", "Simulate a walk or a drive with camera, IMU, magnetometer, GNSS, barometer and exact truth");
  auto a = std::make_shared<SimArguments>();
  command->add_option("scenario", a->scenario, "scenario file (YAML); keys: odograph config schema scenario")
      ->required();
  command->add_option("-o,--output", a->output, "recording to write (*.odo)")->required();
  command->add_option("--seed", a->seed, "seed of world, tremor and noise")->capture_default_str();
  command->add_option("--city", a->city,
                      "CityJSON file to write, with the surveyed buildings and known objects of the generated town");
  auto* objects = command->add_option(
      "--objects", a->objects,
      "folder to write, with the surveyed objects along the route (objects.yaml and pictures) for fix/known_object and "
      "the ground (ground.obj) for fix/terrain");
  command
      ->add_option("--walk", a->walk,
                   "real walk (Indoor Location Competition trace) to retrace: its own sensor samples, pictures "
                   "rendered along it")
      ->excludes(objects);
  command->add_option("--camera-profile", a->camera_profile,
                      "phone whose camera and IMU are simulated, instead of the scenario's `camera: {profile: ...}`");
  command->add_flag("--colour", a->colour,
                    "pictures in colour; their grey is that of the pictures without this option");
  command->add_option("--first", a->first_m, "only the first part of the route, m");
  command
      ->add_option("--threads", a->threads,
                   "number of threads; 0: one per core; the recording is the same for any number")
      ->capture_default_str();
  command->callback([a, &status] { status = sim(*a); });
}

}  // namespace odograph
