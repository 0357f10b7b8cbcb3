// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/estimator/scale_start.hpp"

#include <algorithm>
#include <cmath>

namespace odograph::inertial {

void ScaleStart::restart() {
  path_.clear();
  steps_m_ = steps_displacement_ = information_ = weighted_ = 0;
  steps_ = 0;
}

void ScaleStart::add_window(const WindowScale& window) {
  const double weight = 1 / (window.sigma * window.sigma);
  information_ += weight;
  weighted_ += weight * window.inverse_scale;
}

bool ScaleStart::add_step(int64_t start_ns, int64_t end_ns, double length_m) {
  const auto from = at(start_ns), to = at(end_ns);
  if (!from || !to || length_m <= 0) return false;
  const double displacement = (*to - *from).head<2>().norm();
  if (steps_ > 0 && displacement * p_.start_min_step_ratio / length_m < steps_displacement_ / steps_m_) return false;
  steps_m_ += length_m, steps_displacement_ += displacement;
  ++steps_;
  return true;
}

std::optional<ScaleStart::Known> ScaleStart::known(double log_factor, double factor_variance) const {
  double by_steps = 0, by_inertia = 0, steps_log = 0, inertia_log = 0;  // information, values
  if (steps_ >= p_.start_min_steps && steps_displacement_ > 0) {
    const double own = p_.step_own_sigma * p_.step_own_sigma / steps_;
    by_steps = 1 / (factor_variance + own);
    steps_log = std::log(steps_m_ / steps_displacement_) + log_factor;
  }
  if (information_ > 0) {
    const double r = weighted_ / information_;
    by_inertia = information_ * r * r;
    if (r > 0 && by_inertia > 1 / (p_.start_inertia_sigma * p_.start_inertia_sigma))
      inertia_log = -std::log(r);
    else
      by_inertia = 0;  // below three sigmas its logarithm means nothing
  }
  const double both = by_steps + by_inertia;
  if (both < 1 / (p_.start_scale_sigma * p_.start_scale_sigma)) return std::nullopt;
  return Known{(by_steps * steps_log + by_inertia * inertia_log) / both, 1 / both, by_steps / both};
}

}  // namespace odograph::inertial
