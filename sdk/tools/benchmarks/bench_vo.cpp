// SPDX-License-Identifier: Apache-2.0
//
// Comparison of visual odometries.
#include <algorithm>
#include <cmath>

#include "sdk/math/time.hpp"
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/evaluation/reference_poses.hpp"
#include "sdk/tools/evaluation/vo_consistency.hpp"
#include "sdk/tools/evaluation/vo_figures.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

constexpr double kAssociate_s = 0.02;  // two thirds of a frame at 30 Hz

constexpr const char* kScaleNote =
    "From the composed motions only. placed: frames with a displacement, not lost; metric: with metric scale; before: "
    "placed before\nmetric scale was available. longest: scale group. start: from the first frame to the first metric "
    "motion; moving:\nfrom the camera's first 5 cm. true, own: path of the metric frames. SE3, yaw: rms displacement "
    "after alignment; tracked: the worst\nSE3 of a metric stretch in state tracking, of its path. scale: |own by true "
    "- 1| of the Sim(3) alignment. jump: the worst\nchange of scale within a group from the 10 m before a stop to the "
    "10 m after. drift: while standing. wrong: part of the time (by\nplaces 5 m apart) in which the scale is off by "
    "more than 3 of its own sigmas; NEES: (log scale / sigma)^2, mean; 1 is\nconsistent.\n\n";

constexpr const char* kShapeNote =
    "APE: after Sim(3), of the path. true scale: error at the end when each frame's displacement, or each 10 m of the "
    "path, has its\ntrue length. scale: how much it changes from one half of such a stretch to the other. rotation: "
    "error of a frame, median. NEES:\nnormalised error squared of a frame's rotation and of its direction, by degree "
    "of freedom; 1 is consistent.\n";

Json stops_of(const VoFigures& f) {
  Json all = Json::array();
  for (const StopFigures& s : f.stops)
    all.push_back({{"from_ns", s.stop.from_ns},
                   {"seconds", seconds(s.stop.to_ns - s.stop.from_ns)},
                   {"new_group", s.new_group},
                   {"drift_m", s.drift_m},
                   {"jump_percent", s.measured() ? Json(100 * s.jump()) : Json(nullptr)}});
  return all;
}

Json windows_of(const VoFigures& f) {
  Json all = Json::array();
  for (const ScaleWindow& w : f.windows)
    all.push_back({{"from_ns", w.from_ns}, {"at_m", w.path_m}, {"log_scale", w.log_scale}, {"sigma", w.sigma}});
  return all;
}

std::vector<Figure> scale_figures(const VoFigures& f) {
  const double percent = f.path_m > 0 ? 100 / f.path_m : std::nan("");
  const auto measured =
      std::count_if(f.stops.begin(), f.stops.end(), [](const StopFigures& s) { return s.measured(); });
  return {{"", "", "frames", -1, f.frames},
          {"placed", "%", "placed_percent", 1, 100 * f.placed_share},
          {"metric", "%", "metric_percent", 1, 100 * f.metric_share},
          {"before", "%", "before_metric_percent", 1, 100 * f.before_metric_share},
          {"groups", "", "scale_groups", 0, f.groups},
          {"longest", "%", "longest_group_percent", 0, 100 * f.longest_group_share},
          {"", "", "holes", -1, f.holes},
          {"start", "s", "start_s", 2, f.start_s},
          {"moving", "s", "start_from_motion_s", 2, f.start_from_motion_s},
          {"true", "m", "metric_path_m", 1, f.path_m},
          {"own", "m", "own_path_m", 1, f.own_path_m},
          {"SE3", "m", "se3_rmse_m", 3, f.se3_rmse_m},
          {"", "", "sim3_rmse_m", -1, f.sim3_rmse_m},
          {"yaw", "m", "yaw_rmse_m", 3, f.yaw_rmse_m},
          {"yaw", "%", "yaw_percent", 2, f.yaw_rmse_m * percent},
          {"tracked", "worst %", "worst_tracked_percent", 2, 100 * f.worst_tracked},
          {"", "", "scale", -1, f.scale},
          {"scale", "err %", "scale_error_percent", 2, 100 * std::abs(1 / f.scale - 1)},
          {"jump", "%", "worst_jump_percent", 1, 100 * f.worst_jump},
          {"", "", "stops", -1, stops_of(f)},
          {"stops", "", "stops_measured", 0, measured},
          {"", "", "scale_windows", -1, windows_of(f)},
          {"drift", "cm/min", "standing_drift_cm_min", 1, 100 * f.standing_drift_m_min},
          {"wrong", "%", "wrongly_certain_percent", 1, 100 * f.overconfident_share},
          {"NEES", "scale", "scale_nees", 2, f.scale_nees}};
}

/// NaN for frames without truth.
std::vector<Figure> shape_of(const VoShape& f, const RunResult& result) {
  const double percent = 100 / std::max(f.path_m, 1e-9);
  return {{"", "", "path_m", -1, f.path_m},
          {"APE", "%", "ape_percent", 2, f.ape_m * percent},
          {"true scale", "per frame, end %", "true_lengths_end_percent", 2, f.end_per_frame_m * percent},
          {"true scale", "per 10 m, end %", "true_windows_end_percent", 2, f.end_per_window_m * percent},
          {"scale", "median %", "scale_change_median_percent", 2, 100 * percentile_or_nan(f.scale_change, 0.5)},
          {"scale", "95 %", "scale_change_p95_percent", 2, 100 * percentile_or_nan(f.scale_change, 0.95)},
          {"rotation", "deg", "rotation_median_deg", 4, percentile_or_nan(f.rotation_rad, 0.5) * 180 / EIGEN_PI},
          {"track", "part", "tracking", 2, f.tracking_share},
          {"lost", "part", "lost", 2, f.lost_share},
          {"NEES", "rotation", "rotation_nees", 2, f.rotation_nees},
          {"NEES", "dir.", "direction_nees", 2, f.direction_nees},
          {"ms", "median", "frame_ms_median", 1, percentile_or_nan(result.frame_ms, 0.5)},
          {"ms", "99 %", "frame_ms_p99", 1, percentile_or_nan(result.frame_ms, 0.99)},
          {"", "", "plugin_faults", -1, result.statistics.plugin_faults}};
}

Json refined_of(const odo_calibration& c) {
  return {{"fx_px", c.fx},
          {"fy_px", c.fy},
          {"cx_px", c.cx},
          {"cy_px", c.cy},
          {"time_offset_ms", static_cast<double>(c.time_offset_ns) * 1e-6},
          {"line_time_us", static_cast<double>(c.line_time_ns) * 1e-3}};
}

struct Vo : Benchmark {
  Vo()
      : Benchmark(
            "vo", "Visual odometries side by side, on simulated walks or recordings",
            kConfigs | kQuick | kSimulated | kRecordings | kSensors,
            {"monocular", "monocular_antigny2019", "monocular_gakne2018", "monocular_odograph", "inertial_odograph"}) {
    quick_m = 120;  // as `bench walk700 --quick`, which shares the kept recordings
  }
  void add_options(CLI::App& command) override {
    command.add_option("--reference", reference, "TUM poses to measure against, instead of the recording's truth")
        ->check(CLI::ExistingFile);
    command
        .add_option("--reference-frame", reference_frame,
                    "frame of the poses of --reference: camera, or body (the IMU)")
        ->check(CLI::IsMember({"camera", "body"}));
    command.add_flag("--stress", stress, "use the stress_*.yaml beside the scenario instead")->group(kCases);
    command.add_option("--cut", cut_s, "start this long after the first frame, s")->check(CLI::NonNegativeNumber);
    command.add_option("--gap", gap,
                       "FROM:FOR, s: frames are missing for this long, from this time after the first one");
    command.add_option("--dark", dark,
                       "FROM:FOR, s: frames are black for this long, from this time after the first one");
  }

  Result<std::vector<BenchCase>> recordings() override {
    for (Degradation& d : qualities) {
      d.cut_s = cut_s;
      if (auto ok = parse_interval(gap, "--gap", d.gap_from_s, d.gap_for_s); !ok) return ok.failure();
      if (auto ok = parse_interval(dark, "--dark", d.dark_from_s, d.dark_for_s); !ok) return ok.failure();
    }
    if (stress) options.scenarios = files_in(fs::path(options.scenarios.front()).parent_path(), "stress_", {".yaml"});
    auto all = Benchmark::recordings();
    if (!all || reference.empty()) return all;
    if (all->size() != 1)
      return Failure{ODO_E_ARGUMENT, text("--reference is for one recording, and there are %zu", all->size())};
    all->front().files.emplace_back(reference);
    return all;
  }

  Result<Recording> recording_of(const BenchCase& one) const override {
    auto recording = read_recording(one.files.front());
    if (!recording) return recording.failure();
    if (!recording->has(ODO_TYPE_FRAME)) return Failure{ODO_E_DATA, one.files.front().string() + ": no camera frames"};
    if (!reference.empty()) {
      auto poses = read_reference(reference, reference_frame, *recording);
      if (!poses) return poses.failure();
      recording->truth = std::move(*poses);
    }
    return degraded(*recording, qualities[one.variant], sensor_seed);
  }

  Result<Json> measure_replay(const BenchCase&, const Recording& recording, const RunResult& result) const override {
    const VoFigures figures =
        vo_figures(recording.truth, result.motions, result.motions_emitted_ns, frame_times_ns(recording));
    const Pairs pairs = associate(recording.truth, compose(result.motions).unscaled(), kAssociate_s);
    Json row = row_of(scale_figures(figures), "metre");
    row.update(row_of(shape_of(vo_shape(recording.truth, result.motions, pairs), result), "shape"));
    if (!result.refined.empty()) row["refined"] = refined_of(result.refined.back());
    return row;
  }

  BenchReport report(const Rows& rows) const override {
    BenchReport report{cases_text(rows, "metre", "Metre", "median") + kScaleNote +
                       cases_text(rows, "shape", "Shape and cost", "median") + kShapeNote};
    for (const Json& row : rows) {
      const Json refined = row.value("refined", Json::object());
      if (!refined.empty()) report.text += run_name(row) + ": refined to";
      for (const auto& [key, value] : refined.items())
        report.text += text(" %s %.2f", key.c_str(), value.get<double>());
      if (!refined.empty()) report.text += '\n';
    }
    return report;
  }

  static std::string run_name(const Json& row) {
    return row["recording"].get<std::string>() + ' ' + stem_of(row["config"].get<std::string>()) +
           (row.contains("sensors") ? ' ' + row["sensors"].get<std::string>() : "");
  }

  std::string reference, reference_frame = "camera", gap, dark;
  double cut_s = 0;
  bool stress = false;
};

}  // namespace

Benchmarks vo_benchmarks() { return {std::make_shared<Vo>()}; }

}  // namespace odograph
