// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/fusion/heading.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/time.hpp"

namespace odograph {

using Eigen::Quaterniond;

void Heading::on_attitude(PoseFilter& filter, const odo_attitude& attitude) {
  const int64_t t_ns = attitude.header.t_ns;
  const double gap_s = attitude_ ? seconds(t_ns - *attitude_) : 0;
  if (gap_s > Trajectory::Parameters().attitude_gap_s)
    filter.add_variance(kAttitudeHeading, std::min(squared(p_.gap_rotation) * gap_s, squared(kUnknownHeading_rad)));
  attitude_ = t_ns;
  north_ = refers_to_north(attitude);
  if (north_) north_sigma_rad_ = std::sqrt(attitude.covariance_n[8]);
}

void Heading::start(PoseFilter& filter) const {
  filter.set(kAttitudeHeading, mean_rad_, north_ ? squared(north_sigma_rad_) : 0.0);
  filter.set_value(kHeading, mean_rad_);
  filter.copy_error(kHeading, kAttitudeHeading);
}

double Heading::propagate(PoseFilter& filter, double dt_s, bool with_attitude) const {
  double keep = 1, variance = squared(p_.walk) * dt_s;
  if (north_) {
    keep = std::exp(-dt_s / p_.north_correlation_s);
    variance = (1 - keep * keep) * squared(north_sigma_rad_);
    if (with_attitude) {
      filter.add_multiple(kHeading, kAttitudeHeading, keep - 1);
      filter.set_value(kHeading, filter.x()[kHeading] - (keep - 1) * mean_rad_);
    }
  }
  filter.decay(kAttitudeHeading, mean_rad_, keep, with_attitude ? 0.0 : variance);
  if (!with_attitude) return 0;
  filter.add_variance(kHeading, kAttitudeHeading, variance);  // o rotates with it
  return variance;
}

bool Heading::due(int64_t t_ns) const { return !used_ || seconds(t_ns - *used_) >= p_.interval_s; }

Innovation Heading::difference(const PoseFilter& filter, const Quaterniond& q_o_a, double sigma_rad) const {
  const double turned = -2 * std::atan2(q_o_a.z(), q_o_a.w());  // about down: heading minus the attitude source's
  Innovation seen(1);
  seen.residual[0] = std::remainder(turned - (filter.x()[kHeading] - filter.x()[kAttitudeHeading]), 2 * EIGEN_PI);
  seen.H(0, kHeading) = 1, seen.H(0, kAttitudeHeading) = -1;
  seen.noise(0, 0) = squared(sigma_rad);
  return seen;
}

UpdateResult Heading::use(PoseFilter& filter, int64_t t_ns, const Quaterniond& q_o_a) {
  used_ = t_ns;
  const auto seen = difference(filter, q_o_a, p_.yaw_rad);
  return filter.update(seen, kGate[1],
                       north_ ? only({kLogScale, kLogFactor, kStepHeading}) : all_but({kAttitudeHeading}));
}

void Heading::join(PoseFilter& filter, const Quaterniond& q_o_a) const {
  constexpr double kExact_rad = 1e-3;  // both refer to the same time
  filter.update(difference(filter, q_o_a, kExact_rad), 0, all_but({kAttitudeHeading}));
  filter.copy_error(kHeading, kAttitudeHeading);
}

}  // namespace odograph
