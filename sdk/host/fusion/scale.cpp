// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/fusion/scale.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sdk/math/time.hpp"

namespace odograph {
namespace {

constexpr double kMinInformationRatio = 1.02;  // minimum ratio to the information so far; less adds nothing

Innovation of_log_scale(double value, const PoseFilter& filter, double variance) {
  Innovation seen(1);
  seen.residual[0] = value - filter.x()[kLogScale];
  seen.H(0, kLogScale) = 1;
  seen.noise(0, 0) = variance;
  return seen;
}

}  // namespace

void Scale::begin_group(PoseFilter& filter) {
  *this = {};
  filter.set(kLogScale, 0, squared(p_.unknown_sigma));
}

void Scale::use_front_end(PoseFilter& filter, double sigma, bool is_walking) {
  const double information = 1 / squared(std::clamp(sigma, p_.min_sigma, p_.unknown_sigma));
  own_ = information;
  if (!known_) {
    known_ = true;
    filter.set(kLogScale, 0, 1 / information);
    stated_ = information;
    return;
  }
  const double held = 1 / filter.P()(kLogScale, kLogScale);
  if (information < p_.lost_confidence * stated_ && is_walking) {
    if (information < held) filter.add_variance(kLogScale, 1 / information - 1 / held);
    stated_ = information;
    return;
  }
  stated_ = std::max(stated_, information);
  if (information > kMinInformationRatio * held) filter.update(of_log_scale(0, filter, 1 / (information - held)), 0);
}

UpdateResult Scale::use(PoseFilter& filter, const odo_scale& scale) {
  if (scale.scale <= 0) return {};
  const double sigma = std::clamp(scale.sigma / scale.scale, p_.min_sigma, p_.unknown_sigma);
  const double information = 1 / squared(sigma), value = std::log(scale.scale);
  const bool by_steps = (scale.header.flags & ODO_SCALE_NOT_BY_STEPS) == 0;
  if (by_steps && steps_ > 0) return {};  // steps are compared with the front-end directly
  const double since_s = stated_at_ ? seconds(scale.header.t_ns - *stated_at_) : 0.0;
  stated_at_ = scale.header.t_ns;
  if (!std::exchange(known_, true)) {
    filter.set(kLogScale, value, squared(sigma));
    stated_ = information;
  } else {
    stated_ *= std::exp(-std::max(0.0, since_s) / p_.memory_s);
    if (information <= kMinInformationRatio * stated_) return {};
    const UpdateResult result = filter.update(of_log_scale(value, filter, 1 / (information - stated_)), kGate[1]);
    if (!result.accepted) return result;
    stated_ = information;
  }
  (by_steps ? by_steps_ : own_) = information;
  return {true, 0.0, 1};
}

void Scale::confirm_by_steps(const PoseFilter& filter) {
  known_ = known_ || (steps_ >= p_.min_steps && filter.sigma(kLogScale) < p_.known_sigma);
}

ScaleKnowledge Scale::knowledge(const PoseFilter& filter) const {
  if (!known_) return {};
  const double all = own_ + by_steps_, sigma = filter.sigma(kLogScale);
  return all > 0 ? ScaleKnowledge{sigma, own_ / all, by_steps_ / all} : ScaleKnowledge{sigma, 0, 0};
}

}  // namespace odograph
