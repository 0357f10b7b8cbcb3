// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/replay/marked_run.hpp"

#include <optional>
#include <random>

#include <sys/resource.h>

#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/evaluation/pose_consistency.hpp"
#include "sdk/tools/evaluation/start_alignment.hpp"
#include "sdk/tools/replay/replayed.hpp"

namespace odograph {
namespace {

using Eigen::Vector3d;

using Poses = std::vector<odo_pose>;

void on_pose(void* user, const odo_header* event) {
  auto& poses = *static_cast<Poses*>(user);
  const odo_pose& pose = as<odo_pose>(*event);
  if ((pose.header.flags & ODO_POSE_METRIC) == 0) return;
  if (!poses.empty() && poses.back().header.t_ns >= event->t_ns) poses.pop_back();  // corrected
  poses.push_back(pose);
}

/// Gives the session true positions from its first metric pose on, in the frame of its track, with a simulated error.
class Marks {
 public:
  Marks(const MarkOptions& options, const StampedPoses& truth) : a_(options), truth_(truth), random_(options.seed) {}

  std::optional<Failure> push_due_fix(odo_session* session, const Poses& poses, int64_t t_ns) {
    if (a_.sigma_m <= 0 || poses.empty() || t_ns < next_ns_) return std::nullopt;
    const auto there = pose_at(truth_, t_ns, kLargestTruthGap_s);
    if (!there) return std::nullopt;
    if (!alignment_) {
      const odo_pose& pose = poses.front();
      const auto first = pose_at(truth_, pose.header.t_ns, kLargestTruthGap_s);
      if (!first) return std::nullopt;
      alignment_ = yaw_alignment({pose.header.t_ns, raw_quaternion(pose.q_n), Vector3d(pose.p_n)}, *first);
    } else {
      auto mark = make_message<odo_waypoint>(ODO_TYPE_WAYPOINT, t_ns);
      Eigen::Map<Vector3d> p(mark.p_n);
      p = alignment_->on_track(there->p);
      for (int i = 0; i < 3; ++i) p[i] += a_.sigma_m * normal_(random_);
      mark.sigma_m = a_.sigma_m;
      if (const int32_t status = odo_session_push(session, &mark.header); status != ODO_OK)
        return Failure{status, "a mark was rejected"};
    }
    next_ns_ = t_ns + nanoseconds(a_.every_s);
    return std::nullopt;
  }

 private:
  const MarkOptions a_;
  const StampedPoses& truth_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::optional<YawAlignment> alignment_;
  int64_t next_ns_ = INT64_MIN;
};

double cpu_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

}  // namespace

Result<MarkedRun> marked_run(const Recording& recording, const RunOptions& run, const MarkOptions& options,
                             double first_s) {
  const auto session = replay_session(run);
  if (!session) return session.failure();
  odo_session* raw = session->get();
  Poses poses;
  const uint32_t wanted[] = {ODO_TYPE_POSE};
  odo_session_set_callback(raw, wanted, 1, on_pose, &poses);
  Marks marks(options, recording.truth);
  const double before_s = cpu_s();
  double recorded_s = 0;
  int64_t begin_ns = INT64_MIN;  // sensor descriptions precede it, possibly at time 0
  for (const RecordedMessage& message : recording.messages) {
    const odo_header& header = message.message.header();
    if (begin_ns == INT64_MIN && (header.type == ODO_TYPE_IMU || header.type == ODO_TYPE_FRAME)) begin_ns = header.t_ns;
    recorded_s = begin_ns == INT64_MIN ? 0.0 : seconds(header.t_ns - begin_ns);
    if (recorded_s > first_s) break;
    if (options.sigma_m > 0 && header.type == ODO_TYPE_WAYPOINT) continue;  // marks of the scenario
    if (const auto failure = marks.push_due_fix(raw, poses, header.t_ns)) return *failure;
    if (const auto failure = push(raw, message)) return *failure;
  }
  odo_session_flush(raw);
  const double taken_s = cpu_s() - before_s;
  return MarkedRun{std::move(poses), taken_s > 0 ? recorded_s / taken_s : 0.0};
}

}  // namespace odograph
