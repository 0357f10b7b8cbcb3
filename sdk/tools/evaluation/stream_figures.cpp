// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/evaluation/stream_figures.hpp"

#include <algorithm>
#include <iterator>
#include <optional>

#include <Eigen/Geometry>

#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"

namespace odograph {
namespace {

using Eigen::Vector3d;

double angle_deg(const odo_pose& a, const odo_pose& b) {
  return raw_quaternion(a.q_n).angularDistance(raw_quaternion(b.q_n)) * 180 / EIGEN_PI;
}

Vector3d position(const odo_pose& pose) { return Vector3d(pose.p_n); }

/// Difference in length between a track's step from one poll to the next and the true step, m.
double step_beyond(const Vector3d& step, const StampedPoses& truth, int64_t from_ns, int64_t to_ns) {
  return step.norm() - (position_at(truth, to_ns) - position_at(truth, from_ns)).norm();
}

/// The pipeline's own position at a time, as last corrected; nothing before or after its poses.
std::optional<Vector3d> later_position(const PoseStream& stream, int64_t t_ns) {
  const auto after = stream.poses.lower_bound(t_ns);
  if (after == stream.poses.end() || after == stream.poses.begin()) return std::nullopt;
  const auto before = std::prev(after);
  if ((before->second.header.flags & after->second.header.flags & ODO_POSE_POSITION) == 0) return std::nullopt;
  const double part = static_cast<double>(t_ns - before->first) / static_cast<double>(after->first - before->first);
  return Vector3d(position(before->second) + part * (position(after->second) - position(before->second)));
}

/// Fills in what the polls are behind the later track, and how evenly they move.
void add_motion(const PoseStream& stream, int64_t start_ns, StreamFigures& f) {
  constexpr int64_t kBeside_ns = 250'000'000, kApart_ns = 100'000'000;
  double behind = 0, squares = 0, jerk2 = 0;
  size_t jerks = 0;
  std::vector<Vector3d> spaced;  // smooth positions, a tenth of a second apart
  int64_t spaced_ns = INT64_MIN;
  const int64_t poll_ns = stream.polls.size() < 2 ? 0 : stream.polls[1].t_ns - stream.polls[0].t_ns;
  for (const PolledPose& poll : stream.polls) {
    const auto now = later_position(stream, poll.t_ns), before = later_position(stream, poll.t_ns - kBeside_ns),
               after = later_position(stream, poll.t_ns + kBeside_ns);
    if (poll.t_ns < start_ns || !now || !before || !after || !(poll.smooth.header.flags & ODO_POSE_POSITION)) {
      spaced.clear();
      continue;
    }
    if (poll.pose.header.flags & ODO_POSE_POSITION) f.live_m.push_back((position(poll.pose) - *now).norm());
    f.smooth_m.push_back((position(poll.smooth) - *now).norm());
    const Vector3d velocity = (*after - *before) / seconds(2 * kBeside_ns);
    behind += velocity.dot(*now - position(poll.smooth)), squares += velocity.squaredNorm();
    if (!spaced.empty() && poll.t_ns - spaced_ns > kApart_ns + poll_ns) spaced.clear();
    if (!spaced.empty() && poll.t_ns - spaced_ns < kApart_ns - poll_ns / 2) continue;
    spaced.push_back(position(poll.smooth)), spaced_ns = poll.t_ns;
    if (spaced.size() < 4) continue;
    const Vector3d* p = &spaced.back();
    jerk2 += ((p[0] - p[-3] - 3 * (p[-1] - p[-2])) / std::pow(seconds(kApart_ns), 3)).squaredNorm(), ++jerks;
  }
  if (squares > 0) f.smooth_lag_s = behind / squares;
  if (jerks > 0) f.smooth_jerk_mps3 = std::sqrt(jerk2 / static_cast<double>(jerks));
}

}  // namespace

StreamFigures stream_figures(const PoseStream& stream, const StampedPoses& truth, int64_t start_ns) {
  StreamFigures f;
  for (const PolledPose& p : stream.early) {
    const auto later = stream.poses.find(p.t_ns);
    if (p.t_ns < start_ns || later == stream.poses.end()) continue;
    ++f.frames;
    f.orientation_deg.push_back(angle_deg(p.pose, later->second));
    if (p.pose.header.flags & ODO_POSE_POSITION)
      f.position_m.push_back((position(p.pose) - position(later->second)).norm());
    else
      ++f.without_position;
  }
  add_motion(stream, start_ns, f);
  for (size_t i = 1; i < stream.polls.size(); ++i) {
    const PolledPose &a0 = stream.polls[i - 1], &a1 = stream.polls[i];
    if (angle_deg(a0.pose, a1.pose) == 0 && a1.t_ns > start_ns) ++f.repeated;
    if ((a0.pose.header.flags & a1.pose.header.flags & ODO_POSE_POSITION) == 0) continue;
    const auto beyond = [&](const odo_pose& from, const odo_pose& to) {
      return step_beyond(position(to) - position(from), truth, a0.t_ns, a1.t_ns);
    };
    f.jump_m = std::max(f.jump_m, beyond(a0.pose, a1.pose));
    f.smooth_jump_m = std::max(f.smooth_jump_m, beyond(a0.smooth, a1.smooth));
  }
  return f;
}

}  // namespace odograph
