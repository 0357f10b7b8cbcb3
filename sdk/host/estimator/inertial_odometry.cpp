// SPDX-License-Identifier: Apache-2.0
//
// Relative motion of a front-end and its scale. The odometry's pose is a part of the state: it goes on by each motion
// and is tied to the body's by "the odometry's position errs by so much against its map", so that motions that share a
// pose are not taken for independent.
#include <algorithm>
#include <cmath>

#include "sdk/host/base/rotation.hpp"
#include "sdk/host/estimator/inertial_estimator.hpp"
#include "sdk/host/messages/messages.hpp"

namespace odograph {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using namespace inertial;

namespace {

double seconds(int64_t ns) { return static_cast<double>(ns) * kNanoseconds; }
double squared(double x) { return x * x; }

}  // namespace

UpdateResult InertialEstimator::apply(const FrameTime& frame) {
  if (!inputs_.vo || camera_) return {};
  if (!started_) start_without_attitude(frame.t_ns);
  advance_to(frame.t_ns);
  flush();
  camera_ = true;
  first_frame_ns_ = frame.t_ns;
  if (!stepped_ || frame.t_ns - step_ns_ > p_.steps_tell_velocity_ns)  // may walk already
    for (int i = 0; i < 3; ++i) e_.set_independent(kVelocity + i, squared(p_.start_speed_sigma_mps));
  if (!metric_ && placed_ == 0) {  // the start is the camera's
    const Vector3d moved = Vector3d(start_.position_m.data()) - (e_.x.p_n + e_.x.q_n_b * p_b_c_);
    e_.x.p_n += moved;
    e_.set_independent(kPosition, 0.0);
    e_.set_independent(kPosition + 1, 0.0);
    e_.set_independent(kPosition + 2, 0.0);
    e_.forget_clones();
    e_.clone(t_ns_);
    track_.begin_segment();
  }
  first_p_n_ = e_.x.p_n;
  publish(frame.t_ns, ODO_DEGRADED, ODO_REASON_INITIALISING);
  return {true, 0.0, 0};
}

void InertialEstimator::detach() {
  vo_.attached = false;
  window_.restart();
}

bool InertialEstimator::attach(int64_t t_ns) {
  const auto at = past(t_ns);
  if (!at) return false;
  e_.attach_vo(*at, q_b_c_, p_b_c_, squared(vo_.sigma_m), squared(p_.vo_rotation_sigma_rad));
  vo_.attached = true;
  window_.restart();
  return true;
}

void InertialEstimator::begin_group(const odo_vo_motion& motion, bool metric) {
  const bool first = !vo_.any;
  const double sigma_m = vo_.sigma_m;
  vo_ = {};
  vo_.first_group = first;
  vo_.sigma_m = sigma_m;
  vo_.any = true;
  vo_.group = motion.scale_group;
  vo_.began_ns = motion.t_from_ns;
  vo_.metric = metric;
  e_.x.log_scale = 0;
  e_.set_independent(kLogScale, squared(p_.unknown_scale_sigma));
  if (const auto at = past(motion.t_from_ns)) vo_.start_n = at->p_n + at->q_n_b * p_b_c_;
  scale_start_.restart();
  scale_start_.add_motion(motion.t_from_ns, vo_.y_n);
  detach();
}

/// Whether the front-end was blind since steps and its metre agreed.
void InertialEstimator::watch_metre(const odo_vo_motion& motion) {
  if (vo_.any && motion.scale_group != vo_.group) metre_check_.restart();
  metre_check_.add_motion(seconds(motion.header.t_ns - motion.t_from_ns), motion.state == ODO_TRACKING,
                          (motion.header.flags & ODO_VO_METRIC) != 0);
}

UpdateResult InertialEstimator::apply(const RelativeMotion& relative) {
  const odo_vo_motion& m = *relative.motion;
  const uint32_t flags = m.header.flags;
  const int64_t t = m.header.t_ns;
  if (!started_) start_without_attitude(m.t_from_ns);
  camera_ = true;
  advance_to(t);
  flush();
  watch_metre(m);
  const bool metric = (flags & ODO_VO_METRIC) != 0 && !metre_check_.doubted(), lost = m.state == ODO_LOST;
  const bool rotates = (flags & ODO_VO_ROTATION) != 0 && !lost;
  const bool translates = rotates && (flags & ODO_VO_TRANSLATION) != 0;
  inertial_front_end_ = metric && (flags & ODO_VO_INERTIAL) != 0;
  if (!vo_.any || m.scale_group != vo_.group || metric != vo_.metric) begin_group(m, metric);
  const double dt_s = seconds(t - m.t_from_ns);
  UpdateResult result;
  if (!translates) {  // without parallax, before the first motion, the camera is still where it was
    vo_.unbroken = vo_.unbroken && !lost && vo_.y_n.isZero();
    detach();
  }
  if (translates && dt_s > 0) {
    if (vo_.attached && vo_.t_ns != m.t_from_ns) vo_.unbroken = false, detach();
    if (!vo_.attached) attach(m.t_from_ns);
    if (vo_.attached) {
      const Vector3d p_c0_c1(m.p_c0_c1);
      const Vector3d expected_n = expected_displacement(t, std::exp(e_.x.log_scale) * (e_.x.q_n_vo * p_c0_c1));
      const double length_m = expected_n.norm();
      vo_.y_n += e_.x.q_n_vo * p_c0_c1;
      e_.move_vo(quaternion(m.q_c0_c1), p_c0_c1, expected_n, squared(p_.vo_drift_per_root_m) * length_m,
                 rotation_variance(m, dt_s));
      const double walk = metre_check_.doubted() ? p_.doubted_scale_walk : p_.vo_scale_walk;
      e_.add_variance(kLogScale, 1, metric ? squared(p_.vio_scale_walk) * dt_s : squared(walk) * length_m);
      vo_.t_ns = t;
      if (metric) use_metric_scale(m);
      vo_.has_walked = vo_.has_walked || vo_.own_information > 1 / squared(p_.taught_scale_sigma);
      see_rotation(t, dt_s);
      if (vo_.known) result = see_position(t, dt_s);
      scale_start_.add_motion(t, vo_.y_n);
      if (inertial_front_end_) {
        use_inertial(m);
      } else if (const auto at = past(t)) {
        const auto window =
            window_.add_frame(t, at->q_n_b * p_b_c_, vo_.y_n, vo_.known ? p_.window_s : p_.start_window_s);
        // A front-end that was wrong about its metre was so about the same accelerometer's word.
        if (window && !metric && !metre_check_.doubted()) use_window(*window);
      }
      try_scale_start(t);
      vo_.translated_ns = t;
      if (vo_.known) informed_ns_ = t_ns_;
    }
  }
  if (!led()) led_since_ns_ = t;
  if (relative.scale) apply(relative.scale);
  uint32_t state = m.state, reason = m.reason;
  if (state == ODO_TRACKING && !vo_.known) state = ODO_DEGRADED, reason = ODO_REASON_NO_SCALE;
  const int64_t carried_ns = std::max(vo_.translated_ns, step_ns_);
  if (state == ODO_LOST && carried_ns != INT64_MIN && seconds(t - carried_ns) < config_.bridge_s) state = ODO_DEGRADED;
  publish(t, state, reason);
  return result;
}

/// The camera's displacement since the last motion as the IMU has it, or where that is not known the odometry's own.
Vector3d InertialEstimator::expected_displacement(int64_t t_ns, const Vector3d& odometry_n) const {
  const auto from = past(vo_.t_ns), to = past(t_ns);
  if (!vo_.known || !from || !to || vo_.t_ns == INT64_MIN) return odometry_n;
  return to->p_n + to->q_n_b * p_b_c_ - (from->p_n + from->q_n_b * p_b_c_);
}

/// The body is where the odometry has it: closely where that has used inertia itself, unless the IMU disagrees;
/// otherwise as well as an odometry is against its map.
UpdateResult InertialEstimator::tie(Innovation<3>& seen, double inertial_sigma, double sigma, double dt_s, Hold hold) {
  if (hold == Hold::odometry_and_scale) {
    seen.noise = Matrix3d::Identity() * squared(inertial_sigma);
    if (const UpdateResult result = e_.update(seen, p_.gate[3], hold); result.accepted) return result;
  }
  const double same = std::max(1.0, p_.vo_correlation_s / dt_s);  // frames that share one error
  seen.noise = Matrix3d::Identity() * (squared(sigma) * same);
  return e_.update(seen, p_.gate[3], hold);
}

/// What a motion adds to the doubt about the odometry's rotation, rad^2. Errors against the gyroscope beyond the usual
/// ones are renewed each correlation time, and each leaves its trace. A front-end with inertia that has not walked yet
/// knows the gyroscope's bias badly, and that is one error for all that time: sigma^2 T^2 grows by 2 sigma^2 T dt.
double InertialEstimator::rotation_variance(const odo_vo_motion& m, double dt_s) const {
  if (!inertial_front_end_) return squared(p_.vo_rotation_walk) * dt_s;
  const double unusual = std::max(0.0, vo_.rotation_ms - squared(p_.vio_rotation_sigma_rad));
  double rate = squared(p_.vio_rotation_walk) + unusual / p_.vo_correlation_s;
  if (!vo_.has_walked) {
    const double stated = (m.header.flags & ODO_VO_COVARIANCE)
                              ? std::sqrt(std::max({m.covariance[0], m.covariance[7], m.covariance[14]})) / dt_s
                              : p_.vio_start_rate_radps;
    rate += 2 * squared(std::min(stated, p_.vio_start_rate_radps)) * seconds(m.header.t_ns - vo_.began_ns);
  }
  return rate * dt_s;
}

UpdateResult InertialEstimator::see_rotation(int64_t t_ns, double dt_s) {
  const auto at = past(t_ns);
  if (!at) return {};
  Innovation<3> seen;  // of the difference, which is zero but for the odometry's error
  seen.residual = -log_rotation(e_.x.q_n_vo * (at->q_n_b * q_b_c_).conjugate());
  seen.by(kVo, Matrix3d::Identity());
  seen.by_pose(*at, -Matrix3d::Identity(), Matrix3d::Zero());
  const double weight = std::min(1.0, dt_s / p_.vo_rotation_memory_s);
  vo_.rotation_ms += weight * (seen.residual.squaredNorm() / 3 - vo_.rotation_ms);
  const double measured = std::sqrt(vo_.rotation_ms);
  // Until the gyroscope's bias is known the heading of a start is the bias's to mend, and the odometry's with it.
  const bool settled = e_.P.diagonal().segment<3>(kGyroBias).maxCoeff() < squared(p_.settled_gyro_bias_radps);
  const UpdateResult result = tie(seen, std::max(p_.vio_rotation_sigma_rad, measured),
                                  std::max(p_.vo_rotation_sigma_rad, measured), dt_s, settled ? follow() : calm());
  if (!result.accepted) attach(t_ns);
  return result;
}

UpdateResult InertialEstimator::see_position(int64_t t_ns, double dt_s) {
  const auto at = past(t_ns);
  if (!at) return {};
  const Vector3d lever_n = at->q_n_b * p_b_c_;
  Innovation<3> seen;
  seen.residual = at->p_n + lever_n - e_.x.p_n_vo;
  seen.by(kVoPosition, Matrix3d::Identity());
  seen.by_pose(*at, skew(lever_n), -Matrix3d::Identity());
  // What inertia says of the scale comes by use_window, whose regression knows that the odometry errs; here it would
  // be pulled towards zero.
  const UpdateResult result =
      tie(seen, p_.vio_position_sigma_m, vo_.sigma_m, dt_s, inertial_front_end_ ? follow() : Hold::scale_and_factor);
  if (result.accepted) {
    vo_.rejected = 0;
    return result;
  }
  if (++vo_.rejected > p_.max_rejected) {  // it is not the odometry that is wrong
    vo_.rejected = 0;
    for (int i = 0; i < 3; ++i) e_.set_independent(kVelocity + i, squared(p_.jump_velocity_sigma_mps));
    for (int i = 0; i < 3; ++i) e_.set_independent(kAccelBias + i, squared(p_.accel_bias_sigma));
    e_.x.accel_bias_b.setZero();
    if (const double speed = e_.x.v_n.norm(); speed > config_.fastest_mps) e_.x.v_n *= config_.fastest_mps / speed;
  }
  attach(t_ns);
  return result;
}

/// Velocity and inclination of a front-end that has used the IMU itself.
void InertialEstimator::use_inertial(const odo_vo_motion& m) {
  const int64_t t = m.header.t_ns;
  const auto at = past(t);
  if (!at) return;
  const Quaterniond q_n_c = at->q_n_b * q_b_c_;
  if (e_.P.diagonal().segment<3>(kVelocity).maxCoeff() > squared(p_.vio_velocity_unknown_mps) &&
      seconds(t_ns_ - t) < p_.vio_velocity_now_s) {
    Innovation<3> velocity;
    const Vector3d v_n = std::exp(e_.x.log_scale) * (q_n_c * Vector3d(m.velocity_c1));
    velocity.residual = v_n - e_.x.v_n;
    velocity.by(kVelocity, Matrix3d::Identity());
    velocity.by_one(kLogScale, -v_n);
    velocity.by_pose(*at, skew(v_n), Matrix3d::Zero());
    velocity.noise = Matrix3d::Identity() * squared(p_.vio_velocity_sigma_mps);
    e_.update(velocity, p_.gate[3], follow());
  }
  if (vo_.gravity_ns != INT64_MIN && seconds(t - vo_.gravity_ns) < p_.gravity_interval_s) return;
  vo_.gravity_ns = t;
  Innovation<2> down;
  const Vector3d g_n = q_n_c * Vector3d(m.gravity_c1);
  down.residual = -g_n.head<2>();
  Eigen::Matrix<double, 2, 3> by_theta;
  by_theta << 0, 1, 0, -1, 0, 0;
  down.by_pose(*at, by_theta, Eigen::Matrix<double, 2, 3>::Zero());
  // Worth one a second, in small portions: a tilt that is mended moves the height that it has led to.
  const double same = p_.attitude_interval_s / p_.gravity_interval_s;
  down.noise = Eigen::Matrix2d::Identity() * (squared(p_.attitude_unaided_tilt_rad) * same);
  if (e_.update(down, p_.gate[2], calm()).accepted)
    vo_.gravity_rejected = 0;
  else if (++vo_.gravity_rejected > p_.max_rejected && led())
    horizontal(g_n);
}

/// The inclination here is wrong, by more than a filter that is linearised can mend: a phone that was thrown about when
/// its first sample was taken for gravity. The track is turned about where the body is; what inertia has made of the
/// velocity and its bias meanwhile is forgotten.
void InertialEstimator::horizontal(const Vector3d& gravity_n) {
  vo_.gravity_rejected = 0;
  flush();
  rotate_track(Quaterniond::FromTwoVectors(gravity_n, Vector3d::UnitZ()), e_.x.p_n);
  for (int i = 0; i < 2; ++i) e_.set_independent(kTheta + i, squared(p_.attitude_unaided_tilt_rad));
  for (int i = 0; i < 3; ++i) e_.set_independent(kVelocity + i, squared(p_.jump_velocity_sigma_mps));
  for (int i = 0; i < 3; ++i) e_.set_independent(kAccelBias + i, squared(p_.accel_bias_sigma));
  e_.x.accel_bias_b.setZero();
  if (const double speed = e_.x.v_n.norm(); speed > config_.fastest_mps) e_.x.v_n *= config_.fastest_mps / speed;
  e_.forget_clones();
  e_.clone(t_ns_);
  track_.begin_segment();
  detach();
}

/// All that was told in n is turned about a place.
void InertialEstimator::rotate_track(const Quaterniond& q, const Vector3d& about_n) {
  e_.rotate(q, about_n);
  track_.rotate(q);
  vo_.y_n = (q * vo_.y_n).eval();
  vo_.start_n = about_n + q * (vo_.start_n - about_n);
  window_.restart();
  scale_start_.restart();
}

}  // namespace odograph
