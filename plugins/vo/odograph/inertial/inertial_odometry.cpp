// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/inertial/inertial_odometry.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "plugins/vo/odograph/inertial/propagate.hpp"
#include "sdk/math/rotation_integral.hpp"

namespace odograph::vio {
namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

int64_t imu_offset_ns(const Camera& camera) { return nanoseconds(camera.time_offset_s); }

Isometry3d pose_of(const Clone& clone) { return isometry(clone.q_w_c, clone.p_w); }

Isometry3d pose_of(const Camera& camera, const Navigation& nav) {
  return isometry(nav.q_w_b * camera.q_b_c, nav.p_w + nav.q_w_b * camera.p_b_c);
}

/// Time for which `holds` has been true without a break, s. Keeps its start in `since_ns`.
double lasts_s(bool holds, int64_t t_ns, std::optional<int64_t>& since_ns) {
  if (!holds) since_ns.reset();
  if (holds && !since_ns) since_ns = t_ns;
  return holds ? seconds(t_ns - *since_ns) : 0.0;
}

}  // namespace

InertialOdometry::InertialOdometry(const Parameters& parameters, const Camera& camera)
    : p_(parameters),
      camera_(camera),
      frame_lens_(camera.lens),
      corners_(parameters.corners),
      phase_(initial_phase()) {}

InertialOdometry::Initialising InertialOdometry::initial_phase() const {
  Initialising phase;
  phase.visual = std::make_unique<vo::Odometry>(vo::Odometry::Parameters{}, frame_lens_);
  return phase;
}

const Filter* InertialOdometry::filter() const {
  const auto* phase = std::get_if<Filtering>(&phase_);
  return phase ? &phase->filter : nullptr;
}

void InertialOdometry::add_imu(const ImuSample& sample, bool has_force) {
  imu_.add(sample);
  if (has_force) accel_ns_ = sample.t_ns;
  if (auto* phase = std::get_if<Initialising>(&phase_))
    phase->visual->add_gyroscope(sample.t_ns, camera_.q_b_c.conjugate() * sample.gyro_b);
}

void InertialOdometry::begin(const vo::Frame& frame) {
  if (camera_.line_time_s <= 0 && frame.line_time_s > 0) camera_.line_time_s = frame.line_time_s;
  Pending pending{frame.t_ns, follow(frame), {}, true};
  if (auto* phase = std::get_if<Initialising>(&phase_)) pending.visual = phase->visual->process(frame);
  pending.estimate = !estimated_ns_ || seconds(frame.t_ns - *estimated_ns_) >= p_.min_interval_s;
  if (pending.estimate) estimated_ns_ = frame.t_ns;
  pending_ = std::move(pending);
}

std::optional<InertialMotion> InertialOdometry::finish(bool force) {
  if (!pending_) return std::nullopt;
  if (!force && has_accelerometer(pending_->t_ns) && !imu_reaches(pending_->t_ns)) return std::nullopt;
  const Pending frame = *std::exchange(pending_, std::nullopt);
  Outcome outcome = std::visit([&](auto& phase) { return advance(phase, frame); }, phase_);
  if (outcome.next) phase_ = std::move(*outcome.next);
  const std::optional<int64_t> from_ns = std::exchange(previous_ns_, frame.t_ns);
  if (!from_ns) return std::nullopt;
  outcome.motion.from_ns = *from_ns, outcome.motion.t_ns = frame.t_ns;
  outcome.motion.motion.scale_group = group_;
  return std::move(outcome.motion);
}

/// Reports the visual odometry's motion until a filter starts, from standing or from the visual odometry in motion.
InertialOdometry::Outcome InertialOdometry::advance(Initialising& phase, const Pending& frame) {
  compose(phase, frame.visual);
  if (frame.estimate) {
    phase.frames.push_back({frame.corners, phase.T_w_c, frame.visual.translation_valid, group_});
    while (seconds(frame.t_ns - phase.frames.front().corners.t_ns) > p_.keep_frames_s) phase.frames.pop_front();
    if (has_accelerometer(frame.t_ns))
      if (auto started = try_start(phase, frame.t_ns)) {
        ++group_;
        InertialMotion motion = make_motion(*started, frame.t_ns, started->filter.state().nav, true);
        add_corners(frame.corners, started->filter, motion);
        return {motion, std::move(*started)};
      }
  }
  InertialMotion visual;
  visual.motion = frame.visual;
  visual.corners = phase.visual->corners(), visual.corner_sigma_rad = phase.visual->corner_sigma_rad();
  return {visual, std::nullopt};
}

/// Reports the filter's motion until the filter is lost or wrong.
InertialOdometry::Outcome InertialOdometry::advance(Filtering& phase, const Pending& frame) {
  Filter& filter = phase.filter;
  if (!frame.estimate) return {make_motion(phase, frame.t_ns, navigation_at(filter, frame.t_ns), false), std::nullopt};
  const int64_t before_ns = filter.state().t_ns;
  const FrameReport seen = filter.process(frame.corners, imu_);
  if (!seen.standing) phase.moved_s += seconds(filter.state().t_ns - before_ns);
  phase.tracked = static_cast<unsigned>(corners_.followed());
  phase.accepted = static_cast<unsigned>(seen.accepted);
  const bool wrong = has_diverged(phase, seen, frame.t_ns);
  InertialMotion out = make_motion(phase, frame.t_ns, filter.state().nav, true);
  add_corners(frame.corners, filter, out);
  if (!wrong && filter.velocity_sigma() <= p_.lost_sigma_mps) return {out, std::nullopt};
  ++group_;
  out.metric = false;
  out.motion.translation_valid = false;
  out.motion.rotation_valid = out.motion.q_c0_c1.coeffs().allFinite();
  out.motion.state = Tracking::lost;
  out.motion.failure = dark_or_few_features();
  return {out, initial_phase()};
}

/// Tracks the corners of a frame from the positions predicted by IMU rotation and lens shift. Pixels of the calibrated
/// lens.
FrameCorners InertialOdometry::follow(const vo::Frame& frame) {
  Quaterniond rotation = Quaterniond::Identity();
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  if (previous_ns_) rotation = rotation_between(*previous_ns_, frame.t_ns);
  if (filter() && previous_ns_)
    shift = predict_lens_shift(filter()->state(), frame.t_ns + imu_offset_ns(camera()), imu_, p_.filter);
  const double dt_s = previous_ns_ ? seconds(frame.t_ns - *previous_ns_) : 0;
  FrameCorners seen = corners_.follow(frame.grey, frame.mask, frame.t_ns, dt_s, rotation, shift, lens());
  for (Corner& corner : seen.corners) corner.pixel = vio::change_lens(corner.pixel, frame_lens_, camera_.lens);
  return seen;
}

bool InertialOdometry::has_accelerometer(int64_t t_ns) const {
  return !imu_.empty() && accel_ns_ && t_ns - *accel_ns_ < p_.silent_accel_ns;
}

/// True if the IMU samples reach the last row of the frame.
bool InertialOdometry::imu_reaches(int64_t t_ns) const {
  const double reach_s =
      std::max(0.0, camera().time_offset_s) + (camera().middle_row + 1) * std::abs(camera().line_time_s);
  return !imu_.empty() && imu_.newest_ns() >= t_ns + p_.imu_margin_ns + nanoseconds(reach_s);
}

/// Composes the visual motions into the poses of a scale group.
void InertialOdometry::compose(Initialising& phase, const vo::Motion& visual) {
  if (visual.scale_group != phase.visual_group) {
    phase.visual_group = visual.scale_group;
    phase.T_w_c.setIdentity();
    ++group_;
  }
  if (visual.rotation_valid)
    phase.T_w_c = phase.T_w_c * isometry(visual.q_c0_c1, visual.translation_valid ? visual.p_c0_c1 : Vector3d::Zero());
}

/// Starts from standing or, every start_every_s, from the visual odometry in motion.
std::optional<InertialOdometry::Filtering> InertialOdometry::try_start(Initialising& phase, int64_t t_ns) {
  std::optional<Filter> filter = start_still(phase.frames, imu_, camera_, p_.filter, p_.start);
  double spread = 0;
  if (!filter && (!tried_ns_ || seconds(t_ns - *tried_ns_) >= p_.start_every_s)) {
    tried_ns_ = t_ns;
    const Vector3d gyro_bias_b = camera_.q_b_c * phase.visual->gyro_bias_c();
    auto next = start_moving(phase.frames, imu_, camera_, gyro_bias_b, p_.filter, p_.start);
    std::optional<double> ratio;
    if (next && phase.hypothesis) ratio = scale_between(phase.hypothesis->state(), next->state(), p_.start.min_path_m);
    if (phase.evidence.add(ratio, t_ns, p_.start))
      spread = phase.evidence.spread(), filter = std::move(next);
    else
      phase.hypothesis = std::move(next);
  }
  if (!filter) return std::nullopt;
  const Isometry3d T_w_previous = pose_of(filter->state().camera, navigation_at(*filter, *previous_ns_));
  Filtering out{std::move(*filter), T_w_previous, {}, 0, {}, {}, 0, 0, spread, {}};
  out.tracked = out.accepted = static_cast<unsigned>(corners_.corners().corners.size());
  return out;
}

/// Checks the filter: implausible estimates, or measurements that contradict it for too long.
bool InertialOdometry::has_diverged(Filtering& phase, const FrameReport& seen, int64_t t_ns) const {
  const bool rejected = seen.tried >= p_.min_tried && seen.accepted < p_.min_accepted * seen.tried;
  const bool unseen = !seen.standing && seen.accepted < p_.min_seen;
  lasts_s(!seen.standing && seen.accepted < p_.min_used * phase.tracked, t_ns, phase.few_since_ns);
  const bool diverged = lasts_s(rejected, t_ns, phase.rejected_since_ns) > p_.diverged_s;
  const bool long_unseen = lasts_s(unseen, t_ns, phase.unseen_since_ns) > p_.unseen_s;
  const Navigation& nav = phase.filter.state().nav;
  return !nav.v_w.allFinite() || nav.v_w.norm() > p_.max_speed_mps || nav.accel_bias.norm() > p_.max_accel_bias_mps2 ||
         phase.filter.calibration_chi2() > p_.max_calibration_chi2 || diverged || long_unseen;
}

/// Rotation of the camera by the gyroscope; identity if samples are missing.
Quaterniond InertialOdometry::rotation_between(int64_t from_ns, int64_t to_ns) const {
  const int64_t offset_ns = imu_offset_ns(camera());
  Navigation nav;
  if (const auto* phase = std::get_if<Initialising>(&phase_))
    nav.gyro_bias = camera_.q_b_c * phase->visual->gyro_bias_c();
  else
    nav = filter()->state().nav;
  RotationIntegral integral;
  const bool whole = imu_.for_each(from_ns + offset_ns, to_ns + offset_ns, ImuBuffer::kLongestGap_ns,
                                   [&](const ImuSample& a, const ImuSample& b) {
                                     integral.add(nav.rate(0.5 * (a.gyro_b + b.gyro_b)), seconds(b.t_ns - a.t_ns));
                                   });
  if (!whole) return Quaterniond::Identity();
  return (camera().q_b_c.conjugate() * integral.q_b0_b1 * camera().q_b_c).normalized();
}

/// The filter's navigation state, propagated to the frame's time.
Navigation InertialOdometry::navigation_at(const Filter& filter, int64_t frame_ns) const {
  Navigation nav = filter.state().nav;
  integrate(nav, filter.state().t_ns, frame_ns + imu_offset_ns(filter.state().camera), imu_, p_.filter.gravity_mps2);
  return nav;
}

void InertialOdometry::change_lens(const CameraModel& newest) {
  frame_lens_ = newest;
  if (auto* phase = std::get_if<Initialising>(&phase_)) phase->visual->change_lens(newest);
}

CameraModel InertialOdometry::lens() const {
  CameraModel lens = frame_lens_;
  if (!filter()) return lens;
  const CameraModel &refined = camera().lens, &calibrated = camera_.lens;
  const double by_x = lens.fx / calibrated.fx, by_y = lens.fy / calibrated.fy;
  lens.cx += (refined.cx - calibrated.cx) * by_x, lens.cy += (refined.cy - calibrated.cy) * by_y;
  lens.fx = refined.fx * by_x, lens.fy = refined.fy * by_y;
  if (lens.coefficients == calibrated.coefficients) lens.coefficients = refined.coefficients;
  return lens;
}

FailureReason InertialOdometry::dark_or_few_features() const {
  return corners_.too_dark() ? FailureReason::too_dark : FailureReason::few_features;
}

/// Motion to the filter's pose at a frame: that of the newest clone, or `nav` if there is none.
InertialMotion InertialOdometry::make_motion(Filtering& phase, int64_t t_ns, const Navigation& nav,
                                             bool with_clone) const {
  const Filter& filter = phase.filter;
  const State& state = filter.state();
  const Isometry3d T_w_c = with_clone ? pose_of(filter.newest()) : pose_of(state.camera, nav);
  const Isometry3d step = previous_pose(phase).inverse() * T_w_c;
  InertialMotion out;
  vo::Motion& m = out.motion;
  m.q_c0_c1 = Quaterniond(step.linear()).normalized();
  m.p_c0_c1 = step.translation();
  m.covariance = motion_covariance(filter, t_ns, with_clone);
  m.rotation_valid = m.translation_valid = true;
  m.tracked = phase.tracked, m.inliers = std::min(phase.accepted, phase.tracked);
  const bool few = phase.few_since_ns && seconds(t_ns - *phase.few_since_ns) > p_.degraded_unseen_s;
  const bool blind = phase.unseen_since_ns && seconds(t_ns - *phase.unseen_since_ns) > p_.degraded_unseen_s;
  const bool degraded = blind || few || filter.velocity_sigma() > p_.degraded_sigma_mps;
  m.state = degraded ? Tracking::degraded : Tracking::tracking;
  m.failure = degraded ? dark_or_few_features() : FailureReason::none;
  const double spread = phase.spread * std::exp(-phase.moved_s / p_.spread_s);
  const double of_filter = std::hypot(p_.scale_sigma_factor * filter.scale_sigma(), spread);
  out.scale_sigma =
      std::min(1.0, std::hypot(of_filter, p_.scale_sigma_floor, p_.scale_sigma_stabilised * state.camera.gain));
  out.metric = true;
  const Eigen::Matrix3d R_c_w = T_w_c.linear().transpose();
  const Vector3d rate_b = nav.rate(imu_.at(t_ns + imu_offset_ns(state.camera)).gyro_b);
  out.velocity_c = R_c_w * (nav.v_w + nav.q_w_b * rate_b.cross(state.camera.p_b_c));
  out.gravity_c = R_c_w * Vector3d::UnitZ();
  out.gyro_bias_b = nav.gyro_bias, out.accel_bias_b = nav.accel_bias;
  phase.T_w_previous = T_w_c;
  phase.reported.clear();
  for (auto clone = state.clones.rbegin(); clone != state.clones.rend() && phase.reported.size() < 2; ++clone)
    phase.reported.push_back({clone->id, pose_of(*clone).inverse() * T_w_c});
  return out;
}

/// The corners of the newest clone's frame. The camera moves while the rows are read: a ray begins where it was at its
/// row.
void InertialOdometry::add_corners(const FrameCorners& seen, const Filter& filter, InertialMotion& motion) const {
  const Clone& clone = filter.newest();
  const Camera& camera = filter.state().camera;
  const Vector3d velocity_c = clone.q_w_c.conjugate() * clone.v_w;
  std::vector<uint64_t> missed;
  for (const Landmark& landmark : filter.state().landmarks)
    if (landmark.misses > 0) missed.push_back(landmark.track);
  for (const Corner& corner : seen.corners) {
    const double late_s = (corner.row - camera.middle_row) * camera.line_time_s;
    motion.corners.push_back({corner.track, ray_of(clone, camera, corner.pixel, corner.row), late_s * velocity_c,
                              vio::change_lens(corner.pixel, camera_.lens, frame_lens_),
                              std::find(missed.begin(), missed.end(), corner.track) == missed.end()});
  }
  motion.corner_sigma_rad = filter.gate_sigma() / clone.focal_px;
}

/// Covariance of the motion from the previous frame: from the two clones or, if one is missing, from velocity and gyro
/// bias.
Eigen::Matrix<double, 6, 6> InertialOdometry::motion_covariance(const Filter& filter, int64_t t_ns,
                                                                bool with_clone) const {
  const State& state = filter.state();
  const auto& clones = state.clones;
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  // While the camera stands the previous frame has no clone any more.
  if (with_clone && clones.size() > 1 && previous_ns_ && clones[clones.size() - 2].frame_ns == *previous_ns_) {
    const size_t j = clones.size() - 1, i = j - 1;
    const Eigen::Matrix3d R = clones[i].q_w_c.conjugate().toRotationMatrix();
    constexpr int next = block::clone, both = 2 * block::clone;
    Eigen::Matrix<double, 6, both> J = Eigen::Matrix<double, 6, both>::Zero();
    J.block<3, 3>(0, 0) = -R, J.block<3, 3>(0, next) = R;
    J.block<3, 3>(3, 0) = R * skew(clones[j].p_w), J.block<3, 3>(3, next) = -J.block<3, 3>(3, 0);
    J.block<3, 3>(3, 3) = -R, J.block<3, 3>(3, next + 3) = R;
    covariance = J * state.P.block<both, both>(state.clone_at(i), state.clone_at(i)) * J.transpose();
    const Vector3d step = R * (clones[j].p_w - clones[i].p_w);
    const Eigen::Matrix<double, 6, 1> cross = J * state.P.block<both, 1>(state.clone_at(i), block::scale);
    covariance.rightCols<3>() += cross * step.transpose(), covariance.bottomRows<3>() += step * cross.transpose();
    covariance.bottomRightCorner<3, 3>() += state.P(block::scale, block::scale) * step * step.transpose();
    covariance.diagonal().head<3>().array() += std::pow(p_.rotation_floor_rad, 2);
    covariance.diagonal().tail<3>().array() += std::pow(p_.position_floor_m, 2);
  } else {
    const double dt = previous_ns_ ? seconds(t_ns - *previous_ns_) : 0, velocity_sigma = filter.velocity_sigma();
    // The rotation is the gyroscope's. The filter underestimates the sigma of its bias.
    const auto bias_variance = state.P.diagonal().segment<3>(block::gyro_bias).array();
    covariance.diagonal().head<3>() = bias_variance * std::pow(p_.standing_bias_factor * dt, 2);
    covariance.diagonal().tail<3>().setConstant(velocity_sigma * velocity_sigma * dt * dt);
  }
  return covariance;
}

/// Pose of the previous frame by the present estimate. The corrections of the whole window, which come from new
/// information about the past path, are not motion: reported as such they doubled the shape error on euroc_mh05 in the
/// first seconds. If the frame's clone is gone, the clone before it carries the pose.
Isometry3d InertialOdometry::previous_pose(const Filtering& phase) const {
  const State& state = phase.filter.state();
  for (const ReportedFrame& reported : phase.reported) {
    const size_t i = state.find_clone(reported.clone);
    if (i < state.clones.size()) return pose_of(state.clones[i]) * reported.T_clone_c;
  }
  return phase.T_w_previous;
}

}  // namespace odograph::vio
