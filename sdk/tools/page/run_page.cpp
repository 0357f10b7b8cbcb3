// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/page/run_page.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/page/page_pictures.hpp"
#include "sdk/tools/page/page_scene.hpp"
#include "sdk/tools/page/run_page_text.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t kMaxPoses = 20000;    // of a run on the page: ten minutes at 30 Hz; more are decimated
constexpr double kKnownScale = 0.2;    // relative sigma, above which it would dominate a chart
constexpr double kSpeedOver_s = 0.25;  // shorter differences show position noise
constexpr double kGround_m = 1.35;     // of a phone in the hand, downwards; only for the path drawn into pictures

/// Rounds to 1e-4 by default, below what a page shows.
double rounded(double value, double per_unit = 1e4) { return std::round(value * per_unit) / per_unit; }
Json number(double value) { return std::isfinite(value) ? Json(rounded(value)) : Json(nullptr); }

/// Times and values in the form of the page's charts.
struct Series {
  Json t = Json::array(), y = Json::array();
  void add(double time, double value) { t.push_back(rounded(time)), y.push_back(number(value)); }
  Json json() const { return {{"t", t}, {"y", y}}; }
};

class PageOfRun {
 public:
  PageOfRun(const Recording& recording, const NamedRun& run, int64_t t0_ns,
            const std::optional<PageOptions::Evaluation>& evaluation)
      : recording_(recording),
        r_(*run.result),
        name_(run.name),
        t0_ns_(t0_ns),
        evaluation_(evaluation),
        aligned_(align_to_truth(recording, r_, evaluation ? std::optional(evaluation->alignment) : std::nullopt)) {}

  Json json() {
    add_poses();
    const Eigen::Vector3d& p = aligned_.to_truth.p;
    Json aligned = {{"q", json_of(aligned_.to_truth.q)},
                    {"p", {rounded(p.x()), rounded(p.y()), rounded(p.z())}},
                    {"s", aligned_.scale}};
    Series errors, work, relative;
    if (!r_.track.empty())
      for (const auto& [t, error] : aligned_.error_m) errors.add(t + time(r_.track.front().t_ns), error);
    for (size_t k = 0; k < std::min(r_.frame_ms.size(), r_.track.size()); ++k)
      work.add(time(r_.track[k].t_ns), r_.frame_ms[k]);
    if (evaluation_)
      for (const auto& [t, error] : evaluation_->relative_m) relative.add(t, error);
    Json out = std::move(poses_);
    out.update({{"name", name_},
                {"metric", aligned_.metric},
                {"laid", aligned},
                {"error", errors.json()},
                {"speed", speed().json()},
                {"speed_error", (recording_.truth.empty() ? Series() : speed(true)).json()},
                {"steps", steps()},
                {"modes", modes()},
                {"scales", scales()},
                {"fixes", fixes()},
                {"places", page_places(r_, t0_ns_)},
                {"frame_ms", work.json()},
                {"corners", corners()},
                {"relative", relative.json()},
                {"headline", headline()},
                {"table", table()},
                {"reports", reports()},
                {"config", r_.config_text}});
    out.update(page_scene(r_));
    return out;
  }

  /// Summary line.
  std::string headline() const {
    const odo_statistics& s = r_.statistics;
    std::string out;
    const double path_m = recording_.truth.empty() ? s.distance_m : path_length(recording_.truth);
    if (!recording_.truth.empty() && !aligned_.error_m.empty())
      out = text("%.2f m rms from the truth, %.2f %% of the path of %.1f m", aligned_.rms_m(),
                 100 * aligned_.rms_m() / std::max(1e-9, path_m), path_m);
    else
      out = text(aligned_.metric || !recording_.truth.empty() ? "%.1f m of path"
                                                              : "%.1f units of path, without a scale in metres",
                 path_m);
    if (!aligned_.metric && !aligned_.error_m.empty()) out += ", its scale fitted to the truth";
    if (s.scale_sigma > 0) out += text("; metric scale known to %.1f %%", 100 * s.scale_sigma);
    if (s.tracking_s + s.degraded_s + s.lost_s > 0)
      out += text("; tracking for %.1f of %.1f s", s.tracking_s, s.tracking_s + s.degraded_s + s.lost_s);
    return out;
  }
  bool metric() const { return aligned_.metric; }

 private:
  double time(int64_t t_ns) const { return rounded(seconds(t_ns - t0_ns_)); }
  static Json json_of(const Eigen::Quaterniond& q) {
    return {rounded(q.w(), 1e6), rounded(q.x(), 1e6), rounded(q.y(), 1e6), rounded(q.z(), 1e6)};
  }

  /// Poses, decimated if there are many; with sigma and scale if the run collected them.
  void add_poses() {
    Json t = Json::array(), p = Json::array(), q = Json::array(), state = Json::array(), sigma = Json::array(),
         states = Json::array();
    Series scale;
    bool north = false;
    const size_t step = r_.track.size() / kMaxPoses + 1;
    size_t k = 0;
    uint32_t last_state = 0, last_reason = 0;
    for (size_t i = 0; i < r_.track.size(); ++i) {
      const StampedPose& x = r_.track[i];
      while (k + 1 < r_.poses.size() && r_.poses[k + 1].header.t_ns <= x.t_ns) ++k;
      const odo_pose* pose = k < r_.poses.size() && r_.poses[k].header.t_ns == x.t_ns ? &r_.poses[k] : nullptr;
      const uint32_t reason = i < r_.reasons.size() ? r_.reasons[i] : 0;
      if (i == 0 || r_.states[i] != last_state || reason != last_reason) {
        const std::string why = reason ? std::string(": ") + odo_reason_text(reason) : "";
        states.push_back({{"t", time(x.t_ns)},
                          {"state", std::min(r_.states[i], uint32_t(ODO_LOST))},
                          {"text", odo_state_text(r_.states[i]) + why}});
        last_state = r_.states[i], last_reason = reason;
      }
      if (i % step) continue;
      t.push_back(time(x.t_ns)), state.push_back(r_.states[i]);
      for (const double value : {x.p.x(), x.p.y(), x.p.z()}) p.push_back(rounded(value));
      for (const auto& value : json_of(x.q)) q.push_back(value);
      if (!pose) continue;
      sigma.push_back(number(std::sqrt(std::max({pose->covariance[21], pose->covariance[28], 0.0}))));
      if (pose->scale_sigma > 0 && pose->scale_sigma < kKnownScale * pose->scale)
        scale.add(time(x.t_ns), 100 * pose->scale_sigma / pose->scale);
      north = (pose->header.flags & ODO_POSE_NORTH) != 0;
    }
    if (sigma.size() != t.size()) sigma = Json::array();
    poses_ = {{"t", t},
              {"p", p},
              {"q", q},
              {"state", state},
              {"sigma", sigma},
              {"states", states},
              {"scale_sigma", scale.json()},
              {"north", north}};
  }

  /// With `less_true`: the error of the speed, and so of the scale.
  Series speed(bool less_true = false) const {
    Series out;
    size_t from = 0;
    for (size_t k = 1; k < r_.track.size(); ++k) {
      const StampedPose &a = r_.track[from], &b = r_.track[k];
      const double dt_s = seconds(b.t_ns - a.t_ns);
      if (dt_s < kSpeedOver_s) continue;
      const double true_m =
          less_true ? (position_at(recording_.truth, b.t_ns) - position_at(recording_.truth, a.t_ns)).norm() : 0.0;
      out.add(time(a.t_ns) + dt_s / 2, (aligned_.scale * (b.p - a.p).norm() - true_m) / dt_s);
      from = k;
    }
    return out;
  }

  Json steps() const {
    Series lengths;
    Json sigma = Json::array();
    for (const odo_step& s : r_.steps) lengths.add(time(s.t_end_ns), s.length_m), sigma.push_back(number(s.sigma_m));
    Json out = lengths.json();
    out["sigma"] = sigma;
    return out;
  }

  /// Numbers of corners that the front-end tracked and used.
  Json corners() const {
    Json t = Json::array(), tracked = Json::array(), inliers = Json::array();
    const size_t step = r_.motions.size() / kMaxPoses + 1;
    for (size_t i = 0; i < r_.motions.size(); i += step)
      if (r_.motions[i].tracked > 0 || r_.motions[i].inliers > 0)
        t.push_back(time(r_.motions[i].header.t_ns)), tracked.push_back(r_.motions[i].tracked),
            inliers.push_back(r_.motions[i].inliers);
    return {{"t", t}, {"tracked", tracked}, {"inliers", inliers}};
  }

  Json modes() const {
    Json out = Json::array();
    for (const odo_motion_mode& m : r_.modes)
      if (out.empty() || out.back()["text"] != odo_mode_text(m.mode))
        out.push_back({{"t", time(m.header.t_ns)}, {"text", odo_mode_text(m.mode)}});
    return out;
  }

  std::string plugin(uint32_t source) const {
    for (const auto& p : r_.plugins)
      if (p.number == source) return p.id;
    return "source " + std::to_string(source);
  }

  Json scales() const {
    std::map<uint32_t, std::pair<Series, Json>> by_source;
    for (const odo_scale& s : r_.scales) {
      auto& [series, sigma] = by_source.try_emplace(s.header.source, Series{}, Json::array()).first->second;
      series.add(time(s.header.t_ns), s.scale), sigma.push_back(number(s.sigma));
    }
    Json out = Json::array();
    for (const auto& [source, scale] : by_source) {
      Json entry = scale.first.json();
      entry["sigma"] = scale.second, entry["source"] = plugin(source);
      out.push_back(entry);
    }
    return out;
  }

  Json fixes() const {
    Json t = Json::array(), p = Json::array(), used = Json::array(), source = Json::array();
    Json residual = {Json::array(), Json::array(), Json::array()};
    constexpr uint32_t kHorizontal = ODO_FIX_NORTH | ODO_FIX_EAST;
    for (const auto& [fix, accepted] : r_.fixes) {
      const Eigen::Vector3d there = position_at(r_.track, fix.header.t_ns);
      const bool horizontal = (fix.header.flags & kHorizontal) == kHorizontal;
      const bool vertical = (fix.header.flags & ODO_FIX_DOWN) != 0;
      t.push_back(time(fix.header.t_ns)), used.push_back(accepted), source.push_back(plugin(fix.header.source));
      p.push_back(horizontal ? number(fix.p_n[0]) : Json(nullptr)),
          p.push_back(horizontal ? number(fix.p_n[1]) : Json(nullptr));
      p.push_back(number(vertical ? fix.p_n[2] : there.z()));
      for (int axis = 0; axis < 3; ++axis)
        residual[static_cast<size_t>(axis)].push_back(
            (fix.header.flags & (ODO_FIX_NORTH << axis)) ? number(fix.p_n[axis] - there[axis]) : Json(nullptr));
    }
    return {{"t", t}, {"p", p}, {"used", used}, {"source", source}, {"residual", residual}};
  }

  /// The figures of summary.json as text.
  Json table() const {
    const odo_statistics& s = r_.statistics;
    const auto count = [](uint64_t n) { return std::to_string(n); };
    Json rows = Json::array();
    if (evaluation_) {
      for (const auto& [name, figure] : evaluation_->figures) rows.push_back({name, figure});
      return rows;
    }
    rows.push_back({"Error, rms", aligned_.error_m.empty() ? "no truth" : text("%.3f m", aligned_.rms_m())});
    rows.push_back(
        {"Error at the end", aligned_.error_m.empty() ? "no truth" : text("%.3f m", aligned_.error_m.back().second)});
    rows.push_back({"Distance", text("%.2f m", s.distance_m)});
    rows.push_back({"Steps", count(s.steps)});
    rows.push_back({"Camera frames", count(s.frames)});
    rows.push_back({"Metric scale known to",
                    s.scale_sigma > 0 ? text("%.1f %% (%.0f %% by inertia, %.0f %% by steps)", 100 * s.scale_sigma,
                                             100 * s.scale_by_inertia, 100 * s.scale_by_steps)
                                      : "not known"});
    rows.push_back({"Tracking, degraded, lost", text("%.1f, %.1f, %.1f s", s.tracking_s, s.degraded_s, s.lost_s)});
    rows.push_back({"At the end", std::string(odo_state_text(r_.final_state)) +
                                      (r_.final_reason ? std::string(": ") + odo_reason_text(r_.final_reason) : "")});
    if (!r_.key_frames.empty())
      rows.push_back({"Key frames, loops", count(r_.key_frames.size()) + ", " + count(r_.loops.size())});
    rows.push_back({"Fixes used, not used", count(s.fixes_accepted) + ", " + count(s.fixes_rejected)});
    rows.push_back({"Work for a frame, median, 99 %",
                    text("%.2f, %.2f ms", percentile(r_.frame_ms, 0.5), percentile(r_.frame_ms, 0.99))});
    rows.push_back({"Dropped: late, duplicate, invalid, overflow",
                    count(s.late) + ", " + count(s.duplicate) + ", " + count(s.invalid) + ", " + count(s.overflow)});
    rows.push_back({"Plugin faults", count(s.plugin_faults)});
    std::string plugins;
    for (const auto& p : r_.plugins) plugins += (plugins.empty() ? "" : ", ") + p.id + " " + p.version;
    rows.push_back({"Plugins", plugins});
    return rows;
  }

  Json reports() const {
    Json out = r_.reports;
    for (const auto& [key, notice] : r_.notices)
      out.push_back(key + ", " + std::to_string(notice.count) + " times: " + notice.text);
    return out;
  }

  const Recording& recording_;
  const RunResult& r_;
  std::string name_;
  int64_t t0_ns_;
  const std::optional<PageOptions::Evaluation>& evaluation_;
  AlignedRun aligned_;
  Json poses_;
};

Json json_of(const odo_calibration* camera) {
  if (!camera) return nullptr;
  Json distortion = Json::array();
  for (uint32_t k = 0; k < std::min(camera->distortion_count, 8u); ++k) distortion.push_back(camera->distortion[k]);
  return {{"model", camera->model == ODO_CAMERA_KANNALA_BRANDT ? "equidistant" : "pinhole"},
          {"width", camera->width},
          {"height", camera->height},
          {"fx", camera->fx},
          {"fy", camera->fy},
          {"cx", camera->cx},
          {"cy", camera->cy},
          {"distortion", distortion}};
}

Json pictures_of(const Recording& recording, const odo_calibration* camera, const PageOptions& options, int64_t t0_ns) {
  const auto frames = frames_of(recording, camera);
  Json out = Json::array();
  const size_t count = options.served ? frames.size() : std::min(options.pictures, frames.size());
  for (size_t k = 0; k < count; ++k) {
    const size_t number = k * frames.size() / count;
    const int64_t t_ns = frames[number]->message.header().t_ns + (camera ? camera->time_offset_ns : 0);
    Json picture = {{"t", rounded(seconds(t_ns - t0_ns))}};
    if (options.served) {
      picture["number"] = number;
    } else {
      const auto jpeg = jpeg_of(*frames[number], options.picture_width);
      if (jpeg.empty()) continue;
      picture["jpeg"] = base64(jpeg);
    }
    out.push_back(picture);
  }
  return out;
}

Json truth_of(const Recording& recording, int64_t from_ns, int64_t to_ns, int64_t t0_ns, bool with_angles) {
  Json t = Json::array(), p = Json::array(), q = Json::array();
  const size_t step = recording.truth.size() / kMaxPoses + 1;
  for (size_t i = 0; i < recording.truth.size(); i += step) {
    const StampedPose& x = recording.truth[i];
    if (x.t_ns < from_ns || x.t_ns > to_ns) continue;
    t.push_back(rounded(seconds(x.t_ns - t0_ns)));
    for (const double value : {x.p.x(), x.p.y(), x.p.z()}) p.push_back(rounded(value));
    for (const double value : {x.q.w(), x.q.x(), x.q.y(), x.q.z()})
      if (with_angles) q.push_back(rounded(value, 1e6));
  }
  if (t.empty()) return nullptr;
  Json out = {{"t", t}, {"p", p}};
  if (with_angles) out["q"] = q;
  return out;
}

}  // namespace

std::string run_page_data(const Recording& recording, const std::vector<NamedRun>& runs, const PageOptions& options) {
  int64_t from_ns = INT64_MAX, to_ns = INT64_MIN;
  for (const NamedRun& run : runs)
    if (!run.result->track.empty())
      from_ns = std::min(from_ns, run.result->track.front().t_ns),
      to_ns = std::max(to_ns, run.result->track.back().t_ns);
  const int64_t t0_ns = from_ns == INT64_MAX ? 0 : from_ns;
  Json all = Json::array();
  std::string headline;
  bool metric = true;
  for (const NamedRun& run : runs) {
    PageOfRun page(recording, run, t0_ns, options.evaluation);
    all.push_back(page.json());
    headline = page.headline(), metric = metric && page.metric();
  }
  const odo_calibration* camera = camera_of(recording);
  for (const NamedRun& run : runs)
    if (!camera && !run.result->refined.empty()) camera = &run.result->refined.front();
  Json waypoints = Json::array();
  for (const auto& w : recording.waypoints())
    waypoints.push_back({rounded(w.p_n.x()), rounded(w.p_n.y()), rounded(w.p_n.z())});
  const std::string name = recording.path.filename().empty() ? recording.path.parent_path().filename().string()
                                                             : recording.path.filename().string();
  Json about = Json::array();
  if (!options.command.empty()) about.push_back({"Command", options.command});
  about.push_back({"Recording", recording.path.string() + " (" + recording.format + ")"});
  about.push_back({"Odograph", std::string(odo_version())});
  for (const std::string& warning : recording.warnings) about.push_back({"Recording's flaw", warning});
  const Json data = {
      {"title", name},
      {"live", options.live},
      {"headline", runs.size() == 1 ? headline : std::to_string(runs.size()) + " runs of " + name},
      {"alignment", options.evaluation ? options.evaluation->alignment_text.c_str()
                    : metric           ? "a rotation about the vertical and a translation"
                                       : "a rotation, a translation and, for a track without metric scale, a scale"},
      {"axes", options.evaluation.has_value()},
      {"ground_m", kGround_m},
      {"camera", json_of(camera)},
      {"frames", pictures_of(recording, camera, options, t0_ns)},
      {"truth", truth_of(recording, from_ns, to_ns, t0_ns, options.evaluation.has_value())},
      {"waypoints", waypoints},
      {"about", about},
      {"runs", all}};
  return data.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string run_page(const Recording& recording, const std::vector<NamedRun>& runs, const PageOptions& options) {
  // In a script element, the data must not contain its end tag; in JSON, "<" occurs only in strings.
  std::string safe, page = kRunPageText;
  for (const char c : run_page_data(recording, runs, options))
    safe += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return page.replace(page.find("@DATA@"), 6, safe);
}

}  // namespace odograph
