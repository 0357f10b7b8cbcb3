// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/replay/runner.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <set>

#include "sdk/host/base/output_file.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/tools/replay/outcome.hpp"
#include "sdk/tools/replay/replayed.hpp"
#include "sdk/tools/replay/saved_files.hpp"

namespace odograph {
namespace {

constexpr uint64_t kMaxPicturesNamed = 5;
constexpr size_t kMaxReports = 100;

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// Processor time of the calling thread, without waiting and other programs.
double thread_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

/// Cost of a call: wall clock and processor time of the thread.
struct Work {
  double ms, thread_ms;
};
template <class Call>
Work work_of(Call&& call) {
  const auto start = std::chrono::steady_clock::now();
  const double thread_start = thread_ms();
  call();
  return {milliseconds_since(start), thread_ms() - thread_start};
}

/// Collects the session's events; must outlive the callback.
struct Collector {
  RunResult& result;
  bool collect_poses;
  double work_ms = 0, work_thread_ms = 0;  // since the last camera pose
  int64_t pushed_ns = 0;                   // time of the newest input
  /// From the old n to the new one, for the poses before `end`.
  struct Correction {
    size_t end;
    Eigen::Isometry3d n_new_n_old;
  };
  std::vector<Correction> corrections;
  std::vector<odo_key_frame> lived_frames;  // as first published
  size_t closed = 0;                        // corrections until the last loop, in key_frames already
  int64_t closed_ns = 0;

  static void on_event(void* user, const odo_header* event) { static_cast<Collector*>(user)->take(*event); }

  void take(const odo_header& event) {
    switch (event.type) {
      case ODO_TYPE_POSE: take_pose(as<odo_pose>(event)); break;
      case ODO_TYPE_STEP: result.steps.push_back(as<odo_step>(event)); break;
      case ODO_TYPE_MOTION_MODE: result.modes.push_back(as<odo_motion_mode>(event)); break;
      case ODO_TYPE_ATTITUDE: result.attitudes.push_back(as<odo_attitude>(event)); break;
      case ODO_TYPE_VO_MOTION:
        result.motions.push_back(as<odo_vo_motion>(event));
        result.motions_emitted_ns.push_back(std::max(pushed_ns, event.t_ns));
        break;
      case ODO_TYPE_CALIBRATION: result.refined.push_back(as<odo_calibration>(event)); break;
      case ODO_TYPE_SCALE: result.scales.push_back(as<odo_scale>(event)); break;
      case ODO_TYPE_FIX: result.fixes.push_back({as<odo_fix>(event), (event.flags & ODO_FLAG_ACCEPTED) != 0}); break;
      case ODO_TYPE_SURFACE: result.surfaces.push_back(as<odo_surface>(event)); break;
      case ODO_TYPE_KEY_FRAME: take_key_frame(as<odo_key_frame>(event)); break;
      case ODO_TYPE_RELATIVE_POSE: result.loops.push_back(as<odo_relative_pose>(event)); break;
      case ODO_TYPE_MAP_POSE: result.map_poses.push_back(as<odo_map_pose>(event)); break;
      case ODO_TYPE_CORRECTION: take_correction(as<odo_correction>(event)); break;
      case ODO_TYPE_REPORT: take_report(as<odo_report>(event)); break;
      case ODO_TYPE_STATE:
        result.final_state = as<odo_state>(event).state;
        result.final_reason = as<odo_state>(event).reason;
        break;
      default: break;
    }
  }

  /// A later message of a key frame has its corrected pose.
  void take_key_frame(const odo_key_frame& frame) {
    auto& all = result.key_frames;
    const auto found = std::find_if(all.begin(), all.end(), [&](const odo_key_frame& other) {
      return other.id == frame.id && other.header.source == frame.header.source;
    });
    if (found == all.end()) return all.push_back(frame), lived_frames.push_back(frame);
    *found = frame;
    closed = corrections.size();
    closed_ns = result.track.empty() ? 0 : result.track.back().t_ns;
  }

  /// Loops bend the track: each pose before the last one moves as the key frames before and after it have.
  void bend(StampedPoses& track) const {
    const auto pose_of = [](const odo_key_frame& frame) {
      return Eigen::Translation3d(frame.p_n_b[0], frame.p_n_b[1], frame.p_n_b[2]) * raw_quaternion(frame.q_n_b);
    };
    std::vector<std::pair<int64_t, Eigen::Isometry3d>> nodes;  // time, and how it has moved
    for (size_t i = 0; i < lived_frames.size() && lived_frames[i].header.t_ns < closed_ns; ++i)
      nodes.push_back({lived_frames[i].header.t_ns,
                       Eigen::Isometry3d(pose_of(result.key_frames[i]) * pose_of(lived_frames[i]).inverse())});
    nodes.push_back({closed_ns, Eigen::Isometry3d::Identity()});
    size_t next = 0;
    for (StampedPose& pose : track) {
      while (next < nodes.size() && nodes[next].first < pose.t_ns) ++next;
      if (next == nodes.size()) return;
      const auto& [after_ns, after] = nodes[next];
      const auto& [before_ns, before] = nodes[next > 0 ? next - 1 : 0];
      const double span = static_cast<double>(after_ns - before_ns);
      const double w = span > 0 ? static_cast<double>(pose.t_ns - before_ns) / span : 1;
      const Eigen::Quaterniond turned =
          Eigen::Quaterniond(before.linear()).slerp(w, Eigen::Quaterniond(after.linear()));
      pose.p = (1 - w) * (before * pose.p) + w * (after * pose.p);
      pose.q = (turned * pose.q).normalized();
    }
  }

  /// Collects warnings and errors, each text once; counts other reports of plugins.
  void take_report(const odo_report& report) {
    if (report.severity == ODO_SEVERITY_INFO) {
      auto& notice = result.notices[std::string(report.plugin) + ' ' + report.key];
      notice.count += report.count, notice.text = report.text;
      return;
    }
    const std::string text = std::string(report.plugin) + ": " + report.text;
    if (report.severity >= ODO_SEVERITY_WARNING && result.reports.size() < kMaxReports &&
        std::find(result.reports.begin(), result.reports.end(), text) == result.reports.end())
      result.reports.push_back(text);
  }

  void take_correction(const odo_correction& correction) {
    const Eigen::Translation3d p(correction.p_n[0], correction.p_n[1], correction.p_n[2]);
    corrections.push_back({result.track.size(), p * raw_quaternion(correction.q_n)});
  }

  /// Each pose, moved by all later corrections: rigidly, so that a change of scale does not alter the past. Empty if no
  /// correction followed the first metric pose.
  StampedPoses corrected() const {
    if (corrections.empty() || corrections.back().end <= result.first_metric) return {};
    StampedPoses track = result.track;
    if (!result.key_frames.empty() && closed > 0) bend(track);
    Eigen::Isometry3d since = Eigen::Isometry3d::Identity();
    auto next = corrections.rbegin();
    for (size_t i = track.size(); i-- > 0;) {
      for (; next != corrections.rend() - static_cast<std::ptrdiff_t>(closed) && next->end > i; ++next)
        since = since * next->n_new_n_old;
      track[i].q = (Eigen::Quaterniond(since.linear()) * track[i].q).normalized();
      track[i].p = since * track[i].p;
    }
    return track;
  }

  void take(const Work& work) { work_ms += work.ms, work_thread_ms += work.thread_ms; }

  void take_pose(const odo_pose& pose) {
    if (collect_poses) result.poses.push_back(pose);
    const StampedPose x{pose.header.t_ns, raw_quaternion(pose.q_n), Eigen::Vector3d(pose.p_n)};
    if (!result.track.empty() && result.track.back().t_ns >= x.t_ns) {  // a fix corrected the newest pose
      result.track.back() = x;
      for (size_t i = corrections.size(); i > 0 && corrections[i - 1].end == result.track.size(); --i)
        --corrections[i - 1].end;
      return;
    }
    const bool none_metric = result.first_metric == result.track.size();
    result.track.push_back(x);
    result.states.push_back(pose.state), result.reasons.push_back(pose.reason);
    const bool stands = pose.reason == ODO_REASON_INITIALISING || pose.reason == ODO_REASON_NO_SCALE;
    if (none_metric && (stands || !(pose.header.flags & ODO_POSE_METRIC))) result.first_metric = result.track.size();
    if (pose.header.flags & ODO_POSE_CAMERA) {
      result.frame_ms.push_back(work_ms);
      result.frame_thread_ms.push_back(work_thread_ms);
      work_ms = work_thread_ms = 0;
    }
  }
};

/// Pushes all messages; `pictures`: a plugin uses them.
void push_all(odo_session* session, const Recording& recording, const RunOptions& options, bool pictures,
              Collector& collector, RunResult& result) {
  size_t done = 0;
  for (const RecordedMessage& message : recording.messages) {
    const bool is_frame = message.message.header().type == ODO_TYPE_FRAME;
    collector.pushed_ns = message.message.header().t_ns;
    if (is_frame && !pictures) {
      ++done;
      continue;  // not decoded
    }
    if (is_frame) {
      const auto frame = load_frame(message);
      ++done;
      if (!frame) {  // costs this frame
        if (result.loss.pictures++ < kMaxPicturesNamed) result.reports.push_back(frame.failure().text);
        continue;
      }
      collector.take(work_of([&] { odo_session_push(session, &frame->header); }));
      frame->loan.release(frame->loan.owner);
      if (options.so_far) options.so_far(result);
      if (options.at_frame) options.at_frame(session, result);
    } else {
      const Work work = work_of([&] { odo_session_push(session, &message.message.header()); });
      collector.take(work);
      if (options.collect_timing && message.message.header().type == ODO_TYPE_IMU)
        result.imu_us.push_back(work.ms * 1e3);
    }
    if (!is_frame) ++done;
    if (options.progress && (done % 64 == 0 || is_frame)) options.progress(done, recording.messages.size());
  }
}

std::vector<odo_map_point> points_of(odo_session* session) {
  std::vector<odo_map_point> points(ODO_MOST_MAP_POINTS);
  points[0].struct_size = sizeof points[0];
  const int64_t count = odo_session_get_points(session, ODO_WORLD_CORRECTED, points.data(), points.size());
  points.resize(static_cast<size_t>(std::clamp<int64_t>(count, 0, ODO_MOST_MAP_POINTS)));
  return points;
}

std::vector<RunResult::Patch> patches_of(odo_session* session) {
  std::vector<uint64_t> ids(static_cast<size_t>(std::max<int64_t>(0, odo_surface_list(session, nullptr, 0))));
  odo_surface_list(session, ids.data(), ids.size());
  std::vector<RunResult::Patch> patches;
  for (const uint64_t id : ids) {
    alignas(8) char bytes[ODO_LARGEST_SURFACE];
    auto& surface = *reinterpret_cast<odo_surface*>(bytes);
    surface.header.struct_size = sizeof bytes;
    if (odo_surface_get(session, id, ODO_WORLD_CORRECTED, &surface) != ODO_OK) continue;
    const char* kind = surface.kind == ODO_SURFACE_FLOOR        ? "floor"
                       : surface.kind == ODO_SURFACE_HORIZONTAL ? "horizontal"
                       : surface.kind == ODO_SURFACE_VERTICAL   ? "vertical"
                                                                : "other";
    RunResult::Patch& patch = patches.emplace_back(RunResult::Patch{id, kind, surface.sigma_m, {}});
    const Eigen::Quaterniond q = quaternion(surface.q_n);
    for (uint32_t i = 0; const odo_vertex* v = ODO_VERTEX_AT(&surface, i); ++i)
      patch.outline_n.emplace_back(Eigen::Vector3d(surface.p_n) + q * Eigen::Vector3d(v->p[0], v->p[1], 0));
  }
  return patches;
}

/// Aligns the track with the recording's waypoints, as the config's replay section requests.
void align_tracks(const ReplayConfig& replay, const Recording& recording, RunResult& result) {
  const auto waypoints = recording.waypoints();
  if (!replay.start_at_first_waypoint || waypoints.empty() || result.track.empty()) return;
  if (replay.align_heading_over_m > 0)
    result.heading_offset_rad = heading_offset(result.track, waypoints, replay.align_heading_over_m);
  const Eigen::Vector3d before = result.track[0].p;
  result.track = align_to_waypoints(result.track, waypoints, result.heading_offset_rad);
  const Eigen::AngleAxisd turn(result.heading_offset_rad, Eigen::Vector3d::UnitZ());
  const auto moved = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    return result.track[0].p + turn * (p - before);
  };
  for (odo_map_point& point : result.points) Eigen::Vector3d::Map(point.p_n) = moved(Eigen::Vector3d(point.p_n));
  for (RunResult::Patch& patch : result.patches)
    for (Eigen::Vector3d& p : patch.outline_n) p = moved(p);
  if (!result.corrected.empty())
    result.corrected = align_to_waypoints(result.corrected, waypoints, result.heading_offset_rad);
  for (odo_step& step : result.steps)
    step.heading_rad = std::remainder(step.heading_rad + result.heading_offset_rad, 2 * EIGEN_PI);
}

/// In the order of their instance numbers.
std::vector<RunResult::Plugin> plugins_of(const PipelineConfig& config) {
  std::vector<RunResult::Plugin> plugins;
  config.visit_plugins([&](const PluginChoice& choice) {
    const std::string& id = choice.interface_id;  // odo.KIND/1
    plugins.push_back({static_cast<uint32_t>(plugins.size() + 1), id.substr(4, id.find('/') - 4), choice.manifest.id,
                       choice.manifest.version, choice.manifest.sha256});
  });
  return plugins;
}

/// Notes the plugins that gave nothing in the whole run, as the host notes those whose input does not come.
void name_unused(RunResult& result) {
  std::set<uint32_t> gave, maps;
  for (const odo_key_frame& frame : result.key_frames) maps.insert(frame.header.source);
  const auto add = [&](const odo_header& header) { gave.insert(header.source); };
  for (const odo_step& step : result.steps) add(step.header);
  for (const odo_vo_motion& motion : result.motions) add(motion.header);
  for (const odo_scale& scale : result.scales) add(scale.header);
  for (const RunResult::Fix& fix : result.fixes) add(fix.fix.header);
  for (const odo_surface& surface : result.surfaces) add(surface.header);
  for (const odo_relative_pose& loop : result.loops) add(loop.header);
  for (const odo_map_pose& place : result.map_poses) add(place.header);
  for (const RunResult::Plugin& plugin : result.plugins)
    if (plugin.kind != "attitude" && !gave.contains(plugin.number))
      result.notices.try_emplace(
          plugin.id + " unused_source",
          RunResult::Notice{1, maps.contains(plugin.number) ? "no effect: no place was seen again; its map can be kept"
                                                            : "no effect: it has given nothing"});
}

}  // namespace

Result<RunResult> replay(const Recording& recording, const RunOptions& options) {
  // The config is read a second time for its replay section, which the session ignores.
  const auto config = config_of(options);
  if (!config) return config.failure();
  if (!config->vo_frontends.empty() && recording.has(ODO_TYPE_FRAME) && !recording.has(ODO_TYPE_CALIBRATION) &&
      !config->camera)
    return Failure{ODO_E_DATA,
                   recording.path.string() +
                       ": pictures without a lens: neither the recording nor the config's 'camera:' has one"};
  auto opened = replay_session(options);
  if (!opened) return Failure{ODO_E_ERROR, opened.failure().text};  // the config was valid, so a plugin failed
  const std::shared_ptr<odo_session> shared = std::move(*opened);
  odo_session* session = shared.get();

  if (const auto read = read_saved(session, kStateFile, options.state); !read) return read.failure();
  if (const auto read = read_saved(session, kMapFile, options.map); !read) return read.failure();

  RunResult result;
  result.config_text = config->text;
  result.plugins = plugins_of(*config);
  result.loss = recording.loss;
  if (options.keep_session) result.session = shared;
  Collector collector{result, options.collect_poses};
  std::vector<uint32_t> wanted = {ODO_TYPE_POSE,          ODO_TYPE_VO_MOTION,  ODO_TYPE_STEP,    ODO_TYPE_MOTION_MODE,
                                  ODO_TYPE_SCALE,         ODO_TYPE_FIX,        ODO_TYPE_STATE,   ODO_TYPE_CALIBRATION,
                                  ODO_TYPE_REPORT,        ODO_TYPE_CORRECTION, ODO_TYPE_SURFACE, ODO_TYPE_KEY_FRAME,
                                  ODO_TYPE_RELATIVE_POSE, ODO_TYPE_MAP_POSE};
  if (options.collect_attitudes) wanted.push_back(ODO_TYPE_ATTITUDE);
  odo_session_set_callback(session, wanted.data(), static_cast<uint32_t>(wanted.size()), Collector::on_event,
                           &collector);
  const bool pictures = !config->vo_frontends.empty() || !config->fixers.empty();
  push_all(session, recording, options, pictures, collector, result);
  odo_session_flush(session);
  if (result.loss.pictures > 0)
    result.reports.push_back(std::to_string(result.loss.pictures) + " pictures cannot be read; each cost its frame");
  for (const auto& [saved, path] : {std::pair(&kStateFile, &options.state), std::pair(&kMapFile, &options.map)})
    if (const auto written = write_saved(session, *saved, *path); !written)
      result.save_failures.push_back(written.failure().text);
  odo_session_flush(session);                                       // what saving has reported
  odo_session_set_callback(session, nullptr, 0, nullptr, nullptr);  // the collector's lifetime ends here
  result.statistics.struct_size = sizeof result.statistics;
  odo_session_get_statistics(session, &result.statistics);
  if (options.progress) options.progress(recording.messages.size(), recording.messages.size());
  const double p_n[3] = {0, 0, 0};
  std::array<double, 3> origin{};
  if (odo_session_to_geodetic(session, p_n, origin.data()) == ODO_OK) result.origin = origin;
  result.points = points_of(session);
  result.patches = patches_of(session);

  result.corrected = collector.corrected();
  align_tracks(config->replay, recording, result);
  name_unused(result);
  result.nothing = why_nothing(recording, *config, result);
  if (!result.nothing.empty()) result.reports.push_back("the run came to nothing: " + result.nothing);
  return result;
}

}  // namespace odograph
