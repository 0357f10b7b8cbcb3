// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "sdk/tools/benchmarks/bench_consistency.hpp"
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/console/console.hpp"
#include "sdk/tools/replay/runner.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

struct WalkArguments {
  std::vector<std::string> configs;
  std::string data;
  double align_first_m = 10;
  bool each = false, json = false, oracles = false;
};

struct WalkRow {
  std::string name;
  double reference_m, estimate_m, distance_percent, position_median_m;
  std::vector<double> position_m;
  uint64_t steps;
  double heading_drift_deg_min;  ///< of our heading from the phone's own; NaN where it has none
  LegOracles oracles;
};

/// How fast the heading leaves the phone's own: the median of the last tenth less that of the first, by the time
/// between.
double heading_drift(const RunResult& result, const Recording& recording) {
  const auto& own = recording.phone_attitudes;
  std::vector<double> t_s, off_rad;
  size_t at = 0;
  for (const odo_attitude& a : result.attitudes) {
    while (at + 1 < own.size() && own[at + 1].t_ns <= a.header.t_ns) ++at;
    if (at + 1 >= own.size() || own[at].t_ns > a.header.t_ns) continue;
    const double w =
        static_cast<double>(a.header.t_ns - own[at].t_ns) / static_cast<double>(own[at + 1].t_ns - own[at].t_ns);
    const Eigen::Quaterniond q(a.q_n_b[0], a.q_n_b[1], a.q_n_b[2], a.q_n_b[3]);
    const Eigen::Quaterniond off = q * own[at].q.slerp(w, own[at + 1].q).conjugate();
    const double heading = 2 * std::atan2(off.z(), off.w());
    const double last = off_rad.empty() ? heading : off_rad.back();
    off_rad.push_back(last + std::remainder(heading - last, 2 * EIGEN_PI));
    t_s.push_back(static_cast<double>(a.header.t_ns) * 1e-9);
  }
  const size_t tenth = t_s.size() / 10;
  if (tenth < 10) return std::nan("");
  const auto median = [&](size_t from) {
    std::vector<double> part(off_rad.begin() + static_cast<std::ptrdiff_t>(from),
                             off_rad.begin() + static_cast<std::ptrdiff_t>(from + tenth));
    return percentile(part, 0.5);
  };
  const double seconds = t_s[t_s.size() - 1 - tenth / 2] - t_s[tenth / 2];
  return (median(t_s.size() - tenth) - median(0)) * 180 / EIGEN_PI / seconds * 60;
}

Result<std::vector<WalkRow>> run_walks(const std::string& config, const std::vector<fs::path>& files,
                                       double align_first_m) {
  Progress progress(config);
  std::vector<WalkRow> rows;
  for (size_t i = 0; i < files.size(); ++i) {
    progress.show(i, files.size());
    const auto recording = open_recording(files[i]);
    if (!recording) return recording.failure();
    RunOptions options;
    options.config = config;
    options.collect_attitudes = true;
    const auto result = replay(*recording, options);
    if (!result) return result.failure();
    const auto waypoints = recording->waypoints();
    const double rotation = heading_offset(result->track, waypoints, align_first_m);
    WaypointErrors e = waypoint_errors(lay_over(result->track, waypoints, rotation), waypoints);
    // Where the truth is there its own path is the reference, not the polyline.
    if (!recording->truth.empty()) e.reference_m = waypoint_errors(recording->truth, waypoints).estimate_m;
    rows.push_back({files[i].filename().string(), e.reference_m, e.estimate_m, 100 * e.distance_error(),
                    percentile(e.position_m, 0.5), e.position_m, result->statistics.steps,
                    heading_drift(*result, *recording), leg_oracles(result->track, waypoints, align_first_m)});
  }
  return rows;
}

nlohmann::ordered_json summary(const std::string& config, const std::vector<WalkRow>& rows) {
  std::vector<double> distance, medians, all, drift;
  double reference = 0, estimate = 0;
  for (const WalkRow& row : rows) {
    distance.push_back(std::abs(row.distance_percent));
    medians.push_back(row.position_median_m);
    if (std::isfinite(row.heading_drift_deg_min)) drift.push_back(std::abs(row.heading_drift_deg_min));
    all.insert(all.end(), row.position_m.begin(), row.position_m.end());
    reference += row.reference_m, estimate += row.estimate_m;
  }
  return {{"config", config},
          {"walks", rows.size()},
          {"reference_m", reference},
          {"total_percent", 100 * (estimate - reference) / reference},
          {"distance_percent", {{"median", percentile(distance, 0.5)}, {"p90", percentile(distance, 0.9)}}},
          {"position_m", {{"median", percentile(all, 0.5)}, {"p90", percentile(all, 0.9)}}},
          {"heading_drift_deg_min",
           {{"median", drift.empty() ? std::nan("") : percentile(drift, 0.5)},
            {"p90", drift.empty() ? std::nan("") : percentile(drift, 0.9)}}},
          {"position_walk_median_m", {{"median", percentile(medians, 0.5)}, {"p90", percentile(medians, 0.9)}}}};
}

void print_oracles(const std::vector<WalkRow>& rows) {
  std::vector<double> headed, measured, heading, length;
  const auto add = [](std::vector<double>& to, const std::vector<double>& from, double factor) {
    for (const double x : from) to.push_back(factor * std::abs(x));
  };
  for (const WalkRow& row : rows) {
    add(headed, row.oracles.true_headings_m, 1), add(measured, row.oracles.true_lengths_m, 1);
    add(heading, row.oracles.heading_rad, 180 / EIGEN_PI), add(length, row.oracles.length, 100);
  }
  const auto line = [](const char* name, const std::vector<double>& values, const char* unit) {
    std::printf("  %-60s %9.2f %9.2f %s\n", name, percentile(values, 0.5), percentile(values, 0.9), unit);
  };
  line("position, were each leg's heading true: median, 90 %", headed, "m");
  line("position, were each leg's length true", measured, "m");
  line("heading of a leg, its walk's mean taken off", heading, "deg");
  line("length of a leg", length, "%");
}

int walks(const WalkArguments& a) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(a.data, error))
    if (entry.path().extension() == ".txt" || entry.path().extension() == ".odo") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty()) return complain({ODO_E_NOT_FOUND, a.data + ": no walks (*.txt, *.odo) in this folder"});
  nlohmann::ordered_json all = nlohmann::json::array();
  if (!a.json)
    std::printf(
        "%zu walks from %s; heading fitted over the first %.0f m\n\n%-44s %9s %19s %19s %19s\n%-44s %9s %9s %9s %9s "
        "%9s %9s "
        "%9s\n",
        files.size(), a.data.c_str(), a.align_first_m, "", "total", "distance error (%)", "position error (m)",
        "heading (deg/min)", "config", "(%)", "median", "90 %", "median", "90 %", "median", "90 %");
  for (const auto& config : a.configs) {
    const auto rows = run_walks(config, files, a.align_first_m);
    if (!rows) return complain(rows.failure());
    const auto s = summary(config, *rows);
    all.push_back(s);
    if (a.json) continue;
    if (a.each)
      for (const WalkRow& row : *rows)
        std::printf("  %-42s %+8.2f  %7.2f m of %7.2f m, %4llu steps, waypoints %.2f m, heading %+.1f deg/min\n",
                    row.name.c_str(), row.distance_percent, row.estimate_m, row.reference_m,
                    static_cast<unsigned long long>(row.steps), row.position_median_m, row.heading_drift_deg_min);
    std::printf(
        "%-44s %+9.2f %9.2f %9.2f %9.2f %9.2f %9.1f %9.1f\n", config.c_str(), s["total_percent"].get<double>(),
        s["distance_percent"]["median"].get<double>(), s["distance_percent"]["p90"].get<double>(),
        s["position_m"]["median"].get<double>(), s["position_m"]["p90"].get<double>(),
        s["heading_drift_deg_min"]["median"].is_null() ? std::nan("")
                                                       : s["heading_drift_deg_min"]["median"].get<double>(),
        s["heading_drift_deg_min"]["p90"].is_null() ? std::nan("") : s["heading_drift_deg_min"]["p90"].get<double>());
    if (a.oracles) print_oracles(*rows);
  }
  if (a.json) std::printf("%s\n", all.dump(2).c_str());
  return kDone;
}

}  // namespace

void add_bench(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("bench", "Run configs over many recordings and print a table");
  command->require_subcommand(1);
  auto a = std::make_shared<WalkArguments>();
  auto* walks_command =
      command->add_subcommand("walks", "Distance and position errors over a folder of walks with waypoints");
  walks_command->add_option("data", a->data, "folder of Indoor Location Competition traces or of recordings with marks")
      ->required();
  walks_command->add_option("-c,--config", a->configs, "pipeline configs to compare")->required();
  walks_command->add_option("--align-first", a->align_first_m, "the heading is fitted over these first metres")
      ->capture_default_str();
  walks_command->add_flag("--each", a->each, "a line for each walk");
  walks_command->add_flag("--oracles", a->oracles, "what is left were the legs' headings true, or their lengths");
  walks_command->add_flag("--json", a->json, "print one JSON object");
  walks_command->callback([a, &status] { status = walks(*a); });
  add_bench_walk700(*command, status);
  add_bench_allan(*command, status);
  add_bench_anchors(*command, status);
  add_bench_calibrate(*command, status);
  add_bench_calibrate_imu(*command, status);
  add_bench_canyon(*command, status);
  add_bench_consistency(*command, status);
  add_bench_drive(*command, status);
  add_bench_gait(*command, status);
  add_bench_known_object(*command, status);
  add_bench_stream(*command, status);
  add_bench_vo(*command, status);
  add_bench_steps(*command, status);
  add_bench_tracks(*command, status);
}

}  // namespace odograph
