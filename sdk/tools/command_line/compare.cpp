// SPDX-License-Identifier: Apache-2.0
//
// `odograph compare`: several configs over several recordings.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "sdk/host/base/output_file.hpp"
#include "sdk/host/base/printable.hpp"
#include "sdk/tools/command_line/commands.hpp"
#include "sdk/tools/page/run_page.hpp"
#include "sdk/tools/replay/outcome.hpp"
#include "sdk/tools/replay/replayed.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

struct CompareArguments {
  std::vector<std::string> configs, recordings, set;
  std::string output, plugins, assets;
  bool json = false;
};

using Row = nlohmann::ordered_json;

/// Null if the recording has no truth. The scale's part is null if it has only waypoints, or if the run is not metric.
Row errors_of(const Recording& recording, const RunResult& result) {
  const AlignedRun aligned = align_to_truth(recording, result);
  if (aligned.error_m.empty()) return nullptr;
  std::vector<double> errors;
  for (const auto& [t, error] : aligned.error_m) errors.push_back(error);
  Row row = {{"rms", aligned.rms_m()}, {"median", percentile(errors, 0.5)}, {"largest", percentile(errors, 1.0)},
             {"end", errors.back()},   {"rms_with_true_scale", nullptr},    {"scale", nullptr}};
  if (aligned.scale_part)
    row["rms_with_true_scale"] = aligned.scale_part->rms_m, row["scale"] = aligned.scale_part->scale;
  return row;
}

Row row_of(const std::string& config, const std::string& name, const Recording& recording, const RunResult& result) {
  const odo_statistics& s = result.statistics;
  return {{"recording", name},
          {"config", config},
          {"distance_m", s.distance_m},
          {"metric", result.first_metric < result.track.size()},
          {"steps", s.steps},
          {"error_m", errors_of(recording, result)},
          {"tracking_s", s.tracking_s},
          {"degraded_s", s.degraded_s},
          {"lost_s", s.lost_s},
          {"fixes_accepted", s.fixes_accepted},
          {"fixes_rejected", s.fixes_rejected},
          {"frame_ms", percentile(result.frame_ms, 0.5)}};
}

void print_line(const Row& row, const std::string& distance) {
  const Row& error = row["error_m"];
  const auto part = [&](const char* key) {
    return error.is_null() ? std::string("-") : text("%.2f", error[key].get<double>());
  };
  std::string scale;
  if (!error.is_null() && !error["scale"].is_null())
    scale = text("; rms %.2f m with true scale (%+.1f %%)", error["rms_with_true_scale"].get<double>(),
                 100 * (error["scale"].get<double>() - 1));
  std::printf("%-36s %-32s %12s %5llu steps  error rms %s, median %s, largest %s, end %s m%s\n",
              row["recording"].get<std::string>().c_str(), row["config"].get<std::string>().c_str(), distance.c_str(),
              static_cast<unsigned long long>(row["steps"].get<uint64_t>()), part("rms").c_str(),
              part("median").c_str(), part("largest").c_str(), part("end").c_str(), scale.c_str());
}

/// Path of a recording's page: as requested for a single recording, otherwise with the recording's name inserted before
/// the extension.
std::filesystem::path page_of(const CompareArguments& a, const std::string& recording) {
  const std::filesystem::path asked(a.output);
  if (a.recordings.size() == 1) return asked;
  std::string name = std::filesystem::path(recording).filename().string();
  return asked.parent_path() / (asked.stem().string() + "-" + name + asked.extension().string());
}

/// The file names, or the whole paths if two files have the same name.
std::vector<std::string> names_of(const std::vector<std::string>& paths) {
  std::vector<std::string> names;
  for (const std::string& path : paths) {
    const size_t query = std::min(path.find('?'), path.size());  // of a config's overrides
    std::filesystem::path p(path.substr(0, query));
    if (p.filename().empty()) p = p.parent_path();
    names.push_back(p.filename().string() + path.substr(query));
  }
  auto sorted = names;
  std::sort(sorted.begin(), sorted.end());
  return std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end() ? names : paths;
}

std::string command_of(const CompareArguments& a, const std::string& recording) {
  std::string command = "odograph compare";
  for (const std::string& config : a.configs)
    command += config.find('?') == std::string::npos ? ' ' + config : " '" + config + '\'';
  command += " -i " + recording;
  for (const std::string& text : a.set) command += " --set '" + text + "'";
  return command;
}

int compare(const CompareArguments& a) {
  const auto configs = names_of(a.configs), recordings = names_of(a.recordings);
  std::vector<Row> all;
  std::vector<std::string> distances;
  int done = kDone;
  Progress progress("compare");
  for (size_t r = 0; r < a.recordings.size(); ++r) {
    const auto recording = open_recording(a.recordings[r]);
    if (!recording) return print_failure(recording.failure());
    std::vector<RunResult> results;
    for (size_t c = 0; c < a.configs.size(); ++c) {
      progress.show(r * a.configs.size() + c, a.recordings.size() * a.configs.size());
      RunOptions options;
      if (const auto chosen = choose_config(options, a.configs[c], a.set); !chosen)
        return print_failure(chosen.failure());
      options.plugin_path = a.plugins, options.asset_path = a.assets;
      options.collect_poses = !a.output.empty();
      auto result = replay(*recording, options);
      if (!result) {
        const int status = print_failure(result.failure());
        return result.failure().status == ODO_E_NOT_FOUND ? kBadUsage : status;
      }
      if (!result->nothing.empty())
        std::fprintf(stderr, "%s on %s came to nothing: %s\n", configs[c].c_str(), recordings[r].c_str(),
                     printable(result->nothing).c_str());
      done = std::max(done, exit_status(*result));
      results.push_back(std::move(*result));
    }
    std::vector<NamedRun> runs;
    for (size_t c = 0; c < results.size(); ++c) {
      runs.push_back({configs[c], &results[c]});
      all.push_back(row_of(configs[c], recordings[r], *recording, results[c]));
      distances.push_back(distance_text(results[c]));
    }
    if (a.output.empty()) continue;
    const auto path = page_of(a, recordings[r]);
    const auto written =
        write_whole_file(path, run_page(*recording, runs, {.command = command_of(a, a.recordings[r])}));
    if (!written) return print_failure(written.failure());
    std::fprintf(stderr, "written to %s\n", path.string().c_str());
  }
  progress.show(1, 1);
  if (a.json) {
    std::printf("%s\n", Row(all).dump(2).c_str());
  } else {
    for (size_t i = 0; i < all.size(); ++i) print_line(all[i], distances[i]);
  }
  return done;
}

}  // namespace

void add_compare(CLI::App& app, int& status) {
  auto* command =
      app.add_subcommand("compare", "Compare several configs over several recordings, in a table and on a page");
  auto a = std::make_shared<CompareArguments>();
  command
      ->add_option("configs", a->configs,
                   "pipeline configs (YAML), each FILE or FILE?PATH=VALUE&PATH=VALUE with overrides")
      ->required();
  command->add_option("--set", a->set, "PATH=VALUE in every config, such as walker.height=1.8m");
  command->add_option("-i,--input", a->recordings, "recordings, as `run` takes them")->required();
  command->add_option(
      "-o,--output", a->output,
      "page to write (HTML), as by `run --report`, with all runs of a recording; one page per recording");
  command->add_option("--plugins", a->plugins, "folder to look for plugins in first");
  command->add_option("--assets", a->assets,
                      "folder of files named by the configs, such as a city model, if they are not beside them");
  command->add_flag("--json", a->json, "print one JSON array with an entry for each run");
  command->callback([a, &status] { status = compare(*a); });
}

}  // namespace odograph
