// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "sdk/host/messages/messages.hpp"

namespace odograph {

/// FIFO of the pending events that one sample caused. The number per sample is bounded, so that plugins that answer
/// each other's events cannot loop forever. No allocation after construction.
class EventQueue {
 public:
  explicit EventQueue(size_t limit) : events_(limit) {}

  /// Starts a new sample and its event count.
  void begin() {
    taken_ = 0;
    if (count_ > 0) return;
    first_ = 0;  // so that large events, one per frame, use the same few slots
    for (; used_ > AnyMessage::kKeptLarge; --used_) events_[used_ - 1].release_memory();
    used_ = 0;
  }
  /// Copies an event. False, and nothing done, if the sample has reached its limit.
  bool push(const AnyMessage& event) {
    if (taken_ >= events_.size() || count_ >= events_.size()) return false;
    ++taken_;
    const size_t slot = (first_ + count_++) % events_.size();
    events_[slot] = event;
    used_ = std::max(used_, slot + 1);
    return true;
  }
  bool empty() const { return count_ == 0; }
  /// The oldest event; valid until popped.
  AnyMessage& front() { return events_[first_]; }
  void pop() {
    first_ = (first_ + 1) % events_.size();
    --count_;
  }
  size_t limit() const { return events_.size(); }

 private:
  std::vector<AnyMessage> events_;
  size_t first_ = 0, count_ = 0, taken_ = 0, used_ = 0;  // used_: slots since begin()
};

}  // namespace odograph
