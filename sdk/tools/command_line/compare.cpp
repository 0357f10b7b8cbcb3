// SPDX-License-Identifier: Apache-2.0
//
// `odograph compare`: several configs over several recordings, on one page.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <nlohmann/json.hpp>

#include "sdk/host/base/output_file.hpp"
#include "sdk/tools/command_line/commands.hpp"
#include "sdk/tools/replay/run_plots.hpp"

namespace odograph {
namespace {

struct CompareArguments {
  std::vector<std::string> configs, recordings;
  std::string output, plugins, assets;
  bool json = false;
};

using Row = nlohmann::ordered_json;

/// Null where a recording has no truth.
Row errors_of(const Recording& recording, const RunResult& result) {
  std::vector<double> errors;
  double squares = 0;
  for (const auto& [t, error] : error_over_time(recording, result)) errors.push_back(error), squares += error * error;
  if (errors.empty()) return nullptr;
  return {{"rms", std::sqrt(squares / static_cast<double>(errors.size()))},
          {"median", percentile(errors, 0.5)},
          {"largest", percentile(errors, 1.0)},
          {"end", errors.back()}};
}

Row row_of(const std::string& config, const std::string& name, const Recording& recording, const RunResult& result) {
  const odo_statistics& s = result.statistics;
  return {{"recording", name},
          {"config", config},
          {"distance_m", s.distance_m},
          {"steps", s.steps},
          {"error_m", errors_of(recording, result)},
          {"tracking_s", s.tracking_s},
          {"degraded_s", s.degraded_s},
          {"lost_s", s.lost_s},
          {"fixes_accepted", s.fixes_accepted},
          {"fixes_rejected", s.fixes_rejected},
          {"frame_ms", percentile(result.frame_ms, 0.5)}};
}

const char* const kHeadings[] = {"config",           "distance (m)", "steps",      "error: rms (m)",
                                 "median",           "largest",      "at the end", "tracking / degraded / lost (s)",
                                 "fixes used / not", "frame (ms)"};

std::vector<std::string> cells_of(const Row& row) {
  const auto number = [](const Row& value, int digits) { return html::fixed(value.get<double>(), digits); };
  const Row& error = row["error_m"];
  const auto part = [&](const char* key) { return error.is_null() ? std::string("-") : number(error[key], 2); };
  return {row["config"].get<std::string>(),
          number(row["distance_m"], 2),
          std::to_string(row["steps"].get<uint64_t>()),
          part("rms"),
          part("median"),
          part("largest"),
          part("end"),
          number(row["tracking_s"], 1) + " / " + number(row["degraded_s"], 1) + " / " + number(row["lost_s"], 1),
          std::to_string(row["fixes_accepted"].get<uint64_t>()) + " / " +
              std::to_string(row["fixes_rejected"].get<uint64_t>()),
          number(row["frame_ms"], 2)};
}

std::string table_of(const std::vector<Row>& rows) {
  std::ostringstream table;
  table << "<table>\n<tr>";
  for (const char* heading : kHeadings) table << "<th>" << heading << "</th>";
  table << "</tr>\n";
  for (const Row& row : rows) {
    table << "<tr>";
    for (const std::string& cell : cells_of(row)) table << "<td>" << html::escape(cell) << "</td>";
    table << "</tr>\n";
  }
  table << "</table>\n";
  return table.str();
}

/// The names of the files, or the whole paths where two files are named alike.
std::vector<std::string> names_of(const std::vector<std::string>& paths) {
  std::vector<std::string> names;
  for (const std::string& path : paths) {
    std::filesystem::path p(path);
    if (p.filename().empty()) p = p.parent_path();
    names.push_back(p.filename().string());
  }
  auto sorted = names;
  std::sort(sorted.begin(), sorted.end());
  return std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end() ? names : paths;
}

int compare(const CompareArguments& a) {
  const auto configs = names_of(a.configs), recordings = names_of(a.recordings);
  std::string page = html::head("Odograph, " + std::to_string(a.configs.size()) + " configs");
  std::vector<Row> all;
  int done = kDone;
  Progress progress("compare");
  for (size_t r = 0; r < a.recordings.size(); ++r) {
    const auto recording = open_recording(a.recordings[r]);
    if (!recording) return complain(recording.failure());
    std::vector<RunResult> results;
    for (size_t c = 0; c < a.configs.size(); ++c) {
      progress.show(r * a.configs.size() + c, a.recordings.size() * a.configs.size());
      RunOptions options;
      options.config = a.configs[c], options.plugin_path = a.plugins, options.asset_path = a.assets;
      auto result = replay(*recording, options);
      if (!result) {
        const int status = complain(result.failure());
        return result.failure().status == ODO_E_NOT_FOUND ? kBadUsage : status;
      }
      done = status_over(result->loss, done);
      results.push_back(std::move(*result));
    }
    std::vector<NamedRun> runs;
    std::vector<Row> rows;
    for (size_t c = 0; c < results.size(); ++c) {
      runs.push_back({configs[c], &results[c]});
      rows.push_back(row_of(configs[c], recordings[r], *recording, results[c]));
    }
    if (!a.output.empty())
      page +=
          "<h1>" + html::escape(recordings[r]) + "</h1>\n" + table_of(rows) + html::figures(plots_of(*recording, runs));
    all.insert(all.end(), rows.begin(), rows.end());
  }
  progress.show(1, 1);
  if (a.json) {
    std::printf("%s\n", Row(all).dump(2).c_str());
  } else {
    for (const Row& row : all) {
      const auto cells = cells_of(row);
      std::printf("%-36s %-32s %9s m %5s steps  error rms %s, median %s, largest %s, end %s m\n",
                  row["recording"].get<std::string>().c_str(), cells[0].c_str(), cells[1].c_str(), cells[2].c_str(),
                  cells[3].c_str(), cells[4].c_str(), cells[5].c_str(), cells[6].c_str());
    }
  }
  if (a.output.empty()) return done;
  for (size_t c = 0; c < a.configs.size(); ++c) {
    std::ifstream file(a.configs[c]);
    std::stringstream text;
    text << file.rdbuf();
    page += "<h2>" + html::escape(configs[c]) + "</h2>\n<pre>" + html::escape(text.str()) + "</pre>\n";
  }
  const auto written = write_whole_file(a.output, page + "</html>\n");
  return written ? done : complain(written.failure());
}

}  // namespace

void add_compare(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("compare", "Several configs over several recordings, in a table and on one page");
  auto a = std::make_shared<CompareArguments>();
  command->add_option("configs", a->configs, "pipeline configs (YAML)")->required();
  command->add_option("-i,--input", a->recordings, "recordings, as `run` takes them")->required();
  command->add_option("-o,--output", a->output, "page to write: tables, tracks, errors, steps, scale, states, fixes");
  command->add_option("--plugins", a->plugins, "folder to look for plugins in first");
  command->add_option("--assets", a->assets, "folder of files that the configs name, where they are not beside them");
  command->add_flag("--json", a->json, "print one JSON array, an entry for each run");
  command->callback([a, &status] { status = compare(*a); });
}

}  // namespace odograph
