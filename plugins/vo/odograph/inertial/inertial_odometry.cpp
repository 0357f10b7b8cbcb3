// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/inertial/inertial_odometry.hpp"

#include <algorithm>
#include <cmath>

#include "plugins/vo/odograph/inertial/propagate.hpp"
#include "plugins/vo/odograph/visual/gyroscope.hpp"
#include "plugins/vo/odograph/visual/shared.hpp"

namespace odograph::vio {
namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr int64_t kLongestGap_ns = 60'000'000;
constexpr int64_t kAccelSilent_ns = 500'000'000;
constexpr int64_t kMargin_ns = 2'000'000;
constexpr double kKeepFrames_s = 3.5;
constexpr int kLeastTried = 8;

double seconds(int64_t ns) { return static_cast<double>(ns) * 1e-9; }

}  // namespace

InertialOdometry::InertialOdometry(const Parameters& parameters, const Camera& camera)
    : p_(parameters), camera_(camera), lens_told_(camera.lens), corners_(parameters.corners) {
  visual_.emplace(vo::Odometry::Parameters{}, camera.lens);
}

void InertialOdometry::add_imu(const ImuSample& sample, bool has_force) {
  imu_.add(sample);
  if (has_force) accel_ns_ = sample.t_ns;
  visual_->add_gyroscope(sample.t_ns, camera_.q_b_c.conjugate() * sample.gyro_b);
}

Isometry3d InertialOdometry::camera_pose(const Navigation& nav) const {
  const Camera& camera = filter_->state().camera;
  return vo::isometry(nav.q_w_b * camera.q_b_c, nav.p_w + nav.q_w_b * camera.p_b_c);
}

/// Of the camera, by the gyroscope; none where samples lack.
Quaterniond InertialOdometry::rotation_since(int64_t from_ns, int64_t to_ns) const {
  const Camera& camera = filter_ ? filter_->state().camera : camera_;
  const auto offset_ns = static_cast<int64_t>(std::llround(camera.time_offset_s * 1e9));
  Navigation nav;
  nav.gyro_bias = camera_.q_b_c * visual_->gyro_bias_c();
  if (filter_) nav = filter_->state().nav;
  Quaterniond q = Quaterniond::Identity();
  const bool whole = imu_.for_each(from_ns + offset_ns, to_ns + offset_ns, kLongestGap_ns,
                                   [&](const ImuSample& a, const ImuSample& b) {
                                     const Vector3d rate = nav.rate(0.5 * (a.gyro_b + b.gyro_b));
                                     q = q * vo::exp_rotation(seconds(b.t_ns - a.t_ns) * rate);
                                   });
  return whole ? (camera.q_b_c.conjugate() * q * camera.q_b_c).normalized() : Quaterniond::Identity();
}

void InertialOdometry::begin(const vo::Frame& frame) {
  if (camera_.line_time_s <= 0 && frame.line_time_s > 0) camera_.line_time_s = frame.line_time_s;
  const bool first = previous_ns_ == INT64_MIN;
  const Quaterniond turn = first ? Quaterniond::Identity() : rotation_since(previous_ns_, frame.t_ns);
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  if (filter_ && !first) {
    const double offset_s = filter_->state().camera.time_offset_s;
    const auto offset_ns = static_cast<int64_t>(std::llround(offset_s * 1e9));
    shift = lens_moves(filter_->state(), frame.t_ns + offset_ns, imu_, p_.filter);
  }
  seen_ = corners_.follow(frame.grey, frame.mask, frame.t_ns, first ? 0 : seconds(frame.t_ns - previous_ns_), turn,
                          shift, lens());
  for (Corner& corner : seen_.corners) corner.pixel = vio::change_lens(corner.pixel, lens_told_, camera_.lens);
  Pending pending{frame.t_ns, {}, true};
  if (!filter_) {
    pending.visual = visual_->process(frame);
  }
  pending.estimate = estimated_ns_ == INT64_MIN || seconds(frame.t_ns - estimated_ns_) >= p_.least_interval_s;
  if (pending.estimate) estimated_ns_ = frame.t_ns;
  pending_ = pending;
}

std::optional<InertialMotion> InertialOdometry::finish(bool force) {
  if (!pending_) return std::nullopt;
  const Pending frame = *pending_;
  const Camera& camera = filter_ ? filter_->state().camera : camera_;
  const double reach_s = std::max(0.0, camera.time_offset_s) + (camera.middle_row + 1) * std::abs(camera.line_time_s);
  const bool reached =
      !imu_.empty() && imu_.newest_ns() >= frame.t_ns + kMargin_ns + static_cast<int64_t>(reach_s * 1e9);
  const bool inertial = !imu_.empty() && accel_ns_ != INT64_MIN && frame.t_ns - accel_ns_ < kAccelSilent_ns;
  if (!force && !reached && inertial) return std::nullopt;
  pending_.reset();
  const bool first = previous_ns_ == INT64_MIN;
  InertialMotion out;
  if (filter_) {
    out = estimate(frame);
  } else {
    const vo::Motion& visual = frame.visual;
    if (visual.scale_group != visual_group_) {
      visual_group_ = visual.scale_group;
      ++group_;
      T_visual_.setIdentity();
    }
    if (visual.rotation_valid)
      T_visual_ =
          T_visual_ * vo::isometry(visual.q_c0_c1, visual.translation_valid ? visual.p_c0_c1 : Vector3d::Zero());
    if (frame.estimate) {
      start_frames_.push_back({seen_, T_visual_, visual.translation_valid, group_});
      while (seconds(frame.t_ns - start_frames_.front().corners.t_ns) > kKeepFrames_s) start_frames_.pop_front();
      if (inertial) try_start(frame.t_ns);
    }
    if (filter_) {
      ++group_;
      out = report(frame.t_ns, filter_->state().nav, true);
    } else {
      out.motion = visual;
    }
  }
  out.motion.scale_group = group_;
  out.from_ns = previous_ns_;
  out.t_ns = previous_ns_ = frame.t_ns;
  if (first) return std::nullopt;
  return out;
}

void InertialOdometry::try_start(int64_t t_ns) {
  filter_ = start_still(start_frames_, imu_, camera_, p_.filter, p_.start);
  if (!filter_ && (tried_ns_ == INT64_MIN || seconds(t_ns - tried_ns_) >= p_.start_every_s)) {
    tried_ns_ = t_ns;
    filter_ = start_moving(start_frames_, imu_, camera_, camera_.q_b_c * visual_->gyro_bias_c(), p_.filter, p_.start);
  }
  if (!filter_) return;
  // Where the frame before was, by the filter.
  Navigation before = filter_->state().nav;
  const auto offset_ns = static_cast<int64_t>(std::llround(filter_->state().camera.time_offset_s * 1e9));
  integrate(before, filter_->state().t_ns, previous_ns_ + offset_ns, imu_, p_.filter.gravity_mps2);
  T_w_previous_ = camera_pose(before);
  told_.clear();
  moved_s_ = 0;
  refused_since_ns_ = blind_since_ns_ = INT64_MIN;
  tracked_ = accepted_ = static_cast<unsigned>(corners_.corners().corners.size());
}

InertialMotion InertialOdometry::estimate(const Pending& frame) {
  if (!frame.estimate) {
    Navigation nav = filter_->state().nav;
    const auto offset_ns = static_cast<int64_t>(std::llround(filter_->state().camera.time_offset_s * 1e9));
    integrate(nav, filter_->state().t_ns, frame.t_ns + offset_ns, imu_, p_.filter.gravity_mps2);
    return report(frame.t_ns, nav, false);
  }
  const int64_t before_ns = filter_->state().t_ns;
  const FrameReport seen = filter_->process(seen_, imu_);
  if (!seen.standing) moved_s_ += seconds(filter_->state().t_ns - before_ns);
  tracked_ = static_cast<unsigned>(corners_.followed());
  accepted_ = static_cast<unsigned>(seen.accepted);
  const bool refused = seen.tried >= kLeastTried && seen.accepted < p_.least_accepted * seen.tried;
  if (!refused) refused_since_ns_ = INT64_MIN;
  if (refused && refused_since_ns_ == INT64_MIN) refused_since_ns_ = frame.t_ns;
  const bool blind = !seen.standing && seen.accepted < p_.least_seen;
  if (!blind) blind_since_ns_ = INT64_MIN;
  if (blind && blind_since_ns_ == INT64_MIN) blind_since_ns_ = frame.t_ns;
  InertialMotion out = report(frame.t_ns, filter_->state().nav, true);
  const Navigation& nav = filter_->state().nav;
  const bool wrong = !nav.v_w.allFinite() || nav.v_w.norm() > p_.most_speed_mps ||
                     nav.accel_bias.norm() > p_.most_accel_bias_mps2 || filter_->camera_pull() > p_.most_camera_pull ||
                     (refused && seconds(frame.t_ns - refused_since_ns_) > p_.diverged_s) ||
                     (blind && seconds(frame.t_ns - blind_since_ns_) > p_.blind_s);
  if (wrong || filter_->velocity_sigma() > p_.lost_sigma_mps) {
    lose();
    out.metric = false;
    out.motion.translation_valid = false;
    out.motion.rotation_valid = out.motion.q_c0_c1.coeffs().allFinite();
    out.motion.state = Tracking::lost;
    out.motion.failure = corners_.mean_grey() < vo::kDarkGrey ? FailureReason::too_dark : FailureReason::few_features;
  }
  return out;
}

void InertialOdometry::change_lens(const CameraModel& told) {
  lens_told_ = told;
  visual_->change_lens(told);
}

CameraModel InertialOdometry::lens() const {
  CameraModel lens = lens_told_;
  if (!filter_) return lens;
  const CameraModel &refined = filter_->state().camera.lens, &calibrated = camera_.lens;
  const double by_x = lens.fx / calibrated.fx, by_y = lens.fy / calibrated.fy;
  lens.cx += (refined.cx - calibrated.cx) * by_x, lens.cy += (refined.cy - calibrated.cy) * by_y;
  lens.fx = refined.fx * by_x, lens.fy = refined.fy * by_y;
  if (lens.coefficients == calibrated.coefficients) lens.coefficients = refined.coefficients;
  return lens;
}

void InertialOdometry::lose() {
  filter_.reset();
  start_frames_.clear();
  const vo::Odometry::Parameters parameters{};
  visual_.emplace(parameters, lens_told_);
  visual_group_ = 0;
  T_visual_.setIdentity();
  ++group_;
}

InertialMotion InertialOdometry::report(int64_t t_ns, const Navigation& nav, bool with_clone) {
  InertialMotion out;
  const State& state = filter_->state();
  const Clone& clone = filter_->newest();
  const Isometry3d T = with_clone ? vo::isometry(clone.q_w_c, clone.p_w) : camera_pose(nav);
  const Isometry3d T_w_before = previous_pose();
  const Isometry3d step = T_w_before.inverse() * T;
  vo::Motion& m = out.motion;
  m.q_c0_c1 = Quaterniond(step.linear()).normalized();
  m.p_c0_c1 = step.translation();
  m.rotation_valid = m.translation_valid = true;
  m.tracked = tracked_, m.inliers = std::min(accepted_, tracked_);
  const double velocity_sigma = filter_->velocity_sigma();
  m.state = velocity_sigma > p_.degraded_sigma_mps ? Tracking::degraded : Tracking::tracking;
  m.failure = m.state == Tracking::tracking          ? FailureReason::none
              : corners_.mean_grey() < vo::kDarkGrey ? FailureReason::too_dark
                                                     : FailureReason::few_features;
  out.scale_sigma = std::min(1.0, std::hypot(p_.scale_sigma_factor * filter_->scale_sigma(), p_.scale_sigma_floor,
                                             p_.scale_sigma_stabilised * state.camera.follow));
  out.metric = true;
  const Eigen::Matrix3d R_c_w = T.linear().transpose();
  out.velocity_c = R_c_w * nav.v_w;
  out.gravity_c = R_c_w * Vector3d::UnitZ();
  out.gyro_bias_b = nav.gyro_bias, out.accel_bias_b = nav.accel_bias;
  const auto& clones = state.clones;
  // While the camera stands the frame before has lost its clone.
  if (with_clone && clones.size() > 1 && clones[clones.size() - 2].frame_ns == previous_ns_) {
    const size_t j = clones.size() - 1, i = j - 1;
    const Eigen::Matrix3d R = clones[i].q_w_c.conjugate().toRotationMatrix();
    constexpr int next = block::clone, both = 2 * block::clone;
    Eigen::Matrix<double, 6, both> J = Eigen::Matrix<double, 6, both>::Zero();
    J.block<3, 3>(0, 0) = -R, J.block<3, 3>(0, next) = R;
    J.block<3, 3>(3, 0) = R * vo::cross_matrix(clones[j].p_w), J.block<3, 3>(3, next) = -J.block<3, 3>(3, 0);
    J.block<3, 3>(3, 3) = -R, J.block<3, 3>(3, next + 3) = R;
    m.covariance = J * state.P.block<both, both>(state.clone_at(i), state.clone_at(i)) * J.transpose();
    m.covariance.diagonal().head<3>().array() += std::pow(p_.rotation_floor_rad, 2);
    m.covariance.diagonal().tail<3>().array() += std::pow(p_.position_floor_m, 2);
  } else {
    const double dt = seconds(t_ns - previous_ns_);
    // Its rotation is the gyroscope's, less a bias that the filter takes for better known than it is.
    const auto bias_variance = state.P.diagonal().segment<3>(block::gyro_bias).array();
    m.covariance.diagonal().head<3>() = bias_variance * std::pow(p_.standing_bias_factor * dt, 2);
    m.covariance.diagonal().tail<3>().setConstant(velocity_sigma * velocity_sigma * dt * dt);
  }
  T_w_previous_ = T;
  told_.clear();
  for (auto clone_before = clones.rbegin(); clone_before != clones.rend() && told_.size() < 2; ++clone_before)
    told_.push_back({clone_before->id, vo::isometry(clone_before->q_w_c, clone_before->p_w).inverse() * T});
  return out;
}

/// The frame before, as it is seen by now: the filter corrects where everything of the window is together, by what it
/// learns of the way so far; that is no motion, but for the first seconds of moving, whose metre and bias are still
/// being found: there the motion mends what was told. A clone may have been forgotten since, then the one before it
/// holds the frame.
Isometry3d InertialOdometry::previous_pose() const {
  const State& state = filter_->state();
  if (moved_s_ < p_.mended_s) return T_w_previous_;
  for (const Told& told : told_) {
    const size_t i = state.find_clone(told.clone);
    if (i < state.clones.size()) return vo::isometry(state.clones[i].q_w_c, state.clones[i].p_w) * told.T_clone_c;
  }
  return T_w_previous_;
}

}  // namespace odograph::vio
