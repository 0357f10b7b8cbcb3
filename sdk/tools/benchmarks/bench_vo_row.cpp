// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/benchmarks/bench_vo_row.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/tools/evaluation/vo_consistency.hpp"
#include "sdk/tools/evaluation/vo_figures.hpp"

namespace odograph {
namespace {

constexpr double kAssociate_s = 0.02;  // two thirds of a frame at 30 Hz

VoFigures figures_of(const Recording& recording, const RunResult& result) {
  std::vector<int64_t> frames;
  int64_t offset_ns = 0;  // frames are on the camera's clock, everything that comes out on the IMU's
  for (const RecordedMessage& m : recording.messages) {
    const odo_header& header = m.message.header();
    if (header.type == ODO_TYPE_FRAME) frames.push_back(header.t_ns);
    if (header.type == ODO_TYPE_CALIBRATION && (header.flags & ODO_CALIBRATION_TIME_OFFSET) && offset_ns == 0)
      offset_ns = as<odo_calibration>(header).time_offset_ns;
  }
  for (int64_t& t : frames) t += offset_ns;
  return vo_figures(recording.truth, result.motions, result.motions_known_ns, frames);
}

Json stops_of(const VoFigures& f) {
  Json all = Json::array();
  for (const StopFigures& s : f.stops)
    all.push_back({{"from_ns", s.stop.from_ns},
                   {"seconds", static_cast<double>(s.stop.to_ns - s.stop.from_ns) * 1e-9},
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

Json metre_of(const VoFigures& f) {
  const double percent = f.path_m > 0 ? 100 / f.path_m : std::nan("");
  const auto measured =
      std::count_if(f.stops.begin(), f.stops.end(), [](const StopFigures& s) { return s.measured(); });
  return row_of("metre", {{"", "", "frames", -1, f.frames},
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
                          {"wrong", "%", "wrongly_certain_percent", 1, 100 * f.wrongly_certain_share},
                          {"NEES", "scale", "scale_nees", 2, f.scale_nees}});
}

/// NaN where no frame has a truth.
Json shape_of(const VoShape& f, const RunResult& result) {
  const auto share = [&](uint32_t state) {
    const auto n = std::count_if(result.motions.begin(), result.motions.end(),
                                 [&](const odo_vo_motion& m) { return m.state == state; });
    return static_cast<double>(n) / static_cast<double>(std::max<size_t>(1, result.motions.size()));
  };
  const double percent = 100 / std::max(f.path_m, 1e-9);
  return row_of("shape",
                {{"", "", "path_m", -1, f.path_m},
                 {"APE", "%", "ape_percent", 2, f.ape_m * percent},
                 {"true scale", "per frame, end %", "true_lengths_end_percent", 2, f.end_per_frame_m * percent},
                 {"true scale", "per 10 m, end %", "true_windows_end_percent", 2, f.end_per_window_m * percent},
                 {"scale", "median %", "scale_change_median_percent", 2, 100 * part_of(f.scale_change, 0.5)},
                 {"scale", "95 %", "scale_change_p95_percent", 2, 100 * part_of(f.scale_change, 0.95)},
                 {"rotation", "deg", "rotation_median_deg", 4, part_of(f.rotation_rad, 0.5) * 180 / EIGEN_PI},
                 {"track", "part", "tracking", 2, share(ODO_TRACKING)},
                 {"lost", "part", "lost", 2, share(ODO_LOST)},
                 {"NEES", "rotation", "rotation_nees", 2, f.rotation_nees},
                 {"NEES", "dir.", "direction_nees", 2, f.direction_nees},
                 {"ms", "median", "frame_ms_median", 1, part_of(result.frame_ms, 0.5)},
                 {"ms", "99 %", "frame_ms_p99", 1, part_of(result.frame_ms, 0.99)},
                 {"", "", "plugin_faults", -1, result.statistics.plugin_faults}});
}

Json refined_of(const odo_calibration& c) {
  return {{"fx_px", c.fx},
          {"fy_px", c.fy},
          {"cx_px", c.cx},
          {"cy_px", c.cy},
          {"time_offset_ms", static_cast<double>(c.time_offset_ns) * 1e-6},
          {"line_time_us", static_cast<double>(c.line_time_ns) * 1e-3}};
}

Json scale_along(const VoFigures& f, const Pairs& pairs) {
  Json points = Json::array();
  for (const ScaleWindow& w : f.windows) points.push_back({w.path_m, std::exp(w.log_scale)});
  if (!points.empty()) return points;
  const auto ratios = scale_along_path(pairs.reference, pairs.estimate, VoFigureParameters{}.window_m);
  std::vector<double> scales;
  for (const auto& [at_m, scale] : ratios) scales.push_back(scale);
  for (const auto& [at_m, scale] : ratios) points.push_back({at_m, scale / percentile(scales, 0.5)});
  return points;
}

}  // namespace

Json vo_row(const Recording& recording, const RunResult& result) {
  const VoFigures figures = figures_of(recording, result);
  const Pairs pairs = associate(recording.truth, compose(result.motions).own(), kAssociate_s);
  Json row = metre_of(figures);
  row.update(shape_of(vo_shape(recording.truth, result.motions, pairs), result));
  if (!result.refined.empty()) row["refined"] = refined_of(result.refined.back());
  if (!recording.truth.empty()) row["_scale"] = scale_along(figures, pairs);
  return row;
}

}  // namespace odograph
