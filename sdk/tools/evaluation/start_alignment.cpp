// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/evaluation/start_alignment.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/scalar.hpp"

namespace odograph {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

StampedPoses aligned_at_start(const StampedPoses& truth, const StampedPoses& track, double over_m) {
  std::vector<Waypoint> start;
  double walked = 0, next = 0;
  for (size_t i = 0; i < truth.size() && walked <= over_m; ++i) {
    if (i > 0) walked += (truth[i].p - truth[i - 1].p).head<2>().norm();
    if (walked >= next) start.push_back({truth[i].t_ns, truth[i].p}), next += 1;
  }
  return align_to_waypoints(track, start, heading_offset(track, start, over_m));
}

StampedPoses aligned_by_pose(const StampedPoses& truth, const StampedPoses& track, double after_m) {
  double walked = 0;
  size_t at = 0;
  while (at + 1 < truth.size() && walked <= after_m) {
    walked += (truth[at + 1].p - truth[at].p).head<2>().norm();
    ++at;
  }
  if (truth.empty() || track.empty()) return track;
  const auto nearest = std::min_element(track.begin(), track.end(), [&](const StampedPose& a, const StampedPose& b) {
    return std::abs(a.t_ns - truth[at].t_ns) < std::abs(b.t_ns - truth[at].t_ns);
  });
  const Eigen::Quaterniond off = truth[at].q * nearest->q.conjugate();
  const Eigen::Quaterniond rotation = Eigen::Quaterniond(off.w(), 0, 0, off.z()).normalized();
  const Eigen::Vector3d from = position_at(track, truth[at].t_ns);
  StampedPoses aligned = track;
  for (StampedPose& pose : aligned) {
    pose.p = rotation * (pose.p - from) + truth[at].p;
    pose.q = rotation * pose.q;
  }
  return aligned;
}

StampedPoses scaled_by_start(const StampedPoses& truth, const StampedPoses& track, double over_m) {
  const auto from = truth.front().t_ns;
  int64_t until = from;
  double driven = 0;
  for (size_t i = 1; i < truth.size() && driven < over_m; ++i)
    driven += (truth[i].p - truth[i - 1].p).norm(), until = truth[i].t_ns;
  StampedPoses head;
  for (const StampedPose& pose : track)
    if (pose.t_ns >= from && pose.t_ns <= until) head.push_back(pose);
  StampedPoses scaled = track;
  if (const double own = path_length(head); own > 1e-9)
    for (StampedPose& pose : scaled) pose.p *= driven / own;
  return scaled;
}

StampedPoses rotated_onto_first(const StampedPoses& truth, const StampedPoses& track) {
  if (track.empty()) return track;
  size_t same = 0;
  while (same + 1 < truth.size() && truth[same].t_ns < track.front().t_ns) ++same;
  const Eigen::Quaterniond rotation = truth[same].q * track.front().q.conjugate();
  StampedPoses out = track;
  for (StampedPose& pose : out) pose.p = rotation * pose.p, pose.q = rotation * pose.q;
  return out;
}

double yaw_error(const Quaterniond& estimate, const Quaterniond& truth) {
  const AngleAxisd off(truth * estimate.conjugate());
  return std::remainder(off.angle(), 2 * kPi) * off.axis().z();
}

Vector3d YawAlignment::on_truth(const Vector3d& p) const { return AngleAxisd(yaw_rad, Vector3d::UnitZ()) * p + shift; }
Vector3d YawAlignment::on_track(const Vector3d& p) const {
  return AngleAxisd(-yaw_rad, Vector3d::UnitZ()) * Vector3d(p - shift);
}
double YawAlignment::yaw_error(const Quaterniond& estimate, const Quaterniond& truth) const {
  return odograph::yaw_error(Quaterniond(AngleAxisd(yaw_rad, Vector3d::UnitZ())) * estimate, truth);
}

YawAlignment yaw_alignment(const StampedPose& estimate, const StampedPose& truth) {
  YawAlignment alignment;
  alignment.yaw_rad = alignment.yaw_error(estimate.q, truth.q);
  alignment.shift = truth.p - alignment.on_truth(estimate.p);
  return alignment;
}

double horizontal_error(const StampedPoses& truth, const StampedPoses& track, int64_t t_ns) {
  return (position_at(track, t_ns) - position_at(truth, t_ns)).head<2>().norm();
}

std::vector<double> horizontal_errors(const StampedPoses& truth, const StampedPoses& track) {
  std::vector<double> errors;
  for (const StampedPose& pose : truth) errors.push_back(horizontal_error(truth, track, pose.t_ns));
  return errors;
}

PositionErrors position_errors(const StampedPoses& truth, const StampedPoses& track) {
  PositionErrors errors;
  errors.horizontal_m = horizontal_errors(truth, track);
  for (size_t i = 0; i < truth.size(); ++i) {
    const Vector3d estimate = position_at(track, truth[i].t_ns), d = estimate - truth[i].p;
    errors.north_m.push_back(d.x()), errors.east_m.push_back(d.y());
    if (i == 0) continue;
    const Vector3d before = position_at(track, truth[i - 1].t_ns);
    errors.displacement_m.push_back(std::abs((estimate - before).norm() - (truth[i].p - truth[i - 1].p).norm()));
  }
  return errors;
}

}  // namespace odograph
