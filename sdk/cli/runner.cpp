// SPDX-License-Identifier: Apache-2.0
#include "sdk/cli/runner.hpp"

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <chrono>
#include <cstring>
#include <fstream>
#include <iomanip>

#include <sys/resource.h>

#include <nlohmann/json.hpp>

#include "sdk/config/pipeline_config.hpp"

namespace odograph {
namespace {

struct SessionDeleter {
  void operator()(odo_session* session) const { odo_session_destroy(session); }
};
using SessionPtr = std::unique_ptr<odo_session, SessionDeleter>;

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// Collects events of the session; lives as long as the callback is set.
struct Collector {
  RunResult& result;
  double work_ms = 0;     // since the last camera pose
  int64_t pushed_ns = 0;  // time of the newest input

  static void on_event(void* user, const odo_header* event) { static_cast<Collector*>(user)->take(*event); }

  void take(const odo_header& event) {
    switch (event.type) {
      case ODO_TYPE_POSE: take_pose(as<odo_pose>(event)); break;
      case ODO_TYPE_STEP: result.steps.push_back(as<odo_step>(event)); break;
      case ODO_TYPE_MOTION_MODE: result.modes.push_back(as<odo_motion_mode>(event)); break;
      case ODO_TYPE_ATTITUDE: result.attitudes.push_back(as<odo_attitude>(event)); break;
      case ODO_TYPE_VO_MOTION:
        result.motions.push_back(as<odo_vo_motion>(event));
        result.motions_known_ns.push_back(std::max(pushed_ns, event.t_ns));
        break;
      case ODO_TYPE_CALIBRATION: result.refined.push_back(as<odo_calibration>(event)); break;
      case ODO_TYPE_SCALE: result.scales.push_back(as<odo_scale>(event)); break;
      case ODO_TYPE_FIX: result.fixes.push_back({as<odo_fix>(event), (event.flags & ODO_FIX_ACCEPTED) != 0}); break;
      case ODO_TYPE_REPORT: take_report(as<odo_report>(event)); break;
      case ODO_TYPE_STATE:
        result.final_state = as<odo_state>(event).state;
        result.final_reason = as<odo_state>(event).reason;
        break;
      default: break;
    }
  }

  void take_report(const odo_report& report) {
    if (report.severity != ODO_SEVERITY_INFO) return;
    auto& notice = result.notices[std::string(report.plugin) + ' ' + report.key];
    notice.count += report.count, notice.text = report.text;
  }

  void take_pose(const odo_pose& pose) {
    const StampedPose x{
        pose.header.t_ns, {pose.q_n[0], pose.q_n[1], pose.q_n[2], pose.q_n[3]}, Eigen::Vector3d(pose.p_n)};
    if (!result.track.empty() && result.track.back().t_ns >= x.t_ns) {  // a fix corrected the latest pose
      result.track.back() = x;
      return;
    }
    result.track.push_back(x);
    result.states.push_back(pose.state);
    if (pose.header.flags & ODO_POSE_CAMERA) {
      result.frame_ms.push_back(work_ms);
      work_ms = 0;
    }
  }
};

Result<SessionPtr> open_session(const RunOptions& options) {
  odo_session_options o{};
  o.struct_size = sizeof o;
  o.run = ODO_RUN_REPLAY;
  o.config_path = {options.config.data(), options.config.size()};
  o.plugin_path = {options.plugin_path.data(), options.plugin_path.size()};
  o.seed = options.seed;
  o.asset_path = {options.asset_path.data(), options.asset_path.size()};
  odo_error error{};
  error.struct_size = sizeof error;
  odo_session* session = nullptr;
  const int32_t status = odo_session_create(&o, &session, &error);
  if (status != ODO_OK) return Failure{status, error.message};
  return SessionPtr(session);
}

/// Gives the session what a file holds; a file that is not there yet is none.
Result<bool> read_state(odo_session* session, const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return true;
  std::stringstream bytes;
  bytes << file.rdbuf();
  const std::string blob = bytes.str();
  if (odo_session_load(session, blob.data(), blob.size()) == ODO_OK) return true;
  odo_error error{};
  error.struct_size = sizeof error;
  odo_session_last_error(session, &error);
  return Failure{ODO_E_DATA, path + ": " + error.message};
}

/// Beside the file first: what was there stays whole if this does not come to its end.
Result<bool> write_state(odo_session* session, const std::string& path) {
  std::string blob(static_cast<size_t>(std::max<int64_t>(0, odo_session_save(session, nullptr, 0))), '\0');
  odo_session_save(session, blob.data(), blob.size());
  const std::string beside = path + ".new";
  std::ofstream file(beside, std::ios::binary);
  file << blob;
  file.close();
  std::error_code error;
  if (file) std::filesystem::rename(beside, path, error);
  if (!file || error) return Failure{ODO_E_NOT_FOUND, path + ": cannot be written"};
  return true;
}

void note_error(odo_session* session, RunResult& result) {
  odo_error error{};
  error.struct_size = sizeof error;
  if (odo_session_last_error(session, &error) != ODO_OK && result.reports.size() < 100 &&
      std::find(result.reports.begin(), result.reports.end(), error.message) == result.reports.end())
    result.reports.emplace_back(error.message);
}

}  // namespace

Result<RunResult> replay(const Recording& recording, const RunOptions& options) {
  // The config is read once more than the session does, for the replay section, which is not the session's business.
  std::vector<std::filesystem::path> directories;
  if (!options.plugin_path.empty()) directories.emplace_back(options.plugin_path);
  const auto config = read_pipeline_config_file(options.config, directories);
  if (!config) return config.failure();
  auto opened = open_session(options);
  if (!opened) return Failure{ODO_E_ERROR, opened.failure().text};  // the config was good: it is a plugin
  odo_session* session = opened->get();

  if (!options.state.empty())
    if (const auto read = read_state(session, options.state); !read) return read.failure();

  RunResult result;
  result.config_text = config->text;
  Collector collector{result};
  std::vector<uint32_t> wanted = {ODO_TYPE_POSE,        ODO_TYPE_VO_MOTION,   ODO_TYPE_STEP,
                                  ODO_TYPE_MOTION_MODE, ODO_TYPE_SCALE,       ODO_TYPE_FIX,
                                  ODO_TYPE_STATE,       ODO_TYPE_CALIBRATION, ODO_TYPE_REPORT};
  if (options.collect_attitudes) wanted.push_back(ODO_TYPE_ATTITUDE);
  odo_session_set_callback(session, wanted.data(), static_cast<uint32_t>(wanted.size()), Collector::on_event,
                           &collector);
  size_t done = 0;
  for (const RecordedMessage& message : recording.messages) {
    const bool is_frame = message.message.header().type == ODO_TYPE_FRAME;
    collector.pushed_ns = message.message.header().t_ns;
    if (is_frame && config->vo_frontends.empty() && config->fixers.empty()) {
      ++done;
      continue;  // nobody looks at it: do not decode it
    }
    int32_t status;
    if (is_frame) {
      const auto frame = load_frame(message);
      if (!frame) return frame.failure();
      const auto start = std::chrono::steady_clock::now();
      status = odo_session_push(session, &frame->header);
      collector.work_ms += milliseconds_since(start);
      frame->release(&*frame);
    } else {
      const auto start = std::chrono::steady_clock::now();
      status = odo_session_push(session, &message.message.header());
      const double ms = milliseconds_since(start);
      collector.work_ms += ms;
      if (options.collect_timing && message.message.header().type == ODO_TYPE_IMU) result.imu_us.push_back(ms * 1e3);
    }
    if (status < 0) note_error(session, result);
    ++done;
    if (options.progress && (done % 64 == 0 || is_frame)) options.progress(done, recording.messages.size());
  }
  odo_session_flush(session);
  note_error(session, result);
  if (!options.state.empty())
    if (const auto written = write_state(session, options.state); !written) return written.failure();
  result.statistics.struct_size = sizeof result.statistics;
  odo_session_get_statistics(session, &result.statistics);
  if (options.progress) options.progress(recording.messages.size(), recording.messages.size());

  const auto waypoints = recording.waypoints();
  if (config->replay.start_at_first_waypoint && !waypoints.empty() && !result.track.empty()) {
    if (config->replay.align_heading_over_m > 0)
      result.heading_turn_rad = heading_offset(result.track, waypoints, config->replay.align_heading_over_m);
    result.track = lay_over(result.track, waypoints, result.heading_turn_rad);
    for (odo_step& step : result.steps)
      step.heading_rad = std::remainder(step.heading_rad + result.heading_turn_rad, 2 * EIGEN_PI);
  }
  return result;
}

double peak_rss_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

namespace {

void write_motions(const std::filesystem::path& file, const std::vector<odo_vo_motion>& motions) {
  if (motions.empty()) return;
  std::ofstream out(file);
  out << std::setprecision(9) << "t_from_ns,t_ns,state,reason,scale_group,tracked,inliers,qw,qx,qy,qz,x,y,z,"
      << "sigma_rotation_rad,sigma_position\n";
  for (const odo_vo_motion& m : motions) {
    const double* c = m.covariance;
    out << m.t_from_ns << ',' << m.header.t_ns << ',' << m.state << ',' << m.reason << ',' << m.scale_group << ','
        << m.tracked << ',' << m.inliers;
    for (const double q : m.q_c0_c1) out << ',' << q;
    for (const double p : m.p_c0_c1) out << ',' << p;
    out << ',' << std::sqrt((c[0] + c[7] + c[14]) / 3) << ',' << std::sqrt((c[21] + c[28] + c[35]) / 3) << '\n';
  }
}

}  // namespace

Result<bool> write_run(const std::filesystem::path& folder, const Recording& recording, const RunResult& result,
                       const RunOptions& options) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Failure{ODO_E_NOT_FOUND, folder.string() + ": cannot be created: " + error.message()};
  const auto track = write_trajectory(folder / "trajectory.tum", result.track, nullptr);
  if (!track) return track.failure();

  std::ofstream steps(folder / "steps.csv"), scales(folder / "scale.csv"), fixes(folder / "fixes.csv");
  steps << std::setprecision(9) << "t_start_ns,t_end_ns,length_m,sigma_m,frequency_hz,mode,heading_rad\n";
  for (const odo_step& s : result.steps)
    steps << s.t_start_ns << ',' << s.t_end_ns << ',' << s.length_m << ',' << s.sigma_m << ',' << s.frequency_hz << ','
          << odo_mode_text(s.mode) << ',' << s.heading_rad << '\n';
  write_motions(folder / "vo.csv", result.motions);
  scales << std::setprecision(9) << "t_ns,source,scale_m,sigma_m,used\n";
  for (const odo_scale& s : result.scales)
    scales << s.header.t_ns << ',' << s.header.source << ',' << s.metres_per_unit << ',' << s.sigma << ",1\n";
  fixes << std::setprecision(9) << "t_ns,source,kind,x_m,y_m,z_m,sigma_x_m,sigma_y_m,sigma_z_m,yaw_rad,accepted\n";
  for (const auto& [f, accepted] : result.fixes)
    fixes << f.header.t_ns << ',' << f.header.source << ','
          << ((f.header.flags & ODO_FIX_ORIENTATION) ? "pose"
              : (f.header.flags & ODO_FIX_YAW)       ? "yaw"
                                                     : "position")
          << ',' << f.p_n[0] << ',' << f.p_n[1] << ',' << f.p_n[2] << ',' << std::sqrt(f.covariance_n[0]) << ','
          << std::sqrt(f.covariance_n[4]) << ',' << std::sqrt(f.covariance_n[8]) << ',' << f.yaw_rad << ','
          << (accepted ? 1 : 0) << '\n';

  const odo_statistics& s = result.statistics;
  nlohmann::ordered_json notices = nlohmann::json::object();
  for (const auto& [key, notice] : result.notices) notices[key] = {{"count", notice.count}, {"text", notice.text}};
  const nlohmann::ordered_json summary = {
      {"recording", recording.path.string()},
      {"format", recording.format},
      {"distance_m", s.distance_m},
      {"steps", s.steps},
      {"frames", s.frames},
      {"poses", result.track.size()},
      {"states_s", {{"tracking", s.tracking_s}, {"degraded", s.degraded_s}, {"lost", s.lost_s}}},
      {"final_state", odo_state_text(result.final_state)},
      {"final_reason", odo_reason_text(result.final_reason)},
      {"fixes", {{"accepted", s.fixes_accepted}, {"rejected", s.fixes_rejected}}},
      {"timing_ms",
       {{"frame", {{"median", percentile(result.frame_ms, 0.5)}, {"p99", percentile(result.frame_ms, 0.99)}}}}},
      {"timing_us", {{"imu", {{"median", percentile(result.imu_us, 0.5)}, {"p99", percentile(result.imu_us, 0.99)}}}}},
      {"peak_rss_mb", peak_rss_mb()},
      {"faults",
       {{"late", s.late},
        {"duplicate", s.duplicate},
        {"invalid", s.invalid},
        {"overflow", s.overflow},
        {"wild", s.wild},
        {"events_dropped", s.events_dropped},
        {"gaps", s.gaps},
        {"plugin", s.plugin_faults}}},
      {"heading_turn_rad", result.heading_turn_rad},
      {"reports", result.reports},
      {"notices", notices},
      {"versions",
       {{"odograph", odo_version()},
        {"abi", std::to_string(odo_abi_version() >> 16) + "." + std::to_string(odo_abi_version() & 0xFFFF)}}},
      {"seed", options.seed},
      {"config", result.config_text}};
  std::ofstream file(folder / "summary.json");
  file << summary.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
  if (!steps.flush() || !scales.flush() || !fixes.flush() || !file.flush())
    return Failure{ODO_E_NOT_FOUND, folder.string() + ": writing failed; is the disk full?"};
  return true;
}

}  // namespace odograph
