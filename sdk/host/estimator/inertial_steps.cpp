// SPDX-License-Identifier: Apache-2.0
//
// Steps over their whole interval, and fixes of any subset at their own time.
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
using RowMatrix3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

namespace {

constexpr double kNothing = 1e12;  // variance of what a fix does not have

double squared(double x) { return x * x; }
bool is_loose(const odo_step& step) {
  return step.mode == ODO_MODE_WALKING_SWINGING || step.mode == ODO_MODE_WALKING_POCKET;
}

/// Heading of a fix minus the body's.
double heading_residual(const odo_fix& fix, const Eigen::Quaterniond& q_n_b) {
  if (fix.header.flags & ODO_FIX_ORIENTATION) {
    const Eigen::Quaterniond off = quaternion(fix.q_n_b) * q_n_b.conjugate();
    return std::remainder(2 * std::atan2(off.z(), off.w()), 2 * EIGEN_PI);
  }
  const Vector3d axis_n = q_n_b * Vector3d(fix.yaw_axis_b);
  return std::remainder(fix.yaw_rad - std::atan2(axis_n.y(), axis_n.x()), 2 * EIGEN_PI);
}

/// Rotation first, position below; what the fix does not have is noise without end.
struct FixInnovation {
  Innovation<6> seen;
  Eigen::Matrix<double, 6, 3> by_theta = Eigen::Matrix<double, 6, 3>::Zero(), by_position = by_theta;
  int dof = 0;

  /// `lever_n`: from the body to what the fix speaks of.
  FixInnovation(const odo_fix& fix, const PastPose& at, const Vector3d& lever_n) { set(fix, at, lever_n); }
  /// The same for a track that was moved since.
  void set(const odo_fix& fix, const PastPose& at, const Vector3d& lever_n) {
    dof = 0;
    seen.noise = Eigen::Matrix<double, 6, 6>::Identity() * kNothing;
    if (fix.header.flags & ODO_FIX_ORIENTATION)
      add_rotation(fix, at);
    else if (fix.header.flags & ODO_FIX_YAW)
      add_yaw(fix, at);
    add_position(fix, at, lever_n);
  }

  /// The heading was taken from the fix: it says nothing more of it.
  void forget_heading() {
    seen.residual[2] = 0;
    seen.noise.row(2).setZero(), seen.noise.col(2).setZero();
    seen.noise(2, 2) = kNothing;
  }

 private:
  void add_rotation(const odo_fix& fix, const PastPose& at) {
    seen.residual.head<3>() = log_rotation(quaternion(fix.q_n_b) * at.q_n_b.conjugate());
    by_theta.topRows<3>().setIdentity();
    seen.noise.topLeftCorner<3, 3>() = Eigen::Map<const RowMatrix3d>(fix.orientation_cov_n);
    dof += 3;
  }
  void add_yaw(const odo_fix& fix, const PastPose& at) {
    const Vector3d axis_n = at.q_n_b * Vector3d(fix.yaw_axis_b);
    const double across = std::max(1e-6, axis_n.head<2>().squaredNorm());
    seen.residual[2] = heading_residual(fix, at.q_n_b);
    by_theta.row(2) << -axis_n.x() * axis_n.z() / across, -axis_n.y() * axis_n.z() / across, 1;
    seen.noise(2, 2) = squared(fix.yaw_sigma_rad);
    dof += 1;
  }
  void add_position(const odo_fix& fix, const PastPose& at, const Vector3d& lever_n) {
    const Matrix3d R = Eigen::Map<const RowMatrix3d>(fix.covariance_n);
    const auto has = [&](int axis) { return (fix.header.flags & (ODO_FIX_NORTH << axis)) != 0; };
    for (int i = 0; i < 3; ++i) {
      if (!has(i)) continue;
      seen.residual[3 + i] = fix.p_n[i] - at.p_n[i] - lever_n[i];
      by_theta.row(3 + i) = -skew(lever_n).row(i);
      by_position(3 + i, i) = 1;
      for (int j = 0; j < 3; ++j)
        if (has(j)) seen.noise(3 + i, 3 + j) = R(i, j);
      ++dof;
    }
  }
};

}  // namespace

UpdateResult InertialEstimator::apply(const odo_step* step) {
  if (!started_ || step->length_m <= 0) return {};
  flush();
  const double stated = step->sigma_m / step->length_m,
               own = std::min(p_.step_own_sigma, std::max(stated, p_.step_min_sigma));
  if (!std::exchange(stepped_, true))
    e_.set_independent(kLogFactor, std::max(squared(p_.factor_sigma), squared(stated) - squared(own)));
  // A walker changes, and so does what plugins learn, but not without bound; where steps alone tell the metre, nobody
  // would see it.
  if (!metre_check_.doubted()) {
    const double decay = std::exp(-1 / p_.factor_steps);
    e_.wander(kLogFactor, decay, (1 - decay * decay) * squared(p_.factor_sigma));
    e_.x.log_factor *= decay;
  }
  e_.add_variance(kStepHeading, 1, squared(p_.step_heading_walk));
  const bool loose = is_loose(*step);
  if (std::exchange(step_loose_, loose) != loose)  // the phone is held otherwise
    e_.add_variance(kStepHeading, 1, squared(p_.step_loose_across_rad));
  if (unaided() && step_ns_ != INT64_MIN && step->t_start_ns > step_ns_) rest_between(step_ns_, step->t_start_ns);
  step_ns_ = step->t_end_ns;
  if (!vo_.known && vo_.any && scale_start_.add_step(step->t_start_ns, step->t_end_ns, step->length_m))
    try_scale_start(vo_.t_ns);

  const UpdateResult result = see_step(*step, own);
  if (result.accepted) {
    steps_rejected_ = 0;
    // A front-end that moves, but not in metres yet, will put what was walked in place; until then nothing is shown.
    metric_ = metric_ || vo_.known || unaided();
    informed_ns_ = t_ns_;
  } else if (result.dof > 0 && ++steps_rejected_ >= p_.max_steps_rejected) {
    doubt_steps();
  }
  if (!camera_) publish(step->t_end_ns, ODO_TRACKING, ODO_REASON_NONE);  // none there, or none yet
  return result;
}

/// A step's displacement between the poses at its start and end. Own error relative to its length.
UpdateResult InertialEstimator::see_step(const odo_step& step, double own_sigma) {
  const int64_t oldest_ns = e_.clone_back(e_.clone_count() - 1).t_ns;
  const int64_t from_ns = std::max(step.t_start_ns, oldest_ns);
  const auto from = past(from_ns), to = past(step.t_end_ns);
  // Of a step told later than the clones reach back: the share that they cover.
  const double covered =
      from && to ? static_cast<double>(step.t_end_ns - from_ns) / static_cast<double>(step.t_end_ns - step.t_start_ns)
                 : 0.0;
  const bool heading = (step.header.flags & ODO_STEP_HEADING) != 0, stairs = step.mode == ODO_MODE_STAIRS;
  if (covered < 1 && !(unaided() && heading)) return {};

  const Vector3d moved = covered > 0 ? Vector3d(to->p_n - from->p_n) : Vector3d(Vector3d::Zero());
  if (covered == 1) check_metre(step, moved);
  const bool from_north = north_ && unaided();  // the steps' heading errs with the compass, and is mended with it
  const double source_rad = from_north ? e_.x.north_rad : 0.0;
  const double direction =
      heading ? step.heading_rad + start_.heading_rad + turned_rad_ + e_.x.step_heading_rad - source_rad
              : std::atan2(moved.y(), moved.x());
  const Vector3d along(std::cos(direction), std::sin(direction), 0), across(-along.y(), along.x(), 0);
  const double length_m = std::exp(e_.x.log_factor) * step.length_m;
  // Derivatives at the usual length: this step's own error in them would favour short steps.
  if (step_mean_m_ == 0) step_mean_m_ = step.length_m;
  const double usual_m = std::exp(e_.x.log_factor) * step_mean_m_;
  step_mean_m_ += p_.step_usual_gain * (step.length_m - step_mean_m_);
  const Vector3d by_factor = (stairs ? 0.0 : usual_m) * along, by_heading = (heading ? usual_m : 0.0) * across;
  const double sway = !heading                       ? EIGEN_PI
                      : is_loose(step) && !unaided() ? p_.step_loose_across_rad
                                                     : p_.step_across_rad;
  Matrix3d noise = squared(own_sigma * length_m) * along * along.transpose() +
                   squared(sway * length_m) * across * across.transpose();
  // Alone, a step says nothing of the height: that goes on with time, as fast as people climb.
  noise(2, 2) = unaided() ? 0.0 : squared(stairs ? p_.stair_height_sigma_m : p_.step_height_sigma_m);

  if (const double rest = 1 - covered; rest > 0) {
    e_.shift_by_step(rest * length_m * along, rest * by_factor, rest * by_heading, rest * rest * noise);
    if (covered <= 0) return {true, 0.0, 0};
  }
  if (unaided()) e_.loosen_velocity_since(from_ns, t_ns_, p_.step_velocity_sigma_mps);
  Innovation<3> walked;
  walked.residual = covered * length_m * along - moved;
  walked.by_pose(*to, Matrix3d::Zero(), Matrix3d::Identity());
  walked.by_pose(*from, Matrix3d::Zero(), -Matrix3d::Identity());
  walked.by_one(kLogFactor, -covered * by_factor);
  walked.by_one(kStepHeading, -covered * by_heading);
  if (from_north) walked.by_one(kNorth, covered * by_heading);
  walked.noise = covered * covered * noise;
  if (unaided())
    walked.noise(2, 2) = kNothing;
  else
    walked.noise += (p_.step_correlation - 1) * squared(own_sigma * length_m) * along * along.transpose();
  const double before = 1 / e_.P(kLogScale, kLogScale);
  const UpdateResult result = e_.update(walked, p_.gate[unaided() ? 2 : 3], hold_at_step());
  if (result.accepted && vo_.known) vo_.steps_information += 1 / e_.P(kLogScale, kLogScale) - before;
  return result;
}

/// Where nothing else moves the body, what it was expected to do is no news of the walker: fixes are. Where odometry
/// moves it, steps and scale learn from each other, and what was walked stays unless the scale of an odometry without
/// a metre has come into doubt; a front-end that says it knows the metre better than walkers differ learns nothing.
Hold InertialEstimator::hold_at_step() const {
  const bool followed = vo_.known && vo_.attached;
  const bool taught = followed && vo_.metric && vo_.own_information > 1 / squared(p_.taught_scale_sigma);
  const bool doubted = !vo_.metric && e_.P(kLogScale, kLogScale) > squared(2 * p_.start_scale_sigma);
  return unaided()              ? Hold::scale_and_steps
         : taught               ? Hold::all_but_steps
         : followed && !doubted ? Hold::all_but_scale_and_steps
                                : Hold::nothing;
}

/// Against the lengths as the step estimator tells them: what was learnt of the walker was learnt from the front-end.
void InertialEstimator::check_metre(const odo_step& step, const Vector3d& moved_n) {
  if (!vo_.known || !vo_.attached || step.mode == ODO_MODE_STAIRS) return;
  if (!vo_.metric && !metre_check_.doubted()) return;  // has none
  if (!metre_check_.add(step.length_m, std::exp(-e_.x.log_scale) * moved_n.head<2>().norm())) return;
  if (metre_check_.doubted()) {  // what the steps were taught since it went wrong is forgotten
    e_.x.log_factor = metre_check_.log_factor();
    e_.set_independent(kLogFactor, metre_check_.variance());
  }
  notice_ = {"odometry_metre", metre_check_.doubted()
                                   ? "the odometry's metre contradicts the steps of the walker by two "
                                     "fifths and more: its motions count up to scale"
                                   : "the odometry's metre agrees with the steps again"};
}

/// Where nothing but steps moves the body it rests between them.
void InertialEstimator::rest_between(int64_t from_ns, int64_t to_ns) {
  from_ns = std::max(from_ns, e_.clone_back(e_.clone_count() - 1).t_ns);
  const auto from = past(from_ns), to = past(to_ns);
  if (!from || !to || to_ns <= from_ns) return;
  e_.loosen_velocity_since(from_ns, t_ns_, p_.step_velocity_sigma_mps);
  Innovation<2> rested;
  const Eigen::Matrix<double, 2, 3> horizontal = Matrix3d::Identity().topRows<2>();
  rested.residual = (from->p_n - to->p_n).head<2>();
  rested.by_pose(*to, Eigen::Matrix<double, 2, 3>::Zero(), horizontal);
  rested.by_pose(*from, Eigen::Matrix<double, 2, 3>::Zero(), -horizontal);
  const double gap_s = static_cast<double>(to_ns - from_ns) * kNanoseconds;
  rested.noise = Eigen::Matrix2d::Identity() * squared(p_.rest_speed_mps * gap_s);
  e_.update(rested, 0, Hold::scale_and_steps);
}

/// Steps in a row that contradict what is known: the phone is held otherwise, the walker goes otherwise, or the unit of
/// an odometry without a metre of its own has changed unsaid.
void InertialEstimator::doubt_steps() {
  steps_rejected_ = 0;
  e_.add_variance(kStepHeading, 1, squared(p_.step_heading_sigma_rad));
  if (!metre_check_.doubted()) e_.add_variance(kLogFactor, 1, squared(p_.factor_sigma));
  if (vo_.known && !vo_.metric) e_.add_variance(kLogScale, 1, squared(p_.doubted_scale_sigma));
  if (unaided()) e_.add_variance(kVelocity, 3, squared(p_.jump_velocity_sigma_mps));
}

/// The first position of an axis moves the whole track there, and says how well that is known; nothing was known
/// before, and nothing is said of the other axes.
void InertialEstimator::place_by(Innovation<6>& seen, uint32_t axes) {
  Vector3d moved = Vector3d::Zero();
  Matrix3d covariance = Matrix3d::Zero();
  const auto first = [&](int axis) { return (axes & (ODO_FIX_NORTH << axis)) != 0; };
  for (int i = 0; i < 3; ++i) {
    if (!first(i)) continue;
    moved[i] = std::exchange(seen.residual[3 + i], 0.0);
    for (int j = 0; j < 3; ++j)
      if (first(j)) covariance(i, j) = seen.noise(3 + i, 3 + j);
  }
  for (int i = 0; i < 3; ++i) {
    if (!first(i)) continue;
    seen.noise.row(3 + i).setZero();
    seen.noise.col(3 + i).setZero();
    seen.noise(3 + i, 3 + i) = kNothing;
  }
  e_.shift(moved);
  e_.loosen_position(covariance);
  e_.shift_held(moved, covariance, fixed_distance_m_, distance_m_);
}

/// Until now nobody knew which way n's axes point in the world: what the track and its sources tell in n is turned.
void InertialEstimator::rotate_n(double by_rad) {
  turned_rad_ += by_rad;
  rotate_track(Quaterniond(Eigen::AngleAxisd(by_rad, Vector3d::UnitZ())), Vector3d(start_.position_m.data()));
}

/// A fix places a track of which nobody has told the heading, and tells one.
bool InertialEstimator::tells_first_heading(const odo_fix& fix) const {
  const uint32_t flags = fix.header.flags;
  const bool unheaded = !start_.given && !start_.heading_given && !north_ && fixed_ns_ == INT64_MIN;
  return unheaded && (flags & kHorizontal) == kHorizontal && (flags & (ODO_FIX_ORIENTATION | ODO_FIX_YAW)) != 0;
}

/// A fix says that the heading is off by more than a small angle: the track is turned first, so that the position is
/// compared with where the rotation takes it. How well both fit, as a normalised innovation squared; nothing is changed
/// where that is beyond the gate.
double InertialEstimator::update_heading(const Innovation<6>& seen, const PastPose& at, uint32_t axes) {
  const Eigen::Matrix<double, 6, 6> P = e_.covariance(at);
  const double by_rad = seen.residual[2], S = P(2, 2) + seen.noise(2, 2);
  const Vector3d by_heading = P.block<3, 1>(3, 2) / S;
  const Vector3d theta_n(0, 0, P(2, 2) / S * by_rad);
  const Vector3d left = seen.residual.tail<3>() - left_jacobian(theta_n) * (by_heading * by_rad);
  Matrix3d doubt =
      P.bottomRightCorner<3, 3>() - S * by_heading * by_heading.transpose() + seen.noise.bottomRightCorner<3, 3>();
  for (int i = 0; i < 3; ++i)
    if (!(axes & (ODO_FIX_NORTH << i))) doubt(i, i) = kNothing;
  const double nis = by_rad * by_rad / S + left.dot(doubt.ldlt().solve(left));
  if (!(nis < squared(config_.fix_gate_sigma))) return nis;
  Innovation<1> heading;
  heading.residual[0] = by_rad;
  heading.by_pose(at, Eigen::RowVector3d::UnitZ(), Eigen::RowVector3d::Zero());
  heading.noise(0, 0) = seen.noise(2, 2);
  e_.update_heading(heading, 0);
  const Quaterniond turned(Eigen::AngleAxisd(theta_n.z(), Vector3d::UnitZ()));
  track_.rotate(turned);
  vo_.y_n = (turned * vo_.y_n).eval();
  vo_.start_n = at.p_n + turned * (vo_.start_n - at.p_n);
  window_.restart();
  scale_start_.restart();
  return nis;
}

/// Fixes agreed with the track, and a front-end has led without a break since: it is not the track that is off.
bool InertialEstimator::outweighs_fixes(int64_t t_ns) const {
  return fixes_agreed_ >= p_.agreed_fixes && led() && led_since_ns_ <= fixed_ns_ &&
         static_cast<double>(t_ns - fixed_ns_) * kNanoseconds < p_.agreed_for_s;
}

/// Against fixes the heading of a start without a compass is open, and is told by the path; that needs a velocity.
void InertialEstimator::open_heading() {
  if (north_ || heading_open_) return;
  if (!(e_.P.diagonal().segment<2>(kVelocity).maxCoeff() < squared(p_.settled_velocity_mps))) return;
  heading_open_ = true;
  e_.loosen_heading(p_.start_heading_sigma_rad);
}

UpdateResult InertialEstimator::apply(const odo_fix* fix) {
  const uint32_t flags = fix->header.flags;
  flush();
  auto at = past(fix->header.t_ns);
  if (!at && started_) notice_ = {"late_fix", "a fix is of a time that the clones no longer reach back to: not used"};
  const bool risky = (fix->header.flags & ODO_FIX_INTEGRITY) && fix->integrity > p_.max_integrity_risk;
  if (!at || risky) return {};
  const bool rotates = tells_first_heading(*fix);
  if (rotates) {
    rotate_n(heading_residual(*fix, at->q_n_b));
    at = past(fix->header.t_ns);
    if (!at) return {};
  }
  const Vector3d lever_n = camera_ ? Vector3d(at->q_n_b * p_b_c_) : Vector3d::Zero();
  if ((flags & (kAllAxes | ODO_FIX_ORIENTATION | ODO_FIX_YAW)) == 0) return {};
  const bool horizontal = (flags & kHorizontal) != 0;
  FixInnovation innovation(*fix, *at, lever_n);
  if (rotates) {  // the heading is the fix's now, and as uncertain
    e_.loosen_heading(std::sqrt(innovation.seen.noise(2, 2)));
    heading_open_ = true;
    innovation.forget_heading();
  }
  Innovation<6>& seen = innovation.seen;
  for (int i = 0; i < 6; ++i) seen.noise(i, i) += 1e-12;
  const uint32_t axes = flags & kAllAxes;
  if (fixes_rejected_ >= p_.max_fixes_rejected && !outweighs_fixes(fix->header.t_ns)) {
    placed_ &= ~axes;
    fixes_agreed_ = 0;
  }
  if (horizontal) open_heading();
  // The heading first where it is off by much, or would move a place that is told at last.
  const bool on_arc = std::abs(seen.residual[2]) > p_.arc_rad || (axes & ~placed_);
  if ((flags & ODO_FIX_ORIENTATION) && !rotates && on_arc) {
    if (const double nis = update_heading(seen, *at, axes & placed_); !(nis < squared(config_.fix_gate_sigma))) {
      ++fixes_rejected_;
      return {false, nis, innovation.dof};
    }
    at = past(fix->header.t_ns);
    innovation.set(*fix, *at, camera_ ? Vector3d(at->q_n_b * p_b_c_) : Vector3d::Zero());
    innovation.forget_heading();
    for (int i = 0; i < 6; ++i) seen.noise(i, i) += 1e-12;
  }
  if (axes & ~placed_) place_by(seen, axes & ~placed_);
  seen.by_pose(*at, innovation.by_theta, innovation.by_position);
  UpdateResult result = e_.update(seen, squared(config_.fix_gate_sigma));
  result.dof = innovation.dof;
  if (result.accepted)
    agree(*fix);
  else
    ++fixes_rejected_;
  return result;
}

void InertialEstimator::agree(const odo_fix& fix) {
  fixes_rejected_ = 0;
  ++fixes_agreed_;
  placed_ |= fix.header.flags & kAllAxes;
  if (fix.header.flags & kHorizontal) metric_ = true, fixed_ns_ = fix.header.t_ns, fixed_distance_m_ = distance_m_;
  informed_ns_ = t_ns_;
}

}  // namespace odograph
