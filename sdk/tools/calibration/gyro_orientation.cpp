// SPDX-License-Identifier: Apache-2.0
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/calibration/gyro_orientation.hpp"

#include <algorithm>

namespace odograph {

GyroOrientation::GyroOrientation(const std::vector<GyroSample>& samples, const Eigen::Vector3d& bias_b,
                                 const Eigen::Matrix3d& scale)
    : first_ns_(samples.front().t_ns) {
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  for (size_t i = 0; i + 1 < samples.size(); ++i) {
    const double dt = odograph::seconds(samples[i + 1].t_ns - samples[i].t_ns);
    const Eigen::Vector3d rate = scale * (samples[i].rate_b - bias_b);
    const Eigen::Vector3d change = scale * (samples[i + 1].rate_b - samples[i].rate_b);
    knots_.push_back({seconds(samples[i].t_ns), q, rate, change / dt});
    q = (q * exp_rotation(dt * (rate + 0.5 * change))).normalized();
  }
  knots_.push_back(
      {seconds(samples.back().t_ns), q, scale * (samples.back().rate_b - bias_b), Eigen::Vector3d::Zero()});
}

size_t GyroOrientation::interval(double t_s) const {
  const auto after =
      std::upper_bound(knots_.begin(), knots_.end(), t_s, [](double t, const Knot& knot) { return t < knot.t_s; });
  return after == knots_.begin() ? 0 : static_cast<size_t>(after - knots_.begin()) - 1;
}

bool GyroOrientation::covers(double from_s, double to_s, double gap_s) const {
  if (from_s < knots_.front().t_s || to_s > knots_.back().t_s) return false;
  for (size_t i = interval(from_s); i + 1 < knots_.size() && knots_[i].t_s < to_s; ++i)
    if (knots_[i + 1].t_s - knots_[i].t_s > gap_s) return false;
  return true;
}

Eigen::Quaterniond GyroOrientation::at(double t_s) const {
  const Knot& knot = knots_[interval(t_s)];
  const double dt = t_s - knot.t_s;
  return knot.q * exp_rotation(dt * knot.rate + 0.5 * dt * dt * knot.acceleration);
}

Eigen::Vector3d GyroOrientation::rate(double t_s) const {
  const Knot& knot = knots_[interval(t_s)];
  return knot.rate + knot.acceleration * (t_s - knot.t_s);
}

}  // namespace odograph
