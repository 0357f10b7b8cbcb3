// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/localizer/scale_update.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sdk/math/time.hpp"

namespace odograph {
namespace {

constexpr double kMinInformationRatio = 1.02;  // minimum ratio to the information so far; less adds nothing

Innovation of_log_scale(double value, const Localizer& localizer, double variance) {
  Innovation seen(1);
  seen.residual[0] = value - localizer.x()[kLogScale];
  seen.H(0, kLogScale) = 1;
  seen.noise(0, 0) = variance;
  return seen;
}

}  // namespace

void ScaleUpdate::begin_group(Localizer& localizer) {
  *this = {};
  localizer.set(kLogScale, 0, squared(p_.unknown_sigma));
}

void ScaleUpdate::use_front_end(Localizer& localizer, double sigma, bool is_walking) {
  const double information = 1 / squared(std::clamp(sigma, p_.min_sigma, p_.unknown_sigma));
  own_ = information;
  if (!known_) {
    known_ = true;
    localizer.set(kLogScale, 0, 1 / information);
    stated_ = information;
    return;
  }
  const double held = 1 / localizer.P()(kLogScale, kLogScale);
  if (information < p_.lost_confidence * stated_ && is_walking) {
    if (information < held) localizer.add_variance(kLogScale, 1 / information - 1 / held);
    stated_ = information;
    return;
  }
  stated_ = std::max(stated_, information);
  if (information > kMinInformationRatio * held)
    localizer.update(of_log_scale(0, localizer, 1 / (information - held)), 0);
}

UpdateResult ScaleUpdate::use(Localizer& localizer, const odo_scale& scale) {
  if (scale.scale <= 0) return {};
  const double sigma = std::clamp(scale.sigma / scale.scale, p_.min_sigma, p_.unknown_sigma);
  const double information = 1 / squared(sigma), value = std::log(scale.scale);
  const bool by_steps = (scale.header.flags & ODO_SCALE_NOT_BY_STEPS) == 0;
  if (by_steps && steps_ > 0) return {};  // steps are compared with the front-end directly
  const double since_s = stated_ns_ == INT64_MIN ? 0.0 : seconds(scale.header.t_ns - stated_ns_);
  stated_ns_ = scale.header.t_ns;
  if (!std::exchange(known_, true)) {
    localizer.set(kLogScale, value, squared(sigma));
    stated_ = information;
  } else {
    stated_ *= std::exp(-std::max(0.0, since_s) / p_.memory_s);
    if (information <= kMinInformationRatio * stated_) return {};
    const UpdateResult result = localizer.update(of_log_scale(value, localizer, 1 / (information - stated_)), kGate[1]);
    if (!result.accepted) return result;
    stated_ = information;
  }
  (by_steps ? by_steps_ : own_) = information;
  return {true, 0.0, 1};
}

void ScaleUpdate::confirm_by_steps(const Localizer& localizer) {
  known_ = known_ || (steps_ >= p_.min_steps && localizer.sigma(kLogScale) < p_.known_sigma);
}

ScaleKnowledge ScaleUpdate::knowledge(const Localizer& localizer) const {
  if (!known_) return {};
  const double all = own_ + by_steps_, sigma = localizer.sigma(kLogScale);
  return all > 0 ? ScaleKnowledge{sigma, own_ / all, by_steps_ / all} : ScaleKnowledge{sigma, 0, 0};
}

}  // namespace odograph
