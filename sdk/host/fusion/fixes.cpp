// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/fusion/fixes.hpp"

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
Innovation innovation_of(const PoseFilter& filter, const odo_fix& fix, const Fixes::Context& at) {
  const Quaterniond q_n_o = filter.q_n_o(), q_n_b = q_n_o * at.then.q_o_b;
  const Vector3d since_n = q_n_o * (at.now.p_o_b - at.then.p_o_b);
  const double since_s = seconds(at.now.t_ns - at.then.t_ns);
  const Quaterniond q = (fix.header.flags & ODO_FIX_ORIENTATION) ? quaternion(fix.q_n_b) : q_n_b;
  const Vector3d lever_n =
      (fix.header.flags & ODO_FIX_LEVER) ? Vector3d(q * Vector3d(fix.lever_b)) : Vector3d(Vector3d::Zero());
  Innovation seen(4);
  seen.residual[kYaw] = has_yaw(fix) ? heading_residual(fix, q_n_b) : 0.0;
  seen.residual.tail<3>() = Vector3d(fix.p_n) - (filter.p_n() - since_n + lever_n);
  seen.H(kYaw, kHeading) = 1;
  seen.H(kYaw, kHeadingRate) = -since_s;
  seen.H.block<3, 3>(1, kNorth).setIdentity();
  seen.H.block<3, 1>(1, kHeading) = across(lever_n - since_n);
  seen.H.block<3, 1>(1, kLogScale) = -since_n;
  seen.noise(kYaw, kYaw) = has_yaw(fix) ? yaw_variance(fix) : kUninformedVariance;
  seen.noise.bottomRightCorner<3, 3>() =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(fix.covariance_n);
  seen.noise.diagonal().segment<2>(1).array() += squared(at.then_sigma_m);
  for (int i = 0; i < 3; ++i)
    if ((fix.header.flags & (ODO_FIX_NORTH << i)) == 0) ignore_row(seen, 1 + i);
  seen.noise.diagonal().array() += 1e-12;
  seen.drift_then = drift_of(at.then), seen.drift_now = drift_of(at.now);
  return seen;
}

int degrees_of_freedom(const odo_fix& fix) {
  int dof = has_yaw(fix);
  for (const uint32_t axis : {ODO_FIX_NORTH, ODO_FIX_EAST, ODO_FIX_DOWN}) dof += (fix.header.flags & axis) != 0;
  return dof;
}

}  // namespace

/// The fix initialises the heading: it has one, and the track has none yet.
bool Fixes::is_first_heading(const odo_fix& fix, const Context& at) const {
  const bool unheaded = !heading_known_ && !at.north && !fixed_;
  return unheaded && (fix.header.flags & kHorizontal) == kHorizontal && has_yaw(fix);
}

/// Fixes agreed with the track, and the front-end has been metric and inertial without a break since. Then the fix, not
/// the track, is the likely outlier.
bool Fixes::outweighs_fixes(int64_t t_ns, const Context& at) const {
  return accepted_ >= p_.min_accepted && at.has_priority && fixed_ && at.priority_since <= fixed_ &&
         seconds(t_ns - *fixed_) < p_.accepted_for_s;
}

/// The first position of an axis moves the whole track to it; so does one after many rejections.
void Fixes::place(PoseFilter& filter, Innovation& seen, uint32_t axes, const Context& at) {
  for (const uint32_t part : {axes & ~ever_placed_, axes & ever_placed_}) {
    if (part == 0) continue;
    PoseFilter::Position position{Vector3d::Zero(), Vector3d::Zero(), seen.noise.bottomRightCorner<3, 3>(), {}};
    if (part & ever_placed_) position.fixed_m = at.now.path_m;
    for (int i = 0; i < 3; ++i) {
      if ((part & (ODO_FIX_NORTH << i)) == 0) continue;
      position.axes[i] = 1;
      if (position.fixed_m) position.fixed_m = std::min(*position.fixed_m, fixed_m_[i]);
    }
    position.by_n = position.axes.cwiseProduct(seen.residual.tail<3>());
    moved_down_m_ += position.by_n.z();
    filter.place(position, at.then, at.now);
    for (int i = 0; i < 3; ++i)
      if (position.axes[i] > 0) ignore_row(seen, 1 + i);
  }
}

/// A heading that is off by more than a small angle is corrected first, so that the position innovation is computed
/// with the corrected heading.
UpdateResult Fixes::rotate(PoseFilter& filter, const odo_fix& fix, const Context& at) {
  Innovation heading = innovation_of(filter, fix, at);
  for (int row = 1; row < 4; ++row) ignore_row(heading, row);
  return filter.update(heading, squared(gate_sigma_), at.kept_by_heading);
}

void Fixes::accept(const odo_fix& fix, double now_m) {
  rejected_ = 0;
  ++accepted_;
  any_ = true;
  placed_ |= fix.header.flags & kAllAxes;
  ever_placed_ |= placed_;
  for (int i = 0; i < 3; ++i)
    if (fix.header.flags & (ODO_FIX_NORTH << i)) fixed_m_[i] = now_m;
  if (fix.header.flags & kHorizontal) fixed_ = fix.header.t_ns;
}

UpdateResult Fixes::use(PoseFilter& filter, const odo_fix& fix, const Context& at) {
  const uint32_t axes = fix.header.flags & kAllAxes;
  const bool risky = (fix.header.flags & ODO_FIX_INTEGRITY) && fix.integrity > p_.max_integrity_risk;
  if (risky || (axes == 0 && !has_yaw(fix))) return {};
  if (rejected_ >= p_.max_rejected && !outweighs_fixes(fix.header.t_ns, at)) {
    placed_ &= ~axes;
    accepted_ = 0;
  }
  // It has several parts, each of which may be rejected: tried first, so that it is used as a whole or not at all.
  const Fixes before = *this;
  PoseFilter trial = filter.without_kept_poses();
  UpdateResult result = try_on(trial, fix, at);
  *this = before;
  if (result.accepted)
    try_on(filter, fix, at), accept(fix, at.now.path_m);
  else
    ++rejected_;
  result.dof = degrees_of_freedom(fix);
  return result;
}

UpdateResult Fixes::try_on(PoseFilter& filter, const odo_fix& fix, const Context& at) {
  const uint32_t axes = fix.header.flags & kAllAxes;
  bool heading_used = false;
  if (is_first_heading(fix, at)) {
    filter.rotate(innovation_of(filter, fix, at).residual[kYaw], at.start_n);
    filter.inflate_heading(std::sqrt(yaw_variance(fix)));
    heading_used = heading_known_ = true;
  }
  // Without a compass, fixes may correct the starting heading: the path determines it.
  if (((axes & kHorizontal) || has_yaw(fix)) && !heading_known_ && !at.north) {
    heading_known_ = true;
    filter.inflate_heading(p_.start_heading_rad);
  }
  Innovation seen = innovation_of(filter, fix, at);
  const bool on_arc = has_yaw(fix) && (at.kept_by_position[kHeading] || std::abs(seen.residual[kYaw]) > p_.arc_rad ||
                                       (axes & ~placed_));
  if (on_arc && !heading_used) {
    const UpdateResult turned = rotate(filter, fix, at);
    if (!turned.accepted) return turned;
    heading_used = true;
    seen = innovation_of(filter, fix, at);
  }
  if (heading_used) ignore_row(seen, kYaw);
  if (axes & ~placed_) place(filter, seen, axes & ~placed_, at);
  return filter.update(seen, squared(gate_sigma_), at.kept_by_position);
}

}  // namespace odograph
