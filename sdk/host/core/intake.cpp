// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/intake.hpp"

#include <cmath>
#include <cstdio>
#include <utility>

#include "sdk/host/base/saturating.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

Intake::Intake(const PipelineConfig& config, SharedPixels* shared, CameraTable& cameras, InputChecks& checks,
               PoseStream& poses, HostServices& host, Outbox& outbox, std::mutex& mutex)
    : cameras_(cameras),
      checks_(checks),
      poses_(poses),
      host_(host),
      outbox_(outbox),
      frames_(config.ordering.frames, shared),
      mutex_(mutex),
      order_(config.ordering.queue, static_cast<int64_t>(config.ordering.max_wait_s * 1e9)) {
  if (config.camera) order_.expect_camera();
  for (auto& source : sources_) source = -1;
}

/// Of several gyroscopes, accelerometers, magnetometers or barometers, the first that delivers is used.
bool Intake::is_first_source(const odo_header& sample) {
  const bool imu = sample.type == ODO_TYPE_IMU;
  const std::array<bool, 4> of = {imu && (sample.flags & ODO_IMU_GYRO), imu && (sample.flags & ODO_IMU_ACCEL),
                                  sample.type == ODO_TYPE_MAGNETOMETER, sample.type == ODO_TYPE_BAROMETER};
  for (size_t i = 0; i < of.size(); ++i) {
    int64_t none = -1;
    if (of[i]) sources_[i].compare_exchange_strong(none, sample.source);
    if (of[i] && sources_[i] != sample.source) return false;
  }
  return true;
}

int32_t Intake::take(const odo_header& sample, OwnedMessage& out) {
  ++counts_.pushed;
  try {
    const int32_t status = check(sample, out);
    if (status < 0) out.disown();  // its loan is still the app's
    return status;
  } catch (...) {
    out.disown();
    throw;
  }
}

int32_t Intake::check(const odo_header& sample, OwnedMessage& copy) {
  if (!is_input(sample.type))
    return refuse_invalid(sample, ODO_E_ARGUMENT, "type = " + message_name(sample.type) + "; expected an input");
  if (!copy.assign(sample))
    return refuse_invalid(sample, ODO_E_STRUCT_SIZE,
                          "struct_size = " + std::to_string(sample.struct_size) + "; expected " +
                              std::to_string(min_size(sample.type)) + " to " + std::to_string(ODO_LARGEST_MESSAGE));
  copy.header().flags &= ~ODO_FLAG_HOST_MASK;
  copy.header().reserved = 0;
  if (const std::string fault = message_fault(copy.header()); !fault.empty())
    return refuse_invalid(sample, ODO_E_DISCARD, fault);
  if (const std::string fault = gate_.range_fault(copy.header()); !fault.empty())
    return refuse(counts_.wild, "wild_", sample, ODO_E_DISCARD, fault);
  if (!is_first_source(sample))
    return refuse_invalid(sample, ODO_E_UNSUPPORTED,
                          "source = " + std::to_string(sample.source) + "; expected that of the first such sensor");
  if (sample.type == ODO_TYPE_CALIBRATION) cameras_.take_calibration(reinterpret_cast<odo_calibration&>(copy.header()));
  if (sample.type == ODO_TYPE_FRAME)
    if (const std::string fault = cameras_.complete(reinterpret_cast<odo_frame&>(copy.header())); !fault.empty())
      return refuse_invalid(sample, ODO_E_DISCARD, fault);
  if (ODO_IS_BORROWED(sample.type))
    if (const int32_t status = borrow(reinterpret_cast<odo_borrowed&>(copy.header())); status < 0) return status;
  return ODO_OK;
}

int32_t Intake::borrow(odo_borrowed& message) {
  const int32_t status = frames_.adopt(message);
  if (status >= 0) return status;
  if (status == ODO_E_DISCARD)
    return refuse_invalid(message.header, status, "a plane's row_stride is smaller than its row");
  if (status == ODO_E_UNSUPPORTED)
    return refuse_invalid(message.header, status, "it cannot be copied and has no retain and release");
  return refuse(counts_.overflow, "dropped_", message.header, status,
                "all retainable messages are still in use: they arrive faster than they are processed, or its retain "
                "refused");
}

int32_t Intake::add(OwnedMessage&& message, Lock& lock) {
  const odo_header header = message.header();
  checks_.on_push(message.header());
  std::vector<OwnedMessage> dropped, discarded;
  TimeOrder::Verdict verdict = TimeOrder::Verdict::accepted;
  int spikes = 0;
  bool passes = true;
  lock = Lock(mutex_);
  if (closed_) return ODO_E_STATE;
  const int64_t newest_ns = order_.newest_ns();
  if (header.type == ODO_TYPE_IMU) {
    auto& imu = reinterpret_cast<odo_imu&>(message.header());
    if (header.struct_size > sizeof imu)  // flags of fields beyond the host's struct are cleared with them
      imu.header.flags &= (2 * ODO_IMU_ACCEL_CORRECTED - 1) | ODO_FLAG_QUALITY;
    imu.header.struct_size = sizeof imu;
    passes = false;
    spikes = gate_.push(imu, [&](const odo_imu& passed) {
      if (&passed == &imu)
        passes = true;
      else
        verdict = order(OwnedMessage(passed.header), dropped);
    });
  }
  if (passes)
    if (const auto own = order(std::move(message), dropped); own != TimeOrder::Verdict::accepted) verdict = own;
  order_.discard_contradicted(discarded);
  if (dropped.empty() && discarded.empty() && spikes == 0 && verdict == TimeOrder::Verdict::accepted) return ODO_OK;
  lock.unlock();
  for (const OwnedMessage& held : discarded)
    refuse_unordered(held.header(), TimeOrder::Verdict::implausible, newest_ns);
  if (spikes > 0)
    refuse(counts_.wild, "wild_", header, ODO_E_DISCARD,
           "the previous sample is a spike: it differs from both its neighbours");
  const int32_t status =
      verdict == TimeOrder::Verdict::accepted ? ODO_OK : refuse_unordered(header, verdict, newest_ns);
  dropped.clear(), discarded.clear();
  lock.lock();
  return status;
}

/// Requires the lock. Rejected messages are released without it.
TimeOrder::Verdict Intake::order(OwnedMessage&& message, std::vector<OwnedMessage>& dropped) {
  auto verdict = order_.classify(message.header());
  if (verdict == TimeOrder::Verdict::restarted) {
    restart(dropped);
    verdict = order_.classify(message.header());
  }
  if (verdict == TimeOrder::Verdict::accepted)
    accept(std::move(message));
  else if (verdict == TimeOrder::Verdict::held)
    order_.hold(std::move(message)), verdict = TimeOrder::Verdict::accepted;
  else
    dropped.push_back(std::move(message));
  return verdict;
}

/// Requires the lock.
void Intake::accept(OwnedMessage&& message) {
  poses_.set_pushed(message.header().t_ns);
  if (message.header().type == ODO_TYPE_IMU) poses_.add_imu(as<odo_imu>(message.header()));
  order_.add(std::move(message));
}

/// Requires the lock. Waiting messages are of the old clock and are dropped, except sensor descriptions.
void Intake::restart(std::vector<OwnedMessage>& dropped) {
  std::vector<OwnedMessage> descriptions;
  OwnedMessage message;
  while (order_.drain(message)) {
    (is_description(message.header()) ? descriptions : dropped).push_back(std::move(message));
  }
  order_.restart();
  gate_.reset();
  poses_.clear();
  for (OwnedMessage& description : descriptions) order_.push(std::move(description));
  restarted_ = true;
}

Intake::Next Intake::next(OwnedMessage& out, int64_t flush_until_ns) {
  if (std::exchange(restarted_, false)) return Next::restart;
  return order_.pop(out, flush_until_ns) ? Next::sample : Next::nothing;
}

void Intake::end() {
  std::vector<OwnedMessage> discarded;
  int64_t newest_ns = INT64_MIN;
  {
    const std::lock_guard lock(mutex_);
    newest_ns = order_.newest_ns();
    order_.discard_held(discarded);
  }
  for (const OwnedMessage& held : discarded)
    refuse_unordered(held.header(), TimeOrder::Verdict::implausible, newest_ns);
}

void Intake::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
}

bool Intake::drop_one() {
  OwnedMessage waiting;  // released without the lock
  const std::lock_guard lock(mutex_);
  return order_.drain(waiting);
}

/// Stores the newest refusal as the last error even if it is not reported: each kind is reported at most once a second.
int32_t Intake::refuse(std::atomic<uint64_t>& count, const char* key, const odo_header& sample, int32_t status,
                       const std::string& why) {
  ++count;
  const std::string name = message_name(sample.type);
  const std::string text = "dropped a sample of " + name + ": " + why;
  host_.report(0, ODO_SEVERITY_WARNING, key + name, text, status);
  outbox_.set_last_error({status, "host: " + text});
  return status;
}

int32_t Intake::refuse_unordered(const odo_header& sample, TimeOrder::Verdict verdict, int64_t newest_ns) {
  using Verdict = TimeOrder::Verdict;
  auto [count, why] =
      verdict == Verdict::late ? std::pair(&counts_.late, std::string("arrived after its time had been processed"))
      : verdict == Verdict::duplicate
          ? std::pair(&counts_.duplicate, std::string("same sensor and time as the previous one"))
      : verdict == Verdict::full ? std::pair(&counts_.overflow, std::string("the queue is full"))
                                 : std::pair(&counts_.invalid, std::string("its time is far ahead of all others"));
  const double ahead_s = seconds(saturating_difference(sample.t_ns, newest_ns));
  const bool far = std::abs(ahead_s) > seconds(TimeOrder::Parameters().far_ahead_ns);
  if (newest_ns != INT64_MIN && far && (verdict == Verdict::late || verdict == Verdict::implausible)) {
    char text[128];
    std::snprintf(text, sizeof text, ": %.6g s %s the steady sensors'; expected times of the IMU's clock",
                  std::abs(ahead_s), ahead_s > 0 ? "after" : "before");
    why += text;
  }
  return refuse(*count, "dropped_", sample, verdict == Verdict::full ? ODO_E_EXHAUSTED : ODO_E_DISCARD, why);
}

}  // namespace odograph
