// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/fusion/odometry.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

/// Largest axis sigma of a motion's rotation, rad; 0 if it states none.
double rotation_sigma(const odo_vo_motion& m) {
  if ((m.header.flags & ODO_VO_COVARIANCE) == 0) return 0;
  return std::sqrt(std::max({m.covariance[0], m.covariance[7], m.covariance[14]}));
}

}  // namespace

/// Whether the front-end's rotation agrees with the gyroscope's. It does not when the camera sees the inside of a
/// pocket.
bool Odometry::rotates_with_gyroscope(const odo_vo_motion& m) const {
  const auto q_b0_b1 = state_.track.gyro_rotation(m.t_from_ns, m.header.t_ns);
  if (!q_b0_b1) return true;
  const Quaterniond q_c0_c1 = q_b_c_.conjugate() * *q_b0_b1 * q_b_c_;
  const double off_rad = log_rotation(quaternion(m.q_c0_c1).conjugate() * q_c0_c1).norm();
  return off_rad < p_.rotation_off_rad + p_.rotation_off_share * log_rotation(*q_b0_b1).norm() +
                       GyroAttitude::Parameters().bias_sigma_radps * seconds(m.header.t_ns - m.t_from_ns);
}

/// Orientation of the body in o at the motion's end, from the source that the config prefers among those available.
std::optional<Quaterniond> Odometry::rotated(const Motion& motion) {
  const odo_vo_motion& m = motion.m;
  const Orientation orientation = state_.config.orientation;
  if (const auto q_a_b = state_.track.attitude(m.header.t_ns); q_a_b && orientation == Orientation::attitude)
    return q_a_b;
  if (const auto q_o_b = gyroscope_.rotate(m, rotation_sigma(m))) return q_o_b;
  if (motion.rotates) return motion.q_o_c0 * quaternion(m.q_c0_c1) * q_b_c_.conjugate();
  if (const auto q_o_b = state_.track.by_attitude(m.header.t_ns)) return q_o_b;
  const auto q_b0_b1 = state_.track.gyro_rotation(m.t_from_ns, m.header.t_ns);
  return q_b0_b1 ? std::optional<Quaterniond>(motion.from.q_o_b * *q_b0_b1) : std::nullopt;
}

/// Variance of the heading, rad^2. Before a front-end with inertia has walked, its gyroscope bias is poorly known,
/// which is one constant error over that time: (sigma T)^2 grows by 2 sigma^2 T dt.
double Odometry::heading_variance(const Motion& motion) const {
  const double unknown_rotation = squared(state_.heading.parameters().gap_rotation);
  if (!motion.rotation_known) return unknown_rotation * motion.dt_s;
  const odo_vo_motion& m = motion.m;
  double rate = squared(motion.inertial ? p_.inertial_rotation_walk : p_.rotation_walk);
  // If the gyroscope has stopped, nothing checks the front-end's rotation, and the prediction of its corners is
  // missing.
  const bool has_gyroscope = !state_.track.inertia.empty();
  if (has_gyroscope && !state_.track.gyro_rotation(m.t_from_ns, m.header.t_ns)) rate += unknown_rotation;
  if (motion.inertial && !group_.scale_converged) {
    const bool stated = (m.header.flags & ODO_VO_COVARIANCE) != 0;
    const double sigma_radps = stated ? rotation_sigma(m) / motion.dt_s : p_.start_rate_radps;
    rate += 2 * squared(std::min(sigma_radps, p_.start_rate_radps)) * seconds(m.header.t_ns - group_.began_ns);
  }
  return rate * motion.dt_s;
}

/// Whether the camera walks. If so, the uncertainty of its displacement is one of scale.
bool Odometry::is_walking(int64_t t_ns) const {
  const auto moved = group_.moved_in_a_second(t_ns);
  return moved && std::exp(state_.filter.x()[kLogScale]) * *moved > p_.walking_m;
}

/// A metric front-end's own statement.
void Odometry::use_own_scale(const Motion& motion) {
  if (!motion.translates) return;
  const bool stated = motion.inertial || motion.m.scale_sigma > 0;
  state_.filter.add_variance(kLogScale, squared(p_.metric_scale_walk) * motion.dt_s);
  scale_.use_front_end(state_.filter, stated ? motion.m.scale_sigma : p_.unstated_scale_sigma,
                       is_walking(motion.m.header.t_ns));
}

bool Odometry::to_metres(Motion& motion, const odo_scale* scale) {
  if (motion.metric) {
    use_own_scale(motion);
    motion.d_o *= std::exp(state_.filter.x()[kLogScale]);
    return true;
  }
  if (scale) scale_.use(state_.filter, *scale);
  if (!scale_.known()) return false;
  motion.d_o *= std::exp(state_.filter.x()[kLogScale]);
  const double walk = scale_check_.rejected() ? p_.rejected_scale_walk : p_.scale_walk;
  state_.filter.add_variance(kLogScale, squared(walk) * motion.d_o.norm());
  motion.caught_up_m = catch_up(true, false, motion.uncertain);
  return true;
}

/// Adds what the scale group moved before its scale was known, if the scale `applies` to that part too, as far as
/// nothing else has moved the track. Returns its length, m.
double Odometry::catch_up(bool applies, bool horizontal, bool uncertain) {
  const Vector3d waiting_o = group_.take_unscaled();
  const double missing = state_.track.tracked.missing(group_.unscaled_ns, state_.track.newest().t_ns);
  if (waiting_o.isZero() || !applies || missing == 0) return 0;
  if (uncertain) state_.add_gap(group_.unscaled_ns);
  Vector3d d_o = missing * std::exp(state_.filter.x()[kLogScale]) * waiting_o;
  if (horizontal) d_o.z() = 0;
  const Vector3d d_n = state_.filter.q_n_o() * d_o;
  state_.filter.move(d_n, {{kHeading, across(d_n)}, {kLogScale, d_n}}, Matrix3d::Zero());
  state_.track.push(state_.track.newest().t_ns, state_.track.newest().q_o_b, d_o);
  state_.track.tracked.add(group_.unscaled_ns, state_.track.newest().t_ns);
  return d_o.norm();
}

/// A front-end with inertia estimates the vertical, so its inclination is used. Otherwise the attitude source corrects
/// the inclination slowly.
void Odometry::level(Motion& motion) const {
  Vector3d down_b = q_b_c_ * Vector3d(motion.m.gravity_c1);
  double share = 1;
  if (!motion.inertial) {
    const auto q_a_b = state_.track.attitude(motion.m.header.t_ns);
    if (!q_a_b) return;
    down_b = q_a_b->conjugate() * Vector3d::UnitZ();
    share = std::min(1.0, motion.dt_s / p_.tilt_time_s);
  }
  const Quaterniond up = shortest_rotation(motion.q_o_b1 * down_b, Vector3d::UnitZ());
  motion.q_o_b1 = (Quaterniond::Identity().slerp(share, up) * motion.q_o_b1).normalized();
}

/// The first metric motion, or the first after a gap. The displacement over the last seconds follows from the velocity
/// and the inertial samples; what came before them is unobserved, or, unless the track is `fresh`, left to steps.
void Odometry::back_propagate(const Motion& motion, bool fresh) {
  const int64_t to_ns = motion.m.header.t_ns;
  const int64_t from_ns =
      std::max({state_.track.tracked.until_ns(), to_ns - nanoseconds(p_.rewind_s), state_.track.inertia.oldest_ns()});
  const Vector3d v_o = motion.q_o_b1 * q_b_c_ * Vector3d(motion.m.velocity_c1) - lever_velocity_o(motion);
  const auto d_o =
      state_.track.inertial_displacement(from_ns, to_ns, motion.q_o_b1, v_o, Vector3d(motion.m.accel_bias_b));
  state_.add_gap(d_o ? from_ns : to_ns);
  if (fresh)
    state_.track.tracked.begin(to_ns);
  else
    state_.track.tracked.add(d_o ? from_ns : to_ns, to_ns);
  if (!d_o) return;
  const Vector3d d_n = state_.filter.q_n_o() * *d_o;
  const double sigma_m = p_.rewind_sigma_mps * seconds(to_ns - from_ns);
  state_.filter.move(d_n, {{kHeading, across(d_n)}}, Matrix3d::Identity() * squared(sigma_m));
  state_.track.push(state_.track.newest().t_ns, state_.track.newest().q_o_b, *d_o);
}

/// Velocity of the camera relative to the body's origin, by the gyroscope; zero without its samples.
Vector3d Odometry::lever_velocity_o(const Motion& motion) const {
  const auto point = state_.track.inertial_point(motion.m.header.t_ns);
  if (!point) return Vector3d::Zero();
  return motion.q_o_b1 * Vector3d(point->rate_b - Vector3d(motion.m.gyro_bias_b)).cross(p_b_c_);
}

/// Advances the track by the rotation and, if it moves, by the metric displacement.
void Odometry::move(const Motion& motion) {
  const odo_vo_motion& m = motion.m;
  const bool moves = motion.moves;
  const Vector3d d_o = moves ? motion.d_o : Vector3d(Vector3d::Zero());
  const Vector3d body_o = d_o - (motion.q_o_b1 * p_b_c_ - motion.from.q_o_b * p_b_c_);
  const double walk = squared(p_.drift_per_root_m) * d_o.norm();
  Vector3d variance(walk, walk, squared(p_.height_drift_per_root_m) * d_o.norm());
  if (!motion.inertial) {  // an inclination error is constant over the path: (sigma r)^2 at distance r
    const Vector3d from_o = state_.track.newest().p_o_b;
    const double further_m2 = (from_o + d_o).head<2>().squaredNorm() - from_o.head<2>().squaredNorm();
    variance.z() += state_.tilt_variance() * std::max(0.0, further_m2);
  }
  double outage_sigma_m = 0;  // a covered camera continues on inertia, whose errors accumulate coherently
  if (moves && motion.state != ODO_TRACKING && (m.header.flags & ODO_VO_COVARIANCE)) {
    outage_sigma_m = outage_sigma_m_ + std::sqrt(std::max({m.covariance[21], m.covariance[28], m.covariance[35]}));
    variance.array() += squared(outage_sigma_m) - squared(outage_sigma_m_);
  }
  outage_sigma_m_ = outage_sigma_m;
  const Quaterniond q_n_o = state_.filter.q_n_o();
  const Vector3d body_n = q_n_o * body_o, d_n = q_n_o * d_o;
  state_.filter.move(body_n, {{kHeading, across(body_n)}, {kLogScale, d_n}}, Matrix3d(variance.asDiagonal()));
  const double turned = heading_variance(motion);
  state_.filter.add_variance(kHeading, turned);
  state_.track.push(m.header.t_ns, motion.q_o_b1, body_o, variance, turned);
  if (!moves) return state_.track.clear_velocity();
  camera_velocity_o_ = d_o / motion.dt_s;
  if (!motion.inertial) return state_.track.set_velocity(body_o / motion.dt_s, Velocity::mean);
  camera_velocity_o_ = motion.q_o_b1 * q_b_c_ * Vector3d(m.velocity_c1);
  state_.track.set_velocity(camera_velocity_o_ - lever_velocity_o(motion), Velocity::now);
  gyro_bias_b = Vector3d(m.gyro_bias_b), accel_bias_b = Vector3d(m.accel_bias_b);
}

void Odometry::on_calibration(const odo_calibration& calibration) {
  calibrated_ = true;
  if ((calibration.header.flags & ODO_CALIBRATION_EXTRINSICS) == 0) return;
  q_b_c_ = quaternion(calibration.q_b_c);
  p_b_c_ = Vector3d(calibration.p_b_c);
}

void Odometry::begin(int64_t t_ns, bool has_stepped, bool was_placed) {
  first_frame_ = t_ns;
  has_stepped_ = has_stepped;
  state_.begin_camera(t_ns, p_b_c_, has_stepped, was_placed);
  gyroscope_.start(q_b_c_);
}

void Odometry::select(Motion& motion) const {
  const uint32_t flags = motion.m.header.flags;
  motion.rotates = (flags & ODO_VO_ROTATION) != 0 && !lost_;
  motion.translates = (flags & ODO_VO_TRANSLATION) != 0 && !lost_ && motion.dt_s > 0;
  if (motion.rotates && !rotates_with_gyroscope(motion.m)) motion.rotates = motion.translates = false;
}

bool Odometry::is_in_metres(const odo_vo_motion& m) const {
  const bool same_group = group_.any && m.scale_group == group_.id;
  return (m.header.flags & ODO_VO_METRIC) != 0 && !(same_group && scale_check_.rejected());
}

Odometry::Motion Odometry::begin_motion(const odo_vo_motion& m) {
  const int64_t t_ns = m.header.t_ns;
  if (group_.any && m.scale_group != group_.id) scale_check_.restart();
  scale_check_.add_motion(seconds(t_ns - m.t_from_ns), m.state == ODO_TRACKING, (m.header.flags & ODO_VO_METRIC) != 0);
  const bool metric = is_in_metres(m);
  if (!group_.any || m.scale_group != group_.id || metric != group_.metric) {
    group_.begin(m, metric);
    begin_scale();
  }
  lost_ = m.state == ODO_LOST;
  const TrackPoint from = state_.track.stored(m.t_from_ns).value_or(state_.track.newest());
  const bool inertial = metric && (m.header.flags & ODO_VO_INERTIAL) != 0;
  Motion motion{m,       from,    from.q_o_b * q_b_c_, from.q_o_b, seconds(t_ns - m.t_from_ns), metric, inertial,
                m.state, m.reason};
  group_.inertial = inertial;
  select(motion);
  const auto q_o_b1 = rotated(motion);
  motion.rotation_known = q_o_b1.has_value();
  motion.q_o_b1 = q_o_b1.value_or(from.q_o_b);
  level(motion);
  if (motion.translates) {
    motion.d_o = motion.q_o_c0 * Vector3d(m.p_c0_c1);
    group_.add(t_ns, motion.d_o);
  }
  return motion;
}

/// A displacement that only a failure of tracking or scale explains. With unknown scale, the bound is relaxed by three
/// sigma of the scale prior.
bool Odometry::is_impossible(const Motion& motion) const {
  const bool in_metres = motion.metric || inputs_.scale || scale_.known();
  const double units = in_metres ? 1 : std::exp(3 * Scale::Parameters().unknown_sigma);
  return state_.is_impossible(motion.d_o.norm() / units, motion.dt_s);
}

Odometry::Motion Odometry::apply(const odo_vo_motion& m, const odo_scale* scale, bool placed, bool fresh) {
  const int64_t t_ns = m.header.t_ns;
  Motion motion = begin_motion(m);
  motion.uncertain = placed;
  const Vector3d units_o = motion.d_o;
  motion.moves = to_metres(motion, scale) && motion.translates;
  if (motion.translates && !motion.moves) {
    group_.add_unscaled(m.t_from_ns, units_o);
    if (motion.state == ODO_TRACKING) motion.state = ODO_DEGRADED, motion.reason = ODO_REASON_NO_SCALE;
  }
  moves_ = motion.translates;
  if (motion.moves && is_impossible(motion)) {
    motion.moves = moves_ = false;
    motion.state = ODO_DEGRADED, motion.reason = ODO_REASON_TOO_FAST;
  }
  const bool resumes = motion.moves && motion.inertial && (fresh || state_.track.tracked.until_ns() < m.t_from_ns);
  if (motion.moves && motion.uncertain && !resumes) state_.add_gap(m.t_from_ns);
  if (resumes) {
    back_propagate(motion, fresh);
    motion.d_o.setZero();
  } else if (motion.moves && state_.track.tracked.until_ns() > m.t_from_ns) {  // steps have moved the track meanwhile
    motion.d_o *= state_.track.tracked.missing(m.t_from_ns, t_ns);
  }
  move(motion);
  group_.scale_converged = group_.scale_converged || scale_.own_information() > 1 / squared(p_.converged_scale_sigma);
  if (!motion.moves || !has_priority()) priority_since_ = t_ns;
  if (motion.moves) {
    state_.track.tracked.add(m.t_from_ns, t_ns);
    state_.moved_by(motion.metric ? MotionSource::metric_camera : MotionSource::scaled_camera);
    moved_ = t_ns;
  }
  return motion;
}

UpdateResult Odometry::apply(const odo_scale& scale) {
  if (!group_.any || scale.scale_group != group_.id || group_.metric) return {};
  return scale_.use(state_.filter, scale);
}

bool Odometry::has_priority() const {
  return group_.inertial && scale_.own_information() > 1 / squared(p_.priority_scale_sigma);
}

bool Odometry::is_metric_scale_known() const {
  return group_.metric && scale_.own_information() > 1 / squared(p_.converged_scale_sigma);
}

bool Odometry::is_silent(int64_t now_ns) const {
  if (!first_frame_) return true;
  if (!moved_) return has_stepped_ || seconds(now_ns - *first_frame_) > p_.silent_start_s;
  return lost_ || seconds(now_ns - *moved_) > state_.p.unobserved_s;
}

bool Odometry::check_metric_scale(const odo_step& step, const Vector3d& moved_o) {
  if ((!group_.metric && !scale_check_.rejected()) || step.mode == ODO_MODE_STAIRS) return false;
  if (!scale_check_.add(step.length_m, moved_o.head<2>().norm())) return false;
  if (scale_check_.rejected())  // discards the step factor learned since the scale went wrong
    state_.filter.set(kLogFactor, scale_check_.log_factor(), scale_check_.variance());
  return true;
}

}  // namespace odograph
