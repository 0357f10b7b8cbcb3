// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/localizer/step_update.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sdk/host/localizer/scale_update.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr double kMaxStretch = 0.9;  // of log-length; more means a false step, or a phone handed on

bool is_loose(const odo_step& step) {
  return step.mode == ODO_MODE_WALKING_SWINGING || step.mode == ODO_MODE_WALKING_POCKET;
}

}  // namespace

double StepUpdate::own_sigma(const odo_step& step) const {
  return std::min(p_.own_sigma, std::max(step.sigma_m / step.length_m, p_.min_sigma));
}

double StepUpdate::direction_sigma(const odo_step& step) const {
  return is_loose(step) ? p_.loose_direction_rad : p_.direction_rad;
}

void StepUpdate::reset(Localizer& localizer) {
  *this = {};
  localizer.set(kLogFactor, 0, squared(p_.factor_sigma));
  localizer.set(kStepHeading, 0, squared(p_.heading_sigma_rad));
}

void StepUpdate::propagate(Localizer& localizer, const odo_step& step, bool learns) {
  if (!std::exchange(any_, true)) {
    const double common = squared(step.sigma_m / step.length_m) - squared(own_sigma(step));
    localizer.set(kLogFactor, localizer.x()[kLogFactor], std::max(squared(p_.factor_sigma), common));
  }
  const double keep = std::exp(-1 / p_.factor_steps);
  if (learns) localizer.decay(kLogFactor, 0, keep, (1 - keep * keep) * squared(p_.factor_sigma));
  localizer.add_variance(kStepHeading, squared(p_.heading_walk));
  if (settling_ > 0 && --settling_ == 0)
    localizer.set(kStepHeading, 0, squared(loose_ ? p_.loose_direction_rad : p_.heading_sigma_rad));
  if (std::exchange(loose_, is_loose(step)) == is_loose(step)) return;
  localizer.add_variance(kStepHeading, squared(p_.loose_direction_rad));
  settling_ = p_.settle_steps;
}

StepUpdate::Stride StepUpdate::apply_step(Localizer& localizer, const odo_step& step, double share,
                                          double phone_heading_rad) const {
  const auto& x = localizer.x();
  const bool heading = (step.header.flags & ODO_STEP_HEADING) != 0;
  const double direction = x[kAttitudeHeading] + (heading ? step.heading_rad + x[kStepHeading] : phone_heading_rad);
  const Vector3d along(std::cos(direction), std::sin(direction), 0), side_n = across(along);
  const double length_m = share * std::exp(x[kLogFactor]) * step.length_m;
  const double sway = heading ? p_.direction_rad : p_.loose_direction_rad;
  const Matrix3d noise = squared(own_sigma(step) * length_m) * along * along.transpose() +
                         squared(sway * length_m) * side_n * side_n.transpose();
  const Vector3d walked_n = length_m * along, by_heading = across(walked_n);
  const Vector3d by_factor = step.mode == ODO_MODE_STAIRS ? Vector3d(Vector3d::Zero()) : walked_n;
  // Stairs: vertical velocity is limited to what people climb.
  const double dt_s = share * seconds(step.t_end_ns - step.t_start_ns), keep = std::exp(-dt_s / p_.climb_s);
  localizer.decay(kClimb, 0, keep, (1 - keep * keep) * squared(p_.climb_sigma_mps));
  const Vector3d d_n = walked_n + Vector3d(0, 0, x[kClimb] * dt_s);
  localizer.move(d_n,
                 {{kLogFactor, by_factor},
                  {kAttitudeHeading, by_heading},
                  {kStepHeading, by_heading},
                  {kClimb, Vector3d(0, 0, dt_s)}},
                 noise);
  return {d_n, noise};
}

UpdateResult StepUpdate::compare(Localizer& localizer, const odo_step& step, const Vector3d& moved_o, double variance,
                                 bool metric) {
  const double moved = moved_o.head<2>().norm();
  if (moved < p_.min_moved || step.mode == ODO_MODE_STAIRS) return {};
  const auto& x = localizer.x();
  const bool heading = (step.header.flags & ODO_STEP_HEADING) != 0;
  Innovation seen(2);  // of two differences whose expected value is zero
  const double stretch = x[kLogFactor] + std::log(step.length_m / moved) - x[kLogScale];
  seen.residual[0] = -stretch;
  seen.H(0, kLogFactor) = 1, seen.H(0, kLogScale) = -1;
  const double unseen = p_.correlation * variance / squared(moved);  // relative, the same along and across
  seen.noise(0, 0) = (squared(own_sigma(step)) + squared(p_.odometry_sigma / moved)) * p_.correlation + unseen;
  seen.noise(1, 1) = 1e12;
  if (heading) {
    const double off =
        step.heading_rad + x[kAttitudeHeading] + x[kStepHeading] - std::atan2(moved_o.y(), moved_o.x()) - x[kHeading];
    seen.residual[1] = -std::remainder(off, 2 * EIGEN_PI);
    seen.H(1, kAttitudeHeading) = seen.H(1, kStepHeading) = 1, seen.H(1, kHeading) = -1;
    seen.noise(1, 1) = squared(direction_sigma(step)) + unseen;
  }
  const bool bounded = !metric || std::abs(stretch) < kMaxStretch;
  const UpdateResult result = bounded ? localizer.update(seen, kGate[2],
                                                         metric ? all_but({kLogFactor, kStepHeading})
                                                                : all_but({kLogScale, kLogFactor, kStepHeading}))
                                      : UpdateResult{false, 0, 2};
  if (result.accepted) {
    rejected_ = 0;
  } else if (++rejected_ >= p_.max_rejected) {
    rejected_ = 0;
    localizer.add_variance(kStepHeading, squared(p_.heading_sigma_rad));
    localizer.add_variance(metric ? kLogFactor : kLogScale,
                           squared(metric ? p_.factor_sigma : ScaleUpdate::Parameters().unknown_sigma));
  }
  return result;
}

}  // namespace odograph
