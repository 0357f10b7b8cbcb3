// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/benchmarks/bench_vo_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>

#include "sdk/tools/evaluation/evaluation.hpp"

namespace odograph {
namespace {

using Json = nlohmann::ordered_json;

struct Column {
  const char *head, *unit, *key;
  int width, decimals;
};

constexpr Column kMetre[] = {{"placed", "%", "placed_percent", 7, 1},
                             {"metric", "%", "metric_percent", 7, 1},
                             {"before", "%", "before_metric_percent", 7, 1},
                             {"groups", "", "scale_groups", 7, 0},
                             {"longest", "%", "longest_group_percent", 8, 0},
                             {"start", "s", "start_s", 7, 2},
                             {"moving", "s", "start_from_motion_s", 7, 2},
                             {"true", "m", "metric_path_m", 8, 1},
                             {"own", "m", "own_path_m", 8, 1},
                             {"SE3", "m", "se3_rmse_m", 8, 3},
                             {"yaw", "m", "yaw_rmse_m", 8, 3},
                             {"yaw", "%", "yaw_percent", 7, 2},
                             {"tracked", "worst %", "worst_tracked_percent", 8, 2},
                             {"scale", "err %", "scale_error_percent", 7, 2},
                             {"jump", "%", "worst_jump_percent", 7, 1},
                             {"stops", "", "stops_measured", 6, 0},
                             {"drift", "cm/min", "standing_drift_cm_min", 7, 1},
                             {"wrong", "%", "wrongly_certain_percent", 6, 1},
                             {"NEES", "scale", "scale_nees", 7, 2}};

constexpr Column kShape[] = {{"APE", "%", "ape_percent", 7, 2},
                             {"lengths", "end %", "true_lengths_end_percent", 9, 2},
                             {"windows", "end %", "true_windows_end_percent", 9, 2},
                             {"scale", "median %", "scale_change_median_percent", 9, 2},
                             {"scale", "95 %", "scale_change_p95_percent", 7, 2},
                             {"turn", "deg", "rotation_median_deg", 9, 4},
                             {"track", "part", "tracking", 7, 2},
                             {"lost", "part", "lost", 6, 2},
                             {"NEES", "turn", "rotation_nees", 8, 2},
                             {"NEES", "dir.", "direction_nees", 8, 2},
                             {"ms", "median", "frame_ms_median", 8, 1},
                             {"ms", "99 %", "frame_ms_p99", 8, 1}};

double value_of(const Json& row, const char* key) {
  return row.contains(key) && row[key].is_number() ? row[key].get<double>() : std::nan("");
}

std::string config_of(const Json& row) { return std::filesystem::path(row["config"].get<std::string>()).stem(); }

std::string sensors_of(const Json& row) { return row.contains("sensors") ? row["sensors"].get<std::string>() : ""; }

std::string name_of(const Json& row) {
  const std::string sensors = sensors_of(row);
  return sensors.empty() ? row["recording"].get<std::string>() : sensors;
}

template <size_t N>
void print_row(const Column (&columns)[N], const std::string& name, const std::string& config, const Json& row) {
  std::printf("%-26.26s %-22.22s", name.c_str(), config.c_str());
  for (const Column& c : columns) {
    const double value = value_of(row, c.key);
    if (std::isfinite(value))
      std::printf(" %*.*f", c.width - 1, c.decimals, value);
    else
      std::printf(" %*s", c.width - 1, "-");
  }
  std::printf("\n");
}

/// The median over recordings of everything that a row has.
template <size_t N>
Json median_of(const Column (&columns)[N], const std::vector<const Json*>& rows) {
  Json out;
  for (const Column& c : columns) {
    std::vector<double> values;
    for (const Json* row : rows)
      if (const double value = value_of(*row, c.key); std::isfinite(value)) values.push_back(value);
    if (!values.empty()) out[c.key] = percentile(values, 0.5);
  }
  return out;
}

template <size_t N>
void print_table(const char* title, const Column (&columns)[N], const std::vector<Json>& rows) {
  std::printf("%-49s", title);
  for (const Column& c : columns) std::printf(" %*s", c.width - 1, c.head);
  std::printf("\n%-26s %-22s", "recording", "config");
  for (const Column& c : columns) std::printf(" %*s", c.width - 1, c.unit);
  std::printf("\n");
  std::string recording;
  std::vector<std::pair<std::string, std::string>> groups;  // config and sensors, in order
  for (const Json& row : rows) {
    if (!sensors_of(row).empty() && row["recording"] != recording)
      std::printf("%s\n", (recording = row["recording"].get<std::string>()).c_str());
    print_row(columns, name_of(row), config_of(row), row);
    const std::pair<std::string, std::string> group{row["config"].get<std::string>(), sensors_of(row)};
    if (std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(group);
  }
  if (groups.size() < rows.size()) std::printf("median\n");
  for (const auto& [config, sensors] : groups) {
    std::vector<const Json*> members;
    for (const Json& row : rows)
      if (row["config"] == config && sensors_of(row) == sensors) members.push_back(&row);
    if (groups.size() < rows.size())
      print_row(columns, sensors.empty() ? "" : sensors, std::filesystem::path(config).stem(),
                median_of(columns, members));
  }
  std::printf("\n");
}

}  // namespace

void print_vo_tables(const std::vector<Json>& rows) {
  print_table("Metre", kMetre, rows);
  std::printf(
      "From the motions alone, one after the other. placed: frames with a displacement, not lost; metric: in metres; "
      "before: not in\n"
      "metres while the metre came later. longest: scale group. start: from the first frame to the first metric "
      "motion; moving:\n"
      "from the camera's first 5 cm. true, own: path of the metric frames. SE3, yaw: rms displacement after alignment; "
      "tracked: the worst SE3 of a metric stretch that says it is tracked, of its path. "
      "scale: |own\n"
      "by true - 1| of the Sim(3) alignment. jump: the worst change of scale within a group from the 10 m before a "
      "stop to the 10 m\n"
      "after. drift: while standing. wrong: part of the time (by places 5 m apart) in which the scale is off by more "
      "than 3 "
      "of its own\n"
      "sigmas; NEES: (log scale / sigma)^2, mean; 1 is consistent.\n\n");
  print_table("Shape and cost", kShape, rows);
  std::printf(
      "APE: after Sim(3), of the path. lengths, windows: error at the end when each frame's displacement, or each 10 m "
      "of the path,\n"
      "is given its true length. scale: how much it changes from one half of such a stretch to the other. turn: "
      "rotation error of a\n"
      "frame, median. NEES: normalised error squared of a frame's rotation and of its direction, by degree of freedom; "
      "1 is\n"
      "consistent.\n");
  for (const Json& row : rows)
    if (row.contains("refined"))
      std::printf("%s %s: refined to f %.1f %.1f, centre %.1f %.1f px, time offset %.2f ms, line time %.2f us\n",
                  name_of(row).c_str(), config_of(row).c_str(), value_of(row["refined"], "fx_px"),
                  value_of(row["refined"], "fy_px"), value_of(row["refined"], "cx_px"),
                  value_of(row["refined"], "cy_px"), value_of(row["refined"], "time_offset_ms"),
                  value_of(row["refined"], "line_time_us"));
}

}  // namespace odograph
