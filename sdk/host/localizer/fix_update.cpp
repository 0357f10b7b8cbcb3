// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/localizer/fix_update.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

constexpr double kUninformedVariance = 1e12;  // variance of a component that the fix lacks
constexpr int kYaw = 0;                       // row of a fix's innovation; position follows

bool has_yaw(const odo_fix& fix) { return (fix.header.flags & (ODO_FIX_YAW | ODO_FIX_ORIENTATION)) != 0; }

/// Heading of the fix minus that of the body.
double heading_residual(const odo_fix& fix, const Quaterniond& q_n_b) {
  if (fix.header.flags & ODO_FIX_ORIENTATION) {
    const Quaterniond off = quaternion(fix.q_n_b) * q_n_b.conjugate();
    return std::remainder(2 * std::atan2(off.z(), off.w()), 2 * EIGEN_PI);
  }
  const Vector3d axis_n = q_n_b * Vector3d(fix.yaw_axis_b);
  return std::remainder(fix.yaw_rad - std::atan2(axis_n.y(), axis_n.x()), 2 * EIGEN_PI);
}

double yaw_variance(const odo_fix& fix) {
  return (fix.header.flags & ODO_FIX_ORIENTATION) ? fix.orientation_cov_n[8] : squared(fix.yaw_sigma_rad);
}

void ignore_row(Innovation& seen, int row) {
  seen.residual[row] = 0;
  seen.noise.row(row).setZero(), seen.noise.col(row).setZero();
  seen.noise(row, row) = kUninformedVariance;
}

/// Eq. (10): heading and position of the body at the fix's time, from the current state and the track in between.
Innovation innovation_of(const Localizer& localizer, const odo_fix& fix, const FixUpdate::Context& at) {
  const Quaterniond q_n_o = localizer.q_n_o(), q_n_b = q_n_o * at.then.q_o_b;
  const Vector3d since_n = q_n_o * (at.now.p_o_b - at.then.p_o_b);
  const double since_s = seconds(at.now.t_ns - at.then.t_ns);
  const Quaterniond q = (fix.header.flags & ODO_FIX_ORIENTATION) ? quaternion(fix.q_n_b) : q_n_b;
  const Vector3d lever_n =
      (fix.header.flags & ODO_FIX_LEVER) ? Vector3d(q * Vector3d(fix.lever_b)) : Vector3d(Vector3d::Zero());
  Innovation seen(4);
  seen.residual[kYaw] = has_yaw(fix) ? heading_residual(fix, q_n_b) : 0.0;
  seen.residual.tail<3>() = Vector3d(fix.p_n) - (localizer.p_n() - since_n + lever_n);
  seen.H(kYaw, kHeading) = 1;
  seen.H(kYaw, kHeadingRate) = -since_s;
  seen.H.block<3, 3>(1, kNorth).setIdentity();
  seen.H.block<3, 1>(1, kHeading) = across(lever_n - since_n);
  seen.H.block<3, 1>(1, kLogScale) = -since_n;
  seen.noise(kYaw, kYaw) = has_yaw(fix) ? yaw_variance(fix) : kUninformedVariance;
  seen.noise.bottomRightCorner<3, 3>() =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(fix.covariance_n);
  for (int i = 0; i < 3; ++i)
    if ((fix.header.flags & (ODO_FIX_NORTH << i)) == 0) ignore_row(seen, 1 + i);
  seen.noise.diagonal().array() += 1e-12;
  seen.since.head<3>() = (at.now.drift_m2 - at.then.drift_m2).cwiseMax(0);
  seen.since[kHeading] = std::max(0.0, at.now.heading_drift_rad2 - at.then.heading_drift_rad2);
  return seen;
}

int degrees_of_freedom(const odo_fix& fix) {
  int dof = has_yaw(fix);
  for (const uint32_t axis : {ODO_FIX_NORTH, ODO_FIX_EAST, ODO_FIX_DOWN}) dof += (fix.header.flags & axis) != 0;
  return dof;
}

}  // namespace

void FixUpdate::reset(bool given, bool heading_given) {
  *this = FixUpdate(gate_sigma_);
  given_ = given, heading_known_ = heading_given || given;
  placed_ = given ? kAllAxes : 0;
  fixed_m_ = given ? 0 : -1;
}

/// The fix initialises the heading: it has one, and the track has none yet.
bool FixUpdate::is_first_heading(const odo_fix& fix, const Context& at) const {
  const bool unheaded = !heading_known_ && !at.north && fixed_ns_ == INT64_MIN;
  return unheaded && (fix.header.flags & kHorizontal) == kHorizontal && has_yaw(fix);
}

/// Fixes agreed with the track, and the front-end has been metric and inertial without a break since. Then the fix, not
/// the track, is the likely outlier.
bool FixUpdate::outweighs_fixes(int64_t t_ns, const Context& at) const {
  return accepted_ >= p_.min_accepted && at.has_priority && at.priority_since_ns <= fixed_ns_ &&
         seconds(t_ns - fixed_ns_) < p_.accepted_for_s;
}

/// The first position of an axis shifts the whole track to it and sets its covariance.
void FixUpdate::place(Localizer& localizer, Innovation& seen, uint32_t axes, double now_m) {
  Vector3d moved_n = Vector3d::Zero();
  Matrix3d covariance = Matrix3d::Zero();
  const auto first = [&](int axis) { return (axes & (ODO_FIX_NORTH << axis)) != 0; };
  for (int i = 0; i < 3; ++i) {
    if (!first(i)) continue;
    moved_n[i] = seen.residual[1 + i];
    for (int j = 0; j < 3; ++j)
      if (first(j)) covariance(i, j) = seen.noise(1 + i, 1 + j);
  }
  localizer.shift(moved_n, covariance, fixed_m_, now_m);
  for (int i = 0; i < 3; ++i)
    if (first(i)) ignore_row(seen, 1 + i);
}

/// A heading that is off by more than a small angle is corrected first, so that the position innovation is computed
/// with the corrected heading. If the fix is rejected, the caller restores the state.
UpdateResult FixUpdate::rotate(Localizer& localizer, const odo_fix& fix, const Context& at) {
  Innovation heading = innovation_of(localizer, fix, at);
  for (int row = 1; row < 4; ++row) ignore_row(heading, row);
  const StateSet considered = at.path_is_given ? only({kLogScale, kLogFactor, kStepHeading}) : StateSet{};
  const UpdateResult turned = localizer.update(heading, squared(gate_sigma_), considered);
  return turned;
}

void FixUpdate::accept(const odo_fix& fix, double now_m) {
  rejected_ = 0;
  ++accepted_;
  placed_ |= fix.header.flags & kAllAxes;
  if (fix.header.flags & kHorizontal) fixed_ns_ = fix.header.t_ns, fixed_m_ = now_m;
}

UpdateResult FixUpdate::use(Localizer& localizer, const odo_fix& fix, const Context& at) {
  const uint32_t axes = fix.header.flags & kAllAxes;
  const bool risky = (fix.header.flags & ODO_FIX_INTEGRITY) && fix.integrity > p_.max_integrity_risk;
  if (risky || (axes == 0 && !has_yaw(fix))) return {};
  const double now_m = at.now.path_m;
  if (rejected_ >= p_.max_rejected && !outweighs_fixes(fix.header.t_ns, at)) {
    placed_ &= ~axes;
    accepted_ = 0;
  }
  const FixUpdate policy = *this;
  std::optional<Localizer> before;  // restored if a later part of the update is rejected
  bool heading_used = false;
  if (is_first_heading(fix, at)) {
    before = localizer;
    localizer.rotate(innovation_of(localizer, fix, at).residual[kYaw], at.start_n);
    localizer.inflate_heading(std::sqrt(yaw_variance(fix)));
    heading_used = heading_known_ = true;
  }
  // Without a compass, fixes may correct the starting heading: the path determines it.
  if (((axes & kHorizontal) || has_yaw(fix)) && !heading_known_ && !at.north) {
    heading_known_ = true;
    before = localizer;
    localizer.inflate_heading(p_.start_heading_rad);
  }
  Innovation seen = innovation_of(localizer, fix, at);
  const bool on_arc =
      has_yaw(fix) && (at.path_is_given || std::abs(seen.residual[kYaw]) > p_.arc_rad || (axes & ~placed_));
  const int dof = degrees_of_freedom(fix);
  if (!before && (on_arc || (axes & ~placed_))) before = localizer;
  const auto reject = [&](double nis) {
    if (before) localizer = *before;
    *this = policy;
    ++rejected_;
    return UpdateResult{false, nis, dof};
  };
  if (on_arc && !heading_used) {
    const UpdateResult turned = rotate(localizer, fix, at);
    if (!turned.accepted) return reject(turned.nis);
    heading_used = true;
    seen = innovation_of(localizer, fix, at);
  }
  if (heading_used) ignore_row(seen, kYaw);
  if (axes & ~placed_) place(localizer, seen, axes & ~placed_, now_m);
  const StateSet considered = at.path_is_given ? all_but({kNorth, kEast, kDown}) : StateSet{};
  UpdateResult result = localizer.update(seen, squared(gate_sigma_), considered);
  if (!result.accepted) return reject(result.nis);
  accept(fix, now_m);
  result.dof = dof;
  return result;
}

}  // namespace odograph
