// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/localizer/heading_update.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/time.hpp"

namespace odograph {

using Eigen::Quaterniond;

void HeadingUpdate::on_attitude(Localizer& localizer, const odo_attitude& attitude) {
  const int64_t t_ns = attitude.header.t_ns;
  const double gap_s = attitude_ns_ == INT64_MIN ? 0 : seconds(t_ns - attitude_ns_);
  if (gap_s > p_.gap_s)
    localizer.add_variance(kAttitudeHeading, std::min(squared(p_.gap_rotation) * gap_s, squared(kUnknownHeading_rad)));
  attitude_ns_ = t_ns;
  north_ = refers_to_north(attitude);
  if (north_) north_sigma_rad_ = std::sqrt(attitude.covariance_n[8]);
}

void HeadingUpdate::start(Localizer& localizer) const {
  localizer.set(kAttitudeHeading, mean_rad_, north_ ? squared(north_sigma_rad_) : 0.0);
  localizer.set_value(kHeading, mean_rad_);
  localizer.copy_error(kHeading, kAttitudeHeading);
}

double HeadingUpdate::propagate(Localizer& localizer, double dt_s, bool with_attitude) const {
  double keep = 1, variance = squared(p_.walk) * dt_s;
  if (north_) {
    keep = std::exp(-dt_s / p_.north_correlation_s);
    variance = (1 - keep * keep) * squared(north_sigma_rad_);
    if (with_attitude) {
      localizer.add_multiple(kHeading, kAttitudeHeading, keep - 1);
      localizer.set_value(kHeading, localizer.x()[kHeading] - (keep - 1) * mean_rad_);
    }
  }
  localizer.decay(kAttitudeHeading, mean_rad_, keep, variance);
  if (!with_attitude) return 0;
  localizer.add_variance(kHeading, variance);
  localizer.add_covariance(kHeading, kAttitudeHeading, variance);
  return variance;
}

bool HeadingUpdate::due(int64_t t_ns) const {
  return used_ns_ == INT64_MIN || seconds(t_ns - used_ns_) >= p_.interval_s;
}

Innovation HeadingUpdate::difference(const Localizer& localizer, const Quaterniond& q_o_a, double sigma_rad) const {
  const double turned = -2 * std::atan2(q_o_a.z(), q_o_a.w());  // about down: heading minus the attitude source's
  Innovation seen(1);
  seen.residual[0] = std::remainder(turned - (localizer.x()[kHeading] - localizer.x()[kAttitudeHeading]), 2 * EIGEN_PI);
  seen.H(0, kHeading) = 1, seen.H(0, kAttitudeHeading) = -1;
  seen.noise(0, 0) = squared(sigma_rad);
  return seen;
}

UpdateResult HeadingUpdate::use(Localizer& localizer, int64_t t_ns, const Quaterniond& q_o_a) {
  used_ns_ = t_ns;
  const auto seen = difference(localizer, q_o_a, p_.yaw_rad);
  return localizer.update(seen, kGate[1],
                          north_ ? only({kLogScale, kLogFactor, kStepHeading}) : all_but({kAttitudeHeading}));
}

void HeadingUpdate::join(Localizer& localizer, const Quaterniond& q_o_a) const {
  constexpr double kExact_rad = 1e-3;  // both refer to the same time
  localizer.update(difference(localizer, q_o_a, kExact_rad), 0, all_but({kAttitudeHeading}));
  localizer.copy_error(kHeading, kAttitudeHeading);
}

}  // namespace odograph
