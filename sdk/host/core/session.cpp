// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/session.hpp"

#include <algorithm>
#include <cstring>

#include "sdk/host/base/saturating.hpp"
#include "sdk/host/config/runs_processes.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph {

Result<std::unique_ptr<Session>> Session::make(PipelineConfig config, std::vector<std::filesystem::path> assets,
                                               bool live, uint64_t seed, AppServices app) {
  std::unique_ptr<Session> session(new Session(std::move(config), std::move(assets), live, seed, app));
  session->hang_watch_ = std::make_unique<HangWatch>(session->host_);
  auto pipeline = Pipeline::make(
      session->config_, {session->host_, session->geodesy_, session->poses_, session->anchors_, session->world_mutex_},
      [raw = session.get()](const odo_header& event) { raw->publish(event); });
  if (!pipeline) {
    Failure failure = pipeline.failure();
    if (session->errors_ > 0) failure.text += std::string("; ") + session->last_error_.message;
    return failure;
  }
  session->pipeline_ = std::move(*pipeline);
  if (session->config_.camera) {
    odo_calibration camera = *session->config_.camera;
    session->take_calibration(camera);
    session->order_.expect_camera();
    session->pipeline_->process(camera.header);
  }
  session->publish_progress();
  if (live) session->thread_ = std::thread([raw = session.get()] { raw->work(); });
  return session;
}

Session::Session(PipelineConfig config, std::vector<std::filesystem::path> assets, bool live, uint64_t seed,
                 AppServices app)
    : config_(std::move(config)),
      live_(live),
      host_(
          seed, std::move(assets), [this](const Report& report) { reported(report); }, app),
      frames_(config_.ordering.frames, runs_processes(config_) ? &host_.shared_pixels() : nullptr),
      order_(config_.ordering.queue, static_cast<int64_t>(config_.ordering.max_wait_s * 1e9)) {
  host_.on_wake([this] { notify(); });
}

Session::~Session() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  work_waiting_.notify_all();
  if (thread_.joinable()) thread_.join();
  OwnedMessage waiting;
  while (order_.drain(waiting)) {
  }
  waiting.release();
  pipeline_.reset();  // before the frame store: plugins may hold frames
}

int32_t Session::push(const odo_header& sample) {
  ++intake_.pushed;
  OwnedMessage message;
  if (const int32_t status = take(sample, message); status < 0) return status;
  const int32_t status = enqueue(std::move(message));
  if (live_) return status;
  Lock lock(mutex_);
  if (owned_ || stopping_)
    return status;  // who owns the pipeline processes this too; within a callback it is this very thread
  const Ownership ownership(*this, lock);
  process_waiting(lock, INT64_MIN);
  return status;
}

/// The sample as a message of the session's own, or why it is refused. What no one knows is taken: a plugin may.
int32_t Session::take(const odo_header& sample, OwnedMessage& out) {
  if (!is_input(sample.type))
    return refuse_invalid(sample, ODO_E_ARGUMENT, "type = " + message_name(sample.type) + "; expected an input");
  AnyMessage copy;
  if (!copy.assign(sample))
    return refuse_invalid(sample, ODO_E_STRUCT_SIZE,
                          "struct_size = " + std::to_string(sample.struct_size) + "; expected " +
                              std::to_string(min_size(sample.type)) + " to " + std::to_string(ODO_LARGEST_MESSAGE));
  copy.header().flags &= ~ODO_FLAG_HOST_MASK;
  copy.header().reserved = 0;
  if (const std::string fault = message_fault(copy.header()); !fault.empty())
    return refuse_invalid(sample, ODO_E_DISCARD, fault);
  if (!gate_.within_range(copy.header())) return refuse_wild(sample, "outside the range of any such sensor");
  return own(std::move(copy), out);
}

int32_t Session::refuse_invalid(const odo_header& sample, int32_t status, const std::string& why) {
  ++intake_.invalid;
  const std::string name = message_name(sample.type);
  host_.report(0, ODO_SEVERITY_WARNING, "invalid_" + name, "dropped a sample of " + name + ": " + why, status);
  return status;
}

int32_t Session::refuse_wild(const odo_header& sample, const char* what) {
  ++intake_.wild;
  const std::string name = message_name(sample.type);
  host_.report(0, ODO_SEVERITY_WARNING, "wild_" + name, "dropped a sample of " + name + ": " + what, ODO_E_DISCARD);
  return ODO_E_DISCARD;
}

int32_t Session::enqueue(OwnedMessage message) {
  std::vector<OwnedMessage> given_up;  // released without the lock
  const odo_header header = message.header();
  TimeOrder::Verdict verdict = TimeOrder::Verdict::accepted;
  int spikes = 0;
  bool wake;
  {
    const std::lock_guard lock(mutex_);
    if (stopping_) return ODO_E_STATE;  // an app that pushes while its last frames are given back
    if (header.type == ODO_TYPE_IMU) {
      odo_imu sample = copy_as<odo_imu>(message.header());
      if (header.struct_size > sizeof sample)  // bits of fields that are cut off go with them
        sample.header.flags &= (2 * ODO_IMU_ACCEL_CORRECTED - 1) | ODO_FLAG_QUALITY;
      spikes = gate_.push(sample, [&](const odo_imu& imu) {
        const auto each = order(OwnedMessage(imu.header), given_up);
        if (each == TimeOrder::Verdict::accepted) poses_.add_imu(imu);
        if (each != TimeOrder::Verdict::accepted) verdict = each;
      });
    } else {
      verdict = order(std::move(message), given_up);
    }
    wake = work_is_waiting();
  }
  if (wake && live_) work_waiting_.notify_one();
  if (spikes > 0) refuse_wild(header, "the one before it sticks out from both its neighbours");
  return verdict == TimeOrder::Verdict::accepted ? ODO_OK : note_verdict(verdict, header);
}

/// Under the lock. What is not accepted goes to `given_up`.
TimeOrder::Verdict Session::order(OwnedMessage message, std::vector<OwnedMessage>& given_up) {
  TimeOrder::Verdict verdict = order_.push(std::move(message));
  if (verdict == TimeOrder::Verdict::restarted) {
    restart_clock(given_up);
    verdict = order_.push(std::move(message));
  }
  if (ODO_IS_BORROWED(message.header().type)) given_up.push_back(std::move(message));
  return verdict;
}

int32_t Session::note_verdict(TimeOrder::Verdict verdict, const odo_header& sample) {
  const char* why = nullptr;
  switch (verdict) {
    case TimeOrder::Verdict::late: ++intake_.late, why = "came after its time had been processed"; break;
    case TimeOrder::Verdict::duplicate: ++intake_.duplicate, why = "same sensor and time as the one before"; break;
    case TimeOrder::Verdict::full: ++intake_.overflow, why = "the queue is full"; break;
    default: ++intake_.invalid, why = "its time is far ahead of all others";
  }
  const std::string name = message_name(sample.type);
  host_.report(0, ODO_SEVERITY_WARNING, "dropped_" + name, "a sample of " + name + " was dropped: " + why,
               ODO_E_DISCARD);
  const std::lock_guard lock(error_mutex_);
  ++errors_;
  last_error_.status = verdict == TimeOrder::Verdict::full ? ODO_E_EXHAUSTED : ODO_E_DISCARD;
  std::snprintf(last_error_.message, sizeof last_error_.message, "a sample of %s was dropped: %s", name.c_str(), why);
  return last_error_.status;
}

/// Under the lock. What waits is of the old clock, but for what describes the sensors.
void Session::restart_clock(std::vector<OwnedMessage>& given_up) {
  std::vector<OwnedMessage> descriptions;
  OwnedMessage message;
  while (order_.drain(message)) {
    const uint32_t type = message.header().type;
    const bool describes = type == ODO_TYPE_CALIBRATION || type == ODO_TYPE_IMU_NOISE;
    (describes ? descriptions : given_up).push_back(std::move(message));
  }
  order_.restart();
  gate_.reset();
  poses_.clear();
  for (OwnedMessage& description : descriptions) order_.push(std::move(description));
  restart_pending_ = true;
}

bool Session::work_is_waiting() const {
  return restart_pending_ || flushes_asked_ != flushes_done_ || order_.ready() || report_is_waiting() ||
         host_.has_woken();
}

/// Waits for the pipeline; only for threads that do not own it.
void Session::acquire(Lock& lock) {
  owner_changed_.wait(lock, [this] { return !owned_; });
  owned_ = true;
  owner_ = std::this_thread::get_id();
}

/// Under the lock.
void Session::release_ownership() {
  owned_ = false;
  owner_changed_.notify_all();
}

/// With ownership and the lock, which is given up while anything is called. What is pushed meanwhile is not flushed.
void Session::process_waiting(Lock& lock, int64_t flush_until_ns) {
  bool woken = false;  // once: a plugin may ask again each time
  for (;;) {
    OwnedMessage message;
    if (std::exchange(restart_pending_, false)) {
      lock.unlock();
      host_.report(0, ODO_SEVERITY_WARNING, "clock_restart", "the sensor clock was set back; starting anew");
      pipeline_->reset();
    } else if (order_.pop(message, flush_until_ns)) {
      lock.unlock();
      intake_.newest_ns = std::max<int64_t>(intake_.newest_ns, message.header().t_ns);
      pipeline_->process(message.header());
      message.release();
      ++intake_.processed;
    } else if (report_is_waiting()) {
      lock.unlock();
      publish_reports();
    } else if (!woken && host_.has_woken()) {
      woken = true;
      lock.unlock();
      pipeline_->wake();
    } else {
      return;
    }
    publish_progress();
    lock.lock();
  }
}

void Session::publish_progress() {
  progress_.write({pipeline_->counters(), pipeline_->gaps(), pipeline_->plugin_faults(), pipeline_->distance_m(),
                   pipeline_->scale_knowledge()});
}

void Session::work() {
  Lock lock(mutex_);
  for (;;) {
    work_waiting_.wait(lock, [this] { return stopping_ || work_is_waiting(); });
    if (stopping_) return;
    const Ownership ownership(*this, lock);
    const uint64_t asked = flushes_asked_;
    process_waiting(lock, asked != flushes_done_ ? order_.latest_waiting_ns() : INT64_MIN);
    flushes_done_ = asked;
  }
}

int32_t Session::flush() {
  Lock lock(mutex_);
  if (is_owner()) return ODO_E_STATE;
  if (live_) {
    const uint64_t mine = ++flushes_asked_;
    work_waiting_.notify_one();
    owner_changed_.wait(lock, [&] { return flushes_done_ >= mine; });
    return ODO_OK;
  }
  const Ownership ownership(*this, lock);
  process_waiting(lock, order_.latest_waiting_ns());
  return ODO_OK;
}

void Session::publish(const odo_header& event) {
  if (!has_callback_.load(std::memory_order_relaxed)) return;
  odo_callback callback;
  void* user;
  {
    const std::lock_guard lock(mutex_);
    if (!callback_ || !callback_types_.has(event.type)) return;
    callback = callback_, user = callback_user_;
    callback_runs_ = true;
    callback_thread_ = std::this_thread::get_id();
  }
  callback(user, &event);
  {
    const std::lock_guard lock(mutex_);
    callback_runs_ = false;
  }
  owner_changed_.notify_all();
}

void Session::set_callback(TypeSet types, odo_callback callback, void* user) {
  Lock lock(mutex_);
  callback_ = types.empty() ? nullptr : callback;
  callback_user_ = user;
  callback_types_ = std::move(types);
  has_callback_ = callback_ != nullptr;
  if (live_) work_waiting_.notify_one();  // what has been reported before
  owner_changed_.wait(lock, [this] { return !callback_runs_ || callback_thread_ == std::this_thread::get_id(); });
}

void Session::statistics(odo_statistics& out) const {
  const Progress progress = progress_.read();
  const Pipeline::Counters& counters = progress.counters;
  odo_statistics now{};
  now.pushed = intake_.pushed;
  now.processed = intake_.processed;
  now.frames = counters.frames;
  now.steps = counters.steps;
  now.fixes_accepted = counters.fixes_accepted;
  now.fixes_rejected = counters.fixes_rejected;
  now.late = intake_.late;
  now.duplicate = intake_.duplicate;
  now.invalid = intake_.invalid;
  now.overflow = intake_.overflow;
  now.gaps = progress.gaps;
  now.plugin_faults = progress.plugin_faults;
  now.tracking_s = counters.state_s[ODO_TRACKING];
  now.degraded_s = counters.state_s[ODO_DEGRADED];
  now.lost_s = counters.state_s[ODO_LOST];
  now.distance_m = progress.distance_m;
  now.wild = intake_.wild;
  now.events_dropped = counters.events_dropped;
  now.unknown = counters.unknown;
  now.scale_sigma = progress.scale.sigma;
  now.scale_by_inertia = progress.scale.by_inertia;
  now.scale_by_steps = progress.scale.by_steps;
  const uint32_t size = std::min<uint32_t>(out.struct_size, sizeof now);
  now.struct_size = size;
  std::memcpy(&out, &now, size);
}

}  // namespace odograph
