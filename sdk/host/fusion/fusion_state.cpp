// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/fusion/fusion_state.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/host/base/saturating.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

const char* describe(MotionSource source) {
  switch (source) {
    case MotionSource::steps: return "steps move the track";
    case MotionSource::lift: return "a lift or an escalator moves the track up or down, by the barometer";
    case MotionSource::scaled_camera: return "the front-end moves the track, with an external scale";
    case MotionSource::metric_camera: return "the front-end moves the track, with its own metric scale";
    default: return "nothing moves the track";
  }
}

void FusionState::start(int64_t t_ns, const Quaterniond& q_o_b) {
  t_ns_ = t_ns;
  filter.set_position(Vector3d(start_pose.position_m.data()));
  heading.start(filter);
  if (config.orientation == Orientation::gyroscope)
    filter.set(kHeadingRate, 0, squared(GyroAttitude::Parameters().bias_sigma_radps));
  track.tracked.begin(t_ns);
  track.push(t_ns, q_o_b, Vector3d::Zero());
}

void FusionState::start_without_attitude(int64_t t_ns, const Quaterniond& q_b_c) {
  if (const auto point = track.inertia.at(t_ns, Trajectory::Parameters().gravity_age_s);
      point && track.inertia.has_force())
    return start(t_ns, shortest_rotation(point->force_b, -Vector3d::UnitZ()));
  Matrix3d level;  // columns: the camera's x, y, z in o, optical axis horizontal along the first axis of o
  level << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  start(t_ns, Quaterniond(level) * q_b_c.conjugate());
}

bool FusionState::add_attitude(const odo_attitude& attitude) {
  const bool first = !heading.has_attitude();
  track.add_attitude(attitude);
  heading.on_attitude(filter, attitude);
  tilt_variance_ = std::max(attitude.covariance_n[0], attitude.covariance_n[4]);
  return first;
}

void FusionState::begin_camera(int64_t t_ns, const Vector3d& p_b_c, bool has_stepped, bool was_placed) {
  propagate(t_ns);
  const Quaterniond q_o_b = at(t_ns).value_or(track.newest()).q_o_b;
  if (!has_stepped) track.tracked.begin(t_ns);
  if (!has_stepped && !was_placed)
    filter.set_position(Vector3d(start_pose.position_m.data()) - filter.q_n_o() * (q_o_b * p_b_c));
  track.push(t_ns, q_o_b, Vector3d::Zero());
  source_ = MotionSource::camera_not_moving;
}

void FusionState::moved_by(MotionSource source) {
  const bool led = camera_leads();
  source_ = source;
  if (led && !camera_leads() && heading.has_attitude()) heading.join(filter, track.q_o_a());
}

void FusionState::propagate(int64_t t_ns) {
  if (t_ns <= t_ns_) return;
  const double dt_s = seconds(saturating_difference(t_ns, t_ns_));
  t_ns_ = t_ns;
  track.add_heading_drift(heading.propagate(filter, dt_s, !camera_leads()));
  height.propagate(filter, dt_s);
  if (config.orientation != Orientation::gyroscope) return;
  filter.add_multiple(kHeading, kHeadingRate, dt_s);
  filter.add_variance(kHeadingRate, squared(GyroAttitude::Parameters().bias_walk) * dt_s);
}

double FusionState::unobserved_m(int64_t t_ns) const {
  const int64_t moved_ns = track.tracked.until_ns(), observed_ns = std::max(moved_ns, gap_.value_or(INT64_MIN));
  const bool tracked = seconds(saturating_difference(t_ns, moved_ns)) < p.unobserved_s;
  if (!camera_leads() || tracked) return 0;
  return unobserved_m_in(std::max(0.0, seconds(saturating_difference(t_ns, observed_ns))));
}

double FusionState::unobserved_m_in(double unobserved_s) const {
  return std::min(unobserved_s * config.fastest_mps, p.farthest_m);
}

void FusionState::observe(int64_t t_ns, double sigma_m) {
  const int64_t observed_ns = std::max(track.tracked.until_ns(), gap_.value_or(INT64_MIN));
  if (sigma_m < unobserved_m_in(seconds(saturating_difference(t_ns, observed_ns)))) gap_ = t_ns;
}

void FusionState::add_gap(int64_t until_ns) {
  const double unobserved_m = this->unobserved_m(until_ns);
  if (unobserved_m == 0) return;
  for (const StateIndex i : {kNorth, kEast}) filter.add_variance(i, squared(unobserved_m));
  gap_ = until_ns;
}

void FusionState::pause(int64_t until_ns, bool placed) {
  track.clear_velocity();
  const int64_t seen_ns = camera_leads() ? std::max(track.tracked.until_ns(), gap_.value_or(INT64_MIN)) : now_ns();
  gap_ = until_ns;  // immediately, so that any later motion source can ignore the pause
  if (!placed) return;
  const double unobserved_m = unobserved_m_in(seconds(saturating_difference(until_ns, seen_ns)));
  for (const StateIndex i : {kNorth, kEast}) filter.add_variance(i, squared(unobserved_m));
}

}  // namespace odograph
