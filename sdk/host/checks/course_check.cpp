// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/checks/course_check.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/host/base/saturating.hpp"
#include "sdk/math/scalar.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

using Eigen::Vector2d;

void CourseCheck::integrate(const odo_gnss& gnss, const FaultFound& found) {
  const bool has_velocity = (gnss.header.flags & ODO_GNSS_VELOCITY) != 0;
  const double dt_s = last_ ? seconds(saturating_difference(gnss.header.t_ns, last_->header.t_ns)) : 0;
  if (!has_velocity && !paths_.empty()) paths_.clear(), found(InputFault::gnss_velocity, false, 1, {});
  if (!has_velocity || !last_ || dt_s <= 0 || dt_s > p_.max_gap_s)
    moved_m_.reset();
  else if (moved_m_)
    *moved_m_ += 0.5 * dt_s * (Vector2d(gnss.velocity_n) + Vector2d(last_->velocity_n));
  last_ = has_velocity ? std::optional(gnss) : std::nullopt;
}

void CourseCheck::add(const odo_gnss& gnss, const FaultFound& found) {
  constexpr double kEarth_m = 6371000;
  integrate(gnss, found);
  const Vector2d path_m(
      kEarth_m * (gnss.latitude_rad - latitude_rad_),
      kEarth_m * std::cos(gnss.latitude_rad) * std::remainder(gnss.longitude_rad - longitude_rad_, 2 * kPi));
  const double sigma_m =
      gnss.header.flags & ODO_GNSS_COVARIANCE ? std::sqrt(std::max(gnss.covariance_n[0], gnss.covariance_n[4])) : 0.0;
  if (legs_ >= 0 && path_m.norm() < std::max(p_.min_leg_m, p_.sigmas * sigma_m)) return;
  latitude_rad_ = gnss.latitude_rad, longitude_rad_ = gnss.longitude_rad;
  if (legs_ < 2) ++legs_;
  if (legs_ >= 1 && moved_m_) {
    paths_.push({path_m.normalized(), *moved_m_ / path_m.norm()});
    compare_paths(found);
  }
  moved_m_ = Vector2d::Zero();
  compare_bends(std::atan2(path_m.y(), path_m.x()), found);
}

/// Of the velocities' paths with those by positions after an exchange of axes.
double CourseCheck::product(const SignedAxes& axes) const {
  double sum = 0;
  for (size_t i = 0; i < paths_.size(); ++i) {
    const Eigen::Vector3d path(paths_.back(i).positions.x(), paths_.back(i).positions.y(), 0);
    sum += paths_.back(i).velocities.dot(Vector2d(axes.of(path, 0), axes.of(path, 1)));
  }
  return sum;
}

/// Finds the factor or the exchange of axes by which the paths by positions become the velocities'.
void CourseCheck::compare_paths(const FaultFound& found) const {
  if (paths_.size() < paths_.capacity()) return;
  const auto legs = static_cast<double>(paths_.size());
  double off2 = 0, moved2 = 0;
  for (size_t i = 0; i < paths_.size(); ++i) {
    moved2 += paths_.back(i).velocities.squaredNorm();
    off2 += (paths_.back(i).velocities - paths_.back(i).positions).squaredNorm();
  }
  if (off2 < p_.differs * legs) return found(InputFault::gnss_velocity, false, 1, {});
  const auto left = [&](double product, double factor) {
    return moved2 - 2 * factor * product + factor * factor * legs;
  };
  const double right = product({}), unit = right / legs;
  double least =
      std::min(p_.explained * moved2, p_.better * left(right, std::clamp(unit, 1 / p_.other_unit, p_.other_unit)));
  double factor = 0;
  SignedAxes axes;
  const bool other_unit = unit > p_.other_unit || (unit < 1 / p_.other_unit && unit > p_.wandering);
  if (other_unit && left(right, unit) < least) least = p_.better * left(right, unit), factor = unit;
  for (const SignedAxes& each : all_signed_axes()) {
    if (each.from[2] != 2 || each.sign[2] < 0 || each.changes() == 0) continue;
    const double exchanged = product(each), k = exchanged / legs;
    if (k > p_.wandering && left(exchanged, k) < least) least = left(exchanged, k), factor = k, axes = each;
  }
  if (factor > 0) found(InputFault::gnss_velocity, true, factor, axes);
}

void CourseCheck::compare_bends(double course, const FaultFound& found) {
  const double mean = samples_ > 0 ? sum_rad_ / samples_ : turned_rad_;
  sum_rad_ = 0, samples_ = 0;
  if (legs_ >= 2) {
    const double bend = std::remainder(course - course_rad_, 2 * kPi), turn = mean - mean_turned_rad_;
    const auto tells = [&](double x) { return std::abs(x) > p_.bend_rad && std::abs(x) < p_.max_bend_rad; };
    const auto zero = [&](double x) { return std::abs(std::remainder(x, 2 * kPi)) < p_.same_rad; };
    const bool mirrored = zero(bend + turn), right = zero(bend - turn), tell = tells(bend) && tells(turn);
    opposed_ = !mirrored ? 0 : opposed_ + (tell && !right);
    if (opposed_ >= p_.opposed || (tell && right && !mirrored)) found(InputFault::gnss_mirrored, mirrored, turn, {});
  }
  course_rad_ = course, mean_turned_rad_ = mean;
}

}  // namespace odograph
