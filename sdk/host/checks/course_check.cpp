// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/checks/course_check.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/host/base/saturating.hpp"
#include "sdk/math/scalar.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

using Eigen::Vector2d;

void CourseCheck::integrate(const odo_gnss& gnss) {
  const bool has_velocity = (gnss.header.flags & ODO_GNSS_VELOCITY) != 0;
  const double dt_s = last_ ? seconds(saturating_difference(gnss.header.t_ns, last_->header.t_ns)) : 0;
  if (!has_velocity || !last_ || dt_s <= 0 || dt_s > p_.max_gap_s)
    moved_m_.reset();
  else if (moved_m_)
    *moved_m_ += 0.5 * dt_s * (Vector2d(gnss.velocity_n) + Vector2d(last_->velocity_n));
  last_ = has_velocity ? std::optional(gnss) : std::nullopt;
}

void CourseCheck::add(const odo_gnss& gnss, const FaultFound& found) {
  constexpr double kEarth_m = 6371000;
  integrate(gnss);
  const Vector2d path_m(
      kEarth_m * (gnss.latitude_rad - latitude_rad_),
      kEarth_m * std::cos(gnss.latitude_rad) * std::remainder(gnss.longitude_rad - longitude_rad_, 2 * kPi));
  const double sigma_m =
      gnss.header.flags & ODO_GNSS_COVARIANCE ? std::sqrt(std::max(gnss.covariance_n[0], gnss.covariance_n[4])) : 0.0;
  if (legs_ >= 0 && path_m.norm() < std::max(p_.min_leg_m, p_.sigmas * sigma_m)) return;
  latitude_rad_ = gnss.latitude_rad, longitude_rad_ = gnss.longitude_rad;
  if (legs_ < 2) ++legs_;
  if (legs_ >= 1 && moved_m_) paths_.push({path_m, *moved_m_}), compare_paths(found);
  moved_m_ = Vector2d::Zero();
  compare_bends(std::atan2(path_m.y(), path_m.x()), found);
}

/// Finds the factor and the exchange of axes by which the positions' way becomes the velocities'.
void CourseCheck::compare_paths(const FaultFound& found) const {
  if (paths_.size() < 8) return;
  double path2 = 0, off2 = 0, moved2 = 0;
  for (size_t i = 0; i < paths_.size(); ++i) {
    const auto& [path, moved] = paths_.back(i);
    path2 += path.squaredNorm(), moved2 += moved.squaredNorm(), off2 += (moved - path).squaredNorm();
  }
  if (off2 < p_.differs * path2) return found(InputFault::gnss_velocity, false, 1, {});
  double factor = 0, best2 = p_.explained * moved2;
  SignedAxes axes;
  for (const SignedAxes& each : all_signed_axes()) {
    if (each.from[2] != 2 || each.sign[2] < 0) continue;
    double product = 0;
    for (size_t i = 0; i < paths_.size(); ++i) {
      const auto& [path, moved] = paths_.back(i);
      const Eigen::Vector3d path3(path.x(), path.y(), 0);
      product += moved.dot(Vector2d(each.of(path3, 0), each.of(path3, 1)));
    }
    const double k = product / path2, left2 = moved2 - k * product;
    const bool other = each.changes() > 0 || k > p_.other_unit || k < 1 / p_.other_unit;
    if (other && k > 1 / p_.most && k < p_.most && left2 < best2) best2 = left2, factor = k, axes = each;
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
