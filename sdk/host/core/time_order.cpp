// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/time_order.hpp"

#include <algorithm>

#include "sdk/host/base/saturating.hpp"
#include "sdk/host/messages/messages.hpp"

namespace odograph {
namespace {

/// Sensors for which a time that goes back means that the clock was set back.
bool is_clock_reference(uint32_t type) {
  return type == ODO_TYPE_IMU || type == ODO_TYPE_MAGNETOMETER || type == ODO_TYPE_FRAME;
}

/// Other sensors wait for those that deliver at a steady rate, not for sporadic ones.
bool is_waited_for(uint32_t type) {
  return is_clock_reference(type) || type == ODO_TYPE_BAROMETER || type == ODO_TYPE_PLATFORM_POSE;
}

/// Slow sensors are passed on late rather than dropped; their users look up the pose at their time.
bool may_be_late(uint32_t type) {
  return type == ODO_TYPE_GNSS || type == ODO_TYPE_WAYPOINT || type == ODO_TYPE_CALIBRATION ||
         type == ODO_TYPE_IMU_NOISE || type == ODO_TYPE_EARTH_FIELD || type == ODO_TYPE_RANGE ||
         type == ODO_TYPE_SYSTEM_STEP || !message_info(type);
}

/// Among equal times: descriptions first, then by type and source.
uint64_t rank_of(const odo_header& message) {
  return is_description(message) ? 0 : uint64_t(message.type) << 32 | message.source;
}

}  // namespace

TimeOrder::TimeOrder(size_t capacity, int64_t max_wait_ns, const Parameters& parameters)
    : parameters_(parameters), capacity_(capacity), max_wait_ns_(max_wait_ns) {
  slots_.reserve(capacity);
  free_.reserve(capacity);
  heap_.reserve(capacity);
  held_.reserve(parameters.held);
}

bool TimeOrder::later(const Entry& a, const Entry& b) {
  return a.t_ns != b.t_ns ? a.t_ns > b.t_ns : a.rank != b.rank ? a.rank > b.rank : a.sequence > b.sequence;
}

TimeOrder::Stream& TimeOrder::stream_of(const odo_header& message) {
  // Accelerometer and gyroscope delivered separately are two streams.
  const uint32_t part = message.type == ODO_TYPE_IMU ? message.flags & 3 : 0;
  for (Stream& stream : streams_)
    if (stream.used && stream.type == message.type && stream.source == message.source && stream.part == part)
      return stream;
  for (Stream& stream : streams_)
    if (!stream.used) {
      stream = {message.type, message.source, part, INT64_MIN, 0, 0, 0, true, false};
      return stream;
    }
  return streams_.back();
}

bool TimeOrder::silent(const Stream& stream) const {
  return saturating_difference(newest_ns_, stream.latest_ns) > std::max(parameters_.silent_ns, max_wait_ns_);
}

bool TimeOrder::awaits_camera() const {
  if (!camera_expected_ ||
      saturating_difference(newest_ns_, oldest_ns_) > std::max(parameters_.silent_ns, max_wait_ns_))
    return false;
  return std::none_of(streams_.begin(), streams_.end(), [](const Stream& stream) {
    return stream.used && stream.type == ODO_TYPE_FRAME && stream.latest_ns != INT64_MIN;
  });
}

/// Judges a sample older than what was released. Its stream is noted first, so that the others wait for it.
TimeOrder::Verdict TimeOrder::classify_late(Stream& stream, const odo_header& message) {
  if (message.t_ns <
      stream.latest_ns) {  // the sensor's own time went back; while others go on, this is not a clock reset
    const bool set_back = ++stream.behind >= parameters_.consecutive_behind && is_clock_reference(message.type);
    return set_back ? Verdict::restarted : Verdict::late;
  }
  if (stream.latest_ns == INT64_MIN || silent(stream)) stream.joined = false;
  stream.latest_ns = message.t_ns;
  // The others began on a clock that is not the IMU's, which is the reference.
  const bool another_clock = message.type == ODO_TYPE_IMU && !stream.joined &&
                             saturating_difference(released_ns_, message.t_ns) > parameters_.far_ahead_ns;
  stream.behind = another_clock ? stream.behind + 1 : 0;
  if (stream.behind >= parameters_.consecutive_behind) return Verdict::restarted;
  const bool joins = !stream.joined && is_waited_for(message.type) &&
                     saturating_difference(released_ns_, message.t_ns) <= max_wait_ns_;
  return joins ? Verdict::accepted : Verdict::late;
}

TimeOrder::Verdict TimeOrder::classify(const odo_header& message) {
  const int64_t t_ns = message.t_ns;
  if (message.type == ODO_TYPE_CALIBRATION) expect_camera();
  if (may_be_late(message.type)) {
    if (is_far_ahead(t_ns)) return Verdict::held;
  } else {
    Stream& stream = stream_of(message);
    if (t_ns == stream.latest_ns) return Verdict::duplicate;
    if (is_far_ahead(t_ns)) {
      const bool agreed = std::any_of(streams_.begin(), streams_.end(), [&](const Stream& other) {
        const int64_t apart_ns = saturating_difference(t_ns, other.ahead_ns);
        const bool another = other.type != stream.type || other.source != stream.source;  // not a half of the same IMU
        return another && other.ahead > 0 && apart_ns <= parameters_.far_ahead_ns &&
               apart_ns >= -parameters_.far_ahead_ns;
      });
      stream.ahead_ns = t_ns;
      if (++stream.ahead < parameters_.consecutive_ahead && !agreed) return Verdict::implausible;
    }
    for (Stream& any : streams_) any.ahead = 0;  // decided, or contradicted by this one
    if (released_ns_ != INT64_MIN && t_ns < released_ns_) {
      if (const Verdict verdict = classify_late(stream, message); verdict != Verdict::accepted) return verdict;
    } else {
      stream.joined = true;
      for (Stream& any : streams_) any.behind = 0;
    }
  }
  return heap_.size() == capacity_ ? Verdict::full : Verdict::accepted;
}

bool TimeOrder::is_far_ahead(int64_t t_ns) const {
  return newest_ns_ != INT64_MIN && saturating_difference(t_ns, newest_ns_) > parameters_.far_ahead_ns;
}

/// The steady sensors have come to the time of some held messages.
void TimeOrder::admit_held() {
  for (size_t i = 0; i < held_.size();) {
    const bool ahead = is_far_ahead(held_[i].message.header().t_ns);
    if (ahead) ++held_[i].contradictions;
    if (ahead || heap_.size() == capacity_) {
      ++i;
      continue;
    }
    OwnedMessage message = std::move(held_[i].message);
    held_.erase(held_.begin() + static_cast<std::ptrdiff_t>(i));
    add(std::move(message));
  }
}

void TimeOrder::hold(OwnedMessage&& message) {
  if (held_.size() == parameters_.held) held_.front().contradictions = parameters_.contradictions;  // the newest count
  held_.push_back({std::move(message), 0});
}

void TimeOrder::discard(int contradictions, std::vector<OwnedMessage>& discarded) {
  std::erase_if(held_, [&](Held& held) {
    if (held.contradictions < contradictions) return false;
    discarded.push_back(std::move(held.message));
    return true;
  });
}

void TimeOrder::add(OwnedMessage&& message) {
  const odo_header header = message.header();
  if (!may_be_late(header.type)) {
    Stream& stream = stream_of(header);
    stream.latest_ns = std::max(stream.latest_ns, header.t_ns);
    newest_ns_ = std::max(newest_ns_, header.t_ns);
    if (oldest_ns_ == INT64_MIN) oldest_ns_ = header.t_ns;
  }
  if (free_.empty()) {  // memory is touched only when needed
    free_.push_back(static_cast<uint32_t>(slots_.size()));
    slots_.emplace_back();
  }
  const uint32_t slot = free_.back();
  free_.pop_back();
  heap_.push_back({header.t_ns, rank_of(header), slot, sequence_++});
  slots_[slot] = std::move(message);
  std::push_heap(heap_.begin(), heap_.end(), later);
  if (!held_.empty() && !may_be_late(header.type)) admit_held();
}

TimeOrder::Verdict TimeOrder::push(OwnedMessage message) {
  const Verdict verdict = classify(message.header());
  if (verdict == Verdict::accepted) add(std::move(message));
  if (verdict == Verdict::held) hold(std::move(message));
  return verdict;
}

int64_t TimeOrder::watermark() const {
  if (newest_ns_ == INT64_MIN) return INT64_MAX;  // only calibrations so far: nothing to wait for
  // At first the set of sensors is unknown: all get the longest wait to appear.
  const int64_t bound_ns = saturating_difference(newest_ns_, max_wait_ns_);
  if (saturating_difference(newest_ns_, oldest_ns_) < max_wait_ns_ || awaits_camera()) return bound_ns;
  int64_t slowest = INT64_MAX;
  for (const Stream& stream : streams_)
    if (stream.used && stream.latest_ns != INT64_MIN && !silent(stream) && is_waited_for(stream.type))
      slowest = std::min(slowest, stream.latest_ns);
  return std::max(bound_ns, std::min(slowest, newest_ns_));
}

void TimeOrder::take_first(OwnedMessage& out) {
  std::pop_heap(heap_.begin(), heap_.end(), later);
  const Entry entry = heap_.back();
  heap_.pop_back();
  out = std::move(slots_[entry.slot]);
  free_.push_back(entry.slot);
}

int64_t TimeOrder::latest_waiting_ns() const {
  int64_t latest = INT64_MIN;
  for (const Entry& entry : heap_) latest = std::max(latest, entry.t_ns);
  return latest;
}

bool TimeOrder::pop(OwnedMessage& out, int64_t flush_until_ns) {
  if (heap_.empty() || heap_.front().t_ns > std::max(watermark(), flush_until_ns)) return false;
  take_first(out);
  if (!may_be_late(out.header().type)) released_ns_ = std::max(released_ns_, out.header().t_ns);
  return true;
}

void TimeOrder::restart() {
  for (Stream& stream : streams_) stream.latest_ns = INT64_MIN, stream.ahead = stream.behind = 0, stream.joined = false;
  oldest_ns_ = newest_ns_ = released_ns_ = INT64_MIN;
}

bool TimeOrder::drain(OwnedMessage& out) {
  if (heap_.empty() && !held_.empty()) {
    out = std::move(held_.back().message);
    held_.pop_back();
    return true;
  }
  if (heap_.empty()) return false;
  take_first(out);
  return true;
}

}  // namespace odograph
