// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/fusion/paper_fusion.hpp"

#include <algorithm>
#include <cmath>

namespace odograph {

using Eigen::Vector3d;

void PaperOdometry::select(Motion& motion) const {
  const uint32_t flags = motion.m.header.flags;
  motion.rotates = (flags & ODO_VO_ROTATION) != 0;
  motion.translates = (flags & ODO_VO_TRANSLATION) != 0 && !lost_ && motion.dt_s > 0;
}

void PaperOdometry::level(Motion& motion) const {
  if (motion.inertial) Odometry::level(motion);
}

double PaperOdometry::heading_variance(const Motion& motion) const {
  const double variance = Odometry::heading_variance(motion);
  if (!motion.rotation_known || (motion.m.header.flags & ODO_VO_COVARIANCE) == 0) return variance;
  const Vector3d down_c = motion.q_o_c0.conjugate() * Vector3d::UnitZ();
  const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> stated(motion.m.covariance);
  return variance + down_c.dot(stated.topLeftCorner<3, 3>() * down_c);
}

/// Each motion has its own scale, whose errors are correlated over the path.
bool PaperOdometry::to_metres(Motion& motion, const odo_scale* scale) {
  if (motion.metric) use_own_scale(motion);
  if (motion.metric || !inputs_.scale) return true;
  if (!scale) return false;
  motion.d_o *= scale->scale;
  const bool horizontal =
      (scale->header.flags & ODO_SCALE_HORIZONTAL) != 0 && state_.config.vertical == Vertical::ignore;
  if (horizontal) motion.d_o.z() = 0.0;
  const double relative = scale->scale > 0 ? std::min(1.0, scale->sigma / scale->scale) : 0.0;
  state_.filter.set_value(kLogScale, scale->scale > 0 ? std::log(scale->scale) : 0.0);
  state_.filter.set_variance(kLogScale, squared(relative));
  if (motion.translates)
    motion.caught_up_m = catch_up((scale->header.flags & ODO_SCALE_STEADY) != 0, horizontal, motion.uncertain);
  return true;
}

PaperFusion::PaperFusion(const CouplingConfig& config, const StartPose& start, FusionInputs inputs)
    : Fusion(config, start, inputs, std::type_identity<PaperOdometry>()) {
  kept_by_heading_ = only({kLogScale, kLogFactor, kStepHeading});
  kept_by_position_ = all_but({kNorth, kEast, kDown});
}

void PaperFusion::move_by(const odo_step& step, Outputs& out) {
  Steps::Moved moved;
  const bool stands = !odometry_->begun() || !odometry_->moves();
  if (stands && (step.header.flags & ODO_STEP_HEADING)) steps_.apply(step, 1, moved);
  distance_m_ += moved.d_n.norm();
  record(moved, out);
}

}  // namespace odograph
