// SPDX-License-Identifier: Apache-2.0
//
// Steps: compared with the front-end where it moved meanwhile, the motion itself where it did not.
#include <algorithm>
#include <cmath>

#include "sdk/host/base/rotation.hpp"
#include "sdk/host/localizer/composer.hpp"
#include "sdk/host/messages/messages.hpp"

namespace odograph {

using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

double seconds(int64_t ns) { return static_cast<double>(ns) * kNanoseconds; }

}  // namespace

/// The front-end will say nothing of the time until now.
bool Composer::camera_is_silent(int64_t t_ns) const {
  if (!camera_) return true;
  if (translated_ns_ == INT64_MIN) return seconds(t_ns - first_frame_ns_) > p_.silent_start_s;
  return lost_ || seconds(t_ns - translated_ns_) > p_.silent_s;
}

UpdateResult Composer::apply(const odo_step* step) {
  if (!started_ || step->length_m <= 0 || step->t_end_ns <= step->t_start_ns) return {};
  go_on(step->header.t_ns);
  if (paper()) {  // the papers' rule: whole, while the front-end does not move
    if (!inputs_.vo || (camera_ && !moves_)) carry(*step, 1.0);
    return {true, 0.0, 0};
  }
  steps_.go_on(localizer_, *step, !metre_check_.doubted());
  waiting_.push(*step);
  waiting_count_ = std::min(waiting_count_ + 1, waiting_.size());
  settle_steps(step->header.t_ns);
  return {true, 0.0, 0};
}

/// Steps of a time that the front-end has answered for, or will not.
void Composer::settle_steps(int64_t now_ns) {
  for (; waiting_count_ > 0; --waiting_count_) {
    const odo_step step = waiting_.back(waiting_count_ - 1);
    const bool answered = coverage_.until_ns() >= step.t_end_ns;
    if (!answered && !camera_is_silent(now_ns)) return;
    const double missing = coverage_.missing(step.t_start_ns, step.t_end_ns);
    if (missing > 0)
      carry(step, missing);
    else
      compare(step);
  }
}

void Composer::carry(const odo_step& step, double share) {
  const bool heading = (step.header.flags & ODO_STEP_HEADING) != 0;
  if (!heading && paper()) return;
  const bool late = !paper() && coverage_.until_ns() >= step.t_end_ns;  // the front-end has gone on since
  const auto q_a_b = attitudes_.at(step.t_end_ns);
  if (!late && !std::exchange(carried_, true) && q_a_b) heading_.join(localizer_, q_o_a_);
  const Vector3d top_a = q_a_b ? Vector3d(*q_a_b * Vector3d::UnitY()) : Vector3d::UnitX();
  const auto stride = steps_.stride(localizer_, step, share, std::atan2(top_a.y(), top_a.x()));
  // Up and down the walker goes with the ground, as fast as people climb: a Gauss-Markov velocity.
  const double dt_s = share * seconds(step.t_end_ns - step.t_start_ns), keep = std::exp(-dt_s / p_.climb_s);
  localizer_.decay(kClimb, 0, keep, (1 - keep * keep) * squared(p_.climb_sigma_mps));
  const Vector3d d_n = stride.d_n + Vector3d(0, 0, localizer_.x[kClimb] * dt_s);
  localizer_.move(d_n,
                  {{kLogFactor, stride.by_factor},
                   {kAttitudeHeading, stride.by_heading},
                   {kStepHeading, stride.by_heading},
                   {kClimb, Vector3d(0, 0, dt_s)}},
                  stride.noise);
  const Vector3d d_o = localizer_.q_n_o().conjugate() * d_n;
  carried_n_ += d_n;
  const TrackPoint from = track_.newest();
  const auto turned = late ? std::nullopt : by_attitude(std::max(from.t_ns, step.t_end_ns));
  push(step.t_end_ns, turned ? *turned : from.q_o_b, d_o);
  TrackPoint now = track_.newest();
  now.drift_m2 += stride.noise.diagonal();
  track_.push(now);
  coverage_.fill(step.t_start_ns, step.t_end_ns);
  step_ns_ = step.t_end_ns;
  if (paper()) distance_m_ += d_n.norm();
  if (late) return;
  velocity_o_.setZero(), velocity_ = Velocity::none;
  metric_ = true;
  set_source(StepSource{});
  if (!camera_)
    publish(step.t_end_ns, ODO_TRACKING, ODO_REASON_NONE);
  else if (!paper() && step.t_end_ns > last_pose_ns_)  // no frames come any more
    publish(step.t_end_ns, ODO_DEGRADED, ODO_REASON_SENSOR_SILENT);
}

/// The front-end's displacement over a step against its length.
void Composer::compare(const odo_step& step) {
  const auto from = path_.at(step.t_start_ns), to = path_.at(step.t_end_ns);
  if (!from || !to) return;
  const Vector3d moved_o = *to - *from;
  if ((group_.metric || metre_check_.doubted()) && step.mode != ODO_MODE_STAIRS &&
      metre_check_.add(step.length_m, moved_o.head<2>().norm())) {
    if (metre_check_.doubted())  // what the steps were taught since it went wrong is forgotten
      localizer_.set(kLogFactor, metre_check_.log_factor(), metre_check_.variance());
    notice_ = {"odometry_metre", metre_check_.doubted()
                                     ? "the front-end's metres contradict the walker's steps by two fifths and more: its "
                                       "motions count up to scale"
                                     : "the front-end's metres agree with the steps again"};
  }
  const bool taught = group_.metric && scale_.own_information() > 1 / squared(p_.walked_scale_sigma);
  const double before = 1 / localizer_.P(kLogScale, kLogScale);
  const UpdateResult result = steps_.compare(localizer_, step, moved_o, taught);
  if (!result.accepted) return;
  scale_.add_steps(std::max(0.0, 1 / localizer_.P(kLogScale, kLogScale) - before));
  scale_.know_by_steps(localizer_);
}

}  // namespace odograph
