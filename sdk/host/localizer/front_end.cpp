// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/localizer/front_end.hpp"

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
bool FrontEnd::rotates_with_gyroscope(const odo_vo_motion& m) const {
  const auto q_b0_b1 = tracker_.gyro_rotation(m.t_from_ns, m.header.t_ns);
  if (!q_b0_b1) return true;
  const Quaterniond q_c0_c1 = q_b_c_.conjugate() * *q_b0_b1 * q_b_c_;
  const double off_rad = log_rotation(quaternion(m.q_c0_c1).conjugate() * q_c0_c1).norm();
  return off_rad < p_.rotation_off_rad + p_.rotation_off_share * log_rotation(*q_b0_b1).norm() +
                       tracker_.gyroscope().bias_sigma_radps * seconds(m.header.t_ns - m.t_from_ns);
}

/// Orientation of the body in o at the motion's end, from the source that the config prefers among those available.
std::optional<Quaterniond> FrontEnd::rotated(const MotionUpdate& motion) {
  const odo_vo_motion& m = motion.m;
  const Orientation orientation = tracker_.config().orientation;
  if (const auto q_a_b = tracker_.attitudes.at(m.header.t_ns); q_a_b && orientation == Orientation::attitude)
    return q_a_b;
  if (const auto q_o_b = gyroscope_.rotate(m, rotation_sigma(m))) return q_o_b;
  if (motion.rotates) return motion.q_o_c0 * quaternion(m.q_c0_c1) * q_b_c_.conjugate();
  if (const auto q_o_b = tracker_.by_attitude(m.header.t_ns)) return q_o_b;
  const auto q_b0_b1 = tracker_.gyro_rotation(m.t_from_ns, m.header.t_ns);
  return q_b0_b1 ? std::optional<Quaterniond>(motion.from.q_o_b * *q_b0_b1) : std::nullopt;
}

/// Variance of the heading, rad^2. Before a front-end with inertia has walked, its gyroscope bias is poorly known,
/// which is one constant error over that time: (sigma T)^2 grows by 2 sigma^2 T dt.
double FrontEnd::heading_variance(const MotionUpdate& motion) const {
  const double unknown_rotation = squared(tracker_.heading.parameters().gap_rotation);
  if (!motion.rotation_known) return unknown_rotation * motion.dt_s;
  const odo_vo_motion& m = motion.m;
  double rate = squared(motion.inertial ? p_.inertial_rotation_walk : p_.rotation_walk);
  // If the gyroscope has stopped, nothing checks the front-end's rotation, and the prediction of its corners is
  // missing.
  const bool has_gyroscope = tracker_.inertia.newest_ns() != INT64_MIN;
  if (has_gyroscope && !tracker_.gyro_rotation(m.t_from_ns, m.header.t_ns)) rate += unknown_rotation;
  if (motion.inertial && !group_.scale_converged) {
    const bool stated = (m.header.flags & ODO_VO_COVARIANCE) != 0;
    const double sigma_radps = stated ? rotation_sigma(m) / motion.dt_s : p_.start_rate_radps;
    rate += 2 * squared(std::min(sigma_radps, p_.start_rate_radps)) * seconds(m.header.t_ns - group_.began_ns);
  }
  double variance = rate * motion.dt_s;
  if (tracker_.paper() && (m.header.flags & ODO_VO_COVARIANCE)) {
    const Vector3d down_c = motion.q_o_c0.conjugate() * Vector3d::UnitZ();
    const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> stated(m.covariance);
    variance += down_c.dot(stated.topLeftCorner<3, 3>() * down_c);
  }
  return variance;
}

/// Whether the camera walks. If so, the uncertainty of its displacement is one of scale.
bool FrontEnd::is_walking(int64_t t_ns) const {
  const auto moved = group_.moved_in_a_second(t_ns);
  return moved && std::exp(tracker_.localizer.x()[kLogScale]) * *moved > p_.walking_m;
}

/// Paper mode: each motion has its own scale, whose errors are correlated over the path.
bool FrontEnd::apply_paper_scale(MotionUpdate& motion, const odo_scale* scale) {
  if (!inputs_.scale) return true;
  if (!scale) return false;
  motion.d_o *= scale->scale;
  const bool horizontal =
      (scale->header.flags & ODO_SCALE_HORIZONTAL) != 0 && tracker_.config().vertical == Vertical::ignore;
  if (horizontal) motion.d_o.z() = 0.0;
  const double relative = scale->scale > 0 ? std::min(1.0, scale->sigma / scale->scale) : 0.0;
  tracker_.localizer.set_value(kLogScale, scale->scale > 0 ? std::log(scale->scale) : 0.0);
  tracker_.localizer.set_variance(kLogScale, squared(relative));
  if (motion.translates) motion.caught_up_m = catch_up(scale, horizontal, motion.doubtful);
  return true;
}

/// Scales the displacement to metres; false if the scale is unknown.
bool FrontEnd::apply_metric_scale(MotionUpdate& motion, const odo_scale* scale) {
  const odo_vo_motion& m = motion.m;
  if (motion.metric) {
    if (motion.translates) {
      const bool stated = motion.inertial || m.scale_sigma > 0;
      tracker_.localizer.add_variance(kLogScale, squared(p_.metric_scale_walk) * motion.dt_s);
      scale_.use_front_end(tracker_.localizer, stated ? m.scale_sigma : p_.unstated_scale_sigma,
                           is_walking(m.header.t_ns));
    }
    if (!tracker_.paper()) motion.d_o *= std::exp(tracker_.localizer.x()[kLogScale]);
    return true;
  }
  if (tracker_.paper()) return apply_paper_scale(motion, scale);
  if (scale) scale_.use(tracker_.localizer, *scale);
  if (!scale_.known()) return false;
  motion.d_o *= std::exp(tracker_.localizer.x()[kLogScale]);
  const double walk = scale_check_.rejected() ? p_.rejected_scale_walk : p_.scale_walk;
  tracker_.localizer.add_variance(kLogScale, squared(walk) * motion.d_o.norm());
  motion.caught_up_m = catch_up(scale, false, motion.doubtful);
  return true;
}

/// Adds what the scale group moved before its scale was known, if the scale also applies to that part and nothing else
/// has moved the track. Returns its length, m.
double FrontEnd::catch_up(const odo_scale* scale, bool horizontal, bool doubtful) {
  const Vector3d waiting_o = group_.take_unscaled();
  if (waiting_o.isZero() || (tracker_.paper() && !(scale && (scale->header.flags & ODO_SCALE_STEADY)))) return 0;
  if (tracker_.coverage.missing(group_.unscaled_ns, tracker_.newest().t_ns) < 0.5) return 0;
  if (doubtful) tracker_.add_gap(group_.unscaled_ns);
  Vector3d d_o = std::exp(tracker_.localizer.x()[kLogScale]) * waiting_o;
  if (horizontal) d_o.z() = 0;
  const Vector3d d_n = tracker_.localizer.q_n_o() * d_o;
  tracker_.localizer.move(d_n, {{kHeading, across(d_n)}, {kLogScale, d_n}}, Matrix3d::Zero());
  tracker_.push(tracker_.newest().t_ns, tracker_.newest().q_o_b, d_o);
  tracker_.coverage.add(group_.unscaled_ns, tracker_.newest().t_ns);
  return d_o.norm();
}

/// A front-end with inertia estimates the vertical, so its inclination is used. Otherwise the attitude source corrects
/// the inclination slowly.
void FrontEnd::correct_inclination(MotionUpdate& motion) const {
  Vector3d down_b = q_b_c_ * Vector3d(motion.m.gravity_c1);
  double share = 1;
  if (!motion.inertial) {
    if (tracker_.paper()) return;
    const auto q_a_b = tracker_.attitudes.at(motion.m.header.t_ns);
    if (!q_a_b) return;
    down_b = q_a_b->conjugate() * Vector3d::UnitZ();
    share = std::min(1.0, motion.dt_s / p_.tilt_time_s);
  }
  const Quaterniond up = Quaterniond::FromTwoVectors(motion.q_o_b1 * down_b, Vector3d::UnitZ());
  motion.q_o_b1 = (Quaterniond::Identity().slerp(share, up) * motion.q_o_b1).normalized();
}

/// The first metric motion. The displacement over the last seconds follows from the velocity and the inertial samples;
/// what came before them since the first frame is unobserved.
void FrontEnd::back_propagate_start(const MotionUpdate& motion) {
  const int64_t to_ns = motion.m.header.t_ns;
  const int64_t from_ns =
      std::max({tracker_.coverage.until_ns(), to_ns - nanoseconds(p_.rewind_s), tracker_.inertia.oldest_ns()});
  const Vector3d v_o = motion.q_o_b1 * q_b_c_ * Vector3d(motion.m.velocity_c1) - lever_velocity_o(motion);
  const auto d_o = tracker_.inertial_displacement(from_ns, to_ns, motion.q_o_b1, v_o, Vector3d(motion.m.accel_bias_b));
  tracker_.add_gap(d_o ? from_ns : to_ns);
  tracker_.coverage.begin(to_ns);
  if (!d_o) return;
  const Vector3d d_n = tracker_.localizer.q_n_o() * *d_o;
  const double sigma_m = p_.rewind_sigma_mps * seconds(to_ns - from_ns);
  tracker_.localizer.move(d_n, {{kHeading, across(d_n)}}, Matrix3d::Identity() * squared(sigma_m));
  tracker_.push(tracker_.newest().t_ns, tracker_.newest().q_o_b, *d_o);
}

/// Velocity of the camera relative to the body's origin, by the gyroscope; zero without its samples.
Vector3d FrontEnd::lever_velocity_o(const MotionUpdate& motion) const {
  const auto point = tracker_.inertial_point(motion.m.header.t_ns);
  if (!point) return Vector3d::Zero();
  return motion.q_o_b1 * Vector3d(point->rate_b - Vector3d(motion.m.gyro_bias_b)).cross(p_b_c_);
}

/// Advances the track by the rotation and, if `moves`, by the metric displacement.
void FrontEnd::move(const MotionUpdate& motion, bool moves) {
  const odo_vo_motion& m = motion.m;
  const Vector3d d_o = moves ? motion.d_o : Vector3d(Vector3d::Zero());
  const Vector3d body_o = d_o - (motion.q_o_b1 * p_b_c_ - motion.from.q_o_b * p_b_c_);
  const double walk = squared(p_.drift_per_root_m) * d_o.norm();
  Vector3d variance(walk, walk, squared(p_.height_drift_per_root_m) * d_o.norm());
  if (!motion.inertial) {  // an inclination error is constant over the path: (sigma r)^2 at distance r
    const Vector3d from_o = tracker_.newest().p_o_b;
    const double further_m2 = (from_o + d_o).head<2>().squaredNorm() - from_o.head<2>().squaredNorm();
    variance.z() += tracker_.tilt_variance() * std::max(0.0, further_m2);
  }
  double outage_sigma_m = 0;  // a covered camera continues on inertia, whose errors accumulate coherently
  if (moves && motion.state != ODO_TRACKING && (m.header.flags & ODO_VO_COVARIANCE)) {
    outage_sigma_m = outage_sigma_m_ + std::sqrt(std::max({m.covariance[21], m.covariance[28], m.covariance[35]}));
    variance.array() += squared(outage_sigma_m) - squared(outage_sigma_m_);
  }
  outage_sigma_m_ = outage_sigma_m;
  const Quaterniond q_n_o = tracker_.localizer.q_n_o();
  const Vector3d body_n = q_n_o * body_o, d_n = q_n_o * d_o;
  tracker_.localizer.move(body_n, {{kHeading, across(body_n)}, {kLogScale, d_n}}, Matrix3d(variance.asDiagonal()));
  const double turned = heading_variance(motion);
  tracker_.localizer.add_variance(kHeading, turned);
  tracker_.push(m.header.t_ns, motion.q_o_b1, body_o, variance, turned);
  if (!moves) return tracker_.set_velocity(Vector3d::Zero(), Tracker::Velocity::none);
  camera_velocity_o_ = d_o / motion.dt_s;
  if (!motion.inertial) return tracker_.set_velocity(body_o / motion.dt_s, Tracker::Velocity::mean);
  camera_velocity_o_ = motion.q_o_b1 * q_b_c_ * Vector3d(m.velocity_c1);
  tracker_.set_velocity(camera_velocity_o_ - lever_velocity_o(motion), Tracker::Velocity::now);
  gyro_bias_b = Vector3d(m.gyro_bias_b), accel_bias_b = Vector3d(m.accel_bias_b);
}

void FrontEnd::reset() {
  scale_ = {}, scale_check_ = {}, group_ = {};
  lost_ = moves_ = false, outage_sigma_m_ = 0;
  first_frame_ns_ = translated_ns_ = priority_since_ns_ = INT64_MIN;
  gyro_bias_b.setZero(), accel_bias_b.setZero(), camera_velocity_o_.setZero();
}

void FrontEnd::on_calibration(const odo_calibration& calibration) {
  if ((calibration.header.flags & ODO_CALIBRATION_EXTRINSICS) == 0) return;
  q_b_c_ = quaternion(calibration.q_b_c);
  p_b_c_ = Vector3d(calibration.p_b_c);
}

void FrontEnd::begin(int64_t t_ns, bool has_stepped) {
  first_frame_ns_ = t_ns;
  tracker_.propagate(t_ns);
  const Quaterniond q_o_b = tracker_.at(t_ns).value_or(tracker_.newest()).q_o_b;
  if (!has_stepped) tracker_.start_camera_at(t_ns, q_o_b, p_b_c_);
  tracker_.push(t_ns, q_o_b, Vector3d::Zero());
  tracker_.rotate_with_camera();
  gyroscope_.start(q_b_c_);
}

FrontEnd::MotionUpdate FrontEnd::begin_motion(const odo_vo_motion& m) {
  const int64_t t_ns = m.header.t_ns;
  const uint32_t flags = m.header.flags;
  if (group_.any && m.scale_group != group_.id) scale_check_.restart();
  scale_check_.add_motion(seconds(t_ns - m.t_from_ns), m.state == ODO_TRACKING, (flags & ODO_VO_METRIC) != 0);
  const bool metric = (flags & ODO_VO_METRIC) != 0 && !scale_check_.rejected();
  if (!group_.any || m.scale_group != group_.id || metric != group_.metric) {
    group_.begin(m, metric);
    if (!tracker_.paper()) scale_.begin_group(tracker_.localizer);
  }
  lost_ = m.state == ODO_LOST;
  const TrackPoint from = tracker_.track().at(m.t_from_ns).value_or(tracker_.newest());
  MotionUpdate motion{m,
                      from,
                      from.q_o_b * q_b_c_,
                      from.q_o_b,
                      seconds(t_ns - m.t_from_ns),
                      metric,
                      metric && (flags & ODO_VO_INERTIAL) != 0,
                      false,
                      false,
                      true,
                      m.state,
                      m.reason,
                      Vector3d::Zero()};
  group_.inertial = motion.inertial;
  motion.rotates = (flags & ODO_VO_ROTATION) != 0 && (!lost_ || tracker_.paper());
  motion.translates = (flags & ODO_VO_TRANSLATION) != 0 && !lost_ && motion.dt_s > 0;
  if (!tracker_.paper() && motion.rotates && !rotates_with_gyroscope(m)) motion.rotates = motion.translates = false;
  const auto q_o_b1 = rotated(motion);
  motion.rotation_known = q_o_b1.has_value();
  motion.q_o_b1 = q_o_b1.value_or(from.q_o_b);
  correct_inclination(motion);
  if (motion.translates) {
    motion.d_o = motion.q_o_c0 * Vector3d(m.p_c0_c1);
    group_.add(t_ns, motion.d_o);
  }
  return motion;
}

/// A displacement that only a failure of tracking or scale explains. With unknown scale, the bound is relaxed by three
/// sigma of the scale prior.
bool FrontEnd::is_impossible(const MotionUpdate& motion) const {
  const bool in_metres = motion.metric || inputs_.scale || scale_.known();
  const double units = in_metres ? 1 : std::exp(3 * ScaleUpdate::Parameters().unknown_sigma);
  return tracker_.is_impossible(motion.d_o.norm() / units, motion.dt_s);
}

FrontEnd::Outcome FrontEnd::apply(const RelativeMotion& relative, const TrackState& track) {
  const odo_vo_motion& m = *relative.motion;
  const int64_t t_ns = m.header.t_ns;
  MotionUpdate motion = begin_motion(m);
  motion.doubtful = track.shown || track.placed;
  const Vector3d units_o = motion.d_o;
  bool moves = apply_metric_scale(motion, relative.scale) && motion.translates;
  if (motion.translates && !moves) {
    group_.add_unscaled(m.t_from_ns, units_o);
    if (motion.state == ODO_TRACKING) motion.state = ODO_DEGRADED, motion.reason = ODO_REASON_NO_SCALE;
  }
  moves_ = motion.translates;
  if (moves && is_impossible(motion)) {
    moves = moves_ = false;
    motion.state = ODO_DEGRADED, motion.reason = ODO_REASON_TOO_FAST;
  }
  const bool begins = moves && motion.inertial && !track.shown && !track.fixed && !track.has_stepped;
  if (moves && motion.doubtful && !begins) tracker_.add_gap(m.t_from_ns);
  if (begins) {
    back_propagate_start(motion);
    motion.d_o.setZero();
  } else if (moves && tracker_.coverage.until_ns() > m.t_from_ns) {  // steps have moved the track meanwhile
    motion.d_o *= tracker_.coverage.missing(m.t_from_ns, t_ns);
  }
  move(motion, moves);
  group_.scale_converged = group_.scale_converged || scale_.own_information() > 1 / squared(p_.converged_scale_sigma);
  if (!moves || !has_priority()) priority_since_ns_ = t_ns;
  if (moves) {
    tracker_.coverage.add(m.t_from_ns, t_ns);
    tracker_.rotate_with_camera();
    translated_ns_ = t_ns;
  }
  return {motion.state,       motion.reason, moves,          motion.caught_up_m + (moves ? motion.d_o.norm() : 0.0),
          motion.caught_up_m, motion.metric, motion.inertial};
}

UpdateResult FrontEnd::apply(const odo_scale& scale) {
  if (tracker_.paper() || !group_.any || scale.scale_group != group_.id || group_.metric) return {};
  return scale_.use(tracker_.localizer, scale);
}

bool FrontEnd::has_priority() const {
  return group_.inertial && scale_.own_information() > 1 / squared(p_.priority_scale_sigma);
}

bool FrontEnd::is_metric_scale_known() const {
  return group_.metric && scale_.own_information() > 1 / squared(p_.converged_scale_sigma);
}

bool FrontEnd::is_silent(int64_t now_ns) const {
  if (!begun()) return true;
  if (translated_ns_ == INT64_MIN) return seconds(now_ns - first_frame_ns_) > p_.silent_start_s;
  return lost_ || seconds(now_ns - translated_ns_) > tracker_.parameters().unobserved_s;
}

bool FrontEnd::check_metric_scale(const odo_step& step, const Vector3d& moved_o) {
  if ((!group_.metric && !scale_check_.rejected()) || step.mode == ODO_MODE_STAIRS) return false;
  if (!scale_check_.add(step.length_m, moved_o.head<2>().norm())) return false;
  if (scale_check_.rejected())  // discards the step factor learned since the scale went wrong
    tracker_.localizer.set(kLogFactor, scale_check_.log_factor(), scale_check_.variance());
  return true;
}

}  // namespace odograph
