// SPDX-License-Identifier: Apache-2.0
//
// The scale of a front-end's motions: as itself, a scale source or inertia tells it, and what begins when it is known.
#include <algorithm>
#include <cmath>

#include "sdk/host/estimator/inertial_estimator.hpp"
#include "sdk/host/messages/messages.hpp"

namespace odograph {

using Eigen::Vector3d;
using namespace inertial;

namespace {

double seconds(int64_t ns) { return static_cast<double>(ns) * kNanoseconds; }
double squared(double x) { return x * x; }

}  // namespace

/// Where the camera hardly moves a front-end's doubt about its displacement is no doubt about the metre.
bool InertialEstimator::walks(int64_t t_ns) const {
  const auto before = scale_start_.at(t_ns - 2 * static_cast<int64_t>(p_.chord_s * 1e9));
  return before && std::exp(e_.x.log_scale) * (vo_.y_n - *before).norm() > p_.walking_m;
}

/// A front-end's own doubt about the metre is one error common to its motions, so that the scale is never better known
/// for it than the front-end says at its surest.
void InertialEstimator::use_metric_scale(const odo_vo_motion& m) {
  const int64_t t_ns = m.header.t_ns;
  const bool stated = inertial_front_end_ || m.scale_sigma > 0;
  const double sigma = stated ? m.scale_sigma : p_.unstated_scale_sigma;
  const double information = 1 / squared(std::clamp(sigma, p_.min_log_scale_sigma, p_.max_log_scale_sigma));
  if (!vo_.known) {
    if (!metric_ && placed_ == 0 && inertial_front_end_) begin_here(m);
    vo_.gravity_rejected = p_.max_rejected;  // nothing to lose yet
    know_scale(0.0, 1 / information, 0.0, t_ns);
    vo_.told_information = information, vo_.told_ns = t_ns;
    vo_.own_information = information;
    return;
  }
  vo_.own_information = information;
  const double held = 1 / e_.P(kLogScale, kLogScale);
  if (information < p_.lost_confidence * vo_.told_information && walks(t_ns)) {
    if (information < held) e_.add_variance(kLogScale, 1, 1 / information - 1 / held);
    vo_.told_information = information;
    return;
  }
  vo_.told_information = std::max(vo_.told_information, information);
  if (information <= p_.scale_news * held) return;
  Innovation<1> metre;
  metre.residual[0] = -e_.x.log_scale;
  metre.by_one(kLogScale, Innovation<1>::Vector::Ones());
  metre.noise(0, 0) = 1 / (information - held);
  e_.update(metre, 0);
}

void InertialEstimator::use_window(const WindowScale& window) {
  if (window.noise_m > 0) {
    const double measured = std::clamp(window.noise_m, p_.vo_min_sigma_m, p_.vo_max_sigma_m);
    vo_.sigma_m += p_.vo_sigma_gain * (measured - vo_.sigma_m);
  }
  if (!vo_.known) return scale_start_.add_window(window);
  const double r = std::exp(-e_.x.log_scale);
  Innovation<1> seen;
  seen.residual[0] = window.inverse_scale - r;
  seen.by_one(kLogScale, Innovation<1>::Vector::Constant(-r));
  seen.noise(0, 0) = squared(window.sigma);
  const double before = 1 / e_.P(kLogScale, kLogScale);
  if (!e_.update(seen, p_.gate[1], Hold::all_but_scale_and_steps).accepted) return;
  const double gained = 1 / e_.P(kLogScale, kLogScale) - before;
  vo_.inertia_information += gained;
  vo_.own_information += squared(r / window.sigma);
}

UpdateResult InertialEstimator::apply(const odo_scale* scale) {
  // Steps speak for themselves.
  if (!vo_.any || scale->scale_group != vo_.group || scale->scale <= 0 || vo_.metric) return {};
  if ((scale->header.flags & ODO_SCALE_NOT_BY_STEPS) == 0 && stepped_) return {};
  const double sigma = std::clamp(scale->sigma / scale->scale, p_.min_log_scale_sigma, p_.max_log_scale_sigma);
  const double value = std::log(scale->scale), information = 1 / squared(sigma);
  if (!vo_.known) {
    know_scale(value, squared(sigma), 0.0, vo_.t_ns);
    vo_.told_information = information, vo_.told_ns = scale->header.t_ns;
    return {true, 0.0, 1};
  }
  vo_.told_information *= std::exp(-seconds(scale->header.t_ns - vo_.told_ns) / p_.vio_scale_forgetting_s);
  vo_.told_ns = scale->header.t_ns;
  if (information <= p_.scale_news * vo_.told_information) return {};
  Innovation<1> seen;
  seen.residual[0] = value - e_.x.log_scale;
  seen.by_one(kLogScale, Innovation<1>::Vector::Ones());
  seen.noise(0, 0) = 1 / (information - vo_.told_information);
  const UpdateResult result = e_.update(seen, p_.gate[1]);
  if (!result.accepted) return result;
  vo_.told_information = information;
  if (scale->header.flags & ODO_SCALE_NOT_BY_STEPS) vo_.own_information = information;
  return result;
}

void InertialEstimator::try_scale_start(int64_t t_ns) {
  if (vo_.known) return;
  const auto known = scale_start_.known(e_.x.log_factor, e_.P(kLogFactor, kLogFactor));
  if (!known) return;
  know_scale(known->log_scale, known->variance, known->steps_share, t_ns);
  vo_.inertia_information = (1 - known->steps_share) / known->variance;
  vo_.steps_information = known->steps_share / known->variance;
  vo_.own_information = vo_.inertia_information;
}

void InertialEstimator::know_scale(double log_scale, double variance, double steps_share, int64_t t_ns) {
  vo_.known = true;
  e_.set_scale(log_scale, variance, steps_share);
  if (!metric_ && !vo_.metric && vo_.first_group && vo_.unbroken && (placed_ & kHorizontal) == 0) put_in_place(t_ns);
  metric_ = true;
  detach();  // the odometry's pose had no scale until now
}

/// Nobody was told a position until now: n is laid so that the start is where it was supposed, and what is learnt later
/// of the time before, as steps tell it, moves nothing.
void InertialEstimator::begin_here(const odo_vo_motion& m) {
  const auto at = past(m.header.t_ns);
  if (!at) return;
  flush();
  const Vector3d v_n = at->q_n_b * q_b_c_ * Vector3d(m.velocity_c1);
  e_.place(shift_since_start(m, *at), Vector3d::Zero(), v_n, 0.0, squared(p_.vio_velocity_sigma_mps));
  e_.forget_clones();
  e_.clone(t_ns_);
  track_.begin_segment();
}

/// By how much the position is wrong for a velocity and an inclination that were guessed at the start: these are told
/// now, and go back along what the IMU measured. Before that nobody walked, since there was no step.
Vector3d InertialEstimator::shift_since_start(const odo_vo_motion& m, const PastPose& at) const {
  if (stepped_) return Vector3d::Zero();
  const Eigen::Quaterniond q_n_c = at.q_n_b * q_b_c_;
  const Eigen::Quaterniond horizontal =
      Eigen::Quaterniond::FromTwoVectors(q_n_c * Vector3d(m.gravity_c1), Vector3d::UnitZ());
  const ImuRewind::Known now{(horizontal * e_.x.q_n_b).normalized(), horizontal * (q_n_c * Vector3d(m.velocity_c1)),
                             Vector3d(m.gyro_bias_b), Vector3d(m.accel_bias_b), p_.gravity_mps2};
  const double since_s = seconds(t_ns_ - first_frame_ns_);
  return first_p_n_ + rewind_.moved(now, std::min(since_s, p_.rewind_s)) - e_.x.p_n;
}

/// What the first group moved before its scale was known: position and velocity now follow from the start.
void InertialEstimator::put_in_place(int64_t t_ns) {
  const auto at = past(t_ns);
  const auto before = scale_start_.at(t_ns - static_cast<int64_t>(p_.chord_s * 1e9));
  if (!at || !before) return;
  flush();
  const double scale = std::exp(e_.x.log_scale);
  const Vector3d moved_n = scale * vo_.y_n, v_n = scale / p_.chord_s * (vo_.y_n - *before);
  Vector3d shift = vo_.start_n + moved_n - (at->p_n + at->q_n_b * p_b_c_);
  const double height_variance = (placed_ & ODO_FIX_DOWN) ? e_.P(kPosition + 2, kPosition + 2) : 0.0;
  if (height_variance > 0) shift.z() = 0;
  e_.place(shift, moved_n, v_n, squared(vo_.sigma_m) + squared(p_.vo_drift_per_root_m) * moved_n.norm(),
           squared(p_.chord_velocity_sigma_mps));
  e_.add_variance(kPosition + 2, 1, height_variance);
  e_.forget_clones();  // how they lie to each other was not known either
  e_.clone(t_ns_);
  track_.begin_segment();
}

}  // namespace odograph
