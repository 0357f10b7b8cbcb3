// SPDX-License-Identifier: Apache-2.0
//
// Output files of a run.
#include <cmath>
#include <filesystem>
#include <functional>
#include <iomanip>
#include <optional>
#include <set>

#include <sys/resource.h>

#include <nlohmann/json.hpp>

#include "sdk/host/base/output_file.hpp"
#include "sdk/math/scalar.hpp"
#include "sdk/tools/replay/ply.hpp"
#include "sdk/tools/replay/runner.hpp"

namespace odograph {

double peak_rss_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

namespace {

void write_motions(std::ostream& out, const std::vector<odo_vo_motion>& motions) {
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

void write_steps(std::ostream& out, const std::vector<odo_step>& steps) {
  out << std::setprecision(9) << "t_start_ns,t_end_ns,length_m,sigma_m,frequency_hz,mode,heading_rad\n";
  for (const odo_step& s : steps)
    out << s.t_start_ns << ',' << s.t_end_ns << ',' << s.length_m << ',' << s.sigma_m << ',' << s.frequency_hz << ','
        << odo_mode_text(s.mode) << ',' << s.heading_rad << '\n';
}

void write_scales(std::ostream& out, const std::vector<odo_scale>& scales) {
  out << std::setprecision(9) << "t_ns,source,scale_m,sigma_m,used\n";
  for (const odo_scale& s : scales)
    out << s.header.t_ns << ',' << s.header.source << ',' << s.scale << ',' << s.sigma << ','
        << ((s.header.flags & ODO_FLAG_ACCEPTED) ? 1 : 0) << '\n';
}

void write_fixes(std::ostream& out, const std::vector<RunResult::Fix>& fixes) {
  out << std::setprecision(9) << "t_ns,source,kind,x_m,y_m,z_m,sigma_x_m,sigma_y_m,sigma_z_m,yaw_rad,accepted\n";
  for (const auto& [f, accepted] : fixes)
    out << f.header.t_ns << ',' << f.header.source << ','
        << ((f.header.flags & ODO_FIX_ORIENTATION) ? "pose"
            : (f.header.flags & ODO_FIX_YAW)       ? "yaw"
                                                   : "position")
        << ',' << f.p_n[0] << ',' << f.p_n[1] << ',' << f.p_n[2] << ',' << std::sqrt(f.covariance_n[0]) << ','
        << std::sqrt(f.covariance_n[4]) << ',' << std::sqrt(f.covariance_n[8]) << ',' << f.yaw_rad << ','
        << (accepted ? 1 : 0) << '\n';
}

void write_points(std::ostream& out, const std::vector<odo_map_point>& points) {
  write_ply_head(out, "metres: x north, y east, z down, as trajectory.tum", points.size(),
                 {"float x", "float y", "float z", "float sigma"});
  out << std::setprecision(7);
  for (const odo_map_point& p : points)
    out << p.p_n[0] << ' ' << p.p_n[1] << ' ' << p.p_n[2] << ' ' << p.sigma_m << '\n';
}

/// One row per change of the state or its reason.
void write_states(std::ostream& out, const RunResult& r) {
  out << "t_ns,state,reason\n";
  for (size_t i = 0; i < r.states.size() && i < r.reasons.size() && i < r.track.size(); ++i)
    if (i == 0 || r.states[i] != r.states[i - 1] || r.reasons[i] != r.reasons[i - 1])
      out << r.track[i].t_ns << ',' << odo_state_text(r.states[i]) << ','
          << (r.reasons[i] ? odo_reason_text(r.reasons[i]) : "") << '\n';
}

using Json = nlohmann::ordered_json;

Json json_of(const RecordingLoss& loss) {
  Json records = nullptr;  // unknown
  if (loss.file.records_lost) records = *loss.file.records_lost;
  if (!loss.file.any()) records = 0;
  return {{"records", records},           {"bytes", loss.file.bytes},  {"places", loss.file.places},
          {"cut_off", loss.file.cut},     {"pictures", loss.pictures}, {"wild_times", loss.times_out_of_range},
          {"impossible", loss.impossible}};
}

/// Outlines as trajectory.tum: metres, north, east, down.
Json json_of(const std::vector<RunResult::Patch>& patches) {
  Json rows = Json::array();
  for (const RunResult::Patch& patch : patches) {
    Json outline = Json::array();
    for (const Eigen::Vector3d& p : patch.outline_n) outline.push_back({p.x(), p.y(), p.z()});
    rows.push_back({{"id", patch.id}, {"kind", patch.kind}, {"sigma_m", patch.sigma_m}, {"outline_n", outline}});
  }
  return rows;
}

Json json_of(const std::vector<RunResult::Plugin>& plugins) {
  Json rows = Json::array();
  for (const auto& p : plugins)
    rows.push_back(
        {{"number", p.number}, {"kind", p.kind}, {"id", p.id}, {"version", p.version}, {"sha256", p.sha256}});
  return rows;
}

/// Sources of the metric scale of the last scale group; null if unknown.
Json json_of_scale(const odo_statistics& s) {
  if (s.scale_sigma == 0) return nullptr;
  return {{"sigma_percent", 100 * s.scale_sigma},
          {"by_inertia_percent", 100 * s.scale_by_inertia},
          {"by_steps_percent", 100 * s.scale_by_steps}};
}

/// Degrees and metres; null if the run had no origin.
Json json_of_origin(const RunResult& result) {
  if (!result.origin) return nullptr;
  const auto& [latitude_rad, longitude_rad, height_m] = *result.origin;
  return {{"latitude_deg", latitude_rad * kDeg_per_rad},
          {"longitude_deg", longitude_rad * kDeg_per_rad},
          {"height_m", height_m}};
}

/// Recognised places: a loop leads from a key frame of this session, a map pose from the frame of a map.
void write_places(std::ostream& out, const RunResult& result) {
  out << std::setprecision(9) << "t_ns,source,from,key_frame_ns,map,x_m,y_m,z_m,sigma_m,used\n";
  const auto row = [&](const odo_header& header, const char* from, int64_t key_frame_ns, uint64_t map, const double* p,
                       const double* covariance) {
    const double variance = std::max({covariance[21], covariance[28], covariance[35]});
    out << header.t_ns << ',' << header.source << ',' << from << ',' << key_frame_ns << ',' << map << ',' << p[0] << ','
        << p[1] << ',' << p[2] << ',' << std::sqrt(variance) << ',' << ((header.flags & ODO_FLAG_ACCEPTED) != 0)
        << '\n';
  };
  for (const odo_relative_pose& loop : result.loops)
    row(loop.header, "key_frame", loop.t_from_ns, 0, loop.p_b0_b1, loop.covariance);
  for (const odo_map_pose& place : result.map_poses)
    row(place.header, "map", 0, place.map, place.p_m_b, place.covariance);
}

template <class Message>
Json json_of_use(const std::vector<Message>& places) {
  const auto used = std::count_if(places.begin(), places.end(),
                                  [](const Message& place) { return (place.header.flags & ODO_FLAG_ACCEPTED) != 0; });
  return {{"accepted", used}, {"rejected", static_cast<int64_t>(places.size()) - used}};
}

Json summary_of(const Recording& recording, const RunResult& result, const RunOptions& options) {
  const odo_statistics& s = result.statistics;
  Json notices = Json::object();
  for (const auto& [key, notice] : result.notices) notices[key] = {{"count", notice.count}, {"text", notice.text}};
  return {
      {"recording", recording.path.string()},
      {"format", recording.format},
      {"distance_m", s.distance_m},
      {"steps", s.steps},
      {"scale", json_of_scale(s)},
      {"frames", s.frames},
      {"poses", result.track.size()},
      {"poses_before_scale", result.first_metric},
      {"origin", json_of_origin(result)},
      {"states_s", {{"tracking", s.tracking_s}, {"degraded", s.degraded_s}, {"lost", s.lost_s}}},
      {"final_state", odo_state_text(result.final_state)},
      {"final_reason", odo_reason_text(result.final_reason)},
      {"fixes", {{"accepted", s.fixes_accepted}, {"rejected", s.fixes_rejected}}},
      {"places",
       {{"key_frames", result.key_frames.size()},
        {"loops", json_of_use(result.loops)},
        {"map_poses", json_of_use(result.map_poses)}}},
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
      {"lost", json_of(result.loss)},
      {"warnings", recording.warnings},
      {"heading_offset_rad", result.heading_offset_rad},
      {"reports", result.reports},
      {"notices", notices},
      {"versions",
       {{"odograph", odo_version()},
        {"abi", std::to_string(odo_abi_version() >> 16) + "." + std::to_string(odo_abi_version() & 0xFFFF)}}},
      {"plugins", json_of(result.plugins)},
      {"seed", options.seed},
      {"config", result.config_text}};
}

/// The files of a run, written to temporary names until all are complete.
class RunFiles {
 public:
  explicit RunFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

  void add(const char* name, const std::function<void(std::ostream&)>& write) {
    auto file = OutputFile::create(folder_ / name);
    if (!file) {
      failure_ = file.failure();
      return;
    }
    write(file->stream());
    names_.insert(name);
    if (!file->stream().flush()) failure_ = full();
    files_.push_back(std::move(*file));
  }

  Result<bool> commit() {
    if (failure_) return *failure_;
    for (OutputFile& file : files_)
      if (const auto done = file.commit(); !done) return done.failure();
    std::error_code error;
    for (const char* stale : {"corrected.tum", "vo.csv", "places.csv", "points.ply", "surfaces.json", "report.html"})
      if (!names_.contains(stale)) std::filesystem::remove(folder_ / stale, error);
    return true;
  }

 private:
  Failure full() const { return {ODO_E_IO, folder_.string() + ": writing failed; is the disk full?"}; }

  std::filesystem::path folder_;
  std::vector<OutputFile> files_;
  std::set<std::string> names_;
  std::optional<Failure> failure_;
};

}  // namespace

Result<bool> write_run(const std::filesystem::path& folder, const Recording& recording, const RunResult& result,
                       const RunOptions& options) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Failure{ODO_E_IO, folder.string() + ": cannot be created: " + error.message()};
  RunFiles files(folder);
  const size_t from = result.first_metric < result.track.size() ? result.first_metric : 0;
  const auto add_track = [&](const char* name, const StampedPoses& track) {
    const StampedPoses known(track.begin() + static_cast<std::ptrdiff_t>(from), track.end());
    files.add(name, [&](std::ostream& out) { write_tum(out, known); });
  };
  add_track("trajectory.tum", result.track);
  if (!result.corrected.empty()) add_track("corrected.tum", result.corrected);
  files.add("steps.csv", [&](std::ostream& out) { write_steps(out, result.steps); });
  if (!result.motions.empty()) files.add("vo.csv", [&](std::ostream& out) { write_motions(out, result.motions); });
  files.add("scale.csv", [&](std::ostream& out) { write_scales(out, result.scales); });
  files.add("fixes.csv", [&](std::ostream& out) { write_fixes(out, result.fixes); });
  if (!result.loops.empty() || !result.map_poses.empty())
    files.add("places.csv", [&](std::ostream& out) { write_places(out, result); });
  files.add("states.csv", [&](std::ostream& out) { write_states(out, result); });
  if (!result.points.empty()) files.add("points.ply", [&](std::ostream& out) { write_points(out, result.points); });
  if (!result.patches.empty())
    files.add("surfaces.json", [&](std::ostream& out) { out << json_of(result.patches).dump(1) << '\n'; });
  files.add("summary.json", [&](std::ostream& out) {
    out << summary_of(recording, result, options).dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
  });
  return files.commit();
}

}  // namespace odograph
