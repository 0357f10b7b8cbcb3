// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/export/exported_run.hpp"

#include <fstream>
#include <map>

#include <nlohmann/json.hpp>

#include "sdk/host/base/nearest.hpp"
#include "sdk/tools/recording/run_track.hpp"
#include "sdk/tools/replay/guessed_camera.hpp"

namespace odograph {
namespace fs = std::filesystem;

namespace {

using SortedJson = nlohmann::json;

SortedJson summary_at(const fs::path& file) {
  std::ifstream in(file);
  return SortedJson::parse(in, nullptr, false);
}

/// Calls with the fields of each line except the first; a missing file has none.
void each_row(const fs::path& file, size_t fields, const std::function<void(const std::vector<std::string>&)>& take) {
  std::ifstream in(file);
  std::string line;
  for (std::getline(in, line); std::getline(in, line);)
    if (const auto row = split(line, ','); row.size() >= fields) take(row);
}

void read_tables(const fs::path& folder, const SortedJson& summary, ExportedRun& run) {
  std::map<std::string, std::string> plugins;
  if (summary.contains("plugins") && summary["plugins"].is_array())
    for (const SortedJson& plugin : summary["plugins"])
      if (plugin.is_object() && plugin.contains("number") && plugin.contains("id") && plugin["id"].is_string())
        plugins[plugin["number"].dump()] = plugin["id"];
  each_row(folder / "scale.csv", 5, [&](const auto& row) {
    run.scales.push_back({std::atoll(row[0].c_str()), std::atof(row[2].c_str()), std::atof(row[3].c_str()),
                          plugins.count(row[1]) ? plugins[row[1]] : row[1], row[4] == "1"});
  });
  each_row(folder / "states.csv", 2, [&](const auto& row) {
    run.states.push_back({std::atoll(row[0].c_str()), row[1], row.size() > 2 ? row[2] : ""});
  });
}

void read_points(const fs::path& file, ExportedRun& run) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line) && line != "end_header";) continue;
  float sigma_m = 0;
  for (Eigen::Vector3f p; in >> p.x() >> p.y() >> p.z() >> sigma_m;) run.points.push_back(p);
}

}  // namespace

Origin origin_in_summary(const fs::path& file) {
  const SortedJson summary = summary_at(file);
  std::array<double, 3> origin{};
  if (!summary.is_object() || !summary.contains("origin") || !summary["origin"].is_object()) return std::nullopt;
  const char* keys[] = {"latitude_deg", "longitude_deg", "height_m"};
  for (size_t i = 0; i < 3; ++i) {
    const auto number = summary["origin"].find(keys[i]);
    if (number == summary["origin"].end() || !number->is_number()) return std::nullopt;
    origin[i] = number->get<double>() * (i < 2 ? EIGEN_PI / 180 : 1.0);
  }
  return origin;
}

Result<ExportedRun> read_exported_run(const fs::path& input, const std::string& named, const ReadOptions& options) {
  ExportedRun run;
  std::error_code error;
  const bool is_run = fs::is_regular_file(input / "trajectory.tum", error);
  fs::path path = is_run ? fs::path(named) : input;
  SortedJson summary;
  if (is_run) {
    auto track = read_tum(track_of_run(input));
    if (!track) return track.failure();
    run.track = std::move(*track);
    run.origin = origin_in_summary(input / "summary.json");
    summary = summary_at(input / "summary.json");
    if (path.empty() && summary.is_object() && summary.contains("recording") && summary["recording"].is_string())
      path = summary["recording"].get<std::string>();
    if (path.empty() || !fs::exists(path, error))
      return Failure{ODO_E_NOT_FOUND,
                     input.string() + ": its recording '" + path.string() + "' is not there; name it with --recording"};
  }
  auto recording = read_recording(path, options);
  if (!recording) return recording.failure();
  run.recording = std::move(*recording);
  refine_guessed_camera(run.recording);  // as the run did
  if (is_run) {
    read_tables(input, summary, run);
    read_points(input / "points.ply", run);
  } else {
    run.track = run.recording.truth;
  }
  return run;
}

}  // namespace odograph
