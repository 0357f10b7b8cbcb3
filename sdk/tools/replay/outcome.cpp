// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/replay/outcome.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "sdk/math/time.hpp"
#include "sdk/tools/console/console.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

struct Parameters {
  size_t window = 100;           ///< samples of an accelerometer: one or two seconds
  double walking_share = 0.07;   ///< of the mean norm, its rms scatter in a window: 0.7 m/s^2, a slow walk in the hand
  int walking_windows = 4;       ///< a few seconds
  double gnss_rad = 20 / 6.4e6;  ///< 20 m on the Earth, twice a phone's error
  double moved_m = 0.1;          ///< less is jitter
  int motions = 20;              ///< of a front-end, with a displacement
};
constexpr Parameters kParameters;

bool shakes(const Recording& recording) {
  double sum = 0, squares = 0;
  size_t n = 0;
  int windows = 0;
  for (const RecordedMessage& each : recording.messages) {
    const odo_header& header = each.message.header();
    if (header.type != ODO_TYPE_IMU || !(header.flags & ODO_IMU_ACCEL)) continue;
    const double* a = as<odo_imu>(header).accel_b;
    const double norm = std::hypot(a[0], a[1], a[2]);
    sum += norm, squares += norm * norm;
    if (++n < kParameters.window) continue;
    const double mean = sum / double(n), scatter = std::sqrt(std::max(0.0, squares / double(n) - mean * mean));
    windows += scatter > kParameters.walking_share * mean;
    sum = squares = 0, n = 0;
  }
  return windows >= kParameters.walking_windows;
}

bool travels(const Recording& recording) {
  double low[2] = {10, 10}, high[2] = {-10, -10};
  for (const RecordedMessage& each : recording.messages) {
    const odo_header& header = each.message.header();
    if (header.type != ODO_TYPE_GNSS || !(header.flags & ODO_GNSS_POSITION)) continue;
    const auto& gnss = as<odo_gnss>(header);
    const double place[2] = {gnss.latitude_rad, gnss.longitude_rad * std::cos(gnss.latitude_rad)};
    for (int i = 0; i < 2; ++i) low[i] = std::min(low[i], place[i]), high[i] = std::max(high[i], place[i]);
  }
  return std::max(high[0] - low[0], high[1] - low[1]) > kParameters.gnss_rad;
}

/// The time between frames and inertial samples if all frames are after them, negative if all are before; otherwise 0.
double frames_apart_s(const Recording& recording) {
  std::optional<int64_t> first_imu, last_imu, first_frame, last_frame;
  for (const RecordedMessage& each : recording.messages) {  // in the order of time
    const odo_header& header = each.message.header();
    if (header.type == ODO_TYPE_IMU) first_imu = first_imu.value_or(header.t_ns), last_imu = header.t_ns;
    if (header.type == ODO_TYPE_FRAME) first_frame = first_frame.value_or(header.t_ns), last_frame = header.t_ns;
  }
  if (!last_imu || !last_frame) return 0;
  return seconds(std::max<int64_t>(0, *first_frame - *last_imu) + std::min<int64_t>(0, *last_frame - *first_imu));
}

double extent_m(const StampedPoses& track) {
  double extent = 0;
  for (const StampedPose& pose : track) extent = std::max(extent, (pose.p - track.front().p).norm());
  return extent;
}

/// Whether a front-end up to scale has moved: a car shakes no accelerometer.
bool sees_motion(const RunResult& result) {
  int count = 0;
  for (const odo_vo_motion& m : result.motions)
    count += (m.header.flags & (ODO_VO_TRANSLATION | ODO_VO_METRIC)) == ODO_VO_TRANSLATION && m.state == ODO_TRACKING;
  return count >= kParameters.motions;
}

/// Whether a front-end estimates the scale from inertia, if it has a parameter of that name.
bool has_metric_front_end(const PipelineConfig& config) {
  for (const PluginChoice& choice : config.vo_frontends)
    for (const auto& [spec, value] : choice.parameters)
      if (spec.name == "inertial" && value.boolean) return true;
  return false;
}

/// The first thing that the host called wrong, otherwise what is missing.
std::string likeliest(const Recording& recording, const PipelineConfig& config, const RunResult& result) {
  for (const std::string& report : result.reports)
    if (report.starts_with("host: ")) return report.substr(6);
  const bool camera = !config.vo_frontends.empty() && recording.has(ODO_TYPE_FRAME);
  const bool inertial = recording.has(ODO_TYPE_IMU);
  if (!config.vo_frontends.empty() && !recording.has(ODO_TYPE_FRAME) && config.step_estimators.empty())
    return "the config has a vo_frontend, and the recording no frames";
  if (config.vo_frontends.empty() && config.step_estimators.empty())
    return recording.has(ODO_TYPE_FRAME) ? "the config has no vo_frontend for the frames, and no step_estimator"
                                         : "the config has neither a step_estimator nor a vo_frontend";
  if (!inertial && config.vo_frontends.empty()) return "the recording has no inertial samples, which steps need";
  if (!inertial) return "the recording has no inertial samples, which give the scale";
  if (!config.step_estimators.empty() && result.steps.empty() && !camera) return "no step was found";
  const char* reason = odo_reason_text(result.final_reason);
  return *reason ? reason : "nothing gave a displacement";
}

}  // namespace

bool holds_motion(const Recording& recording) { return shakes(recording) || travels(recording); }

std::string why_nothing(const Recording& recording, const PipelineConfig& config, const RunResult& result) {
  const auto because = [&](const std::string& what) { return what + ": " + likeliest(recording, config, result); };
  if (result.track.empty()) return because("no pose was published");
  const bool front_end = !config.vo_frontends.empty() && recording.has(ODO_TYPE_FRAME);
  if (front_end && result.statistics.frames == 0) return because("all frames were dropped");
  const bool uses_imu = !config.attitudes.empty() || !config.step_estimators.empty() || has_metric_front_end(config);
  if (const double apart_s = frames_apart_s(recording); front_end && uses_imu && apart_s != 0)
    return text("all frames are %.1f s %s the inertial samples: on another clock?", std::abs(apart_s),
                apart_s > 0 ? "after" : "before");
  const bool inertial = recording.has(ODO_TYPE_IMU), moves = holds_motion(recording) || sees_motion(result);
  if (inertial && !moves) return {};
  if (extent_m(result.track) < kParameters.moved_m)
    return because(moves ? "the input moves, and no pose does" : "no pose moves");
  const bool steps = !config.step_estimators.empty() && config.coupling.type == CouplingType::localizer;
  const bool scale = !config.scale_sources.empty() || (inertial && (steps || has_metric_front_end(config))) ||
                     (!config.fixers.empty() && recording.has(ODO_TYPE_GNSS));
  if (scale && result.first_metric == result.track.size()) return because("the poses never had a scale in metres");
  return {};
}

std::string distance_text(const RunResult& result) {
  if (result.nothing.empty() && !result.track.empty() && extent_m(result.track) < kParameters.moved_m) return "still";
  const bool metric = result.first_metric < result.track.size() || result.track.empty();
  return text(metric ? "%.2f m" : "%.2f units", result.statistics.distance_m);
}

int exit_status(const RunResult& result) {
  if (!result.save_failures.empty()) return kBadData;
  if (result.statistics.plugin_faults > 0) return kPluginFailure;
  return exit_status(result.loss,
                     result.nothing.empty() && result.final_state != ODO_LOST ? int{kDone} : int{kLostTracking});
}

}  // namespace odograph
