// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/checks/course_check.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/scalar.hpp"

namespace odograph {

void CourseCheck::add(const odo_gnss& gnss, const FaultFound& found) {
  constexpr double kEarth_m = 6371000;
  const double north_m = kEarth_m * (gnss.latitude_rad - latitude_rad_);
  const double east_m =
      kEarth_m * std::cos(gnss.latitude_rad) * std::remainder(gnss.longitude_rad - longitude_rad_, 2 * kPi);
  const double sigma_m =
      gnss.header.flags & ODO_GNSS_COVARIANCE ? std::sqrt(std::max(gnss.covariance_n[0], gnss.covariance_n[4])) : 0.0;
  if (legs_ >= 0 && std::hypot(north_m, east_m) < std::max(p_.min_leg_m, p_.sigmas * sigma_m)) return;
  latitude_rad_ = gnss.latitude_rad, longitude_rad_ = gnss.longitude_rad;
  const double mean = samples_ > 0 ? sum_rad_ / samples_ : turned_rad_, course = std::atan2(east_m, north_m);
  sum_rad_ = 0, samples_ = 0;
  if (legs_ < 2) ++legs_;
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
