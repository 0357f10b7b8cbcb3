// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sdk/host/messages/messages.hpp"

namespace odograph {

/// Merges the samples of several sensors by time, with a bounded wait for slower ones. No allocation after
/// construction. Order of release: time, then type, then arrival. A sensor that starts while others run may begin with
/// samples older than what was released, by at most the wait, and is waited for from then on. Not thread-safe.
class TimeOrder {
 public:
  struct Parameters {
    /// Bounds a single sample's time, so that one outlier does not make all others late. Judgement: longer than any
    /// app's pause.
    int64_t far_ahead_ns = 10'000'000'000;
    /// Consecutive samples this far ahead are accepted if no other sensor contradicts them: all have paused.
    int consecutive_ahead = 3;
    /// Messages of slow sensors that wait, while they are far ahead, for a steady one to agree; a further one takes the
    /// place of the oldest.
    size_t held = 16;
    /// Samples of steady sensors after which such a message is discarded: half a second of an IMU.
    int contradictions = 100;
    /// Consecutive samples behind the sensor's own latest time, after which the clock counts as set back. Judgement:
    /// half a second of an IMU.
    int consecutive_behind = 50;
    /// A sensor that is silent for longer is not waited for. Judgement: a camera that was switched off.
    int64_t silent_ns = 1'000'000'000;
  };

  enum class Verdict {
    accepted,
    late,         // its time has been released already
    duplicate,    // same sensor and time as the previous sample
    held,         // far ahead of the steady sensors: waits until they agree
    implausible,  // a sample far ahead of everything else
    full,
    restarted,  // the sensor clock was set back; the caller drains, restarts and judges again
  };

  TimeOrder(size_t capacity, int64_t max_wait_ns) : TimeOrder(capacity, max_wait_ns, Parameters()) {}
  TimeOrder(size_t capacity, int64_t max_wait_ns, const Parameters& parameters);

  /// A camera exists: until its first frame, it is waited for as if it had just delivered one. A pushed calibration has
  /// the same effect.
  void expect_camera() { camera_expected_ = true; }

  /// Whether a message may be added; an accepted message must be added.
  Verdict classify(const odo_header& message);
  void add(OwnedMessage&& message);
  /// Keeps a message that is held; those that the steady sensors have contradicted move to `discarded`.
  void hold(OwnedMessage&& message);
  void discard_contradicted(std::vector<OwnedMessage>& discarded) { discard(parameters_.contradictions, discarded); }
  /// Those that are still held, at the end of the input.
  void discard_held(std::vector<OwnedMessage>& discarded) { discard(0, discarded); }
  /// Judges and adds a message; releases it unless accepted.
  Verdict push(OwnedMessage message);

  /// The next message in order, or false while a slower sensor may still deliver an earlier one. Does not wait up to
  /// `flush_until_ns`.
  bool pop(OwnedMessage& out, int64_t flush_until_ns = INT64_MIN);
  /// Time of the latest waiting message; INT64_MIN if there is none.
  int64_t latest_waiting_ns() const;
  /// Whether pop() without flush would return a message.
  bool ready() const { return !heap_.empty() && heap_.front().t_ns <= watermark(); }

  size_t size() const { return heap_.size(); }
  /// Of the steady sensors; INT64_MIN before the first sample.
  int64_t newest_ns() const { return newest_ns_; }
  /// Removes the waiting messages, one per call, regardless of their time; false if none is left.
  bool drain(OwnedMessage& out);
  /// Discards all times, after the sensor clock was set back.
  void restart();

 private:
  struct Stream {
    uint32_t type = 0, source = 0, part = 0;  // part: which half of an IMU that delivers its sensors separately
    int64_t latest_ns = 0;
    int ahead = 0;  // consecutive samples far ahead, the newest of them at ahead_ns
    int64_t ahead_ns = 0;
    int behind = 0;  // consecutive late ones that are also behind the stream's own latest time
    bool used = false;
    bool joined = false;  // in time at least once since it started or was silent
  };
  struct Entry {
    int64_t t_ns;
    uint64_t rank;
    uint32_t slot;
    uint64_t sequence;
  };

  struct Held {
    OwnedMessage message;
    int contradictions;  // samples of steady sensors since it came
  };

  static bool later(const Entry& a, const Entry& b);
  bool is_far_ahead(int64_t t_ns) const;
  void admit_held();
  void discard(int contradictions, std::vector<OwnedMessage>& discarded);
  Stream& stream_of(const odo_header& message);
  Verdict classify_late(Stream& stream, const odo_header& message);
  bool silent(const Stream& stream) const;
  bool awaits_camera() const;
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
  std::vector<Held> held_;
};

}  // namespace odograph
