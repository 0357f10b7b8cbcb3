// SPDX-License-Identifier: Apache-2.0
//
// Time, the start, and what measures heading, height and place. Motions, steps and poses are in files of their own.
#include "sdk/host/localizer/composer.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/host/base/rotation.hpp"
#include "sdk/host/messages/messages.hpp"

namespace odograph {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

double seconds(int64_t ns) { return static_cast<double>(ns) * kNanoseconds; }

}  // namespace

Composer::Composer(const CouplingConfig& config, const StartPose& start, EstimatorInputs inputs,
                   const LocalizerParameters& parameters)
    : p_(parameters),
      config_(config),
      start_(start),
      inputs_(inputs),
      scale_(p_),
      steps_(p_),
      heading_(p_),
      height_(p_),
      fixes_(p_, config.fix_gate_sigma) {
  reset();
}

void Composer::reset() {
  localizer_ = {};
  track_.clear();
  coverage_ = {};
  attitudes_.clear();
  inertia_.clear();
  scale_ = ScaleUpdate(p_);
  steps_.reset(), heading_.reset(), height_.reset();
  fixes_.reset(start_.given, start_.heading_given);
  heading_.set_mean(start_.heading_rad);
  source_ = NoSource{};
  metre_check_ = {};
  reference_.reset();
  group_ = {};
  path_.clear();
  waiting_count_ = 0;
  started_ = camera_ = lost_ = moves_ = false;
  tilt_variance_ = 0;
  metric_ = !inputs_.vo;
  carried_ = true;
  t_ns_ = first_frame_ns_ = translated_ns_ = step_ns_ = leads_since_ns_ = last_pose_ns_ = INT64_MIN;
  blind_sigma_m_ = distance_m_ = 0;
  velocity_ = Velocity::none;
  gyro_bias_b_.setZero(), accel_bias_b_.setZero();
  pose_.reset(), corrected_.reset(), correction_.reset(), step_reference_.reset();
  notice_ = {};
}

void Composer::on_calibration(const odo_calibration& calibration) {
  if ((calibration.header.flags & ODO_CALIBRATION_EXTRINSICS) == 0) return;
  q_b_c_ = quaternion(calibration.q_b_c);
  p_b_c_ = Vector3d(calibration.p_b_c);
}

void Composer::propagate(const odo_imu& imu) { inertia_.add(imu); }

/// o begins here: it is the attitude source's frame, or level by the first specific force.
void Composer::start(int64_t t_ns, const Quaterniond& q_o_b) {
  started_ = true;
  t_ns_ = t_ns;
  localizer_.x.head<3>() = Vector3d(start_.position_m.data());
  localizer_.set(kLogScale, 0, paper() ? 0 : squared(p_.unknown_scale_sigma));
  localizer_.set(kLogFactor, 0, squared(p_.factor_sigma));
  localizer_.set(kStepHeading, 0, squared(p_.step_heading_sigma_rad));
  set_headings();
  if (config_.orientation == Orientation::gyroscope)
    localizer_.set(kHeadingRate, 0, squared(p_.heading_rate_radps));
  coverage_.begin(t_ns);
  push(t_ns, q_o_b, Vector3d::Zero());
}

/// o has the attitude source's axes, whose heading errs as a compass does, or is what n's was laid by.
void Composer::set_headings() {
  localizer_.set(kAttitudeHeading, start_.heading_rad, heading_.north() ? squared(heading_.north_sigma()) : 0.0);
  localizer_.x[kHeading] = start_.heading_rad;
  localizer_.copy_error(kHeading, kAttitudeHeading);
}

void Composer::start_without_attitude(int64_t t_ns) {
  if (const auto point = inertia_.at(t_ns, 1.0); point && inertia_.has_force())
    return start(t_ns, Quaterniond::FromTwoVectors(point->force_b, -Vector3d::UnitZ()));
  Matrix3d horizontal;  // columns: the camera's x, y, z in o when it looks level along o's first axis
  horizontal << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  start(t_ns, Quaterniond(horizontal) * q_b_c_.conjugate());
}

/// Where the camera begins; before it has moved, the start is its own.
void Composer::begin_camera(int64_t t_ns) {
  camera_ = true;
  first_frame_ns_ = t_ns;
  go_on(t_ns);
  const auto now = point_at(t_ns);
  if (!steps_.any()) {
    coverage_.begin(t_ns);
    localizer_.x.head<3>() = Vector3d(start_.position_m.data()) - localizer_.q_n_o() * (now->q_o_b * p_b_c_);
  }
  push(t_ns, now->q_o_b, Vector3d::Zero());
  carried_ = false;
  if (config_.orientation != Orientation::gyroscope) return;
  gyro_.reset(now->q_o_b * q_b_c_, Vector3d(tilt_variance_, tilt_variance_, 0).asDiagonal());
  if (!heading_.north() && !start_.heading_given) localizer_.loosen_heading(p_.any_heading_rad);
}

void Composer::go_on(int64_t t_ns) {
  if (t_ns <= t_ns_) return;
  const double dt_s = seconds(t_ns - t_ns_);
  t_ns_ = t_ns;
  TrackPoint drifted = track_.newest();
  drifted.heading_drift_rad2 += heading_.go_on(localizer_, dt_s, carried_);
  track_.push(drifted);
  localizer_.add_variance(kBarometer, squared(p_.baro_walk) * dt_s);
  if (config_.orientation != Orientation::gyroscope) return;
  localizer_.add_multiple(kHeading, kHeadingRate, dt_s);
  localizer_.add_variance(kHeadingRate, squared(p_.heading_rate_walk) * dt_s);
}

/// The body has moved in o, m; what drift there was is in the newest point.
void Composer::push(int64_t t_ns, const Quaterniond& q_o_b, const Vector3d& d_o) {
  TrackPoint point = track_.empty() ? TrackPoint{} : track_.newest();
  point.t_ns = track_.empty() ? t_ns : std::max(t_ns, point.t_ns);
  point.q_o_b = q_o_b.normalized();
  point.p_o_b += d_o;
  point.path_m += d_o.norm();
  track_.push(point);
  if (const auto q_a_b = attitudes_.at(point.t_ns)) q_o_a_ = point.q_o_b * q_a_b->conjugate();
}

/// The body's orientation in o as the attitude source has it, since the two were compared.
std::optional<Quaterniond> Composer::by_attitude(int64_t t_ns) const {
  const auto q_a_b = attitudes_.covers(t_ns, static_cast<int64_t>(p_.attitude_gap_s * 1e9)) ? attitudes_.at(t_ns) : std::nullopt;
  return q_a_b ? std::optional<Quaterniond>(q_o_a_ * *q_a_b) : std::nullopt;
}

/// The body in o: from the track, and after its newest pose ahead of it by the newest velocity and rotation.
std::optional<TrackPoint> Composer::point_at(int64_t t_ns) const {
  auto point = track_.at(t_ns);
  if (!point || t_ns <= point->t_ns) return point;
  const double ahead_s = std::min(seconds(t_ns - point->t_ns), seconds(kMaxExtrapolation_ns));
  const auto then = inertia_.at(point->t_ns, 0), now = inertia_.at(t_ns, seconds(kMaxExtrapolation_ns));
  const auto attitude = carried_ || !then ? by_attitude(t_ns) : std::nullopt;
  if (attitude)
    point->q_o_b = *attitude;
  else if (then && now && then->t_ns == point->t_ns)
    point->q_o_b = point->q_o_b * then->q_e_b.conjugate() * now->q_e_b;
  if (!carried_) point->p_o_b += ahead_s * velocity_o_;
  point->t_ns = t_ns;
  return point;
}

UpdateResult Composer::update(const Measurement& measurement) {
  const bool fix = std::holds_alternative<const odo_fix*>(measurement);
  const auto* attitude = std::get_if<const odo_attitude*>(&measurement);
  // A compass beside a camera turns the world that the camera tracks, by little each time and by much in the end.
  const bool turns = attitude && camera_ && refers_to_north(**attitude);
  std::optional<odo_pose> before;
  carried_n_.setZero();
  if ((!attitude || turns) && last_pose_ns_ != INT64_MIN)
    if (const auto point = track_.at(last_pose_ns_)) before = make_pose(*point);
  const UpdateResult result = std::visit([this](const auto& what) { return apply(what); }, measurement);
  if (before) Vector3d::Map(before->p_n) += carried_n_;  // steps are told late: that is motion
  if (before) note_jump(*before, fix || turns ? kCorrectionFix : kCorrectionScale, turns ? 0 : 1);
  return result;
}

UpdateResult Composer::apply(const FrameTime& frame) {
  if (!inputs_.vo) return {};
  if (!started_) start_without_attitude(frame.t_ns);
  if (camera_) {
    settle_steps(frame.t_ns);
    return {};
  }
  begin_camera(frame.t_ns);
  publish(frame.t_ns, ODO_DEGRADED, ODO_REASON_INITIALISING);
  return {true, 0.0, 0};
}

UpdateResult Composer::apply(const odo_attitude* attitude) {
  attitudes_.push(*attitude);
  const bool first = !heading_.noted();
  heading_.note(localizer_, *attitude);
  const int64_t t_ns = attitude->header.t_ns;
  tilt_variance_ = std::max(attitude->covariance_n[0], attitude->covariance_n[4]);
  if (!started_) {
    start(t_ns, quaternion(attitude->q_n_b));
    publish(t_ns, inputs_.vo ? ODO_DEGRADED : ODO_TRACKING, inputs_.vo ? ODO_REASON_INITIALISING : ODO_REASON_NONE);
    return {true, 0.0, 0};
  }
  go_on(t_ns);
  if (first && translated_ns_ == INT64_MIN && step_ns_ == INT64_MIN) {  // the camera came first, and has not moved
    set_headings();
    push(track_.newest().t_ns, quaternion(attitude->q_n_b), Vector3d::Zero());
    return {true, 0.0, 0};
  }
  if (carried_ || !heading_.due(t_ns)) return {};
  const auto then = point_at(t_ns);
  const Quaterniond q_o_a = then ? Quaterniond(then->q_o_b * quaternion(attitude->q_n_b).conjugate()) : q_o_a_;
  return heading_.use(localizer_, t_ns, q_o_a);
}

UpdateResult Composer::apply(const odo_barometer* barometer) {
  if (!started_ || paper()) return {};
  go_on(barometer->header.t_ns);
  const auto then = point_at(barometer->header.t_ns);
  if (!then) return {};
  const double since_m = track_.newest().p_o_b.z() - then->p_o_b.z();  // o and n share the vertical
  return height_.use(localizer_, *barometer, localizer_.x[kDown] - since_m, carried_);
}

UpdateResult Composer::apply(const odo_fix* fix) {
  if (!started_) return {};
  const auto then = point_at(fix->header.t_ns);
  if (!then) {
    notice_ = {"late_fix", "a fix is older than the track that is kept: not used"};
    return {};
  }
  const bool leads = group_.inertial && scale_.own_information() > 1 / squared(p_.lead_scale_sigma);
  const UpdateResult result = fixes_.use(localizer_, *fix,
                                         {*then, track_.newest(), Vector3d(start_.position_m.data()), heading_.north(),
                                          paper(), leads, leads_since_ns_});
  if (!result.accepted) return result;
  if (fix->header.flags & FixUpdate::kHorizontal) metric_ = metric_ || !inputs_.vo || scale_.known();
  reference_.fixed(fix->header.t_ns);
  return result;
}

uint64_t Composer::hold_pose(int64_t t_ns) {
  if (!started_ || t_ns > std::max(t_ns_, track_.newest().t_ns)) return 0;
  auto then = track_.at(t_ns);
  if (!then) return 0;
  return localizer_.hold(*then, track_.newest());
}

bool Composer::held_pose(uint64_t id, HeldPose& out) const {
  return localizer_.held(id, squared(p_.tilt_sigma_rad), out);
}

bool Composer::pose_now(HeldPose& out) const {
  if (!started_) return false;
  const auto now = point_at(std::max(t_ns_, track_.newest().t_ns));
  out.q_n_b = localizer_.q_n_o() * now->q_o_b;
  out.p_n_b = localizer_.p_n() + localizer_.q_n_o() * (now->p_o_b - track_.newest().p_o_b);
  out.own = out.now = out.cross = localizer_.pose_covariance(squared(p_.tilt_sigma_rad));
  return true;
}

}  // namespace odograph
