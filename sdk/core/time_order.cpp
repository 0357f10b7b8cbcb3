// SPDX-License-Identifier: Apache-2.0
#include "sdk/core/time_order.hpp"

#include <algorithm>

namespace odograph {
namespace {

constexpr int64_t kFarAhead_ns = 10'000'000'000;  // one sample with a wild time must not make all others late
constexpr int kBelieveAhead = 3;                  // but a sensor that says so three times has had a pause
constexpr int kBelieveBehind = 50;                // and one that stays behind has had its clock set back

/// Sensors that deliver steadily hold the others back; sensors that speak now and then do not.
bool holds_back(uint32_t type) {
  return type == ODO_TYPE_IMU || type == ODO_TYPE_MAGNETOMETER || type == ODO_TYPE_FRAME;
}

/// Slow sensors are passed on late rather than lost; what uses them looks the pose of their time up.
bool may_be_late(uint32_t type) {
  return type == ODO_TYPE_GNSS || type == ODO_TYPE_WAYPOINT || type == ODO_TYPE_CALIBRATION ||
         type == ODO_TYPE_IMU_NOISE;
}

/// Among equal times: what describes a sensor before what it measured, then by type.
uint32_t rank_of(uint32_t type) { return type == ODO_TYPE_CALIBRATION || type == ODO_TYPE_IMU_NOISE ? 0 : type; }

}  // namespace

TimeOrder::TimeOrder(size_t capacity, int64_t max_wait_ns) : max_wait_ns_(max_wait_ns), slots_(capacity) {
  free_.reserve(capacity);
  heap_.reserve(capacity);
  for (size_t i = capacity; i-- > 0;) free_.push_back(static_cast<uint32_t>(i));
}

bool TimeOrder::later(const Entry& a, const Entry& b) {
  return a.t_ns != b.t_ns ? a.t_ns > b.t_ns : a.rank != b.rank ? a.rank > b.rank : a.sequence > b.sequence;
}

TimeOrder::Stream& TimeOrder::stream_of(const odo_header& message) {
  uint64_t key = uint64_t(message.type) << 32 | message.source;
  // An accelerometer and a gyroscope that are delivered apart are two streams.
  if (message.type == ODO_TYPE_IMU) key |= uint64_t(message.flags & 3) << 60;
  for (Stream& stream : streams_)
    if (stream.used && stream.key == key) return stream;
  for (Stream& stream : streams_)
    if (!stream.used) {
      stream = {key, INT64_MIN, 0, 0, true};
      return stream;
    }
  return streams_.back();
}

TimeOrder::Verdict TimeOrder::push(const odo_header& message) {
  Stream& stream = stream_of(message);
  const int64_t t_ns = message.t_ns;
  if (!may_be_late(message.type)) {
    if (t_ns == stream.latest_ns) return Verdict::duplicate;
    if (newest_ns_ != INT64_MIN && t_ns - newest_ns_ > kFarAhead_ns && ++stream.ahead < kBelieveAhead)
      return Verdict::implausible;
    stream.ahead = 0;
    if (released_ns_ != INT64_MIN && t_ns < released_ns_) {
      if (t_ns <= stream.latest_ns && stream.behind == 0) {
        stream.behind = 1;
        return Verdict::late;
      }
      // A slow sensor that is late is late; and while others go on it is not the clock that was set back.
      if (++stream.behind < kBelieveBehind || !holds_back(message.type)) return Verdict::late;
      return Verdict::restarted;
    }
    for (Stream& any : streams_) any.behind = 0;
  }
  if (free_.empty()) return Verdict::full;
  const uint32_t slot = free_.back();
  free_.pop_back();
  slots_[slot].assign(message);
  heap_.push_back({t_ns, rank_of(message.type), slot, sequence_++});
  std::push_heap(heap_.begin(), heap_.end(), later);
  stream.latest_ns = std::max(stream.latest_ns, t_ns);
  if (!may_be_late(message.type)) {
    newest_ns_ = std::max(newest_ns_, t_ns);
    if (oldest_ns_ == INT64_MIN) oldest_ns_ = t_ns;
  }
  return Verdict::accepted;
}

int64_t TimeOrder::watermark() const {
  if (newest_ns_ == INT64_MIN) return INT64_MAX;  // only calibrations so far: nothing to wait for
  // At first nobody knows which sensors there are: all get the longest wait to show up.
  if (newest_ns_ - oldest_ns_ < max_wait_ns_) return newest_ns_ - max_wait_ns_;
  int64_t slowest = INT64_MAX;
  for (const Stream& stream : streams_)
    if (stream.used && stream.latest_ns != INT64_MIN && holds_back(static_cast<uint32_t>(stream.key >> 32) & 0xFFFFFFF))
      slowest = std::min(slowest, stream.latest_ns);
  return std::max(newest_ns_ - max_wait_ns_, std::min(slowest, newest_ns_));
}

void TimeOrder::take_first(AnyMessage& out) {
  std::pop_heap(heap_.begin(), heap_.end(), later);
  const Entry entry = heap_.back();
  heap_.pop_back();
  out = slots_[entry.slot];
  free_.push_back(entry.slot);
}

bool TimeOrder::pop(AnyMessage& out, bool flush) {
  if (heap_.empty() || (!flush && heap_.front().t_ns > watermark())) return false;
  take_first(out);
  released_ns_ = std::max(released_ns_, out.header().t_ns);
  return true;
}

void TimeOrder::restart() {
  for (Stream& stream : streams_) stream.latest_ns = INT64_MIN, stream.ahead = stream.behind = 0;
  oldest_ns_ = newest_ns_ = released_ns_ = INT64_MIN;
}

bool TimeOrder::drain(AnyMessage& out) {
  if (heap_.empty()) return false;
  take_first(out);
  return true;
}

}  // namespace odograph
