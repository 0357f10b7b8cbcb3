// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/estimator/per_frame_coupling.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sdk/host/base/rotation.hpp"
#include "sdk/host/messages/messages.hpp"

namespace odograph {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using RowMatrix3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

Quaterniond about_down(double angle_rad) { return Quaterniond(Eigen::AngleAxisd(angle_rad, Vector3d::UnitZ())); }

/// Of a motion's rotation, in c0; only where ODO_VO_COVARIANCE is set.
Matrix3d rotation_covariance_of(const odo_vo_motion& motion) {
  return Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(motion.covariance).topLeftCorner<3, 3>();
}

double seconds(int64_t ns) { return static_cast<double>(ns) * kNanoseconds; }

}  // namespace

PerFrameCoupling::PerFrameCoupling(const CouplingConfig& config, const StartPose& start, EstimatorInputs inputs)
    : config_(config), start_(start), inputs_(inputs) {
  reset();
}

void PerFrameCoupling::reset() {
  p_n_ = Vector3d(start_.position_m.data());
  heading_offset_rad_ = start_.heading_rad;
  placed_ = start_.given;
  q_n_.setIdentity();
  velocity_n_.setZero();
  velocity_known_ = false;
  caught_up_n_.reset();
  rotation_covariance_.setZero();
  independent_covariance_.setZero();
  since_fix_n_.setZero();
  relative_sigma_ = unobserved_sigma_m_ = 0.0;
  heading_variance_ = p_.heading_unknown_rad * p_.heading_unknown_rad, tilt_variance_ = 0.0;
  turned_by_fixes_ = false;
  scale_ = {};
  last_pose_ns_ = last_tracked_ns_ = INT64_MIN;
  attitudes_.clear();
  camera_ = carried_by_steps_ = corrected_ = metric_by_vo_ = false;
  rejected_in_a_row_ = 0;
  unscaled_.reset();
  history_.clear();
  corrections_.clear();
}

void PerFrameCoupling::on_calibration(const odo_calibration& calibration) {
  if (calibration.header.flags & ODO_CALIBRATION_EXTRINSICS) q_b_c_ = quaternion(calibration.q_b_c);
}

void PerFrameCoupling::on_attitude(const odo_attitude& attitude) {
  attitudes_.push(attitude);
  if (camera_) return;
  const Quaterniond q = orientation_from(attitude);
  history_.set_orientation(attitude.header.t_ns, {q.w(), q.x(), q.y(), q.z()});
}

std::optional<odo_attitude> PerFrameCoupling::attitude_at(int64_t t_ns) const {
  std::optional<odo_attitude> best;
  for (size_t i = 0; i < attitudes_.size(); ++i) {  // newest first; the first one not later than t is the one
    const odo_attitude& a = attitudes_.back(i);
    best = a;
    if (a.header.t_ns <= t_ns) break;
  }
  return best;
}

Quaterniond PerFrameCoupling::orientation_from(const odo_attitude& attitude) const {
  return about_down(heading_offset_rad_) * quaternion(attitude.q_n_b);
}

Quaterniond PerFrameCoupling::initial_camera_orientation(int64_t t_ns) const {
  if (const auto attitude = attitude_at(t_ns)) return orientation_from(*attitude) * q_b_c_;
  Matrix3d horizontal;  // columns: the camera's x, y, z in n when it looks level to the north
  horizontal << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  return about_down(heading_offset_rad_) * Quaterniond(horizontal);
}

odo_pose PerFrameCoupling::on_first_frame(int64_t t_ns) {
  camera_ = true;
  q_n_ = initial_camera_orientation(t_ns);
  bool north = false;
  if (const auto attitude = attitude_at(t_ns)) {
    tilt_variance_ = std::max(attitude->covariance_n[0], attitude->covariance_n[4]);
    north = refers_to_north(*attitude);
    if (north) heading_variance_ = attitude->covariance_n[8];
  }
  // A chained gyroscope that nobody told its heading has any: fixes may turn it around.
  if (!north && !start_.heading_given && config_.orientation == Orientation::gyroscope)
    heading_variance_ = p_.any_heading_rad * p_.any_heading_rad;
  gyro_attitude_.reset(q_n_, Vector3d(tilt_variance_, tilt_variance_, heading_variance_).asDiagonal());
  last_pose_ns_ = last_tracked_ns_ = t_ns;
  return publish(t_ns, ODO_DEGRADED, ODO_REASON_INITIALISING);
}

void PerFrameCoupling::prepare(odo_vo_motion& motion) const {
  put_quaternion(q_n_, motion.q_n_c0);
  motion.header.flags |= ODO_FLAG_NAVIGATION;
}

/// The later frame's orientation, by what the config prefers and what there is.
void PerFrameCoupling::update_orientation(const odo_vo_motion& motion, const std::optional<odo_attitude>& before,
                                          const std::optional<odo_attitude>& after) {
  if (after && config_.orientation == Orientation::attitude) {
    q_n_ = orientation_from(*after) * q_b_c_;
    return;
  }
  if (config_.orientation == Orientation::gyroscope && rotate_with_gyroscope(motion)) return;
  if (motion.header.flags & ODO_VO_ROTATION) {
    q_n_ = (q_n_ * quaternion(motion.q_c0_c1)).normalized();
  } else if (before && after) {  // the picture says nothing: the attitude source's rotation instead
    const Quaterniond q_b0_b1 = quaternion(before->q_n_b).conjugate() * quaternion(after->q_n_b);
    q_n_ = (q_n_ * q_b_c_.conjugate() * q_b0_b1 * q_b_c_).normalized();
  }
}

odo_pose PerFrameCoupling::on_vo_motion(const odo_vo_motion& motion, const odo_scale* scale) {
  const Quaterniond q_n_c0 = q_n_;
  velocity_known_ = false;
  const auto before = attitude_at(motion.t_from_ns);
  const auto after = attitude_at(motion.header.t_ns);
  if (after) rotation_covariance_ = Eigen::Map<const RowMatrix3d>(after->covariance_n);
  update_orientation(motion, before, after);

  const double dt_s = seconds(motion.header.t_ns - motion.t_from_ns);
  bool translated = (motion.header.flags & ODO_VO_TRANSLATION) != 0 && motion.state != ODO_LOST;
  Vector3d d_n = Vector3d::Zero();
  if (translated) d_n = q_n_c0 * Vector3d(motion.p_c0_c1);
  uint32_t state = motion.state, reason = motion.reason;
  double relative = 0.0;
  metric_by_vo_ = (motion.header.flags & ODO_VO_METRIC) != 0;
  Vector3d late_n = Vector3d::Zero();
  if (inputs_.scale && !metric_by_vo_) {
    if (scale) {
      scale_ = {scale->scale, scale->sigma};
      relative = scale->scale > 0 ? std::min(1.0, scale->sigma / scale->scale) : 0.0;
      d_n *= scale->scale;
      const bool horizontal = (scale->header.flags & ODO_SCALE_HORIZONTAL) != 0;
      if (horizontal && config_.vertical == Vertical::ignore) d_n.z() = 0.0;
      if (d_n.norm() > p_.impossible * config_.fastest_mps * dt_s) {
        translated = false;
        state = ODO_DEGRADED, reason = ODO_REASON_TOO_FAST;
      }
      if (translated && unscaled_) late_n = catch_up(*scale);
    } else {
      if (translated) wait_for_scale(motion, d_n);
      d_n.setZero();
      if (state == ODO_TRACKING) state = ODO_DEGRADED, reason = ODO_REASON_NO_SCALE;
    }
  }
  drift(motion, q_n_c0, dt_s, metric() && (!translated || !(scale || metric_by_vo_)));
  share_rotation_covariance();
  carried_by_steps_ = !translated;
  if (translated) last_tracked_ns_ = motion.header.t_ns;
  const bool tracked_once = last_tracked_ns_ != INT64_MIN;
  if (state == ODO_LOST && after && tracked_once && seconds(motion.header.t_ns - last_tracked_ns_) < config_.bridge_s)
    state = ODO_DEGRADED;
  if (translated) {
    if (!late_n.isZero()) move(late_n, relative, 0.0), caught_up_n_ = late_n;
    move(d_n, relative, dt_s);
  }
  return publish(motion.header.t_ns, state, reason);
}

std::optional<odo_pose> PerFrameCoupling::on_step(const odo_step& step) {
  if (inputs_.vo && !(camera_ && carried_by_steps_)) return std::nullopt;
  const double heading = step.heading_rad + heading_offset_rad_;
  const double duration = seconds(step.t_end_ns - step.t_start_ns);
  const double relative = step.length_m > 0 ? step.sigma_m / step.length_m : 0.0;
  const auto attitude = attitude_at(step.t_end_ns);
  if (attitude) rotation_covariance_ = Eigen::Map<const RowMatrix3d>(attitude->covariance_n);
  if (step.header.flags & ODO_STEP_HEADING)
    move(step.length_m * Vector3d(std::cos(heading), std::sin(heading), 0.0), relative, duration);
  if (inputs_.vo) return std::nullopt;  // bridging: the next frame publishes
  if (attitude) q_n_ = orientation_from(*attitude);
  return publish(step.t_end_ns, ODO_TRACKING, ODO_REASON_NONE);
}

std::optional<odo_pose> PerFrameCoupling::start_without_camera() {
  if (inputs_.vo || attitudes_.size() != 1) return std::nullopt;
  q_n_ = orientation_from(attitudes_.back(0));
  return publish(attitudes_.back(0).header.t_ns, ODO_TRACKING, ODO_REASON_NONE);
}

void PerFrameCoupling::move(const Vector3d& d_n, double relative_sigma, double dt_s) {
  const double length = d_n.norm();
  p_n_ += d_n;
  distance_m_ += length;
  if (dt_s > 0) velocity_n_ = d_n / dt_s, velocity_known_ = true;
  // The relative errors along the path are averaged by length and taken as common to all of it.
  const double total = since_fix_n_.norm() + length;
  if (total > 0) relative_sigma_ += (relative_sigma - relative_sigma_) * length / total;
  since_fix_n_ += d_n;
}

void PerFrameCoupling::wait_for_scale(const odo_vo_motion& motion, const Vector3d& d_n) {
  if (!unscaled_ || unscaled_->group != motion.scale_group)
    unscaled_ = Unscaled{Vector3d::Zero(), motion.scale_group, unobserved_sigma_m_};
  unscaled_->d_n += d_n;
}

/// What a group moved before its scale was known, in metres, once the scale holds for it.
Vector3d PerFrameCoupling::catch_up(const odo_scale& scale) {
  const Unscaled waiting = *std::exchange(unscaled_, std::nullopt);
  if (waiting.group != scale.scale_group || (scale.header.flags & ODO_SCALE_STEADY) == 0) return Vector3d::Zero();
  unobserved_sigma_m_ = waiting.sigma_before_m;
  Vector3d d_n = scale.scale * waiting.d_n;
  if ((scale.header.flags & ODO_SCALE_HORIZONTAL) != 0 && config_.vertical == Vertical::ignore) d_n.z() = 0.0;
  return d_n;
}

/// What becomes less certain from one frame to the next.
void PerFrameCoupling::drift(const odo_vo_motion& motion, const Quaterniond& q_n_c0, double dt_s, bool lost_metres) {
  const double walk = p_.angle_random_walk * p_.angle_random_walk * dt_s;
  Matrix3d turned = Matrix3d::Zero();
  if (motion.header.flags & ODO_VO_COVARIANCE) {
    const Matrix3d R_n_c0 = q_n_c0.toRotationMatrix();
    turned = R_n_c0 * rotation_covariance_of(motion) * R_n_c0.transpose();
  }
  heading_variance_ += turned(2, 2) + walk;
  tilt_variance_ += std::max(turned(0, 0), turned(1, 1)) + walk;
  if (lost_metres) unobserved_sigma_m_ += config_.fastest_mps * dt_s;
}

Matrix3d PerFrameCoupling::position_covariance() const {
  const Vector3d along = relative_sigma_ * since_fix_n_;
  const Vector3d across =
      std::sqrt(std::max(0.0, rotation_covariance_(2, 2))) * Vector3d(-since_fix_n_.y(), since_fix_n_.x(), 0.0);
  Matrix3d unseen = Matrix3d::Zero();
  unseen.diagonal().head<2>().setConstant(unobserved_sigma_m_ * unobserved_sigma_m_);
  return independent_covariance_ + along * along.transpose() + across * across.transpose() + unseen;
}

bool PerFrameCoupling::rotate_with_gyroscope(const odo_vo_motion& motion) {
  const auto imu = gyro_attitude_.between(motion.t_from_ns, motion.header.t_ns, q_b_c_);
  if (!imu) return false;
  gyro_attitude_.propagate(imu->q_c0_c1, imu->dt_s);
  // With parallax a picture's rotation and translation are too much alike to tell a bias.
  const bool pure = motion.reason == ODO_REASON_NO_PARALLAX && (motion.header.flags & ODO_VO_ROTATION) != 0;
  if (pure)
    gyro_attitude_.update_relative_rotation(
        imu->q_c0_c1, quaternion(motion.q_c0_c1),
        motion.header.flags & ODO_VO_COVARIANCE ? std::sqrt(rotation_covariance_of(motion).diagonal().maxCoeff()) : 0.0,
        imu->dt_s);
  gyro_attitude_.update_gravity(imu->force_c, pure);
  q_n_ = gyro_attitude_.q_n_c();
  return true;
}

void PerFrameCoupling::share_rotation_covariance() {
  if (camera_ && config_.orientation == Orientation::gyroscope) {
    rotation_covariance_ = gyro_attitude_.covariance_n();
  } else if (turned_by_fixes_) {
    rotation_covariance_(2, 2) = heading_variance_;
    if (config_.orientation == Orientation::vo) rotation_covariance_.diagonal().head<2>().setConstant(tilt_variance_);
  }
}

std::optional<odo_pose> PerFrameCoupling::take_correction() {
  if (!std::exchange(corrected_, false) || last_pose_ns_ == INT64_MIN) return std::nullopt;
  return publish(last_pose_ns_, last_state_, last_reason_);
}

odo_pose PerFrameCoupling::publish(int64_t t_ns, uint32_t state, uint32_t reason) {
  auto pose = make_message<odo_pose>(ODO_TYPE_POSE, t_ns);
  pose.header.flags = ODO_POSE_ORIENTATION | ODO_POSE_POSITION | ODO_POSE_COVARIANCE;
  if (metre_known()) pose.header.flags |= ODO_POSE_METRIC;
  if (metre_known() && velocity_known_) pose.header.flags |= ODO_POSE_VELOCITY;
  if (camera_) pose.header.flags |= ODO_POSE_CAMERA;
  put_quaternion(q_n_, pose.q_n);
  Vector3d::Map(pose.p_n) = p_n_;
  Vector3d::Map(pose.velocity_n) = velocity_n_;
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> covariance(pose.covariance);
  covariance.topLeftCorner<3, 3>() = rotation_covariance_;
  covariance.bottomRightCorner<3, 3>() = position_covariance();
  pose.scale = scale_.scale;
  pose.scale_sigma = scale_.sigma;
  pose.distance_m = distance_m_;
  pose.state = state;
  pose.reason = reason;
  last_pose_ns_ = t_ns;
  last_state_ = state;
  last_reason_ = reason;
  history_.push(pose);
  return pose;
}

}  // namespace odograph
