// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/benchmarks/bench_vo_row.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace odograph {
namespace {

using Json = nlohmann::ordered_json;
using Eigen::Vector3d;

constexpr double kMinDisplacement_m = 0.03;  // of a frame whose direction means something
constexpr double kTrueWindow_m = 10;
constexpr double kAssociate_s = 0.02;  // two thirds of a frame at 30 Hz
constexpr double kLargestGap_s = 0.25;

/// How much larger the squared errors of the motions are than their covariances say, per degree of freedom.
struct Consistency {
  std::vector<double> rotation, direction;
};

Consistency consistency_of(const Trajectory& truth, const std::vector<odo_vo_motion>& motions) {
  Consistency result;
  for (const odo_vo_motion& m : motions) {
    if ((m.header.flags & ODO_VO_COVARIANCE) == 0) continue;
    const auto from = pose_at(truth, m.t_from_ns, kLargestGap_s), to = pose_at(truth, m.header.t_ns, kLargestGap_s);
    if (!from || !to) continue;
    const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> covariance(m.covariance);
    const Eigen::Quaterniond seen(m.q_c0_c1[0], m.q_c0_c1[1], m.q_c0_c1[2], m.q_c0_c1[3]);
    const Eigen::AngleAxisd off(seen * (from->q.conjugate() * to->q).conjugate());
    const Vector3d error = off.angle() * off.axis();
    result.rotation.push_back(error.dot(covariance.topLeftCorner<3, 3>().inverse() * error) / 3);
    const Vector3d displacement = from->q.conjugate() * (to->p - from->p), own(m.p_c0_c1);
    if (displacement.norm() < kMinDisplacement_m) continue;
    const Vector3d across = own - own.norm() / displacement.norm() * displacement;
    result.direction.push_back(across.dot(covariance.bottomRightCorner<3, 3>().inverse() * across) / 2);
  }
  return result;
}

double mean_of(const std::vector<double>& values) { return values.empty() ? std::nan("") : statistics_of(values).mean; }

double percentile_of(const std::vector<double>& values, double p) {
  return values.empty() ? std::nan("") : percentile(values, p);
}

std::vector<int64_t> frame_times(const Recording& recording) {
  std::vector<int64_t> times;
  for (const RecordedMessage& m : recording.messages)
    if (m.message.header().type == ODO_TYPE_FRAME) times.push_back(m.message.header().t_ns);
  return times;
}

/// Frames are on the camera's clock, everything that comes out on the IMU's.
int64_t time_offset_ns(const Recording& recording) {
  for (const RecordedMessage& m : recording.messages)
    if (m.message.header().type == ODO_TYPE_CALIBRATION && (m.message.header().flags & ODO_CALIBRATION_TIME_OFFSET))
      return as<odo_calibration>(m.message.header()).time_offset_ns;
  return 0;
}

VoFigures figures_of(const Recording& recording, const RunResult& result) {
  std::vector<int64_t> frames = frame_times(recording), known = result.motions_known_ns;
  const int64_t offset = time_offset_ns(recording);
  for (int64_t& t : frames) t += offset;
  return vo_figures(recording.truth, result.motions, known, frames);
}

Json stops_of(const VoFigures& f) {
  Json all = Json::array();
  for (const StopFigures& s : f.stops) {
    Json stop = {{"from_ns", s.stop.from_ns},
                 {"seconds", static_cast<double>(s.stop.to_ns - s.stop.from_ns) * 1e-9},
                 {"new_group", s.new_group},
                 {"drift_m", s.drift_m}};
    stop["jump_percent"] = s.measured() ? Json(100 * s.jump()) : Json(nullptr);
    all.push_back(stop);
  }
  return all;
}

Json windows_of(const VoFigures& f) {
  Json all = Json::array();
  for (const ScaleWindow& w : f.windows)
    all.push_back({{"from_ns", w.from_ns}, {"at_m", w.path_m}, {"log_scale", w.log_scale}, {"sigma", w.sigma}});
  return all;
}

void add_metre(const VoFigures& f, Json& row) {
  const double percent = f.path_m > 0 ? 100 / f.path_m : std::nan("");
  row["frames"] = f.frames;
  row["placed_percent"] = 100 * f.placed_share;
  row["metric_percent"] = 100 * f.metric_share;
  row["before_metric_percent"] = 100 * f.before_metric_share;
  row["scale_groups"] = f.groups;
  row["longest_group_percent"] = 100 * f.longest_group_share;
  row["holes"] = f.holes;
  row["start_s"] = f.start_s;
  row["start_from_motion_s"] = f.start_from_motion_s;
  row["metric_path_m"] = f.path_m;
  row["own_path_m"] = f.own_path_m;
  row["se3_rmse_m"] = f.se3_rmse_m;
  row["sim3_rmse_m"] = f.sim3_rmse_m;
  row["yaw_rmse_m"] = f.yaw_rmse_m;
  row["yaw_percent"] = f.yaw_rmse_m * percent;
  row["scale"] = f.scale;
  row["scale_error_percent"] = 100 * std::abs(1 / f.scale - 1);
  row["stops"] = stops_of(f);
  row["stops_measured"] =
      std::count_if(f.stops.begin(), f.stops.end(), [](const StopFigures& s) { return s.measured(); });
  row["scale_windows"] = windows_of(f);
  row["worst_tracked_percent"] = 100 * f.worst_tracked;
  row["worst_jump_percent"] = 100 * f.worst_jump;
  row["standing_drift_cm_min"] = 100 * f.standing_drift_m_min;
  row["wrongly_certain_percent"] = 100 * f.wrongly_certain_share;
  row["scale_nees"] = f.scale_nees;
}

void add_shape(const Recording& recording, const RunResult& result, Json& row) {
  const Pairs pairs = associate(recording.truth, compose(result.motions).own(), kAssociate_s);
  if (pairs.reference.size() < 10) return;
  const double length = path_length(pairs.reference), percent = 100 / std::max(length, 1e-9);
  const Trajectory aligned = align(pairs, Alignment::sim3, nullptr);
  const auto end_with = [&](double window_m) {
    return absolute_errors(pairs.reference, with_true_lengths(pairs, window_m).track).translation_m.back() * percent;
  };
  std::vector<double> rotation_deg, changes;
  for (const double rad : relative_errors(pairs.reference, aligned, 1, false).rotation_rad)
    rotation_deg.push_back(rad * 180 / EIGEN_PI);
  for (const double change : scale_changes(pairs, kTrueWindow_m)) changes.push_back(100 * std::abs(change));
  const Consistency nees = consistency_of(recording.truth, result.motions);
  row["path_m"] = length;
  row["ape_percent"] = statistics_of(absolute_errors(pairs.reference, aligned).translation_m).rmse * percent;
  row["true_lengths_end_percent"] = end_with(0);
  row["true_windows_end_percent"] = end_with(kTrueWindow_m);
  row["scale_change_median_percent"] = percentile_of(changes, 0.5);
  row["scale_change_p95_percent"] = percentile_of(changes, 0.95);
  row["rotation_median_deg"] = percentile_of(rotation_deg, 0.5);
  row["rotation_nees"] = mean_of(nees.rotation);
  row["direction_nees"] = mean_of(nees.direction);
}

void add_refined(const RunResult& result, Json& row) {
  if (result.refined.empty()) return;
  const odo_calibration& c = result.refined.back();
  row["refined"] = {{"fx_px", c.fx},
                    {"fy_px", c.fy},
                    {"cx_px", c.cx},
                    {"cy_px", c.cy},
                    {"time_offset_ms", static_cast<double>(c.time_offset_ns) * 1e-6},
                    {"line_time_us", static_cast<double>(c.line_time_ns) * 1e-3}};
}

}  // namespace

Json vo_row(const Recording& recording, const RunResult& result) {
  Json row;
  add_metre(figures_of(recording, result), row);
  add_shape(recording, result, row);
  const auto part = [&](uint32_t state) {
    const auto n = std::count_if(result.motions.begin(), result.motions.end(),
                                 [state](const odo_vo_motion& m) { return m.state == state; });
    return static_cast<double>(n) / static_cast<double>(std::max<size_t>(1, result.motions.size()));
  };
  row["tracking"] = part(ODO_TRACKING);
  row["lost"] = part(ODO_LOST);
  row["frame_ms_median"] = percentile_of(result.frame_ms, 0.5);
  row["frame_ms_p99"] = percentile_of(result.frame_ms, 0.99);
  row["plugin_faults"] = result.statistics.plugin_faults;
  add_refined(result, row);
  return row;
}

PlotSeries scale_series(const Recording& recording, const RunResult& result, const std::string& name) {
  PlotSeries series{.name = name, .style = "lines"};
  for (const ScaleWindow& w : figures_of(recording, result).windows)
    series.points.emplace_back(w.path_m, std::exp(w.log_scale));
  if (!series.points.empty()) return series;
  const Pairs pairs = associate(recording.truth, compose(result.motions).own(), kAssociate_s);
  series.points = scale_along_path(pairs.reference, pairs.estimate, VoFigureParameters{}.window_m);
  std::vector<double> scales;
  for (const auto& [at_m, scale] : series.points) scales.push_back(scale);
  const double median = percentile_of(scales, 0.5);
  for (auto& [at_m, scale] : series.points) scale /= median;
  return series;
}

}  // namespace odograph
