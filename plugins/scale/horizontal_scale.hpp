// SPDX-License-Identifier: Apache-2.0
//
// Eq. (5) and (7) of Antigny et al. 2019, which the scale sources of this folder share.
#pragma once

#include <cmath>

#include <Eigen/Geometry>
#include <odograph/plugin.hpp>

namespace odograph {

/// D_VO, eq. (5): the horizontal part of a motion's displacement, in VO units.
inline double horizontal_displacement(const odo_vo_motion& motion) {
  const Eigen::Quaterniond q_n_c0(motion.q_n_c0[0], motion.q_n_c0[1], motion.q_n_c0[2], motion.q_n_c0[3]);
  const Eigen::Vector3d d_n = q_n_c0 * Eigen::Vector3d(motion.p_c0_c1);
  return std::hypot(d_n.x(), d_n.y());
}

/// s = D_step / D_VO, eq. (7), for this one motion. Nothing is emitted where D_VO is too small to divide by.
inline void emit_scale(const odo_vo_motion& motion, double d_step_m, double relative_sigma, odo::Output& output) {
  const double d_vo = horizontal_displacement(motion);
  auto scale = odo::make<odo_scale>(motion.header.t_ns);
  if (d_step_m > 0 && !(d_vo >= 1e-9)) return;
  scale.metres_per_unit = d_step_m > 0 ? d_step_m / d_vo : 0.0;
  scale.sigma = scale.metres_per_unit * relative_sigma;
  scale.displacement_m = d_step_m;
  scale.valid_from_ns = motion.t_from_ns;
  scale.valid_to_ns = motion.header.t_ns;
  scale.scale_group = motion.scale_group;
  scale.header.flags = ODO_SCALE_HORIZONTAL;
  output.emit(scale);
}

/// True when the motion can be scaled at all.
inline bool scalable(const odo_vo_motion& motion) {
  constexpr uint32_t needed = ODO_VO_TRANSLATION | ODO_VO_NAVIGATION;
  return (motion.header.flags & needed) == needed;
}

}  // namespace odograph
