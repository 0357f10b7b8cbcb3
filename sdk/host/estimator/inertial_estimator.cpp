// SPDX-License-Identifier: Apache-2.0
//
// Time, inertia and what tells inclination, standing and height. Odometry, steps and fixes, and poses are in files of
// their own.
#include "sdk/host/estimator/inertial_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sdk/host/base/rotation.hpp"
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

InertialEstimator::InertialEstimator(const CouplingConfig& config, const StartPose& start, EstimatorInputs inputs,
                                     const Parameters& parameters)
    : p_(parameters), config_(config), start_(start), inputs_(inputs), window_(p_), scale_start_(p_) {
  gyro_noise_ = p_.gyro_noise, gyro_walk_ = p_.gyro_walk;
  accel_noise_ = p_.accel_noise, accel_walk_ = p_.accel_walk;
  reset();
}

void InertialEstimator::reset() {
  e_.reset();
  track_.clear();
  history_.clear();
  started_ = started_by_attitude_ = camera_ = resting_ = stepped_ = step_loose_ = baro_started_ = north_ = false;
  heading_open_ = start_.given;
  turned_rad_ = 0;
  placed_ = start_.given ? kAllAxes : 0;
  metric_ = !inputs_.vo;
  t_ns_ = first_imu_ns_ = first_frame_ns_ = rested_ns_ = attitude_ns_ = informed_ns_ = reminded_ns_ = stood_ns_ =
      step_ns_ = fixed_ns_ = led_since_ns_ = baro_ns_ = last_pose_ns_ = INT64_MIN;
  last_imu_.reset();
  rewind_.clear();
  transition_.clear();
  inertial_front_end_ = false;
  quiet_ = {};
  mode_ = 0;
  vo_ = {};
  vo_.sigma_m = p_.vo_position_sigma_m;
  window_.restart();
  scale_start_.restart();
  metre_check_ = MetreCheck();
  notice_ = {};
  steps_rejected_ = fixes_rejected_ = fixes_agreed_ = 0;
  step_mean_m_ = 0;
  pose_.reset(), corrected_.reset(), correction_.reset(), reference_.reset();
  reference_path_m_ = -1;
  distance_m_ = 0;
  fixed_distance_m_ = start_.given ? 0 : -1;
  const std::lock_guard lock(newest_mutex_);
  newest_ns_ = INT64_MIN;
}

void InertialEstimator::on_calibration(const odo_calibration& calibration) {
  if ((calibration.header.flags & ODO_CALIBRATION_EXTRINSICS) == 0) return;
  q_b_c_ = quaternion(calibration.q_b_c);
  p_b_c_ = Vector3d(calibration.p_b_c);
}

void InertialEstimator::on_imu_noise(const odo_imu_noise& noise) {
  gyro_noise_ = std::hypot(p_.gyro_noise, noise.gyro_noise);
  accel_noise_ = std::hypot(p_.accel_noise, noise.accel_noise);
  if (noise.gyro_walk > 0) gyro_walk_ = noise.gyro_walk;
  if (noise.accel_walk > 0) accel_walk_ = noise.accel_walk;
}

Quaterniond InertialEstimator::heading_offset() const {
  return Quaterniond(Eigen::AngleAxisd(start_.heading_rad + turned_rad_, Vector3d::UnitZ()));
}

void InertialEstimator::start(int64_t t_ns, const Quaterniond& q_n_b, double tilt_sigma, double heading_sigma) {
  const bool anew = !started_;
  started_ = true;
  e_.x.q_n_b = q_n_b;
  for (int i = 0; i < 3; ++i) e_.set_independent(kTheta + i, squared(i < 2 ? tilt_sigma : heading_sigma));
  if (!anew) return detach();
  t_ns_ = informed_ns_ = t_ns;
  e_.x.p_n = Vector3d(start_.position_m.data());
  e_.add_variance(kVelocity, 3, squared(p_.start_speed_sigma_mps));
  e_.add_variance(kGyroBias, 3, squared(p_.gyro_bias_sigma));
  e_.add_variance(kAccelBias, 3, squared(p_.accel_bias_sigma));
  e_.add_variance(kLogScale, 1, squared(p_.unknown_scale_sigma));
  e_.add_variance(kLogFactor, 1, squared(p_.factor_sigma));
  e_.add_variance(kStepHeading, 1, squared(p_.step_heading_sigma_rad));
  e_.add_variance(kBaro, 1, squared(p_.uninformed_sigma_m));
  e_.clone(t_ns);
  track_.begin_segment();
}

void InertialEstimator::start_without_attitude(int64_t t_ns) {
  Quaterniond q_n_b;
  if (last_imu_) {  // the specific force points up
    q_n_b = heading_offset() * Quaterniond::FromTwoVectors(Vector3d(last_imu_->accel_b), -Vector3d::UnitZ());
  } else {
    Matrix3d horizontal;  // columns: the camera's x, y, z in n when it looks horizontally to the north
    horizontal << 0, 0, 1, 1, 0, 0, 0, 1, 0;
    q_n_b = heading_offset() * Quaterniond(horizontal) * q_b_c_.conjugate();
  }
  start(t_ns, q_n_b, last_imu_ ? 2 * p_.start_tilt_sigma_rad : p_.start_unaided_tilt_rad, 0.0);
}

void InertialEstimator::propagate(const odo_imu& imu) {
  const int64_t t = imu.header.t_ns;
  if (first_imu_ns_ == INT64_MIN) first_imu_ns_ = t;
  if (!started_) {
    last_imu_ = imu;
    if (t - first_imu_ns_ > p_.wait_for_attitude_ns) start_without_attitude(t);
    return;
  }
  const double dt_s = last_imu_ ? seconds(t - last_imu_->header.t_ns) : 0.0;
  if (t > t_ns_) {
    const bool gap = !last_imu_ || dt_s > p_.longest_gap_s;
    if (gap)
      coast(t);
    else
      integrate(0.5 * (Vector3d(last_imu_->gyro_b) + Vector3d(imu.gyro_b)),
                0.5 * (Vector3d(last_imu_->accel_b) + Vector3d(imu.accel_b)), t);
  }
  last_imu_ = imu;
  if (dt_s > 0) watch_quiet(imu, std::min(dt_s, p_.quiet_tau_s));
  stand(imu);
  remind_of_speed();
  snapshot();
}

void InertialEstimator::integrate(const Vector3d& gyro_b, const Vector3d& accel_b, int64_t to_ns) {
  const double dt_s = seconds(to_ns - t_ns_);
  rewind_.add(gyro_b, accel_b, dt_s);
  const Vector3d rotation = (gyro_b - e_.x.gyro_bias_b) * dt_s;
  const Matrix3d R_middle = (e_.x.q_n_b * exp_rotation(0.5 * rotation)).toRotationMatrix();
  // Where nothing but steps knows the velocity, the accelerometer would only carry it away.
  const bool carried = unaided();
  const Vector3d force_n = carried ? Vector3d(Vector3d::Zero()) : Vector3d(R_middle * (accel_b - e_.x.accel_bias_b));
  const Vector3d accel_n = carried ? Vector3d(Vector3d::Zero()) : Vector3d(force_n + Vector3d(0, 0, p_.gravity_mps2));
  e_.x.p_n += dt_s * e_.x.v_n + 0.5 * dt_s * dt_s * accel_n;
  e_.x.v_n += dt_s * accel_n;
  e_.x.q_n_b = (e_.x.q_n_b * exp_rotation(rotation)).normalized();
  t_ns_ = to_ns;
  transition_.add(R_middle, force_n, dt_s);
  window_.add_imu(to_ns, dt_s, accel_n);
  track_.add(t_ns_, e_.clone_back(0), e_.x);
  if (transition_.s >= p_.longest_transition_s) flush();
  clone_when_due();
}

void InertialEstimator::coast(int64_t to_ns) {
  flush();
  window_.restart();
  rewind_.clear();
  while (t_ns_ < to_ns) {
    const int64_t next = std::min(to_ns, t_ns_ + static_cast<int64_t>(1e9 * p_.longest_transition_s));
    transition_.s = seconds(next - t_ns_);
    e_.x.p_n += transition_.s * e_.x.v_n;
    t_ns_ = next;
    flush(true);
    track_.add(t_ns_, e_.clone_back(0), e_.x);
    clone_when_due();
  }
}

void InertialEstimator::advance_to(int64_t t_ns) {
  if (!started_ || t_ns <= t_ns_) return;
  const bool near = last_imu_ && seconds(t_ns - last_imu_->header.t_ns) <= p_.longest_gap_s;
  if (near)
    integrate(Vector3d(last_imu_->gyro_b), Vector3d(last_imu_->accel_b), t_ns);
  else
    coast(t_ns);
}

bool InertialEstimator::unaided() const {
  if (!camera_) return true;
  return vo_.translated_ns == INT64_MIN ? seconds(t_ns_ - first_frame_ns_) > 2 * p_.unaided_after_s
                                        : seconds(t_ns_ - vo_.translated_ns) > p_.unaided_after_s;
}

void InertialEstimator::flush(bool gap) {
  if (transition_.s <= 0) return;
  const bool carried = unaided();
  const double accel = gap ? p_.gap_accel_noise : carried ? p_.unaided_accel_noise : accel_noise_;
  // Who is carried by steps goes up and down with the ground, and no faster than people climb: a Gauss-Markov velocity.
  const double accel_down = carried ? p_.climb_sigma_mps * std::sqrt(2 / p_.climb_s) : accel;
  const double keep = carried ? std::exp(-transition_.s / p_.climb_s) : 1.0;
  e_.propagate(transition_, {squared(gap ? p_.gap_rotation_noise : gyro_noise_), squared(gyro_walk_), squared(accel),
                             squared(accel_walk_), squared(accel_down)});
  if (carried) {
    e_.wander(kVelocity + 2, keep, 0);
    e_.x.v_n.z() *= keep;
  }
  if (north_) {
    const double decay = std::exp(-transition_.s / p_.north_correlation_s);
    e_.wander(kNorth, decay, (1 - decay * decay) * squared(north_sigma_rad_));
    e_.x.north_rad *= decay;
  } else {
    e_.add_variance(kNorth, 1, squared(p_.gyro_heading_walk) * transition_.s);
  }
  e_.add_variance(kBaro, 1, squared(p_.baro_walk) * transition_.s);
  transition_.clear();
}

void InertialEstimator::clone_when_due() {
  if (t_ns_ - e_.clone_back(0).t_ns < p_.clone_spacing_ns) return;
  flush();
  e_.clone(t_ns_);
  track_.begin_segment();
}

std::optional<PastPose> InertialEstimator::past(int64_t t_ns) const {
  if (!started_) return std::nullopt;
  return track_.at(t_ns, t_ns_, e_);
}

void InertialEstimator::watch_quiet(const odo_imu& imu, double dt_s) {
  const double k = dt_s / (p_.quiet_tau_s + dt_s);
  const Vector3d accel(imu.accel_b), gyro(imu.gyro_b);
  quiet_.accel_mean += k * (accel.norm() - quiet_.accel_mean);
  quiet_.accel_variance += k * (squared(accel.norm() - quiet_.accel_mean) - quiet_.accel_variance);
  quiet_.gyro += k * (gyro.norm() - quiet_.gyro);
  Vector3d::Map(quiet_.gyro_mean) += k * (gyro - Vector3d::Map(quiet_.gyro_mean));
}

/// What a measurement that speaks neither of the metre nor of the walker leaves where it is: a front-end's own metre
/// has weighed inertia already, and where nothing but steps moves the body there is nothing to learn from.
Hold InertialEstimator::calm() const {
  if (unaided()) return Hold::scale_and_steps;
  return vo_.known && vo_.metric ? Hold::scale_and_factor : Hold::nothing;
}

/// The same for one that ties the body to the odometry: a front-end that has used inertia itself is not to be mended by
/// it.
Hold InertialEstimator::follow() const { return led() ? Hold::odometry_and_scale : calm(); }

/// A front-end that has used inertia itself leads: it knows inclination and standing from the same samples.
bool InertialEstimator::led() const {
  return vo_.known && vo_.attached && inertial_front_end_ && vo_.own_information > 1 / squared(p_.led_scale_sigma);
}

/// Zero velocity: where a plugin says that the device rests or its carrier stands, and the samples agree.
void InertialEstimator::stand(const odo_imu& imu) {
  if (!resting_ && mode_ != ODO_MODE_STATIC) return;
  if (led()) return;  // by somebody who knows that as well
  if (quiet_.accel_variance > squared(p_.quiet_accel_mps2) || quiet_.gyro > p_.quiet_gyro_radps) return;
  if (stood_ns_ != INT64_MIN && seconds(t_ns_ - stood_ns_) < p_.stand_interval_s) return;
  stood_ns_ = imu.header.t_ns;
  flush();
  Innovation<3> still;
  still.residual = -e_.x.v_n;
  still.by(kVelocity, Matrix3d::Identity());
  // Every stand_interval_s the same sway: worth one measurement a second.
  const double sigma = resting_ ? p_.still_speed_mps : p_.standing_speed_mps;
  still.noise = Matrix3d::Identity() * (squared(sigma) / p_.stand_interval_s);
  if (e_.update(still, 0, follow()).accepted) reminded_ns_ = t_ns_;
  if (vo_.known && !vo_.metric) e_.add_variance(kLogScale, 1, squared(p_.vo_standing_scale_walk) * p_.stand_interval_s);
  if (!resting_) return;
  Innovation<3> rate;
  rate.residual = Vector3d::Map(quiet_.gyro_mean) - e_.x.gyro_bias_b;
  rate.by(kGyroBias, Matrix3d::Identity());
  rate.noise = Matrix3d::Identity() * (squared(p_.still_gyro_radps) / p_.stand_interval_s);
  e_.update(rate, p_.gate[3], calm());
}

/// Where nothing has spoken for a while the carrier is at least no faster than he can be, and without a camera nobody
/// goes without steps.
void InertialEstimator::remind_of_speed() {
  const double since_s = seconds(t_ns_ - std::max(informed_ns_, reminded_ns_));
  const bool idle = unaided() && seconds(t_ns_ - informed_ns_) > p_.uninformed_speed_s;
  if (since_s < (idle ? p_.stand_interval_s : p_.uninformed_speed_s)) return;
  reminded_ns_ = t_ns_;
  flush();
  if (idle && step_ns_ > rested_ns_) {  // since the last step, which went on until now
    rested_ns_ = step_ns_;
    rest_between(step_ns_, t_ns_);
  }
  Innovation<3> speed;
  speed.residual = -e_.x.v_n;
  speed.by(kVelocity, Matrix3d::Identity());
  speed.noise = Matrix3d::Identity() * squared(idle ? p_.idle_speed_mps : config_.fastest_mps);
  e_.update(speed, 0, Hold::scale_and_steps);
}

bool InertialEstimator::due(const odo_attitude& attitude) const {
  return seconds(attitude.header.t_ns - attitude_ns_) >= p_.attitude_interval_s;
}

UpdateResult InertialEstimator::apply(const odo_attitude* attitude) {
  resting_ = (attitude->header.flags & ODO_ATTITUDE_REST) != 0;
  const int64_t t = attitude->header.t_ns;
  const Quaterniond q = heading_offset() * quaternion(attitude->q_n_b);
  const bool north = refers_to_north(*attitude);
  const double tilt_sigma = std::sqrt(std::max(attitude->covariance_n[0], attitude->covariance_n[4]));
  if (north) north_sigma_rad_ = std::sqrt(attitude->covariance_n[8]);
  if (!started_by_attitude_) {
    started_by_attitude_ = true;
    start(t, q, std::max(tilt_sigma, p_.start_tilt_sigma_rad), north ? std::sqrt(attitude->covariance_n[8]) : 0.0);
    attitude_ns_ = t;
    if (std::exchange(north_, north) != north || north) {  // the heading errs by what the compass does
      const double variance = e_.P(kTheta + 2, kTheta + 2);
      e_.set_independent(kNorth, variance);
      e_.P(kNorth, kTheta + 2) = e_.P(kTheta + 2, kNorth) = -variance;
    }
    if (inputs_.vo)
      publish(t, ODO_DEGRADED, ODO_REASON_INITIALISING);
    else
      publish(t, ODO_TRACKING, ODO_REASON_NONE);
    return {true, 0.0, 0};
  }
  if (!due(*attitude)) return {};
  if (led() && !north) return {};
  attitude_ns_ = t;
  flush();
  const auto then = past(t);
  if (!then) return {};
  Innovation<3> seen;
  seen.residual = log_rotation(q * then->q_n_b.conjugate());
  seen.residual.z() -= e_.x.north_rad;
  seen.by_pose(*then, Matrix3d::Identity(), Matrix3d::Zero());
  seen.by_one(kNorth, Vector3d::UnitZ());
  if (!inputs_.vo || resting_) {  // beside a camera in motion its rotations tell the bias better
    Innovation<3> bias;
    bias.residual = Vector3d(attitude->gyro_bias_b) - e_.x.gyro_bias_b;
    bias.by(kGyroBias, Matrix3d::Identity());
    const double same = resting_ ? 1.0 : p_.attitude_bias_s / p_.attitude_interval_s;
    bias.noise = Matrix3d::Identity() * (squared(p_.attitude_bias_radps) * same);
    e_.update(bias, p_.gate[3], calm());
  }
  const double own_tilt = led() ? EIGEN_PI : unaided() ? p_.attitude_unaided_tilt_rad : p_.attitude_tilt_rad;
  const double tilt = std::max(tilt_sigma, own_tilt);
  // Beside a camera a heading without north is the same gyroscope's once more.
  const bool yaw = north || !inputs_.vo;
  const double heading = yaw ? p_.attitude_yaw_rad : EIGEN_PI;
  if (!yaw) seen.residual.z() = 0;
  seen.noise.diagonal() << squared(tilt), squared(tilt), squared(heading);
  return e_.update(seen, p_.gate[yaw ? 3 : 2], calm());
}

UpdateResult InertialEstimator::apply(const odo_barometer* barometer) {
  constexpr double kSeaLevel_pa = 101325, kScaleHeight_m = 44330, kExponent = 0.190263;  // ISA, troposphere
  const auto then = past(barometer->header.t_ns);
  if (!then || barometer->pressure_pa <= 0) return {};
  flush();
  const double down_m = -kScaleHeight_m * (1 - std::pow(barometer->pressure_pa / kSeaLevel_pa, kExponent));
  if (!std::exchange(baro_started_, true)) e_.x.baro_m = down_m - then->p_n.z();
  Innovation<1> height;
  height.residual[0] = down_m - then->p_n.z() - e_.x.baro_m;
  height.by_pose(*then, Eigen::RowVector3d::Zero(), Eigen::RowVector3d::UnitZ());
  height.by_one(kBaro, Innovation<1>::Vector::Ones());
  // Gusts and doors last for seconds; beside a front-end that leads no single reading is to be seen in the height.
  const double since_s = baro_ns_ == INT64_MIN ? p_.baro_correlation_s : seconds(barometer->header.t_ns - baro_ns_);
  const double same = led() ? p_.baro_correlation_s / std::clamp(since_s, 0.01, p_.baro_correlation_s) : 1.0;
  baro_ns_ = barometer->header.t_ns;
  height.noise(0, 0) = squared(p_.baro_sigma_m) * same;
  return e_.update(height, p_.gate[1], calm());
}

UpdateResult InertialEstimator::apply(const odo_motion_mode* mode) {
  mode_ = mode->mode;
  return {true, 0.0, 0};
}

}  // namespace odograph
