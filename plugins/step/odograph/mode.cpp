// SPDX-License-Identifier: Apache-2.0
#include "plugins/step/odograph/mode.hpp"

#include <cmath>

namespace odograph::steps {
namespace {

constexpr double kRunningSwing_mps2 = 14.0, kRunning_hz = 2.25;
constexpr double kLoose_radps = 0.92, kHeld_radps = 0.85;  // mean rate of a step, to become loose and to be held again
constexpr double kOnEnd = 0.75, kTopDown = -0.5;           // part of up that is the phone's long axis
constexpr double kThigh_radps = 1.4;                       // more than a hand that holds an upright phone
constexpr int kStepsToBelieve = 2;
constexpr double kMoves_mps2 = 0.6, kMoves_radps = 0.2, kWindow_s = 0.5;
constexpr int64_t kPause_ns = 4'000'000'000;

}  // namespace

Carry CarryJudge::judge(const FoundStep& step, const Eigen::Vector3d& up_b) {
  const bool loose = step.gyro_radps > (now_ == Carry::texting ? kLoose_radps : kHeld_radps);
  Carry seen = Carry::texting;
  if (step.swing_mps2 > kRunningSwing_mps2 && step.frequency_hz > kRunning_hz)
    seen = Carry::running;
  else if (up_b.y() < kTopDown || (up_b.y() > kOnEnd && step.gyro_radps > kThigh_radps))
    seen = Carry::pocket;
  else if (loose && up_b.y() < kOnEnd)
    seen = Carry::swinging;
  if (since_ns_ == 0) since_ns_ = step.t_start_ns;
  if (seen == now_) {
    agreed_ = 0;
    return now_;
  }
  if (seen != next_ || agreed_ == 0) next_ = seen, agreed_ = 0, next_since_ns_ = step.t_start_ns;
  if (++agreed_ >= kStepsToBelieve) now_ = seen, since_ns_ = next_since_ns_, agreed_ = 0;
  return now_;
}

bool HandJudge::is_still(const WalkSignal& signal, int64_t now_ns) {
  const bool moves = signal.spread(kWindow_s) > kMoves_mps2 || signal.gyro_level(kWindow_s) > kMoves_radps;
  if (moves) last_moved_ns_ = now_ns;
  const bool still = now_ns - last_moved_ns_ > kPause_ns;
  if (still != still_) {
    still_ = still;
    since_ns_ = still ? last_moved_ns_ : now_ns - static_cast<int64_t>(0.5e9 * kWindow_s);
  }
  return still_;
}

}  // namespace odograph::steps
