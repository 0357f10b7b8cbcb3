// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/session.hpp"

#include <algorithm>
#include <cstring>

#include "sdk/host/config/runs_processes.hpp"
#include "sdk/host/platform/features.hpp"
#include "sdk/host/platform/process.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph {

Result<std::unique_ptr<Session>> Session::make(PipelineConfig config, std::vector<std::filesystem::path> assets,
                                               bool live, uint64_t seed, AppServices app) {
  if (live && !kPlatform.threads)
    return Failure{ODO_E_UNSUPPORTED,
                   std::string("run = ODO_RUN_LIVE: this program's platform (") + kPlatform.name +
                       ") has no threads; expected ODO_RUN_REPLAY, in which all processing runs within push"};
  std::unique_ptr<Session> made(new Session(std::move(config), std::move(assets), live, seed, app));
  Session& self = *made;
  WorldView& world = self.world_;
  if (kPlatform.threads) self.call_watchdog_ = std::make_unique<CallWatchdog>(self.host_);
  auto pipeline = Pipeline::make(
      self.config_,
      {self.host_, self.checks_, world.geodesy(), world.poses(), world.anchors(), world.scene(), world.mutex()},
      [&self](const odo_header& event) { self.outbox_.publish(event); });
  if (!pipeline) {
    Failure failure = pipeline.failure();
    if (const Failure last = self.outbox_.take_last_error(); last.status != ODO_OK) failure.text += "; " + last.text;
    return failure;
  }
  self.pipeline_ = std::move(*pipeline);
  if (self.config_.camera) {
    odo_calibration camera = *self.config_.camera;
    self.cameras_.take_calibration(camera);
    self.pipeline_->process(camera.header);
  }
  self.publish_progress();
  if (!live) return made;
  self.host_.set_pace(HostServices::Pace::live);
  self.thread_ = std::thread([&self] { self.work(); });
  return made;
}

Session::Session(PipelineConfig config, std::vector<std::filesystem::path> assets, bool live, uint64_t seed,
                 AppServices app)
    : config_(std::move(config)),
      live_(live),
      process_(this_process()),
      host_(
          seed, std::move(assets), [this](const Report& report) { outbox_.add(report), notify(); }, app),
      cameras_(config_.camera),
      checks_(host_),
      world_(
          cameras_, [this] { return pipeline_->camera(); },
          static_cast<int64_t>(std::max(config_.ordering.max_gap_s, config_.ordering.max_wait_s) * 1e9),
          config_.walker_height_m.value_or(0)),
      intake_(config_, runs_processes(config_) ? &host_.shared_pixels() : nullptr, cameras_, checks_, world_.poses(),
              host_, outbox_, mutex_) {
  host_.set_live(live);
  host_.on_wake([this] { notify(); });
}

bool Session::is_forked_child() const { return live_ && this_process() != process_; }

Session::~Session() {
  host_.set_pace(HostServices::Pace::ending);
  intake_.close();  // the app may push while its last frames are returned
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  work_waiting_.notify_all();
  if (thread_.joinable()) thread_.join();
  while (intake_.drop_one()) {
  }
  pipeline_.reset();  // before the frame store: plugins may hold frames
}

int32_t Session::push(const odo_header& sample) {
  OwnedMessage message;
  if (const int32_t refused = intake_.take(sample, message); refused < 0) return refused;
  Lock lock;
  const int32_t status = intake_.add(std::move(message), lock);
  if (live_ && work_is_waiting()) work_waiting_.notify_one();
  if (live_ || owned_ || stopping_)
    return status;  // the owner of the pipeline processes this too; within a callback that is this thread
  const Ownership ownership(*this, lock);
  process_waiting(lock, INT64_MIN);
  return status;
}

/// Waits for the pipeline; only for threads that do not own it.
Session::Ownership::Ownership(Session& session, Lock& lock) : session_(session), lock_(lock) {
  session_.owner_changed_.wait(lock_, [this] { return !session_.owned_; });
  session_.owned_ = true;
  session_.owner_ = std::this_thread::get_id();
}

Session::Ownership::~Ownership() {
  if (!lock_.owns_lock()) lock_.lock();
  session_.owned_ = false;
  session_.owner_changed_.notify_all();
}

/// Requires the lock.
bool Session::work_is_waiting() const {
  return intake_.ready() || flushes_requested_ != flushes_done_ || outbox_.report_is_waiting() || host_.has_woken();
}

/// Requires ownership and the lock, which is released during every call. Samples pushed meanwhile are not flushed. When
/// the session ends, only reports are left to publish, such as that of the call that it waited for.
void Session::process_waiting(Lock& lock, int64_t flush_until_ns) {
  bool woken = false;  // only once: a plugin may ask again each time
  for (;;) {
    OwnedMessage message;
    const Intake::Next next = stopping_ ? Intake::Next::nothing : intake_.next(message, flush_until_ns);
    if (next == Intake::Next::restart) {
      lock.unlock();
      host_.report(0, ODO_SEVERITY_WARNING, "clock_restart", "the sensor clock was set back; restarting");
      pipeline_->reset();
    } else if (next == Intake::Next::sample) {
      lock.unlock();
      newest_ns_ = std::max(newest_ns_, message.header().t_ns);
      pipeline_->process(message.header());
      world_.poses().set_processed(message.header().t_ns);
      message.release();
      ++processed_;
    } else if (outbox_.report_is_waiting()) {
      lock.unlock();
      outbox_.publish_reports(newest_ns_);
    } else if (!woken && !stopping_ && host_.has_woken()) {
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
  const Pipeline::Counters& counters = pipeline_->counters();
  const ScaleKnowledge scale = pipeline_->scale_knowledge();
  odo_statistics now{};
  now.processed = processed_;
  now.frames = counters.frames;
  now.steps = counters.steps;
  now.fixes_accepted = counters.fixes_accepted;
  now.fixes_rejected = counters.fixes_rejected;
  now.gaps = pipeline_->gaps();
  now.plugin_faults = pipeline_->plugin_faults();
  now.tracking_s = pipeline_->state_s(ODO_TRACKING);
  now.degraded_s = pipeline_->state_s(ODO_DEGRADED);
  now.lost_s = pipeline_->state_s(ODO_LOST);
  now.distance_m = pipeline_->distance_m();
  now.events_dropped = counters.events_dropped;
  now.unknown = counters.unknown;
  now.scale_sigma = scale.sigma;
  now.scale_by_inertia = scale.by_inertia;
  now.scale_by_steps = scale.by_steps;
  progress_.write(now);
}

odo_statistics Session::statistics() const {
  odo_statistics now = progress_.read();
  const Intake::Counts& counts = intake_.counts();
  now.pushed = counts.pushed;
  now.late = counts.late;
  now.duplicate = counts.duplicate;
  now.invalid = counts.invalid;
  now.overflow = counts.overflow;
  now.wild = counts.wild;
  return now;
}

void Session::work() {
  Lock lock(mutex_);
  for (bool stopping = false; !stopping;) {
    work_waiting_.wait(lock, [this] { return stopping_ || work_is_waiting(); });
    stopping = stopping_;
    const Ownership ownership(*this, lock);
    const uint64_t asked = flushes_requested_;
    process_waiting(lock, asked != flushes_done_ ? intake_.latest_waiting_ns() : INT64_MIN);
    flushes_done_ = asked;
  }
}

/// Wakes the session's thread, if it has one.
void Session::notify() {
  if (!live_) return;
  const std::lock_guard lock(mutex_);  // so that the thread does not miss it
  work_waiting_.notify_one();
}

int32_t Session::flush() {
  Lock lock(mutex_);
  if (is_owner() || is_forked_child()) return ODO_E_STATE;
  if (live_) {
    const uint64_t mine = ++flushes_requested_;
    work_waiting_.notify_one();
    owner_changed_.wait(lock, [&] { return flushes_done_ >= mine; });
    return ODO_OK;
  }
  const Ownership ownership(*this, lock);
  process_waiting(lock, intake_.latest_waiting_ns());
  lock.unlock();
  intake_.end();  // a live session may go on after a flush
  return ODO_OK;
}

void Session::set_callback(TypeSet types, odo_callback callback, void* user) {
  outbox_.set_callback(std::move(types), callback, user);
  notify();  // for reports made before
}

/// Runs on the caller's thread, between two messages.
template <class Use>
auto Session::between_messages(Use&& use) -> decltype(use()) {
  Lock lock(mutex_);
  if (is_owner()) return decltype(use()){ODO_E_STATE};
  const Ownership ownership(*this, lock);
  lock.unlock();
  return use();
}

int64_t Session::save(void* data, uint64_t capacity) {
  return between_messages([&] { return written(pipeline_->save(), data, capacity); });
}

int32_t Session::load(const void* data, uint64_t size) {
  return between_messages([&] {
    return reported("load", pipeline_->load({static_cast<const uint8_t*>(data), static_cast<size_t>(size)}));
  });
}

int64_t Session::save_maps(void* data, uint64_t capacity) {
  return between_messages([&] { return written(pipeline_->save_maps(), data, capacity); });
}

int32_t Session::load_maps(const void* data, uint64_t size) {
  return between_messages([&] {
    return reported("map", pipeline_->load_maps({static_cast<const uint8_t*>(data), static_cast<size_t>(size)}));
  });
}

int64_t Session::written(const std::vector<uint8_t>& blob, void* data, uint64_t capacity) {
  if (data && !blob.empty() && blob.size() <= capacity) std::memcpy(data, blob.data(), blob.size());
  return static_cast<int64_t>(blob.size());
}

int32_t Session::reported(const char* key, const Result<bool>& loaded) {
  if (loaded) return ODO_OK;
  host_.report(0, ODO_SEVERITY_WARNING, key, loaded.failure().text);
  return loaded.failure().status;
}

}  // namespace odograph
