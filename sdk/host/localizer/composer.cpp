// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/localizer/composer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "sdk/host/messages/messages.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

// Of the inclination that a front-end or an attitude source maintains; 0.5 degrees.
constexpr double kTiltSigma_rad = 0.01;

}  // namespace

Composer::Composer(const CouplingConfig& config, const StartPose& start, LocalizerInputs inputs)
    : inputs_(inputs),
      tracker_(config, start),
      front_end_(tracker_, inputs),
      walker_(tracker_, front_end_),
      fixes_(config.fix_gate_sigma) {
  reset();
}

void Composer::reset() {
  tracker_.reset();
  front_end_.reset();
  walker_.reset();
  fixes_.reset(tracker_.start_pose().given, tracker_.start_pose().heading_given);
  output_.reset();
  heights_ = {}, lift_.reset(), floors_ = {};
  stepped_ns_ = INT64_MIN / 2, reported_floor_ = 0;
  source_ = NoSource{};
  shown_ = !inputs_.vo, strays_ = false;
  notice_ = {};
}

void Composer::pause(int64_t until_ns) {
  if (tracker_.started()) tracker_.pause(until_ns, shown_ || is_placed() || tracker_.paper());
  front_end_.pause();
}

UpdateResult Composer::update(const Measurement& measurement) {
  const UpdateResult result = apply_and_correct(measurement);
  output_.settle();
  return result;
}

UpdateResult Composer::apply_and_correct(const Measurement& measurement) {
  const bool fix = std::holds_alternative<const odo_fix*>(measurement);
  const auto* attitude = std::get_if<const odo_attitude*>(&measurement);
  // A compass beside a camera rotates the tracked world slowly, but without bound in the end.
  const bool rotates = attitude && front_end_.begun() && refers_to_north(**attitude);
  const int64_t last_ns = output_.last_ns();
  const bool of_camera = front_end_.begun();
  const auto point_before = last_ns == INT64_MIN ? std::nullopt : tracker_.track().at(last_ns);
  std::optional<odo_pose> before;
  stepped_ = false;
  if ((!attitude || rotates) && point_before) before = make_pose(*point_before);
  const UpdateResult result = std::visit([this](const auto& what) { return apply(what); }, measurement);
  const auto point = before ? tracker_.track().at(last_ns) : std::nullopt;
  if (!point || front_end_.begun() != of_camera) return result;  // poses now refer to another part of the pipeline
  if (stepped_)                                                  // even if late, this is motion in o, not a correction
    Vector3d::Map(before->p_n) += tracker_.localizer.q_n_o() * (point->p_o_b - point_before->p_o_b);
  odo_pose after = make_pose(*point);
  after.header.t_ns = last_ns;
  output_.correct(*before, after, fix || rotates ? ODO_CORRECTION_FIX : ODO_CORRECTION_SCALE, rotates);
  return result;
}

void Composer::begin_camera(int64_t t_ns) {
  if (!tracker_.started()) {
    tracker_.start_without_attitude(t_ns, front_end_.q_b_c());
    walker_.start();
  }
  if (!front_end_.begun()) front_end_.begin(t_ns, walker_.any());
}

UpdateResult Composer::apply(const FrameTime& frame) {
  if (!inputs_.vo) return {};
  if (front_end_.begun()) {
    if (!tracker_.paper()) record_steps(walker_.settle(frame.t_ns), frame.t_ns);
    return {};
  }
  begin_camera(frame.t_ns);
  publish(frame.t_ns, ODO_DEGRADED, ODO_REASON_INITIALISING);
  return {true, 0.0, 0};
}

UpdateResult Composer::apply(const odo_attitude* attitude) {
  const int64_t t_ns = attitude->header.t_ns;
  const bool first = tracker_.add_attitude(*attitude);
  if (!tracker_.started()) {
    tracker_.start(t_ns, quaternion(attitude->q_n_b));
    walker_.start();
    if (!inputs_.vo) publish(t_ns, ODO_TRACKING, ODO_REASON_NONE);  // otherwise the first frame publishes
    return {true, 0.0, 0};
  }
  tracker_.propagate(t_ns);
  if (first &&
      std::holds_alternative<NoSource>(source_)) {  // the camera started first, and nothing has moved the track yet
    tracker_.heading.start(tracker_.localizer);
    tracker_.push(tracker_.newest().t_ns, quaternion(attitude->q_n_b), Vector3d::Zero());
    return {true, 0.0, 0};
  }
  if (tracker_.rotates_with_attitude() || !tracker_.heading.due(t_ns)) return {};
  // The camera's orientation at that time; the attitude's own may differ.
  const TrackPoint& newest = tracker_.newest();
  const auto q_b0_b1 = tracker_.gyro_rotation(newest.t_ns, t_ns);
  if (!q_b0_b1) return {};
  return tracker_.heading.use(tracker_.localizer, t_ns,
                              newest.q_o_b * *q_b0_b1 * quaternion(attitude->q_n_b).conjugate());
}

UpdateResult Composer::apply(const RelativeMotion& relative) {
  const int64_t t_ns = relative.motion->header.t_ns;
  begin_camera(relative.motion->t_from_ns);
  tracker_.propagate(t_ns);
  const auto moved = front_end_.apply(relative, {shown_, is_placed(), fixes_.fixed_ns() != INT64_MIN, walker_.any()});
  if (moved.moved) {
    if (shown_ && !tracker_.paper()) output_.catch_up(moved.caught_up_m);
    shown_ = true;
    set_source(moved.metric ? MotionSource(MetricSource{moved.inertial}) : MotionSource(ScaledSource{}));
    if (tracker_.paper()) output_.count(moved.moved_m);
  }
  if (!tracker_.paper()) record_steps(walker_.settle(t_ns), t_ns);
  uint32_t state = moved.state;
  const bool has_moved = walker_.moved_ns() != INT64_MIN || front_end_.moved_ns() != INT64_MIN;
  const int64_t moved_ns = std::max(walker_.moved_ns(), front_end_.moved_ns());
  const double bridge_s = tracker_.config().bridge_s;
  if (state == ODO_LOST && has_moved && seconds(t_ns - moved_ns) < bridge_s) state = ODO_DEGRADED;
  // The camera was blind or moves without a scale: the pose stays behind until a metric motion or a fix.
  strays_ = !moved.moved && (strays_ || moved.state == ODO_LOST || moved.reason == ODO_REASON_NO_SCALE);
  const int64_t known_ns = std::max(moved_ns, fixes_.fixed_ns());
  if (state == ODO_DEGRADED && has_moved && strays_ && seconds(t_ns - known_ns) >= bridge_s) state = ODO_LOST;
  publish(t_ns, state, moved.reason);
  return {moved.moved, 0.0, 0};
}

UpdateResult Composer::apply(const odo_step* step) {
  if (!tracker_.started() || step->length_m <= 0 || step->t_end_ns <= step->t_start_ns) return {};
  if (tracker_.is_impossible(step->length_m, seconds(step->t_end_ns - step->t_start_ns))) {
    notice_ = {"fast_step", "a step is longer than coupling.fastest allows: not used"};
    return {};
  }
  tracker_.propagate(step->header.t_ns);
  lift_.step(step->t_start_ns), stepped_ns_ = std::max(stepped_ns_, step->t_end_ns);
  tracker_.height.ride(lift_.riding(), lift_.since_ns());
  if (tracker_.paper()) {
    const Vector3d moved_n = walker_.apply_paper_step(*step);
    output_.count(moved_n.norm());
    record_steps(moved_n, step->header.t_ns);
  } else {
    walker_.add(*step);
    record_steps(walker_.settle(step->header.t_ns), step->header.t_ns);
  }
  return {true, 0.0, 0};
}

void Composer::record_steps(const Vector3d& moved_n, int64_t now_ns) {
  stepped_ = stepped_ || !moved_n.isZero();
  if (!walker_.take_moved()) return;
  shown_ = true;
  set_source(StepSource{});
  if (!front_end_.begun()) return publish(walker_.moved_ns(), ODO_TRACKING, ODO_REASON_NONE);
  const bool frames_end = walker_.moved_ns() > output_.last_ns() && now_ns > walker_.moved_ns();
  if (frames_end && !tracker_.paper()) publish(walker_.moved_ns(), ODO_DEGRADED, ODO_REASON_SENSOR_SILENT);
}

UpdateResult Composer::apply(const odo_barometer* barometer) {
  if (!tracker_.started() || tracker_.paper()) return {};
  tracker_.propagate(barometer->header.t_ns);
  const auto then = tracker_.at(barometer->header.t_ns);
  if (!then) return {};
  update_lift(*barometer);
  const double since_m = tracker_.newest().p_o_b.z() - then->p_o_b.z();  // o and n share the vertical
  const double down_m = tracker_.localizer.x()[kDown] - since_m;
  const UpdateResult result = tracker_.height.riding() ? ride(*barometer)
                                                       : tracker_.height.use(tracker_.localizer, *barometer, down_m,
                                                                             tracker_.rotates_with_attitude());
  update_floor(barometer->header.t_ns);
  return result;
}

/// A walker who has made steps, makes none now, and whose air pressure keeps changing is in a lift or on an escalator.
void Composer::update_lift(const odo_barometer& barometer) {
  if (!walker_.any() || !heights_.add(barometer.header.t_ns, barometer.pressure_pa)) return;
  lift_.update(heights_, stepped_ns_);
  if (lift_.riding() == tracker_.height.riding()) return;
  tracker_.height.ride(lift_.riding(), lift_.since_ns());
  if (front_end_.begun()) return;
  lift_.riding() ? set_source(LiftSource{}) : set_source(StepSource{});
}

/// The barometer measures motion of the body here, not an error of the track.
UpdateResult Composer::ride(const odo_barometer& barometer) {
  const int64_t t_ns = barometer.header.t_ns;
  const double down_m = tracker_.localizer.x()[kDown];
  tracker_.height.add_ride_noise(tracker_.localizer, t_ns);
  const UpdateResult result = tracker_.height.use(tracker_.localizer, barometer, down_m, true);
  TrackPoint to = tracker_.newest();
  if (!front_end_.begun() && t_ns > to.t_ns) to = tracker_.at(t_ns).value_or(to);
  tracker_.push(to.t_ns, to.q_o_b, Vector3d(0, 0, tracker_.localizer.x()[kDown] - down_m));
  stepped_ = true;
  if (!front_end_.begun()) publish(to.t_ns, ODO_TRACKING, ODO_REASON_NONE);
  return result;
}

/// Reports a new floor once it is probable enough.
void Composer::update_floor(int64_t t_ns) {
  constexpr double kReported = 0.8;  // probability; judgement
  floors_.add(t_ns, -tracker_.localizer.x()[kDown]);
  const auto [floor, probability] = floors_.floor();
  if (floor == reported_floor_ || probability < kReported || notice_.key) return;
  reported_floor_ = floor;
  std::snprintf(floor_text_.data(), floor_text_.size(), "floor %+d from where the track began, probability %.2f", floor,
                probability);
  notice_ = {"floor", floor_text_.data(), ODO_SEVERITY_INFO};
}

UpdateResult Composer::apply(const odo_fix* fix) {
  if (!tracker_.started()) return {};
  const auto then = tracker_.at(fix->header.t_ns);
  if (!then) {
    notice_ = {"late_fix", "a fix is older than the stored track: not used"};
    return {};
  }
  const Vector3d start_n(tracker_.start_pose().position_m.data());
  tracker_.add_gap(fix->header.t_ns);
  const UpdateResult result = fixes_.use(tracker_.localizer, *fix,
                                         {*then, tracker_.newest(), start_n, tracker_.heading.north(), tracker_.paper(),
                                          front_end_.has_priority(), front_end_.priority_since_ns()});
  if (!result.accepted) return result;
  output_.fixed(fix->header.t_ns);
  shown_ = shown_ || is_placed();
  if (fix->header.flags & ODO_FIX_ORIENTATION) {
    const Quaterniond q_o_n = tracker_.localizer.q_n_o().conjugate();
    const Matrix3d R_o_n = q_o_n.toRotationMatrix();
    const auto R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(fix->orientation_cov_n);
    front_end_.gyroscope().update_inclination(q_o_n * quaternion(fix->q_n_b), *then, R_o_n * R * R_o_n.transpose());
  }
  return result;
}

void Composer::set_source(const MotionSource& source) {
  if (source.index() != source_.index() && !notice_.key)
    notice_ = {"motion_source", describe(source), ODO_SEVERITY_INFO};
  source_ = source;
}

Notice Composer::take_notice() {
  const Notice of_steps = walker_.take_notice();
  return of_steps.key ? of_steps : std::exchange(notice_, {});
}

/// In paper mode without a scale source, the track is published up to scale.
bool Composer::is_metric() const {
  if (!inputs_.vo || front_end_.metric()) return shown_;
  return shown_ && (inputs_.scale || !tracker_.paper());
}

odo_pose Composer::make_pose(const TrackPoint& point) const {
  const Localizer& localizer = tracker_.localizer;
  auto pose = make_message<odo_pose>(ODO_TYPE_POSE, point.t_ns);
  const bool placed = shown_ || tracker_.paper(), moves = tracker_.velocity() != Tracker::Velocity::none;
  pose.header.flags = ODO_POSE_ORIENTATION | ODO_POSE_COVARIANCE;
  if (placed) pose.header.flags |= ODO_POSE_POSITION;
  if (is_metric()) pose.header.flags |= ODO_POSE_METRIC | (moves ? ODO_POSE_VELOCITY : 0);
  if (tracker_.height.riding()) pose.header.flags |= ODO_POSE_CARRIED;
  if (floors_.has_height()) {
    pose.header.flags |= ODO_POSE_FLOOR;
    pose.floor = floors_.floor().floor, pose.floor_probability = floors_.floor().probability;
  }
  const Quaterniond q_n_o = localizer.q_n_o(), q_n_b = (q_n_o * point.q_o_b).normalized();
  Vector3d p_n = localizer.p_n() - q_n_o * (tracker_.newest().p_o_b - point.p_o_b);
  Eigen::Matrix<double, 6, 6> covariance = localizer.pose_covariance(squared(kTiltSigma_rad));
  if (front_end_.begun()) {
    covariance.diagonal().segment<2>(3).array() += squared(tracker_.unobserved_m(point.t_ns));
    pose.header.flags |= ODO_POSE_CAMERA;
    const Vector3d lever_n = q_n_b * front_end_.p_b_c();
    p_n += lever_n;
    const Matrix3d by_theta = -skew(lever_n);
    covariance.bottomRows<3>() += (by_theta * covariance.topRows<3>()).eval();
    covariance.rightCols<3>() += (covariance.leftCols<3>() * by_theta.transpose()).eval();
  }
  put_quaternion(front_end_.begun() ? (q_n_b * front_end_.q_b_c()).normalized() : q_n_b, pose.q_n);
  Vector3d::Map(pose.p_n) = placed ? p_n : Vector3d(tracker_.start_pose().position_m.data());
  const bool of_camera = front_end_.begun() && moves;
  Vector3d::Map(pose.velocity_n) = q_n_o * (of_camera ? front_end_.camera_velocity_o() : tracker_.velocity_o());
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(pose.covariance) = covariance;
  if (front_end_.scale().known() || (tracker_.paper() && inputs_.scale && shown_)) {
    pose.scale = std::exp(localizer.x()[kLogScale]);
    pose.scale_sigma = pose.scale * localizer.sigma(kLogScale);
  }
  pose.distance_m = output_.distance_m();
  pose.state = output_.last_state(), pose.reason = output_.last_reason();
  return pose;
}

void Composer::publish(int64_t t_ns, uint32_t state, uint32_t reason) {
  auto point = tracker_.track().at(t_ns);
  if (!point) return;
  point->t_ns = t_ns;
  odo_pose pose = make_pose(*point);
  pose.state = state, pose.reason = reason;
  const double own = front_end_.scale().own_information();
  output_.publish(pose, shown_, own > 0 ? 1 / std::sqrt(own) : 0.0);
}

void Composer::prepare(odo_vo_motion& motion) const {
  Quaterniond q_n_c = front_end_.q_b_c();
  if (tracker_.started()) {
    const TrackPoint point = tracker_.track().at(motion.t_from_ns).value_or(tracker_.newest());
    q_n_c = tracker_.localizer.q_n_o() * point.q_o_b * front_end_.q_b_c();
  }
  put_quaternion(q_n_c.normalized(), motion.q_n_c0);
  motion.header.flags |= ODO_FLAG_NAVIGATION;
}

int32_t Composer::at(int64_t t_ns, Estimate& out) const {
  if (!tracker_.started()) return ODO_NOT_READY;
  const int64_t newest_ns = tracker_.now_ns();
  if (t_ns == INT64_MIN) t_ns = newest_ns;
  if (t_ns > newest_ns && t_ns - newest_ns > kMaxExtrapolation_ns) return ODO_E_NOT_FOUND;
  const auto point = tracker_.at(t_ns);
  if (!point) return ODO_E_NOT_FOUND;
  const Quaterniond q_n_o = tracker_.localizer.q_n_o();
  out.pose = make_pose(*point);
  if (t_ns > newest_ns) out.pose.header.flags |= ODO_POSE_EXTRAPOLATED;
  out.q_n_b = (q_n_o * point->q_o_b).normalized();
  out.p_n_b = tracker_.localizer.p_n() - q_n_o * (tracker_.newest().p_o_b - point->p_o_b);
  out.v_n_b = q_n_o * tracker_.velocity_o();
  out.velocity_is_mean = tracker_.velocity() != Tracker::Velocity::now;
  out.gyro_bias_b = front_end_.gyro_bias_b, out.accel_bias_b = front_end_.accel_bias_b;
  return ODO_OK;
}

uint64_t Composer::retain_pose(int64_t t_ns) {
  if (!tracker_.started() || t_ns > tracker_.newest().t_ns) return 0;
  const auto then = tracker_.track().at(t_ns);
  return then ? tracker_.localizer.retain_pose(*then, tracker_.newest()) : 0;
}

bool Composer::retained_pose(uint64_t id, RetainedPose& out) const {
  return tracker_.localizer.retained_pose(id, squared(kTiltSigma_rad), out);
}

bool Composer::pose_now(RetainedPose& out) const {
  Estimate now;
  if (at(INT64_MIN, now) != ODO_OK) return false;
  out.q_n_b = now.q_n_b, out.p_n_b = now.p_n_b;
  out.own = out.now = out.cross = tracker_.localizer.pose_covariance(squared(kTiltSigma_rad));
  return true;
}

}  // namespace odograph
