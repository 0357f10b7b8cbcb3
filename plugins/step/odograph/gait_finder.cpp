// SPDX-License-Identifier: Apache-2.0
#include "plugins/step/odograph/gait_finder.hpp"

#include <algorithm>
#include <utility>

namespace odograph::steps {

void GaitFinder::add(const WalkSample& sample) {
  found_count_ = 0;
  signal_.add(sample);
  smoother_.add(sample);
  const bool was_vivid = vivid_.walking();
  vivid_.update(signal_);
  gentle_.update(smoother_);
  for (const FoundStep& step : vivid_.found()) take(step);
  if (was_vivid && !vivid_.walking())
    for (const FoundStep& step : std::span(waiting_.data(), std::exchange(waiting_count_, 0))) take(step);
  for (const FoundStep& step : gentle_.found()) {
    if (!vivid_.walking()) {
      take(step);
      continue;
    }
    if (waiting_count_ == waiting_.size()) std::copy(waiting_.begin() + 1, waiting_.end(), waiting_.begin());
    waiting_[std::min(waiting_count_, waiting_.size() - 1)] = step;
    waiting_count_ = std::min(waiting_count_ + 1, waiting_.size());
  }
}

/// A step that overlaps for the most part with one of the other finder is the same step.
void GaitFinder::take(const FoundStep& step) {
  if (last_end_ns_ > step.t_start_ns + (step.t_end_ns - step.t_start_ns) / 2 || found_count_ == found_.size()) return;
  FoundStep& kept = found_[found_count_++] = step;
  kept.t_start_ns = std::max(kept.t_start_ns, last_end_ns_);
  kept.since_stood = since_stood_ = kept.t_start_ns - last_end_ns_ > kStood_ns ? 0 : since_stood_ + 1;
  last_end_ns_ = kept.t_end_ns;
  if (!kept.gentle) {
    last_vivid_ns_ = kept.t_end_ns;
  } else if (kept.t_end_ns - last_vivid_ns_ < kSlowingDown_ns) {
    kept.gentle = false;
  }
}

int64_t GaitFinder::since_ns() const {
  if (vivid_.walking() && gentle_.walking()) return std::min(vivid_.since_ns(), gentle_.since_ns());
  if (vivid_.walking() != gentle_.walking()) return vivid_.walking() ? vivid_.since_ns() : gentle_.since_ns();
  return std::max(vivid_.since_ns(), gentle_.since_ns());
}

}  // namespace odograph::steps
