// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/evaluation/composed_motions.hpp"

#include "sdk/math/rotation.hpp"

namespace odograph {

using Eigen::Vector3d;

StampedPoses ComposedMotions::unscaled() const {
  StampedPoses track;
  for (const ComposedPose& x : poses) track.push_back({x.t_ns, x.q, x.unscaled});
  return track;
}

StampedPoses ComposedMotions::metric() const {
  StampedPoses track;
  for (const ComposedPose& x : poses)
    if (x.metric) track.push_back({x.t_ns, x.q, x.p_m});
  return track;
}

ComposedMotions compose(const std::vector<odo_vo_motion>& motions) {
  ComposedMotions composed;
  if (motions.empty()) return composed;
  ComposedPose x;
  x.t_ns = motions.front().t_from_ns, x.scale_group = motions.front().scale_group;
  composed.poses.push_back(x);
  bool group_is_metric = false;
  for (const odo_vo_motion& m : motions) {
    const uint32_t flags = m.header.flags;
    if (m.scale_group != x.scale_group) group_is_metric = false, x.scale_sigma = 0;
    group_is_metric |= (flags & ODO_VO_METRIC) != 0;
    composed.holes += m.t_from_ns != x.t_ns;
    x.t_ns = m.header.t_ns, x.scale_group = m.scale_group;
    if (flags & ODO_VO_TRANSLATION) {
      const Vector3d d = x.q * Vector3d(m.p_c0_c1);
      x.unscaled += d;
      if (group_is_metric) x.p_m += d;
    }
    if (flags & ODO_VO_ROTATION) x.q = (x.q * raw_quaternion(m.q_c0_c1)).normalized();
    x.placed = (flags & ODO_VO_TRANSLATION) && m.state != ODO_LOST;
    x.metric = x.placed && group_is_metric;
    x.tracking = m.state == ODO_TRACKING;
    x.gravity.reset();
    if (flags & ODO_VO_INERTIAL) x.scale_sigma = m.scale_sigma, x.gravity = x.q * Vector3d(m.gravity_c1);
    composed.poses.push_back(x);
  }
  return composed;
}

}  // namespace odograph
