// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/localizer/walker.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

using Eigen::Vector3d;

void Walker::reset() {
  update_ = {};
  count_ = compared_ = 0;
  moved_ns_ = INT64_MIN;
  moved_ = false;
  notice_ = {};
}

void Walker::add(const odo_step& step) {
  update_.propagate(tracker_.localizer, step, !front_end_.scale_rejected());
  if (count_ == waiting_.size() && count_ > 0) pop();
  waiting_.push(step);
  ++count_;
}

void Walker::pop() {
  --count_;
  compared_ -= std::min<size_t>(compared_, 1);
}

/// Estimates the scale of a front-end without one from steps; until then nothing has moved the track.
void Walker::estimate_scale() {
  for (; compared_ < count_; ++compared_) {
    const odo_step& step = waiting_.back(count_ - 1 - compared_);
    if (front_end_.group().displacement(step.t_start_ns, step.t_end_ns))
      compare(step);
    else if (step.t_start_ns >= front_end_.group().began_ns)
      break;  // the front-end has not reached that step yet
  }
}

Vector3d Walker::settle(int64_t now_ns) {
  Vector3d moved_n = Vector3d::Zero();
  if (front_end_.begun() && !front_end_.scale().known()) estimate_scale();
  for (; count_ > 0; pop()) {
    const odo_step step = waiting_.back(count_ - 1);
    const bool answered = tracker_.coverage.until_ns() >= step.t_end_ns;
    if (!answered && !front_end_.is_silent(now_ns)) break;
    const double missing = tracker_.coverage.missing(step.t_start_ns, step.t_end_ns);
    if (missing > 0)
      moved_n += apply_step(step, missing);
    else if (compared_ == 0)
      compare(step);
  }
  return moved_n;
}

Vector3d Walker::apply_paper_step(const odo_step& step) {
  const bool moves = !front_end_.begun() || !front_end_.moves();
  const bool heading = (step.header.flags & ODO_STEP_HEADING) != 0;
  return moves && heading ? apply_step(step, 1) : Vector3d(Vector3d::Zero());
}

Vector3d Walker::apply_step(const odo_step& step, double share) {
  const bool late = tracker_.coverage.until_ns() >= step.t_end_ns;  // the front-end has continued since
  if (!late) tracker_.rotate_with_attitude();
  const auto q_a_b = tracker_.attitudes.at(step.t_end_ns);
  const Vector3d top_a = q_a_b ? Vector3d(*q_a_b * Vector3d::UnitY()) : Vector3d::UnitX();
  const auto stride = update_.apply_step(tracker_.localizer, step, share, std::atan2(top_a.y(), top_a.x()));
  const TrackPoint& from = tracker_.newest();
  const int64_t to_ns = std::max(from.t_ns, step.t_end_ns);
  const auto turned = late ? std::nullopt : tracker_.by_attitude(to_ns);
  tracker_.push(to_ns, turned.value_or(from.q_o_b), tracker_.localizer.q_n_o().conjugate() * stride.d_n,
                stride.noise.diagonal());
  tracker_.coverage.fill(step.t_start_ns, step.t_end_ns);
  moved_ns_ = step.t_end_ns;
  if (late) return stride.d_n;
  moved_ = true;
  tracker_.set_velocity(Vector3d::Zero(), Tracker::Velocity::none);
  return stride.d_n;
}

/// Compares the front-end's displacement over a step with the step's length.
void Walker::compare(const odo_step& step) {
  const auto displacement_o = front_end_.group().displacement(step.t_start_ns, step.t_end_ns);
  if (!displacement_o) return;
  const Vector3d& moved_o = *displacement_o;
  if (front_end_.check_metric_scale(step, moved_o))
    notice_ = {"odometry_metre",
               front_end_.scale_rejected()
                   ? "the front-end's metric scale contradicts the walker's steps by 40 % or more: its "
                     "motions count up to scale"
                   : "the front-end's metric scale agrees with the steps again"};
  const Localizer& localizer = tracker_.localizer;
  const double before = 1 / localizer.P()(kLogScale, kLogScale);
  const auto from = tracker_.track().at(step.t_start_ns), to = tracker_.track().at(step.t_end_ns);
  const double variance = from && to ? (to->drift_m2 - from->drift_m2).head<2>().maxCoeff() : 0;
  if (!update_.compare(tracker_.localizer, step, moved_o, std::max(0.0, variance), front_end_.is_metric_scale_known())
           .accepted)
    return;
  front_end_.scale().add_steps(std::max(0.0, 1 / localizer.P()(kLogScale, kLogScale) - before));
  front_end_.scale().confirm_by_steps(localizer);
}

}  // namespace odograph
