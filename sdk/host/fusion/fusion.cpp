// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/fusion/fusion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sdk/host/messages/messages.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

/// Covariance of (rotation, position) of a point at a lever, from that of the origin.
void move_by_lever(const Vector3d& lever_n, Eigen::Matrix<double, 6, 6>& covariance) {
  const Matrix3d by_theta = -skew(lever_n);
  covariance.bottomRows<3>() += (by_theta * covariance.topRows<3>()).eval();
  covariance.rightCols<3>() += (covariance.leftCols<3>() * by_theta.transpose()).eval();
}

/// The correction between two poses of one time, after an earlier one.
Correction between(const odo_pose& before, const odo_pose& after, uint32_t reason) {
  const Quaterniond q = (raw_quaternion(after.q_n) * raw_quaternion(before.q_n).conjugate()).normalized();
  return {q, Vector3d(after.p_n) - q * Vector3d(before.p_n), reason, after};
}

}  // namespace

/// Applies an input. Every change of the newest published pose that is not motion is a correction.
template <class Apply>
UpdateResult Fusion::update(uint32_t reason, bool report_small, Outputs& out, Apply&& apply) {
  const size_t published = out.poses.size();
  const bool of_camera = poses_are_of_camera();
  const auto point_before = last_ ? state_.track.stored(*last_) : std::nullopt;
  std::optional<odo_pose> before;
  if (reason && point_before) before = make_pose(*point_before);
  const Instant last = last_;
  stepped_ = false;
  const UpdateResult result = apply();
  const auto point = before ? state_.track.stored(*last) : std::nullopt;
  if (point && poses_are_of_camera() == of_camera) {  // otherwise poses now refer to another part of the phone
    if (stepped_)                                     // even if late, this is motion in o, not a correction
      Vector3d::Map(before->p_n) += state_.filter.q_n_o() * (point->p_o_b - point_before->p_o_b);
    odo_pose after = make_pose(*point);
    after.header.t_ns = *last;
    correct(*before, after, reason, report_small, out);
  }
  for (odo_pose* pose = out.poses.begin() + published; pose != out.poses.end(); ++pose) {
    count(*pose);
    pose->distance_m = distance_m_;
  }
  if (source() != reported_source_ && source() != MotionSource::camera_not_moving) {
    reported_source_ = source();
    out.notices.add({"motion_source", describe(source()), ODO_SEVERITY_INFO});
  }
  return result;
}

void Fusion::correct(const odo_pose& before, const odo_pose& after, uint32_t reason, bool report_small, Outputs& out) {
  if ((before.header.flags & ODO_POSE_POSITION) == 0) {
    if (reason == ODO_CORRECTION_FIX)
      counted_from_ += Vector3d(after.p_n) - Vector3d(before.p_n);  // its first position
    return;
  }
  Correction now = between(before, after, reason);
  const Vector3d jump_n = Vector3d(after.p_n) - Vector3d(before.p_n);
  const double jump_m = jump_n.norm(), rotation_rad = log_rotation(now.q).norm();
  if (jump_m == 0 && rotation_rad < 1e-12) return;
  if (!report_small && jump_m <= p_.announced_jump_m && rotation_rad <= p_.announced_rotation_rad) return;
  if (out.correction) now.p += now.q * out.correction->p, now.q = (now.q * out.correction->q).normalized();
  out.correction = now;
  counted_from_ += jump_n;
}

void Fusion::begin_camera(int64_t t_ns) {
  if (!state_.started()) state_.start_without_attitude(t_ns, odometry_->q_b_c()), steps_.start();
  if (!odometry_->begun()) odometry_->begin(t_ns, steps_.moved().has_value(), fixes_.any());
}

void Fusion::on_frame(int64_t t_ns, Outputs& out) {
  if (!inputs_.vo) return;
  update(ODO_CORRECTION_SCALE, false, out, [&]() -> UpdateResult {
    if (odometry_->begun()) return settle_steps(t_ns, out), UpdateResult{};
    begin_camera(t_ns);
    publish(t_ns, ODO_DEGRADED, ODO_REASON_INITIALISING, out);
    return {};
  });
}

UpdateResult Fusion::on_attitude(const odo_attitude& attitude, Outputs& out) {
  // A compass beside a camera rotates the tracked world slowly, but without bound in the end.
  const bool rotates = odometry_->begun() && refers_to_north(attitude);
  return update(rotates ? ODO_CORRECTION_FIX : 0, rotates, out, [&] { return apply(attitude, out); });
}

UpdateResult Fusion::apply(const odo_attitude& attitude, Outputs& out) {
  const int64_t t_ns = attitude.header.t_ns;
  const bool first = state_.add_attitude(attitude);
  if (!state_.started()) {
    state_.start(t_ns, quaternion(attitude.q_n_b));
    steps_.start();
    if (!inputs_.vo) publish(t_ns, ODO_TRACKING, ODO_REASON_NONE, out);  // otherwise the first frame publishes
    return {true, 0.0, 0};
  }
  state_.propagate(t_ns);
  const bool unmoved = source() == MotionSource::nothing || source() == MotionSource::camera_not_moving;
  if (first && unmoved) {  // the camera started first
    state_.heading.start(state_.filter);
    state_.track.push(state_.track.newest().t_ns, quaternion(attitude.q_n_b), Vector3d::Zero());
    return {true, 0.0, 0};
  }
  if (!state_.corrects_heading(t_ns, odometry_->moved().has_value())) return {};
  // The camera's orientation at that time; the attitude's own may differ.
  const TrackPoint& newest = state_.track.newest();
  const auto q_b0_b1 = state_.track.gyro_rotation(newest.t_ns, t_ns);
  if (!q_b0_b1) return {};
  return state_.heading.use(state_.filter, t_ns, newest.q_o_b * *q_b0_b1 * quaternion(attitude.q_n_b).conjugate());
}

void Fusion::on_motion(const odo_vo_motion& m, const odo_scale* scale, Outputs& out) {
  update(ODO_CORRECTION_SCALE, false, out, [&]() -> UpdateResult {
    const int64_t t_ns = m.header.t_ns;
    begin_camera(m.t_from_ns);
    state_.propagate(t_ns);
    const bool fresh = !shown_ && !fixes_.fixed() && !steps_.any();
    const auto motion = odometry_->apply(m, scale, shown_ || is_placed(), fresh);
    if (motion.moves) count(motion), shown_ = true;
    settle_steps(t_ns, out);
    uint32_t state = motion.state;
    const Instant moved = std::max(steps_.moved(), odometry_->moved()), known = std::max(moved, fixes_.fixed());
    const double bridge_s = state_.config.bridge_s;
    if (state == ODO_LOST && moved && seconds(t_ns - *moved) < bridge_s) state = ODO_DEGRADED;
    // The camera was blind or moves without a scale: the pose stays behind until a metric motion or a fix.
    unobserved_ = !motion.moves && (unobserved_ || motion.state == ODO_LOST || motion.reason == ODO_REASON_NO_SCALE);
    if (state == ODO_DEGRADED && moved && unobserved_ && seconds(t_ns - *known) >= bridge_s) state = ODO_LOST;
    publish(t_ns, state, motion.reason, out);
    return {};
  });
}

UpdateResult Fusion::on_scale(const odo_scale& scale, Outputs& out) {
  return update(ODO_CORRECTION_SCALE, false, out, [&] { return odometry_->apply(scale); });
}

UpdateResult Fusion::on_step(const odo_step& step, Outputs& out) {
  if (!state_.started() || step.length_m <= 0 || step.t_end_ns <= step.t_start_ns) return {};
  if (state_.is_impossible(step.length_m, seconds(step.t_end_ns - step.t_start_ns))) {
    out.notices.add({"fast_step", "a step is longer than coupling.fastest allows: not used"});
    return {};
  }
  return update(ODO_CORRECTION_SCALE, false, out, [&]() -> UpdateResult {
    state_.propagate(step.header.t_ns);
    step_end_ = std::max(step_end_, Instant(step.t_end_ns));
    state_.height.step(step.t_start_ns);
    move_by(step, out);
    return {true, 0.0, 0};
  });
}

void Fusion::move_by(const odo_step& step, Outputs& out) {
  steps_.add(step);
  settle_steps(step.header.t_ns, out);
}

void Fusion::settle_steps(int64_t now_ns, Outputs& out) {
  const Steps::Moved moved = steps_.settle(now_ns, out);
  record(moved, out);
  const bool frames_end = moved.lead && odometry_->begun() && steps_.moved() > last_ && now_ns > *steps_.moved();
  if (frames_end) publish(*steps_.moved(), ODO_DEGRADED, ODO_REASON_SENSOR_SILENT, out);
}

void Fusion::record(const Steps::Moved& moved, Outputs& out) {
  stepped_ = stepped_ || !moved.d_n.isZero();
  if (!moved.lead) return;
  shown_ = true;
  if (!odometry_->begun()) publish(*steps_.moved(), ODO_TRACKING, ODO_REASON_NONE, out);
}

UpdateResult Fusion::on_barometer(const odo_barometer& barometer, Outputs& out) {
  if (!state_.started()) return {};
  return update(ODO_CORRECTION_SCALE, false, out, [&] { return apply(barometer, out); });
}

UpdateResult Fusion::apply(const odo_barometer& barometer, Outputs& out) {
  const int64_t t_ns = barometer.header.t_ns;
  state_.propagate(t_ns);
  const auto then = state_.at(t_ns);
  if (!then) return {};
  // A walker who has made steps, makes none now, and whose air pressure keeps changing is in a lift or on an escalator.
  if (steps_.any() && state_.height.detect_ride(barometer, step_end_) && !odometry_->begun())
    state_.moved_by(state_.height.riding() ? MotionSource::lift : MotionSource::steps);
  const double since_m = state_.track.newest().p_o_b.z() - then->p_o_b.z();  // o and n share the vertical
  const double down_m = state_.filter.x()[kDown] - since_m;
  const UpdateResult result = state_.height.riding()
                                  ? ride(barometer, out)
                                  : state_.height.use(state_.filter, barometer, down_m, !state_.camera_leads());
  floors_.add(t_ns, fixes_.moved_down_m() - state_.filter.x()[kDown]);
  if (const auto floor = floors_.report()) out.notices.add(*floor);
  return result;
}

/// The barometer measures motion of the body here, not an error of the track.
UpdateResult Fusion::ride(const odo_barometer& barometer, Outputs& out) {
  const int64_t t_ns = barometer.header.t_ns;
  const double down_m = state_.filter.x()[kDown];
  state_.height.add_ride_noise(state_.filter, t_ns);
  const UpdateResult result = state_.height.use(state_.filter, barometer, down_m, true);
  TrackPoint to = state_.track.newest();
  if (!odometry_->begun() && t_ns > to.t_ns) to = state_.at(t_ns).value_or(to);
  state_.track.push(to.t_ns, to.q_o_b, Vector3d(0, 0, state_.filter.x()[kDown] - down_m));
  stepped_ = true;
  if (!odometry_->begun()) publish(to.t_ns, ODO_TRACKING, ODO_REASON_NONE, out);
  return result;
}

UpdateResult Fusion::on_fix(const odo_fix& fix, Outputs& out) {
  if (!state_.started()) return {};
  return update(ODO_CORRECTION_FIX, false, out, [&] { return apply(fix, out); });
}

UpdateResult Fusion::apply(const odo_fix& fix, Outputs& out) {
  const auto then = state_.at(fix.header.t_ns);
  if (!then) return out.notices.add({"late_fix", "a fix is older than the stored track: not used"}), UpdateResult{};
  state_.add_gap(fix.header.t_ns);
  const UpdateResult result =
      fixes_.use(state_.filter, fix,
                 {*then, state_.track.newest(), state_.track.walked_sigma_m(fix.header.t_ns),
                  Vector3d(state_.start_pose.position_m.data()), state_.heading.north(), odometry_->has_priority(),
                  odometry_->priority_since(), kept_by_heading_, kept_by_position_});
  if (!result.accepted) return result;
  displacement_reference_.fixed(fix.header.t_ns);
  if (fixes_.fixed() == fix.header.t_ns)
    state_.observe(fix.header.t_ns, std::sqrt(std::max(fix.covariance_n[0], fix.covariance_n[4])));
  shown_ = shown_ || is_placed();
  odometry_->gyroscope().update_inclination(fix, *then);
  return result;
}

template <class Place>
UpdateResult Fusion::on_place(const Place& place, Outputs& out) {
  if (!state_.started() || !shown_) return {};
  const int64_t t_ns = place.header.t_ns;
  // n is arbitrary: neither a start nor a compass nor a fix has given its place.
  const bool takes_frame = !is_placed() && !state_.heading.north() && !fixes_.any();
  return update(ODO_CORRECTION_FIX, false, out, [&]() -> UpdateResult {
    const auto then = state_.at(t_ns);
    if (!then) return out.notices.add({"late_place", "a place was recognised too late: not used"}), UpdateResult{};
    state_.add_gap(t_ns);
    const UpdateResult result = use(place, *then, kept_by_heading_ & kept_by_position_, takes_frame);
    if (!result.accepted) return result;
    displacement_reference_.fixed(t_ns);
    state_.observe(t_ns, std::sqrt(std::max({place.covariance[21], place.covariance[28], place.covariance[35]})));
    return result;
  });
}
template UpdateResult Fusion::on_place(const odo_relative_pose& place, Outputs& out);
template UpdateResult Fusion::on_place(const odo_map_pose& place, Outputs& out);

void Fusion::on_pause(int64_t until_ns) {
  if (state_.started()) state_.pause(until_ns, has_position() || is_placed());
  odometry_->pause();
}

odo_pose Fusion::make_pose(const TrackPoint& point) const {
  const PoseFilter& filter = state_.filter;
  const Velocity velocity = state_.track.velocity(point.t_ns);
  const bool camera = poses_are_of_camera(), moves = velocity != Velocity::none;
  auto pose = make_message<odo_pose>(ODO_TYPE_POSE, point.t_ns);
  pose.header.flags = ODO_POSE_ORIENTATION | ODO_POSE_COVARIANCE;
  if (has_position()) pose.header.flags |= ODO_POSE_POSITION;
  if (is_metric()) pose.header.flags |= ODO_POSE_METRIC | (moves ? ODO_POSE_VELOCITY : 0);
  if (state_.height.riding()) pose.header.flags |= ODO_POSE_CARRIED;
  if (floors_.has_height()) {
    pose.header.flags |= ODO_POSE_FLOOR;
    pose.floor = floors_.floor().floor, pose.floor_probability = floors_.floor().probability;
  }
  const Quaterniond q_n_o = filter.q_n_o(), q_n_b = (q_n_o * point.q_o_b).normalized();
  Vector3d p_n = filter.p_n() - q_n_o * (state_.track.newest().p_o_b - point.p_o_b);
  Eigen::Matrix<double, 6, 6> covariance = filter.pose_covariance(tilt_variance());
  if (camera) {
    covariance.diagonal().segment<2>(3).array() += squared(state_.unobserved_m(point.t_ns));
    pose.header.flags |= ODO_POSE_CAMERA;
    const Vector3d lever_n = q_n_b * odometry_->p_b_c();
    p_n += lever_n;
    move_by_lever(lever_n, covariance);
  }
  put_quaternion(camera ? (q_n_b * odometry_->q_b_c()).normalized() : q_n_b, pose.q_n);
  Vector3d::Map(pose.p_n) = has_position() ? p_n : Vector3d(state_.start_pose.position_m.data());
  Vector3d::Map(pose.velocity_n) =
      q_n_o * (camera && velocity > Velocity::steps ? odometry_->camera_velocity_o() : state_.track.velocity_o());
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(pose.covariance) = covariance;
  if (has_scale()) {
    pose.scale = std::exp(filter.x()[kLogScale]);
    pose.scale_sigma = pose.scale * filter.sigma(kLogScale);
  }
  pose.distance_m = distance_m_, pose.state = last_state_, pose.reason = last_reason_;
  return pose;
}

void Fusion::publish(int64_t t_ns, uint32_t state, uint32_t reason, Outputs& out) {
  auto point = state_.track.stored(t_ns);
  if (!point) return;
  point->t_ns = t_ns;
  odo_pose& pose = out.poses.add(make_pose(*point));
  pose.state = state, pose.reason = reason;
  if (!last_ || !shown_) counted_from_ = Vector3d(pose.p_n);
  last_ = t_ns, last_state_ = state, last_reason_ = reason;
  if ((pose.header.flags & ODO_POSE_CAMERA) == 0) return;
  const double own = odometry_->scale().own_information(), sigma = own > 0 ? 1 / std::sqrt(own) : 0.0;
  const bool moves = state_.camera_leads() && (pose.header.flags & ODO_POSE_VELOCITY) != 0;
  const double scale_sigma = moves && sigma < p_.reference_scale_sigma ? sigma : 0;
  if (const auto reference = displacement_reference_.add_pose(pose, scale_sigma)) out.step_reference = *reference;
}

/// The path between poses, without their corrections.
void Fusion::count(const odo_pose& pose) {
  const Vector3d p_n(pose.p_n);
  const double moved_m = (p_n - counted_from_).norm();
  if (moved_m <= p_.counted_m) return;
  distance_m_ += moved_m;
  counted_from_ = p_n;
}

void Fusion::prepare(odo_vo_motion& motion) const {
  Quaterniond q_n_c = odometry_->q_b_c();
  if (state_.started())
    q_n_c = state_.filter.q_n_o() * state_.track.stored(motion.t_from_ns).value_or(state_.track.newest()).q_o_b * q_n_c;
  put_quaternion(q_n_c.normalized(), motion.q_n_c0);
  motion.header.flags |= ODO_FLAG_NAVIGATION;
}

int32_t Fusion::at(Instant t, Estimate& out) const {
  if (!state_.started()) return ODO_NOT_READY;
  const int64_t newest_ns = state_.now_ns(), t_ns = t.value_or(newest_ns);
  if (t_ns > newest_ns && t_ns - newest_ns > kMaxExtrapolation_ns) return ODO_E_NOT_FOUND;
  const auto point = state_.at(t_ns);
  if (!point) return ODO_E_NOT_FOUND;
  const Quaterniond q_n_o = state_.filter.q_n_o();
  out.pose = make_pose(*point);
  if (t_ns > newest_ns) out.pose.header.flags |= ODO_POSE_EXTRAPOLATED;
  out.q_n_b = (q_n_o * point->q_o_b).normalized();
  out.p_n_b = state_.filter.p_n() - q_n_o * (state_.track.newest().p_o_b - point->p_o_b);
  out.v_n_b = q_n_o * state_.track.velocity_o();
  out.velocity = state_.track.velocity(t_ns), out.velocity_until_ns = state_.track.velocity_until_ns();
  out.gyro_bias_b = odometry_->gyro_bias_b, out.accel_bias_b = odometry_->accel_bias_b;
  return ODO_OK;
}

bool Fusion::pose_now(KeptPose& out) const {
  Estimate now;
  if (at({}, now) != ODO_OK) return false;
  out.q_n_b = now.q_n_b, out.p_n_b = now.p_n_b;
  out.own = out.now = out.cross = state_.filter.pose_covariance(tilt_variance());
  return true;
}

}  // namespace odograph
