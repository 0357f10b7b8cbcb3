// SPDX-License-Identifier: Apache-2.0
#include "plugins/step/odograph/carry_mode.hpp"

namespace odograph::steps {

CarryMode CarryModeClassifier::classify(const FoundStep& step, const Eigen::Vector3d& up_b) {
  const bool loose = step.gyro_radps > (now_ == CarryMode::texting ? p_.loose_radps : p_.held_radps);
  rate_radps_ += (rate_radps_ > 0 ? p_.learn_rate : 1.0) * (step.gyro_radps - rate_radps_);
  swings_ = rate_radps_ > (swings_ ? p_.thigh_ends_radps : p_.thigh_radps);
  const bool hangs = up_b.y() < p_.top_down || (up_b.y() > p_.on_end && step.gyro_radps > p_.thigh_radps);
  const bool swung = loose && up_b.y() < p_.on_end;
  const bool worn = !step.gentle && step.vertical_part < p_.worn_part && rate_radps_ > p_.worn_radps;
  CarryMode seen = CarryMode::texting;
  if (step.swing_mps2 > p_.running_swing_mps2 && step.frequency_hz > p_.running_hz)
    seen = CarryMode::running;
  else if (hangs || (worn && !swung))
    seen = CarryMode::pocket;
  else if (swung)
    seen = CarryMode::swinging;
  if (since_ns_ == 0) since_ns_ = step.t_start_ns;
  if (seen == now_) {
    agreed_ = 0;
    return now_;
  }
  if (seen != next_ || agreed_ == 0) next_ = seen, agreed_ = 0, next_since_ns_ = step.t_start_ns;
  if (++agreed_ >= p_.min_agreeing_steps) now_ = seen, since_ns_ = next_since_ns_, agreed_ = 0;
  return now_;
}

bool StillnessDetector::is_still(const WalkSignal& signal, int64_t now_ns) {
  const bool moves = signal.spread(p_.window_s) > p_.moves_mps2 || signal.gyro_norm(p_.window_s) > p_.moves_radps;
  if (moves) last_moved_ns_ = now_ns;
  const bool still = now_ns - last_moved_ns_ > p_.pause_ns;
  if (still != still_) {
    still_ = still;
    since_ns_ = still ? last_moved_ns_ : now_ns - static_cast<int64_t>(0.5e9 * p_.window_s);
  }
  return still_;
}

}  // namespace odograph::steps
