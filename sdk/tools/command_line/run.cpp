// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "sdk/host/base/output_file.hpp"
#include "sdk/host/base/printable.hpp"
#include "sdk/tools/command_line/commands.hpp"
#include "sdk/tools/evaluation/faults.hpp"
#include "sdk/tools/page/run_page.hpp"
#include "sdk/tools/replay/default_config.hpp"
#include "sdk/tools/replay/guessed_camera.hpp"
#include "sdk/tools/replay/outcome.hpp"

namespace odograph {
namespace {

struct RunArguments {
  RunOptions options;
  ReadOptions reading;
  std::string input, output = "out", faults;
  std::vector<std::string> set;
  bool report = false, json = false;
};

/// The command line that repeats the run.
std::string command_of(const RunArguments& a) {
  std::string command = "odograph run -c " + a.options.config + " -i " + a.input;
  for (const std::string& text : a.set) command += " --set '" + text + "'";
  if (!a.faults.empty()) command += " --faults " + a.faults;
  if (a.options.seed) command += " --seed " + std::to_string(a.options.seed);
  return command;
}

/// Writes the recommended pipeline beside the results if the user gave none.
Result<bool> choose_config(RunArguments& a, const Recording& recording) {
  if (!a.options.config.empty()) return true;
  const auto file = std::filesystem::path(a.output) / "pipeline.yaml";
  std::error_code error;
  std::filesystem::create_directories(a.output, error);
  if (const auto written = write_whole_file(file, default_config(recording)); !written) return written.failure();
  a.options.config = file.string();
  std::fprintf(stderr, "no -c: %s, for a walker of 1.70 m (--set walker.height=1.80m)\n", file.c_str());
  return true;
}

/// Checks the guessed camera parameters before the run, and prints the result.
void check_guesses(Recording& recording) {
  const size_t said = recording.warnings.size();
  {
    Progress progress("camera");
    refine_guessed_camera(recording, {}, [&](size_t done, size_t all) { progress.show(done, all); });
  }
  for (size_t i = said; i < recording.warnings.size(); ++i)
    std::fprintf(stderr, "%s\n", printable(recording.warnings[i]).c_str());
}

double largest_distance(const StampedPoses& a, const StampedPoses& b) {
  double largest = 0;
  for (size_t i = 0; i < a.size() && i < b.size(); ++i) largest = std::max(largest, (a[i].p - b[i].p).norm());
  return largest;
}

void print(const RunArguments& a, const Recording& recording, const RunResult& result) {
  if (a.json) {
    std::ifstream file(std::filesystem::path(a.output) / "summary.json");
    std::stringstream text;
    text << file.rdbuf();
    std::fputs(text.str().c_str(), stdout);
    return;
  }
  const odo_statistics& s = result.statistics;
  std::printf("%s: %s, %zu poses, %s, %llu steps, %llu frames; tracking %.1f s, degraded %.1f s, lost %.1f s\n",
              a.input.c_str(), recording.format.c_str(), result.track.size(), distance_text(result).c_str(),
              static_cast<unsigned long long>(s.steps), static_cast<unsigned long long>(s.frames), s.tracking_s,
              s.degraded_s, s.lost_s);
  if (s.scale_sigma > 0)
    std::printf("metric scale known to %.1f %%: %.0f %% by inertia, %.0f %% by steps\n", 100 * s.scale_sigma,
                100 * s.scale_by_inertia, 100 * s.scale_by_steps);
  if (!result.corrected.empty())
    std::printf("corrected during the run by up to %.2f m: %s/corrected.tum has the track with later corrections\n",
                largest_distance(result.track, result.corrected), a.output.c_str());
  const auto is_used = [](const odo_map_pose& place) { return (place.header.flags & ODO_FLAG_ACCEPTED) != 0; };
  const auto used = std::count_if(result.map_poses.begin(), result.map_poses.end(), is_used);
  const auto first = std::find_if(result.map_poses.begin(), result.map_poses.end(), is_used);
  if (used > 0 && !result.track.empty())
    std::printf("the place of %s is recognised: %td poses used, the first after %.1f s\n", a.options.map.c_str(), used,
                1e-9 * static_cast<double>(first->header.t_ns - result.track[0].t_ns));
  if (result.origin)
    std::printf("on a map: odograph convert %s %s/track.gpx (or .kml, .geojson)\n", a.output.c_str(), a.output.c_str());
  std::printf("written to %s%s\n", a.output.c_str(), a.report ? "/ with report.html" : "/");
}

int run(RunArguments& a) {
  a.reading.true_states = false;
  for (const std::string& text : a.set) {
    const auto value = parse_override(text);
    if (!value) return print_failure(value.failure());
    a.options.overrides.push_back(*value);
  }
  auto recording = open_recording(a.input, a.reading);
  if (!recording) return print_failure(recording.failure());
  if (!a.faults.empty()) {
    const auto faults = read_faults(a.faults);
    if (!faults) return print_failure(faults.failure());
    *recording = with_faults(*recording, *faults);
  }
  check_guesses(*recording);
  if (const auto chosen = choose_config(a, *recording); !chosen) return print_failure(chosen.failure());
  if (!recording->has(ODO_TYPE_IMU))
    std::fprintf(stderr,
                 "%s: contains no inertial samples, which steps and vo/odograph need; from pictures alone, "
                 "samples/configs/monocular.yaml gives a track up to scale\n",
                 printable(a.input).c_str());
  std::error_code failed;
  std::filesystem::create_directories(a.output, failed);  // --map may lie in it
  const std::filesystem::path folder = std::filesystem::absolute(a.options.map, failed).parent_path();
  if (!a.options.map.empty() && !std::filesystem::is_directory(folder, failed))
    return print_failure({ODO_E_ARGUMENT, a.options.map + ": the folder for the map does not exist"});
  Progress progress("run");
  a.options.progress = [&](size_t done, size_t all) { progress.show(done, all); };
  a.options.keep_session = true;
  a.options.collect_poses = a.report;
  const auto result = replay(*recording, a.options);
  if (!result) {
    const int status = print_failure(result.failure());
    return result.failure().status == ODO_E_NOT_FOUND ? kBadUsage : status;
  }
  const auto written = write_run(a.output, *recording, *result, a.options);
  if (!written) return print_failure(written.failure());
  if (a.report) {
    const std::string page =
        run_page(*recording, {{std::filesystem::path(a.options.config).filename().string(), &*result}},
                 {.command = command_of(a)});
    const auto report = write_whole_file(std::filesystem::path(a.output) / "report.html", page);
    if (!report) return print_failure(report.failure());
  }
  for (const auto& report : result->reports) std::fprintf(stderr, "%s\n", printable(report).c_str());
  for (const auto& [key, notice] : result->notices)
    if (key.find(" unused_") != std::string::npos || key.ends_with(" map_not_recognised"))
      std::fprintf(stderr, "%s: %s\n", printable(key.substr(0, key.find(' '))).c_str(), printable(notice.text).c_str());
  for (const auto& failure : result->save_failures) std::fprintf(stderr, "%s\n", printable(failure).c_str());
  print(a, *recording, *result);
  if (const uint64_t faults = result->statistics.plugin_faults; faults > 0)
    std::fprintf(stderr, "plugins failed %llu times; the results are written\n",
                 static_cast<unsigned long long>(faults));
  return exit_status(*result);
}

}  // namespace

void add_run(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("run", "Run a pipeline over a recording");
  auto a = std::make_shared<RunArguments>();
  command->add_option("-c,--config", a->options.config,
                      "pipeline config (YAML); default: the recommended one for the recording's sensors");
  command
      ->add_option(
          "-i,--input", a->input,
          "recording: a phone app's export (zip or folder; docs/phone_recordings.md), a ROS bag, MCAP, EuRoC/ASL, "
          "TUM RGB-D, KITTI, ADVIO, Indoor Location trace, image folder, *.odo")
      ->required();
  command
      ->add_option("-o,--output", a->output,
                   "folder for trajectory.tum, corrected.tum, vo.csv, steps.csv, scale.csv, fixes.csv, states.csv, "
                   "points.ply, surfaces.json, summary.json")
      ->capture_default_str();
  command->add_option("--set", a->set,
                      "PATH=VALUE overrides a value of the config: walker.height=1.8m; in a list, the item is named by "
                      "its plugin or number: absolute_fixers.fix/gnss.parameters.correlation=0s");
  command->add_option("--plugins", a->options.plugin_path, "folder to look for plugins in first");
  command->add_option("--assets", a->options.asset_path,
                      "folder of files named by the config, such as a city model, if they are not beside it");
  command->add_option("--state", a->options.state,
                      "file of the plugins' saved state (walker and device): read if it exists, written at the end");
  command->add_option("--map", a->options.map,
                      "file of the map of places, from a config with fix/map: read if it exists, written at the end");
  command->add_flag("--pictures-outside", a->reading.pictures_outside,
                    "read pictures outside of the recording's folder too");
  command->add_option("--faults", a->faults,
                      "YAML file of sensor faults to inject; keys: odograph config schema faults");
  command->add_option("--seed", a->options.seed, "seed of the plugins' random numbers")->capture_default_str();
  command->add_flag("--report", a->report,
                    "write report.html: one page with the track, landmarks and surfaces, the camera's pictures and "
                    "charts over a common "
                    "time axis");
  command->add_flag("--json", a->json, "print the summary as one JSON object");
  command->callback([a, &status] { status = run(*a); });
}

}  // namespace odograph
