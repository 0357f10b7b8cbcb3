// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "sdk/host/messages/messages.hpp"

namespace odograph {

/// The events that one sample gave and that have not been handled yet, first in, first out. What one sample may give is
/// bounded, so that plugins which answer each other cannot go on without end. No allocation after construction.
class EventQueue {
 public:
  explicit EventQueue(size_t limit) : events_(limit) {}

  /// A new sample: what it gives is counted from here.
  void begin() { taken_ = 0; }
  /// Copies an event. False, and nothing done, when the sample has given its share already.
  bool push(const AnyMessage& event) {
    if (taken_ >= events_.size() || count_ >= events_.size()) return false;
    ++taken_;
    events_[(first_ + count_++) % events_.size()] = event;
    return true;
  }
  bool empty() const { return count_ == 0; }
  /// The oldest; valid until it is popped.
  AnyMessage& front() { return events_[first_]; }
  void pop() {
    first_ = (first_ + 1) % events_.size();
    --count_;
  }
  size_t limit() const { return events_.size(); }

 private:
  std::vector<AnyMessage> events_;
  size_t first_ = 0, count_ = 0, taken_ = 0;
};

}  // namespace odograph
