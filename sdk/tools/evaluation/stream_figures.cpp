// SPDX-License-Identifier: Apache-2.0
#include "sdk/math/rotation.hpp"
#include "sdk/tools/evaluation/stream_figures.hpp"

#include <algorithm>

#include <Eigen/Geometry>

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
