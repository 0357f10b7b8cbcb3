// SPDX-License-Identifier: Apache-2.0
//
// Eq. (5) and (7) of Antigny et al. 2019, common to the scale sources.
#pragma once

#include <cmath>

#include <Eigen/Geometry>
#include <odograph/plugin.hpp>

namespace odograph {

/// A motion's displacement in n, up to scale.
inline Eigen::Vector3d displacement_n(const odo_vo_motion& motion) {
  const Eigen::Quaterniond q_n_c0(motion.q_n_c0[0], motion.q_n_c0[1], motion.q_n_c0[2], motion.q_n_c0[3]);
  return q_n_c0 * Eigen::Vector3d(motion.p_c0_c1);
}

/// D_VO, eq. (5): the horizontal part of the displacement.
inline double horizontal_displacement(const odo_vo_motion& motion) {
  const Eigen::Vector3d d_n = displacement_n(motion);
  return std::hypot(d_n.x(), d_n.y());
}

/// A scale for this motion and its time interval; the other fields are unset.
inline odo_scale scale_of(const odo_vo_motion& motion) {
  auto scale = odo::make<odo_scale>(motion.header.t_ns);
  scale.valid_from_ns = motion.t_from_ns;
  scale.valid_to_ns = motion.header.t_ns;
  scale.scale_group = motion.scale_group;
  scale.header.flags = ODO_SCALE_HORIZONTAL;
  return scale;
}

/// Emits s = D_step / D_VO, eq. (7), for this motion; nothing if D_VO is too small to divide by.
inline void emit_scale(const odo_vo_motion& motion, double d_step_m, double relative_sigma, odo::Output& output) {
  const double d_vo = horizontal_displacement(motion);
  auto scale = scale_of(motion);
  if (d_step_m > 0 && !(d_vo >= 1e-9)) return;
  scale.scale = d_step_m > 0 ? d_step_m / d_vo : 0.0;
  scale.sigma = scale.scale * relative_sigma;
  scale.displacement_m = d_step_m;
  output.emit(scale);
}

/// True if the motion can be scaled: across a pause neither the speed before nor the one after applies.
inline bool scalable(const odo_vo_motion& motion) {
  constexpr int64_t kLongest_ns = 2'000'000'000;  // two steps of a slow walk; frames farther apart share few features
  if (motion.header.t_ns - motion.t_from_ns > kLongest_ns) return false;
  constexpr uint32_t needed = ODO_VO_TRANSLATION | ODO_FLAG_NAVIGATION;
  return (motion.header.flags & needed) == needed;
}

}  // namespace odograph
