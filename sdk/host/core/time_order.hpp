// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sdk/host/messages/messages.hpp"

namespace odograph {

/// Merges samples of several sensors by time, waiting for the slower ones within a bound. No allocation after
/// construction. Order of release: time, then type, then arrival; a sensor that starts while others run joins with
/// samples that are older than what was released, by the wait at most, and is waited for from then on. One thread at a
/// time.
class TimeOrder {
 public:
  struct Parameters {
    /// One sample with a wild time must not make all others late. Judgement: longer than any app's pause.
    int64_t far_ahead_ns = 10'000'000'000;
    /// Consecutive samples that say so are believed: the sensor has had a pause.
    int believe_ahead = 3;
    /// Consecutive samples behind the sensor's own last time, before the clock counts as set back. Judgement: half a
    /// second of an IMU.
    int believe_behind = 50;
    /// A sensor that is silent for longer is not waited for. Judgement: a camera that was switched off.
    int64_t silent_ns = 1'000'000'000;
  };

  enum class Verdict {
    accepted,
    late,         // its time has been released already
    duplicate,    // same sensor and time as the one before
    implausible,  // far ahead of everything else, and alone with that
    full,
    restarted,  // the sensor clock was set back; the caller drains, restarts and asks again
  };

  TimeOrder(size_t capacity, int64_t max_wait_ns) : TimeOrder(capacity, max_wait_ns, Parameters()) {}
  TimeOrder(size_t capacity, int64_t max_wait_ns, const Parameters& parameters);

  /// There is a camera: until its first frame it is waited for like one that has just given a frame. A calibration
  /// that is pushed says so too.
  void expect_camera() { camera_expected_ = true; }

  /// Whether a message may be added; it is to be if it is accepted.
  Verdict judge(const odo_header& message);
  void add(OwnedMessage message);
  /// Both; what is not accepted is released.
  Verdict push(OwnedMessage message);

  /// The next message in order, or false while a slower sensor may still deliver an earlier one. Up to `flush_until_ns`
  /// nothing is waited for.
  bool pop(OwnedMessage& out, int64_t flush_until_ns = INT64_MIN);
  /// Time of the latest message that waits; INT64_MIN when none does.
  int64_t latest_waiting_ns() const;
  /// True when pop without flush would give a message.
  bool ready() const { return !heap_.empty() && heap_.front().t_ns <= watermark(); }

  size_t size() const { return heap_.size(); }
  /// Takes out what waits, one message a call, whether or not its time has come; false when nothing is left.
  bool drain(OwnedMessage& out);
  /// Forgets all times, for a sensor clock that was set back.
  void restart();

 private:
  struct Stream {
    uint32_t type = 0, source = 0, part = 0;  // part: which half of an IMU that delivers its sensors apart
    int64_t latest_ns = 0;
    int ahead = 0;   // consecutive samples far ahead
    int behind = 0;  // consecutive late ones that are behind the stream's own last time too
    bool used = false;
    bool joined = false;  // has been in time since it began or was silent
  };
  struct Entry {
    int64_t t_ns;
    uint32_t rank;
    uint32_t slot;
    uint64_t sequence;
  };

  static bool later(const Entry& a, const Entry& b);
  Stream& stream_of(const odo_header& message);
  Verdict judge_late(Stream& stream, const odo_header& message);
  bool silent(const Stream& stream) const;
  bool camera_to_come() const;
  int64_t watermark() const;
  void take_first(OwnedMessage& out);

  Parameters parameters_;
  size_t capacity_;
  int64_t max_wait_ns_;
  int64_t oldest_ns_ = INT64_MIN;  // of the first sample
  int64_t newest_ns_ = INT64_MIN;
  int64_t released_ns_ = INT64_MIN;  // of the last message released
  uint64_t sequence_ = 0;
  bool camera_expected_ = false;
  std::array<Stream, 32> streams_{};
  std::vector<OwnedMessage> slots_;
  std::vector<uint32_t> free_;
  std::vector<Entry> heap_;
};

}  // namespace odograph
