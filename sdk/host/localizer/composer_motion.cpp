// SPDX-License-Identifier: Apache-2.0
//
// What a front-end's motion does: rotation, scale, displacement, and how uncertain they leave the track.
#include <algorithm>
#include <cmath>

#include "sdk/host/base/rotation.hpp"
#include "sdk/host/localizer/composer.hpp"
#include "sdk/host/messages/messages.hpp"

namespace odograph {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

double seconds(int64_t ns) { return static_cast<double>(ns) * kNanoseconds; }

}  // namespace

void Composer::begin_group(const odo_vo_motion& motion, bool metric) {
  group_ = {};
  group_.any = true;
  group_.id = motion.scale_group;
  group_.metric = metric;
  group_.began_ns = motion.t_from_ns;
  path_.clear();
  path_.add(motion.t_from_ns, group_.y_o);
  scale_.begin_group();
  if (!paper()) localizer_.set(kLogScale, 0, squared(p_.unknown_scale_sigma));
}

bool Composer::turn_by_gyroscope(const odo_vo_motion& m) {
  const auto from = inertia_.at(m.t_from_ns, 0.05), to = inertia_.at(m.header.t_ns, 0.05);
  const double dt_s = seconds(m.header.t_ns - m.t_from_ns);
  if (!from || !to || dt_s <= 0) return false;
  const Quaterniond q_c0_c1 = q_b_c_.conjugate() * from->q_e_b.conjugate() * to->q_e_b * q_b_c_;
  const Vector3d force_c = q_b_c_.conjugate() * (to->q_e_b.conjugate() * ((to->v_e - from->v_e) / dt_s));
  gyro_.propagate(q_c0_c1, dt_s);
  // With parallax a picture's rotation and translation are too much alike to tell a bias.
  const bool pure = m.reason == ODO_REASON_NO_PARALLAX && (m.header.flags & ODO_VO_ROTATION) != 0;
  const bool stated = (m.header.flags & ODO_VO_COVARIANCE) != 0;
  if (pure)
    gyro_.update_relative_rotation(q_c0_c1, quaternion(m.q_c0_c1),
                                   stated ? std::sqrt(std::max({m.covariance[0], m.covariance[7], m.covariance[14]})) : 0,
                                   dt_s);
  gyro_.update_gravity(force_c, pure);
  return true;
}

/// Whether the front-end has turned as the gyroscope has; a picture of the inside of a pocket turns otherwise.
bool Composer::turns_with_gyroscope(const odo_vo_motion& m) const {
  const auto from = inertia_.at(m.t_from_ns, 0.05), to = inertia_.at(m.header.t_ns, 0.05);
  if (!from || !to) return true;
  const Quaterniond q_b0_b1 = from->q_e_b.conjugate() * to->q_e_b;
  const Quaterniond q_c0_c1 = q_b_c_.conjugate() * q_b0_b1 * q_b_c_;
  const double off_rad = log_rotation(quaternion(m.q_c0_c1).conjugate() * q_c0_c1).norm();
  const double dt_s = seconds(m.header.t_ns - m.t_from_ns);
  return off_rad < p_.rotation_off_rad + p_.rotation_off_share * log_rotation(q_b0_b1).norm() +
                       p_.heading_rate_radps * dt_s;
}

/// The body in o at the motion's end, by what the config prefers and what there is.
std::optional<Quaterniond> Composer::turned(const Moving& moving) {
  const odo_vo_motion& m = moving.m;
  if (config_.orientation == Orientation::attitude && attitudes_.at(m.header.t_ns))
    return *attitudes_.at(m.header.t_ns);
  if (config_.orientation == Orientation::gyroscope && turn_by_gyroscope(m)) return gyro_.q_n_c() * q_b_c_.conjugate();
  if (moving.rotates) return moving.q_o_c0 * quaternion(m.q_c0_c1) * q_b_c_.conjugate();
  if (const auto q_o_b = by_attitude(m.header.t_ns)) return *q_o_b;
  const auto from = inertia_.at(m.t_from_ns, 0.05), to = inertia_.at(m.header.t_ns, 0.05);
  if (!from || !to) return std::nullopt;
  return moving.from.q_o_b * from->q_e_b.conjugate() * to->q_e_b;
}

/// Of the heading, rad^2. A front-end with inertia that has not walked yet knows the gyroscope's bias badly, and that
/// is one error for all that time: (sigma T)^2 grows by 2 sigma^2 T dt.
double Composer::heading_variance(const Moving& moving, bool turn_known) const {
  if (!turn_known) return squared(p_.gap_turn) * moving.dt_s;
  if (!moving.inertial) return squared(p_.rotation_walk) * moving.dt_s;
  double rate = squared(p_.inertial_rotation_walk);
  if (!inertia_.at(moving.m.t_from_ns, 0.05)) rate += squared(p_.gap_turn);  // it has had no gyroscope
  if (!group_.walked) {
    const odo_vo_motion& m = moving.m;
    const double stated = (m.header.flags & ODO_VO_COVARIANCE)
                              ? std::sqrt(std::max({m.covariance[0], m.covariance[7], m.covariance[14]})) / moving.dt_s
                              : p_.start_rate_radps;
    rate += 2 * squared(std::min(stated, p_.start_rate_radps)) * seconds(m.header.t_ns - group_.began_ns);
  }
  return rate * moving.dt_s;
}

/// Whether the camera walks: its doubt about the displacement is one about the scale.
bool Composer::walks(int64_t t_ns) const {
  const auto before = path_.at(t_ns - 1'000'000'000);
  return before && std::exp(localizer_.x[kLogScale]) * (group_.y_o - *before).norm() > p_.walking_m;
}

/// The papers' rule: each motion has its own scale, whose errors are common to the path.
bool Composer::scale_as_in_papers(Moving& moving, const odo_scale* scale) {
  if (!inputs_.scale) return true;
  if (!scale) return false;
  moving.d_o *= scale->scale;
  const bool horizontal = (scale->header.flags & ODO_SCALE_HORIZONTAL) != 0 && config_.vertical == Vertical::ignore;
  if (horizontal) moving.d_o.z() = 0.0;
  const double relative = scale->scale > 0 ? std::min(1.0, scale->sigma / scale->scale) : 0.0;
  localizer_.x[kLogScale] = scale->scale > 0 ? std::log(scale->scale) : 0.0;
  localizer_.restate(kLogScale, squared(relative));
  if (moving.translates) catch_up(scale, horizontal);
  return true;
}

/// Metres of the displacement; false where none are known.
bool Composer::scale(Moving& moving, const odo_scale* scale) {
  const odo_vo_motion& m = moving.m;
  if (moving.metric) {
    if (moving.translates) {
      const bool stated = moving.inertial || m.scale_sigma > 0;
      localizer_.add_variance(kLogScale, squared(p_.metric_scale_walk) * moving.dt_s);
      scale_.use_own(localizer_, stated ? m.scale_sigma : p_.unstated_scale_sigma, walks(m.header.t_ns));
    }
    if (!paper()) moving.d_o *= std::exp(localizer_.x[kLogScale]);
    return true;
  }
  if (paper()) return scale_as_in_papers(moving, scale);
  if (scale) scale_.use(localizer_, *scale);
  if (!scale_.known()) return false;
  moving.d_o *= std::exp(localizer_.x[kLogScale]);
  const double walk = metre_check_.doubted() ? p_.doubted_scale_walk : p_.scale_walk;
  localizer_.add_variance(kLogScale, squared(walk) * moving.d_o.norm());
  catch_up(scale, false);
  return true;
}

/// What the group moved before its scale was known, once it holds for that too and nothing else has moved the track.
void Composer::catch_up(const odo_scale* scale, bool horizontal) {
  const Vector3d waiting_o = std::exchange(group_.unscaled_o, Vector3d::Zero());
  if (waiting_o.isZero() || (paper() && !(scale && (scale->header.flags & ODO_SCALE_STEADY)))) return;
  if (coverage_.missing(group_.began_ns, track_.newest().t_ns) < 0.5) return;
  Vector3d d_o = std::exp(localizer_.x[kLogScale]) * waiting_o;
  if (horizontal) d_o.z() = 0;
  const Vector3d d_n = localizer_.q_n_o() * d_o;
  localizer_.move(d_n, {{kHeading, across(d_n)}, {kLogScale, d_n}}, Matrix3d::Zero());
  push(track_.newest().t_ns, track_.newest().q_o_b, d_o);
  distance_m_ += paper() ? d_o.norm() : 0;
  coverage_.add(group_.began_ns, track_.newest().t_ns);
}

/// A front-end with inertia knows the vertical: inclination is its own. Another's is mended slowly by the attitude.
void Composer::level(Moving& moving) {
  Vector3d down_b = q_b_c_ * Vector3d(moving.m.gravity_c1);
  double share = 1;
  if (!moving.inertial) {
    const auto q_a_b = attitudes_.at(moving.m.header.t_ns);
    if (!q_a_b) return;
    down_b = q_a_b->conjugate() * Vector3d::UnitZ();
    share = std::min(1.0, moving.dt_s / p_.tilt_time_s);
  }
  const Quaterniond up = Quaterniond::FromTwoVectors(moving.q_o_b1 * down_b, Vector3d::UnitZ());
  moving.q_o_b1 = (Quaterniond::Identity().slerp(share, up) * moving.q_o_b1).normalized();
}

/// The first metric motion: where it began follows from the velocity and the inertial samples since the first frame,
/// p(T) - p(0) = v T - int t a dt; before that the camera is taken to have stood.
void Composer::begin_here(const Moving& moving) {
  const int64_t to_ns = moving.m.header.t_ns;
  const int64_t from_ns = std::max({coverage_.until_ns(), to_ns - static_cast<int64_t>(p_.rewind_s * 1e9),
                                    inertia_.oldest_ns()});
  coverage_.begin(to_ns);
  const auto from = inertia_.at(from_ns, 0), to = inertia_.at(to_ns, 0.05);
  if (!from || !to || to_ns <= from_ns) return;
  const double T = seconds(to_ns - from_ns);
  const Quaterniond q_o_e = moving.q_o_b1 * to->q_e_b.conjugate();
  const Vector3d v_o = moving.q_o_b1 * q_b_c_ * Vector3d(moving.m.velocity_c1);
  const Vector3d force_o = moving.q_o_b1 * Vector3d(moving.m.accel_bias_b);
  constexpr double kGravity_mps2 = 9.81;
  const Vector3d constant_o = Vector3d(0, 0, kGravity_mps2) - force_o;
  // In e: int_0^T t f dt = T v(T) - (p(T) - p(0)), with v(T) counted from v(0) = v_e of the earlier point.
  const Vector3d moved_e = to->p_e - from->p_e - T * to->v_e;
  const Vector3d d_o = T * v_o + q_o_e * moved_e - 0.5 * T * T * constant_o;
  const Vector3d d_n = localizer_.q_n_o() * d_o;
  localizer_.move(d_n, {{kHeading, across(d_n)}}, Matrix3d::Identity() * squared(p_.rewind_sigma_mps * T));
  push(to_ns, moving.q_o_b1, d_o);
}

/// The track goes on, by the rotation, and where there is a displacement in metres by that.
void Composer::move_by(const Moving& moving, bool moves, bool turn_known) {
  const odo_vo_motion& m = moving.m;
  const Vector3d d_o = moves ? moving.d_o : Vector3d(Vector3d::Zero());
  const Vector3d body_o = d_o - (moving.q_o_b1 * p_b_c_ - moving.from.q_o_b * p_b_c_);
  Vector3d variance = Vector3d::Constant(squared(p_.drift_per_root_m) * d_o.norm());
  variance.z() = squared(p_.height_drift_per_root_m) * d_o.norm();
  // Blind, it goes on by inertia: its errors are one error.
  if (moves && moving.state != ODO_TRACKING && (m.header.flags & ODO_VO_COVARIANCE)) {
    const double grown_m = blind_sigma_m_ + std::sqrt(std::max({m.covariance[21], m.covariance[28], m.covariance[35]}));
    variance.array() += squared(grown_m) - squared(blind_sigma_m_);
    blind_sigma_m_ = grown_m;
  } else {
    blind_sigma_m_ = 0;
  }
  const Quaterniond q_n_o = localizer_.q_n_o();
  const Vector3d body_n = q_n_o * body_o, d_n = q_n_o * d_o;
  localizer_.move(body_n, {{kHeading, across(body_n)}, {kLogScale, d_n}}, Matrix3d(variance.asDiagonal()));
  const double turned = heading_variance(moving, turn_known);
  localizer_.add_variance(kHeading, turned);
  push(m.header.t_ns, moving.q_o_b1, body_o);
  TrackPoint now = track_.newest();
  now.drift_m2 += variance, now.heading_drift_rad2 += turned;
  track_.push(now);
  if (paper()) distance_m_ += d_o.norm();
  velocity_ = Velocity::none;
  velocity_o_.setZero();
  if (!moves || moving.dt_s <= 0) return;
  velocity_ = moving.inertial ? Velocity::now : Velocity::mean;
  velocity_o_ = moving.inertial ? Vector3d(moving.q_o_b1 * q_b_c_ * Vector3d(m.velocity_c1)) : Vector3d(d_o / moving.dt_s);
  if (moving.inertial) gyro_bias_b_ = Vector3d(m.gyro_bias_b), accel_bias_b_ = Vector3d(m.accel_bias_b);
}

UpdateResult Composer::apply(const RelativeMotion& relative) {
  const odo_vo_motion& m = *relative.motion;
  const int64_t t_ns = m.header.t_ns;
  if (!started_) start_without_attitude(m.t_from_ns);
  if (!camera_) begin_camera(m.t_from_ns);
  go_on(t_ns);
  if (group_.any && m.scale_group != group_.id) metre_check_.restart();
  const uint32_t flags = m.header.flags;
  metre_check_.add_motion(seconds(t_ns - m.t_from_ns), m.state == ODO_TRACKING, (flags & ODO_VO_METRIC) != 0);
  const bool metric = (flags & ODO_VO_METRIC) != 0 && !metre_check_.doubted();
  if (!group_.any || m.scale_group != group_.id || metric != group_.metric) begin_group(m, metric);
  lost_ = m.state == ODO_LOST;
  const auto from = track_.at(m.t_from_ns);
  Moving moving{m, from ? *from : track_.newest(), {}, {}, seconds(t_ns - m.t_from_ns), false, false, metric,
                metric && (flags & ODO_VO_INERTIAL) != 0, m.state, m.reason};
  group_.inertial = moving.inertial;
  moving.rotates = (flags & ODO_VO_ROTATION) != 0 && (!lost_ || paper());
  moving.translates = (flags & ODO_VO_TRANSLATION) != 0 && !lost_ && moving.dt_s > 0;
  if (!paper() && moving.rotates && !turns_with_gyroscope(m)) moving.rotates = moving.translates = false;
  moving.q_o_c0 = moving.from.q_o_b * q_b_c_;
  const auto q_o_b1 = turned(moving);
  moving.q_o_b1 = q_o_b1.value_or(moving.from.q_o_b);
  if (!paper()) level(moving);
  if (moving.translates) {
    moving.d_o = moving.q_o_c0 * Vector3d(m.p_c0_c1);
    group_.y_o += moving.d_o;
    path_.add(t_ns, group_.y_o);
  }
  const Vector3d unscaled_o = moving.d_o;
  bool moves = scale(moving, relative.scale) && moving.translates;
  const bool in_metres = metric || inputs_.scale || scale_.known();
  if (moves && in_metres && moving.d_o.norm() > p_.impossible * config_.fastest_mps * moving.dt_s) {
    moves = false;
    moving.state = ODO_DEGRADED, moving.reason = ODO_REASON_TOO_FAST;
  }
  const bool unscaled = moving.translates && !moves && moving.reason != ODO_REASON_TOO_FAST;
  if (unscaled) group_.unscaled_o += unscaled_o;
  if (unscaled && moving.state == ODO_TRACKING) moving.state = ODO_DEGRADED, moving.reason = ODO_REASON_NO_SCALE;
  if (moves && moving.inertial && !metric_ && !is_placed() && !steps_.any()) begin_here(moving), moves = false;
  if (moves && coverage_.until_ns() > m.t_from_ns) {  // steps have carried on meanwhile: only what is after them
    const double after = coverage_.missing(m.t_from_ns, t_ns);
    moving.d_o *= after;
  }
  move_by(moving, moves, q_o_b1.has_value());
  group_.walked = group_.walked || scale_.own_information() > 1 / squared(p_.walked_scale_sigma);
  moves_ = moving.translates && moving.reason != ODO_REASON_TOO_FAST;
  const bool leads = moving.inertial && scale_.own_information() > 1 / squared(p_.lead_scale_sigma) && moves;
  if (!leads) leads_since_ns_ = t_ns;
  if (moving.translates && (metric || scale_.known() || (paper() && moves))) {
    coverage_.add(m.t_from_ns, t_ns);
    translated_ns_ = t_ns;
    carried_ = false;
    metric_ = metric_ || metric || scale_.known();
    set_source(metric ? MotionSource(MetricSource{moving.inertial}) : MotionSource(ScaledSource{scale_.known()}));
  }
  if (!paper()) settle_steps(t_ns);
  const int64_t moved_ns = std::max(translated_ns_, step_ns_);
  if (moving.state == ODO_LOST && moved_ns != INT64_MIN && seconds(t_ns - moved_ns) < config_.bridge_s)
    moving.state = ODO_DEGRADED;
  publish(t_ns, moving.state, moving.reason);
  return {moves, 0.0, 0};
}

UpdateResult Composer::apply(const odo_scale* scale) {
  if (paper() || !group_.any || scale->scale_group != group_.id || group_.metric) return {};
  return scale_.use(localizer_, *scale);
}

}  // namespace odograph
