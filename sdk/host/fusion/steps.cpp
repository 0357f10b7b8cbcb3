// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/fusion/steps.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sdk/math/rotation.hpp"
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

double StepModel::own_sigma(const odo_step& step) const {
  return std::min(p_.own_sigma, std::max(step.sigma_m / step.length_m, p_.min_sigma));
}

double StepModel::direction_sigma(const odo_step& step) const {
  return is_loose(step) ? p_.loose_direction_rad : p_.direction_rad;
}

void StepModel::reset(PoseFilter& filter) {
  *this = {};
  filter.set(kLogFactor, 0, squared(p_.factor_sigma));
  filter.set(kStepHeading, 0, squared(p_.heading_sigma_rad));
}

void StepModel::propagate(PoseFilter& filter, const odo_step& step, bool learns) {
  if (!std::exchange(any_, true)) {
    const double common = squared(step.sigma_m / step.length_m) - squared(own_sigma(step));
    filter.set(kLogFactor, filter.x()[kLogFactor], std::max(squared(p_.factor_sigma), common));
  }
  const double keep = std::exp(-1 / p_.factor_steps);
  if (learns) filter.decay(kLogFactor, 0, keep, (1 - keep * keep) * squared(p_.factor_sigma));
  filter.add_variance(kStepHeading, squared(p_.heading_walk));
  if (settling_ > 0 && --settling_ == 0)
    filter.set(kStepHeading, 0, squared(loose_ ? p_.loose_direction_rad : p_.heading_sigma_rad));
  if (std::exchange(loose_, is_loose(step)) == is_loose(step)) return;
  filter.add_variance(kStepHeading, squared(p_.loose_direction_rad));
  settling_ = p_.settle_steps;
}

StepModel::Stride StepModel::apply_step(PoseFilter& filter, const odo_step& step, double share,
                                        double phone_heading_rad) const {
  const auto& x = filter.x();
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
  filter.decay(kClimb, 0, keep, (1 - keep * keep) * squared(p_.climb_sigma_mps));
  const Vector3d d_n = walked_n + Vector3d(0, 0, x[kClimb] * dt_s);
  filter.move(d_n,
              {{kLogFactor, by_factor},
               {kAttitudeHeading, by_heading},
               {kStepHeading, by_heading},
               {kClimb, Vector3d(0, 0, dt_s)}},
              noise);
  return {d_n, noise};
}

UpdateResult StepModel::compare(PoseFilter& filter, const odo_step& step, const Vector3d& moved_o, double variance,
                                bool metric) {
  const double moved = moved_o.head<2>().norm();
  if (moved < p_.min_moved || step.mode == ODO_MODE_STAIRS) return {};
  const auto& x = filter.x();
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
  const UpdateResult result = bounded ? filter.update(seen, kGate[2],
                                                      metric ? all_but({kLogFactor, kStepHeading})
                                                             : all_but({kLogScale, kLogFactor, kStepHeading}))
                                      : UpdateResult{false, 0, 2};
  if (result.accepted) {
    rejected_ = 0;
  } else if (++rejected_ >= p_.max_rejected) {
    rejected_ = 0;
    filter.add_variance(kStepHeading, squared(p_.heading_sigma_rad));
    filter.add_variance(metric ? kLogFactor : kLogScale,
                        squared(metric ? p_.factor_sigma : Scale::Parameters().unknown_sigma));
  }
  return result;
}

void Steps::add(const odo_step& step) {
  model_.propagate(state_.filter, step, !odometry_.scale_rejected());
  if (count_ == waiting_.capacity()) pop();
  waiting_.push(step);
  ++count_;
}

void Steps::pop() {
  --count_;
  compared_ -= std::min<size_t>(compared_, 1);
}

/// Estimates the scale of a front-end without one from steps; until then nothing has moved the track.
void Steps::estimate_scale(Outputs& out) {
  for (; compared_ < count_; ++compared_) {
    const odo_step& step = waiting_.back(count_ - 1 - compared_);
    if (odometry_.group().displacement(step.t_start_ns, step.t_end_ns))
      compare(step, out);
    else if (step.t_start_ns >= odometry_.group().began_ns)
      break;  // the front-end has not reached that step yet
  }
}

Steps::Moved Steps::settle(int64_t now_ns, Outputs& out) {
  Moved moved;
  if (odometry_.begun() && !odometry_.scale().known()) estimate_scale(out);
  for (; count_ > 0; pop()) {
    const odo_step step = waiting_.back(count_ - 1);
    const TrackedIntervals& tracked = state_.track.tracked;
    const bool answered = tracked.until_ns() >= step.t_end_ns;
    if (!answered && !odometry_.is_silent(now_ns)) break;
    const double missing = tracked.missing(step.t_start_ns, step.t_end_ns);
    if (missing > 0)
      apply(step, missing, moved);
    else if (compared_ == 0)
      compare(step, out);
  }
  return moved;
}

void Steps::apply(const odo_step& step, double share, Moved& moved) {
  const bool late = state_.track.tracked.until_ns() >= step.t_end_ns;  // the front-end has continued since
  if (!late) state_.moved_by(MotionSource::steps);
  const auto q_a_b = state_.track.attitude(step.t_end_ns);
  const Vector3d top_a = q_a_b ? Vector3d(*q_a_b * Vector3d::UnitY()) : Vector3d::UnitX();
  const auto stride = model_.apply_step(state_.filter, step, share, std::atan2(top_a.y(), top_a.x()));
  const TrackPoint& from = state_.track.newest();
  const int64_t to_ns = std::max(from.t_ns, step.t_end_ns);
  const auto turned = late ? std::nullopt : state_.track.by_attitude(to_ns);
  const Vector3d moved_o = state_.filter.q_n_o().conjugate() * stride.d_n;
  state_.track.push(to_ns, turned.value_or(from.q_o_b), moved_o, stride.noise.diagonal());
  state_.track.tracked.fill(step.t_start_ns, step.t_end_ns);
  const Instant before = std::exchange(moved_, step.t_end_ns);
  moved.d_n += stride.d_n;
  if (late) return;
  moved.lead = true;
  walk_on(step, moved_o, before);
}

/// The velocity over two steps, since left and right differ; after a rest, half of the first one's.
void Steps::walk_on(const odo_step& step, const Vector3d& moved_o, Instant before) {
  const int64_t interval_ns = saturating_difference(step.t_end_ns, step.t_start_ns);
  if (!model_.is_stride(interval_ns)) return state_.track.clear_velocity();
  const bool rested = !before || saturating_difference(step.t_start_ns, *before) > interval_ns;
  const int64_t before_ns = rested ? interval_ns : interval_ns_;
  const Vector3d before_o = rested ? Vector3d(Vector3d::Zero()) : moved_o_;
  interval_ns_ = interval_ns, moved_o_ = moved_o;
  state_.track.set_velocity((before_o + moved_o) / seconds(before_ns + interval_ns), Velocity::steps,
                            model_.due_ns(step, std::max(interval_ns, before_ns)));
}

/// Compares the front-end's displacement over a step with the step's length.
void Steps::compare(const odo_step& step, Outputs& out) {
  const auto displacement_o = odometry_.group().displacement(step.t_start_ns, step.t_end_ns);
  if (!displacement_o) return;
  const Vector3d& moved_o = *displacement_o;
  if (odometry_.check_metric_scale(step, moved_o))
    out.notices.add({"odometry_metre", odometry_.scale_rejected()
                                           ? "the front-end's metric scale contradicts the walker's steps by 40 % or "
                                             "more: its motions count up to scale"
                                           : "the front-end's metric scale agrees with the steps again"});
  const PoseFilter& filter = state_.filter;
  const double before = 1 / filter.P()(kLogScale, kLogScale);
  const auto from = state_.track.stored(step.t_start_ns), to = state_.track.stored(step.t_end_ns);
  const double variance = from && to ? (to->drift_m2 - from->drift_m2).head<2>().maxCoeff() : 0;
  if (!model_.compare(state_.filter, step, moved_o, std::max(0.0, variance), odometry_.is_metric_scale_known())
           .accepted)
    return;
  odometry_.scale().add_steps(std::max(0.0, 1 / filter.P()(kLogScale, kLogScale) - before));
  odometry_.scale().confirm_by_steps(filter);
}

}  // namespace odograph
