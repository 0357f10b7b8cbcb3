// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sdk/core/messages.hpp"

namespace odograph {

/// Merges samples of several sensors by time, waiting for the slower ones within a bound. No allocation after
/// construction. Order of release: time, then type, then arrival. One thread at a time.
class TimeOrder {
 public:
  enum class Verdict {
    accepted,
    late,         // its time has been released already
    duplicate,    // same sensor and time as the one before
    implausible,  // far ahead of everything else, and alone with that
    full,
    restarted,  // not taken: the sensor clock was set back; the caller drains, restarts and pushes again
  };

  TimeOrder(size_t capacity, int64_t max_wait_ns);

  Verdict push(const odo_header& message);

  /// The next message in order, or false while a slower sensor may still deliver an earlier one.
  /// With `flush` nothing is waited for.
  bool pop(AnyMessage& out, bool flush);

  /// Time of the last message released; INT64_MIN before the first.
  int64_t released_ns() const { return released_ns_; }
  size_t size() const { return heap_.size(); }
  /// Takes out everything that waits, for the caller to release what it holds.
  bool drain(AnyMessage& out);
  /// Forgets all times, for a sensor clock that was set back.
  void restart();

 private:
  struct Stream {
    uint64_t key = 0;
    int64_t latest_ns = 0;
    int ahead = 0;   // consecutive samples far ahead
    int behind = 0;  // consecutive late ones
    bool used = false;
  };
  struct Entry {
    int64_t t_ns;
    uint32_t rank;
    uint32_t slot;
    uint64_t sequence;
  };

  static bool later(const Entry& a, const Entry& b);
  Stream& stream_of(const odo_header& message);
  int64_t watermark() const;
  void take_first(AnyMessage& out);

  int64_t max_wait_ns_;
  int64_t oldest_ns_ = INT64_MIN;  // of the first sample
  int64_t newest_ns_ = INT64_MIN;
  int64_t released_ns_ = INT64_MIN;
  uint64_t sequence_ = 0;
  std::array<Stream, 32> streams_{};
  std::vector<AnyMessage> slots_;
  std::vector<uint32_t> free_;
  std::vector<Entry> heap_;
};

}  // namespace odograph
