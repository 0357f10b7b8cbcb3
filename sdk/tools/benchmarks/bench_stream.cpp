// SPDX-License-Identifier: Apache-2.0
//
// The pose stream that an app draws with, in simulated time: `odograph bench stream`.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/console/console.hpp"
#include "sdk/tools/replay/arrivals.hpp"
#include "sdk/tools/replay/kept_recordings.hpp"
#include "sdk/tools/replay/replayed.hpp"
#include "sdk/tools/replay/runner.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Eigen::Quaterniond;
using Eigen::Vector3d;

struct StreamArguments {
  RecordingChoice choice;
  std::string config = "samples/configs/walk.yaml";
  double ahead_ms = 30, poll_hz = 60, accel_hz = 104, imu_late_ms = 3, frame_late_ms = 45, settle_s = 8;
  bool json = false;
};

struct Poll {
  int64_t t_ns;
  odo_pose pose, smooth;
};

struct Stream {
  std::map<int64_t, odo_pose> poses;  // the pipeline's own, as last corrected
  std::vector<odo_correction> corrections;
  std::vector<Poll> polls;  // at the rate of the screen
  std::vector<Poll> early;  // each for the time of a frame that comes later
  std::vector<double> poll_us, statistics_us;
};

void on_event(void* user, const odo_header* event) {
  auto& stream = *static_cast<Stream*>(user);
  if (event->type == ODO_TYPE_POSE) stream.poses[event->t_ns] = as<odo_pose>(*event);
  if (event->type == ODO_TYPE_CORRECTION) stream.corrections.push_back(as<odo_correction>(*event));
}

double microseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
}

/// `timed` gets how long the calls took.
void poll(odo_session* session, int64_t t_ns, std::vector<Poll>& to, Stream* timed) {
  Poll poll{t_ns, {}, {}};
  poll.pose.header.struct_size = poll.smooth.header.struct_size = sizeof(odo_pose);
  auto start = std::chrono::steady_clock::now();
  if (odo_session_get_pose(session, t_ns, &poll.pose) != ODO_OK) return;
  if (timed) {
    timed->poll_us.push_back(microseconds_since(start));
    odo_statistics statistics{};
    statistics.struct_size = sizeof statistics;
    start = std::chrono::steady_clock::now();
    odo_session_get_statistics(session, &statistics);
    timed->statistics_us.push_back(microseconds_since(start));
  }
  if (odo_session_get_smooth_pose(session, t_ns, &poll.smooth) == ODO_OK) to.push_back(poll);
}

Result<Stream> run_stream(const Recording& recording, const StreamArguments& a) {
  const auto session = replay_session(a.config);
  if (!session) return session.failure();
  odo_session* raw = session->get();
  Stream stream;
  const uint32_t wanted[] = {ODO_TYPE_POSE, ODO_TYPE_CORRECTION};
  odo_session_set_callback(raw, wanted, 2, on_event, &stream);

  const auto arrivals = arrivals_of(recording, {a.accel_hz, a.imu_late_ms, a.frame_late_ms});
  const auto ahead_ns = static_cast<int64_t>(a.ahead_ms * 1e6);
  std::vector<int64_t> frames;  // when to ask for the pose at a frame's time
  for (const RecordedMessage& message : recording.messages)
    if (message.message.header().type == ODO_TYPE_FRAME) frames.push_back(message.message.header().t_ns - ahead_ns);
  size_t frame = 0;
  int64_t screen_ns = arrivals.empty() ? 0 : arrivals.front().at_ns;
  for (const Arrival& arrival : arrivals) {
    for (; screen_ns < arrival.at_ns; screen_ns += static_cast<int64_t>(1e9 / a.poll_hz))
      poll(raw, screen_ns + ahead_ns, stream.polls, &stream);
    for (; frame < frames.size() && frames[frame] < arrival.at_ns; ++frame)
      poll(raw, frames[frame] + ahead_ns, stream.early, nullptr);
    if (!arrival.other)
      odo_session_push(raw, &arrival.imu.header);
    else if (const auto failure = push(raw, *arrival.other))
      return *failure;
  }
  odo_session_flush(raw);
  return stream;
}

double angle_deg(const odo_pose& a, const odo_pose& b) {
  return Quaterniond(a.q_n[0], a.q_n[1], a.q_n[2], a.q_n[3])
             .angularDistance(Quaterniond(b.q_n[0], b.q_n[1], b.q_n[2], b.q_n[3])) *
         180 / EIGEN_PI;
}

Vector3d position(const odo_pose& pose) { return Vector3d(pose.p_n); }

/// How far a track's step from one poll to the next differs from the truth's in length, m.
double step_beyond(const Vector3d& step, const Trajectory& truth, int64_t from_ns, int64_t to_ns) {
  const auto at = [&](int64_t t_ns) {
    const auto later = std::lower_bound(truth.begin(), truth.end(), t_ns,
                                        [](const StampedPose& pose, int64_t t) { return pose.t_ns < t; });
    if (later == truth.begin() || later == truth.end()) return truth.empty() ? Vector3d(0, 0, 0) : truth.front().p;
    const StampedPose &a = *std::prev(later), &b = *later;
    const double w = static_cast<double>(t_ns - a.t_ns) / static_cast<double>(b.t_ns - a.t_ns);
    return Vector3d(a.p + w * (b.p - a.p));
  };
  return step.norm() - (at(to_ns) - at(from_ns)).norm();
}

Json figures_of(const Stream& stream, const Recording& recording, const StreamArguments& a) {
  const int64_t start_ns = recording.messages.front().message.header().t_ns + static_cast<int64_t>(a.settle_s * 1e9);
  std::vector<double> degrees, metres;
  size_t without_position = 0, repeated = 0, asked = 0;
  for (const Poll& p : stream.early) {
    const auto later = stream.poses.find(p.t_ns);
    if (p.t_ns < start_ns || later == stream.poses.end()) continue;
    ++asked;
    degrees.push_back(angle_deg(p.pose, later->second));
    if (p.pose.header.flags & ODO_POSE_POSITION)
      metres.push_back((position(p.pose) - position(later->second)).norm());
    else
      ++without_position;
  }
  double jump_m = 0, smooth_jump_m = 0;
  for (size_t i = 1; i < stream.polls.size(); ++i) {
    const Poll &a0 = stream.polls[i - 1], &a1 = stream.polls[i];
    if (angle_deg(a0.pose, a1.pose) == 0 && a1.t_ns > start_ns) ++repeated;
    if ((a0.pose.header.flags & a1.pose.header.flags & ODO_POSE_POSITION) == 0) continue;
    const auto beyond = [&](const odo_pose& from, const odo_pose& to) {
      return step_beyond(position(to) - position(from), recording.truth, a0.t_ns, a1.t_ns);
    };
    jump_m = std::max(jump_m, beyond(a0.pose, a1.pose));
    smooth_jump_m = std::max(smooth_jump_m, beyond(a0.smooth, a1.smooth));
  }
  if (degrees.empty()) degrees.push_back(std::nan(""));
  if (metres.empty()) metres.push_back(std::nan(""));
  return {{"frames", asked},
          {"orientation_deg_median", percentile(degrees, 0.5)},
          {"orientation_deg_p99", percentile(degrees, 0.99)},
          {"position_mm_median", 1e3 * percentile(metres, 0.5)},
          {"position_mm_p99", 1e3 * percentile(metres, 0.99)},
          {"without_position", without_position},
          {"repeated", repeated},
          {"corrections", stream.corrections.size()},
          {"jump_cm", 100 * jump_m},
          {"smooth_jump_cm", 100 * smooth_jump_m},
          {"get_pose_us_median", percentile(stream.poll_us, 0.5)},
          {"get_pose_us_p99", percentile(stream.poll_us, 0.99)},
          {"get_statistics_us_p99", percentile(stream.statistics_us, 0.99)}};
}

int bench_stream(const StreamArguments& a) {
  const auto files = a.choice.files();
  if (!files) return complain(files.failure());
  Json rows = Json::array();
  if (!a.json)
    std::printf(
        "%-30s %7s %15s %15s %9s %8s %11s %8s %8s %13s %10s\n%-30s %7s %15s %15s %9s %8s %11s %8s %8s %13s %10s\n",
        "recording", "frames", "orientation deg", "position mm", "no", "repeated", "corrections", "jump", "smooth",
        "get_pose us", "statistics", "", "", "median    99 %", "median    99 %", "position", "polls", "", "cm", "cm",
        "median   99 %", "us, 99 %");
  for (const fs::path& file : *files) {
    const auto recording = open_recording(file);
    if (!recording) return complain(recording.failure());
    const auto stream = run_stream(*recording, a);
    if (!stream) return complain(stream.failure());
    Json row = {{"recording", file.stem().string()}, {"config", a.config}};
    row.update(figures_of(*stream, *recording, a));
    rows.push_back(row);
    const auto value = [&](const char* key) { return row[key].is_null() ? std::nan("") : row[key].get<double>(); };
    if (!a.json)
      std::printf("%-30s %7.0f %7.2f %7.2f %7.1f %7.1f %9.0f %8.0f %11.0f %8.1f %8.1f %6.2f %6.2f %10.2f\n",
                  file.stem().string().substr(0, 30).c_str(), value("frames"), value("orientation_deg_median"),
                  value("orientation_deg_p99"), value("position_mm_median"), value("position_mm_p99"),
                  value("without_position"), value("repeated"), value("corrections"), value("jump_cm"),
                  value("smooth_jump_cm"), value("get_pose_us_median"), value("get_pose_us_p99"),
                  value("get_statistics_us_p99"));
  }
  if (a.json) {
    std::printf("%s\n", rows.dump(2).c_str());
    return kDone;
  }
  std::printf(
      "\nPoses asked %.0f ms ahead, against the pipeline's own later ones; the first %.0f s left out. Gyroscope and\n"
      "accelerometer (%.0f Hz) apart and %.0f ms late, pictures %.0f ms. jump: the longest step between two polls at\n"
      "%.0f Hz beyond the true one, from the start on.\n",
      a.ahead_ms, a.settle_s, a.accel_hz, a.imu_late_ms, a.frame_late_ms, a.poll_hz);
  return kDone;
}

}  // namespace

void add_bench_stream(CLI::App& bench, int& status) {
  auto a = std::make_shared<StreamArguments>();
  auto* command = bench.add_subcommand("stream", "Poses ahead of time, as an app asks for them, in simulated time");
  a->choice.add_options(*command, "recordings with camera and IMU");
  command->add_option("-c,--config", a->config, "pipeline config")->capture_default_str();
  command->add_option("--ahead", a->ahead_ms, "ms ahead of the poll")->capture_default_str();
  command->add_option("--frame-late", a->frame_late_ms, "ms from a picture's time to its pose")->capture_default_str();
  command->add_option("--imu-late", a->imu_late_ms, "ms from a sample's time to its arrival")->capture_default_str();
  command->add_option("--settle", a->settle_s, "seconds left out at the start")->capture_default_str();
  command->add_flag("--json", a->json, "print one JSON array, an entry for each recording");
  command->callback([a, &status] { status = bench_stream(*a); });
}

}  // namespace odograph
