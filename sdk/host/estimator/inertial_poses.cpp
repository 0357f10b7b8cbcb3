// SPDX-License-Identifier: Apache-2.0
//
// What the estimator tells: poses, corrections of them, the metre for the step estimator.
#include <algorithm>
#include <cmath>
#include <utility>

#include "sdk/host/base/rotation.hpp"
#include "sdk/host/estimator/inertial_estimator.hpp"
#include "sdk/host/messages/messages.hpp"

namespace odograph {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using namespace inertial;

namespace {

template <class T>
bool take(std::optional<T>& from, T& out) {
  if (!from) return false;
  out = *std::exchange(from, std::nullopt);
  return true;
}

}  // namespace

UpdateResult InertialEstimator::update(const Measurement& measurement) {
  std::optional<odo_pose> before;
  const auto* attitude = std::get_if<const odo_attitude*>(&measurement);
  const bool rotates = attitude && rotates_camera(**attitude), may_jump = !attitude || rotates;
  const int64_t t_ns = last_pose_ns_;
  if (may_jump && t_ns != INT64_MIN)
    if (const auto at = past(t_ns)) before = make_pose(t_ns, *at);
  const UpdateResult result = std::visit([this](const auto& what) { return apply(what); }, measurement);
  if (before)
    note_jump(*before,
              rotates || std::holds_alternative<const odo_fix*>(measurement) ? kCorrectionFix : kCorrectionScale,
              rotates ? 0 : 1);
  if (may_jump) snapshot();
  return result;
}

/// A compass beside a camera turns the world that the camera tracks, by little each time and by much in the end.
bool InertialEstimator::rotates_camera(const odo_attitude& attitude) const {
  return inputs_.vo && started_by_attitude_ && refers_to_north(attitude) && due(attitude);
}

/// A jump is announced from `part` of the parameters' sizes on.
void InertialEstimator::note_jump(const odo_pose& before, uint32_t reason, double part) {
  const auto at = past(before.header.t_ns);
  if (!at) return;
  odo_pose after = make_pose(before.header.t_ns, *at);
  const Quaterniond turned = (raw_quaternion(after.q_n) * raw_quaternion(before.q_n).conjugate()).normalized();
  const Vector3d p_before(before.p_n), p_after(after.p_n);
  const double jump_m = (p_after - p_before).norm(), rotation_rad = log_rotation(turned).norm();
  if (jump_m <= part * p_.announced_jump_m && rotation_rad <= part * p_.announced_rotation_rad) return;
  after.state = last_state_, after.reason = last_reason_;
  const Correction now{before.header.t_ns, turned, p_after - turned * p_before, reason};
  if (correction_)
    correction_ = Correction{now.t_ns, (now.q * correction_->q).normalized(), now.q * correction_->p + now.p, reason};
  else
    correction_ = now;
  corrected_ = after;
  if (last_pose_ns_ == before.header.t_ns) history_.push(after);
  distance_from_ += p_after - p_before;
}

odo_pose InertialEstimator::make_pose(int64_t t_ns, const PastPose& at) const {
  auto pose = make_message<odo_pose>(ODO_TYPE_POSE, t_ns);
  pose.header.flags = ODO_POSE_ORIENTATION | ODO_POSE_COVARIANCE;
  if (metric_) pose.header.flags |= ODO_POSE_POSITION | ODO_POSE_VELOCITY | ODO_POSE_METRIC;
  Vector3d lever_n = Vector3d::Zero();
  if (camera_) {
    pose.header.flags |= ODO_POSE_CAMERA;
    lever_n = at.q_n_b * p_b_c_;
  }
  put_quaternion(camera_ ? (at.q_n_b * q_b_c_).normalized() : at.q_n_b, pose.q_n);
  Vector3d::Map(pose.p_n) = metric_ ? Vector3d(at.p_n + lever_n) : Vector3d(start_.position_m.data());
  Vector3d::Map(pose.velocity_n) = e_.x.v_n;
  Eigen::Matrix<double, 6, 6> covariance = e_.covariance(at);
  const Matrix3d by_theta = -skew(lever_n);
  covariance.bottomRows<3>() += (by_theta * covariance.topRows<3>()).eval();
  covariance.rightCols<3>() += (covariance.leftCols<3>() * by_theta.transpose()).eval();
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(pose.covariance) = covariance;
  if (vo_.known) {
    pose.scale = std::exp(e_.x.log_scale);
    pose.scale_sigma = pose.scale * std::sqrt(std::max(0.0, e_.P(kLogScale, kLogScale)));
  }
  pose.distance_m = distance_m_;
  pose.state = last_state_;
  pose.reason = last_reason_;
  return pose;
}

void InertialEstimator::publish(int64_t t_ns, uint32_t state, uint32_t reason) {
  flush();
  const auto at = past(t_ns);
  if (!at) return;
  last_state_ = state, last_reason_ = reason;
  odo_pose pose = make_pose(t_ns, *at);
  const Vector3d p_n(pose.p_n);
  if (last_pose_ns_ == INT64_MIN || !metric_) distance_from_ = p_n;
  if (const double moved_m = (p_n - distance_from_).norm(); moved_m > p_.counted_m) {
    distance_m_ += moved_m;
    distance_from_ = p_n;
  }
  pose.distance_m = distance_m_;
  last_pose_ns_ = t_ns;
  history_.push(pose);
  pose_ = pose;
  if (camera_) refer_steps(pose);
}

/// A stretch that the camera knew in metres without the help of steps, for whoever learns the walker's step length.
void InertialEstimator::refer_steps(const odo_pose& pose) {
  const Eigen::Vector2d p(pose.p_n[0], pose.p_n[1]);
  const double step_m = (p - reference_last_).norm();
  reference_last_ = p;
  const double sigma = vo_.own_information > 0 ? 1 / std::sqrt(vo_.own_information) : 1.0;
  if (!vo_.known || !vo_.attached || sigma > p_.reference_sigma || pose.state == ODO_LOST) {
    reference_path_m_ = -1;
    return;
  }
  const bool begins = reference_path_m_ < 0;
  reference_path_m_ = begins ? 0 : reference_path_m_ + step_m;
  if (!begins && reference_path_m_ < p_.reference_path_m) return;
  if (!begins) reference_path_m_ = 0;
  if (fixed_ns_ != INT64_MIN && pose.header.t_ns - fixed_ns_ < p_.fixes_rule_ns) return;
  auto fix = make_message<odo_fix>(ODO_TYPE_FIX, pose.header.t_ns);
  fix.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE;
  std::copy(pose.p_n, pose.p_n + 3, fix.p_n);
  const double sigma_m = std::max(p_.reference_min_sigma, sigma) *
                         std::sqrt(p_.reference_path_m * std::max(p_.reference_path_m, p_.reference_alike_m));
  fix.covariance_n[0] = fix.covariance_n[4] = fix.covariance_n[8] = sigma_m * sigma_m;
  reference_ = fix;
}

uint64_t InertialEstimator::hold_pose(int64_t t_ns) {
  if (!started_ || t_ns > t_ns_) return 0;
  flush();
  const int64_t held_ns = std::max(t_ns, e_.clone_back(e_.clone_count() - 1).t_ns);
  const auto at = past(held_ns);
  return at ? e_.hold(*at, held_ns, distance_m_) : 0;
}

bool InertialEstimator::pose_now(HeldPose& out) const {
  if (!started_) return false;
  out.q_n_b = e_.x.q_n_b, out.p_n_b = e_.x.p_n;
  out.own = out.now = out.cross = e_.P.block<6, 6>(kTheta, kTheta);
  return true;
}

void InertialEstimator::prepare(odo_vo_motion& motion) const {
  Quaterniond q_n_c = e_.x.q_n_b * q_b_c_;
  if (const auto at = past(motion.t_from_ns)) q_n_c = at->q_n_b * q_b_c_;
  put_quaternion(q_n_c, motion.q_n_c0);
  motion.header.flags |= ODO_FLAG_NAVIGATION;
}

void InertialEstimator::snapshot() {
  if (!started_) return;
  const PastPose now{e_.x.q_n_b, e_.x.p_n, kTheta, kTheta, 1.0};
  const std::lock_guard lock(newest_mutex_);
  newest_ns_ = t_ns_;
  newest_.pose = make_pose(t_ns_, now);
  newest_.q_n_b = e_.x.q_n_b, newest_.p_n_b = e_.x.p_n, newest_.v_n_b = e_.x.v_n;
  newest_.gyro_bias_b = e_.x.gyro_bias_b, newest_.accel_bias_b = e_.x.accel_bias_b;
  newest_rate_b_ = last_imu_ ? Vector3d(Vector3d(last_imu_->gyro_b) - e_.x.gyro_bias_b) : Vector3d::Zero();
}

int32_t InertialEstimator::at(int64_t t_ns, Estimate& out) const {
  int64_t newest_ns;
  Vector3d rate_b;
  {
    const std::lock_guard lock(newest_mutex_);
    newest_ns = newest_ns_;
    rate_b = newest_rate_b_;
    out = newest_;
  }
  if (newest_ns == INT64_MIN) return ODO_NOT_READY;
  if (t_ns == INT64_MIN || t_ns == newest_ns) return ODO_OK;
  // The pose against the body, as the newest one has it.
  const Quaterniond q_b_pose = out.q_n_b.conjugate() * raw_quaternion(out.pose.q_n);
  const bool placed = (out.pose.header.flags & ODO_POSE_POSITION) != 0;
  const Vector3d lever_b =
      placed ? Vector3d(out.q_n_b.conjugate() * (Vector3d(out.pose.p_n) - out.p_n_b)) : Vector3d(Vector3d::Zero());
  if (t_ns < newest_ns) {
    const int32_t status = history_.at(t_ns, out.pose);
    if (status != ODO_OK) return status;
    out.q_n_b = (raw_quaternion(out.pose.q_n) * q_b_pose.conjugate()).normalized();
    out.p_n_b = Vector3d(out.pose.p_n) - out.q_n_b * lever_b;
    out.v_n_b = Vector3d(out.pose.velocity_n);
    return ODO_OK;
  }
  if (t_ns - newest_ns > kMaxExtrapolation_ns) return ODO_E_NOT_FOUND;
  const double ahead_s = static_cast<double>(t_ns - newest_ns) * kNanoseconds;
  out.q_n_b = (out.q_n_b * exp_rotation(rate_b * ahead_s)).normalized();
  out.p_n_b += ahead_s * out.v_n_b;
  put_quaternion((out.q_n_b * q_b_pose).normalized(), out.pose.q_n);
  if (placed) Vector3d::Map(out.pose.p_n) = out.p_n_b + out.q_n_b * lever_b;
  out.pose.header.t_ns = t_ns;
  out.pose.header.flags |= ODO_POSE_EXTRAPOLATED;
  return ODO_OK;
}

bool InertialEstimator::take_pose(odo_pose& pose) { return take(pose_, pose); }

bool InertialEstimator::take_correction(Correction& correction, odo_pose& pose) {
  if (!corrected_) return false;
  take(corrected_, pose);
  return take(correction_, correction);
}

bool InertialEstimator::take_step_reference(odo_fix& reference) { return take(reference_, reference); }

ScaleKnowledge InertialEstimator::scale_knowledge() const {
  if (!vo_.known) return {};
  const double inertia = inertial_front_end_ ? vo_.own_information : vo_.inertia_information;
  const double all = inertia + vo_.steps_information;
  const double sigma = std::sqrt(e_.P(kLogScale, kLogScale));
  return all > 0 ? ScaleKnowledge{sigma, inertia / all, vo_.steps_information / all} : ScaleKnowledge{sigma, 0, 0};
}

InertialEstimator::ScaleReport InertialEstimator::scale_report() const {
  return {vo_.known,
          e_.x.log_scale,
          std::sqrt(e_.P(kLogScale, kLogScale)),
          e_.x.log_factor,
          std::sqrt(e_.P(kLogFactor, kLogFactor)),
          vo_.inertia_information,
          vo_.steps_information,
          vo_.sigma_m};
}

}  // namespace odograph
