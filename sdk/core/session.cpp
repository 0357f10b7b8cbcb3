// SPDX-License-Identifier: Apache-2.0
#include "sdk/core/session.hpp"

#include <algorithm>
#include <cstring>

namespace odograph {

Result<std::unique_ptr<Session>> Session::make(PipelineConfig config, std::vector<std::filesystem::path> assets,
                                               bool live, uint64_t seed) {
  std::unique_ptr<Session> session(new Session(std::move(config), std::move(assets), live, seed));
  auto pipeline = Pipeline::make(session->config_, session->host_, session->geodesy_,
                                 [raw = session.get()](const odo_header& event) { raw->publish(event); });
  if (!pipeline) {
    Failure failure = pipeline.failure();
    if (session->errors_ > 0) failure.text += std::string("; ") + session->last_error_.message;
    return failure;
  }
  session->pipeline_ = std::move(*pipeline);
  if (const auto& camera = session->config_.camera) {
    session->note_timing(*camera);
    session->pipeline_->process(camera->header);
  }
  if (live) session->thread_ = std::thread([raw = session.get()] { raw->work(); });
  return session;
}

Session::Session(PipelineConfig config, std::vector<std::filesystem::path> assets, bool live, uint64_t seed)
    : config_(std::move(config)),
      live_(live),
      host_(seed, std::move(assets), [this](const Report& report) { reported(report); }),
      frames_(config_.ordering.frames),
      order_(config_.ordering.queue, static_cast<int64_t>(config_.ordering.max_wait_s * 1e9)) {
  statistics_.struct_size = sizeof statistics_;
}

Session::~Session() {
  if (thread_.joinable()) {
    {
      const std::lock_guard lock(queue_mutex_);
      stopping_ = true;
    }
    queue_changed_.notify_all();
    thread_.join();
  }
  AnyMessage message;
  while (order_.drain(message))
    if (message.header().type == ODO_TYPE_FRAME)
      as<odo_frame>(message.header()).release(&as<odo_frame>(message.header()));
  pipeline_.reset();  // before the frame store: plugins may hold frames
}

int32_t Session::check(const odo_header& sample) {
  const MessageInfo* info = message_info(sample.type);
  if (!info || !info->is_input) return ODO_E_UNSUPPORTED;
  if (sample.struct_size < info->size) return ODO_E_STRUCT_SIZE;
  return message_is_finite(sample) ? ODO_OK : ODO_E_DISCARD;
}

int32_t Session::push(const odo_header& sample) {
  int32_t status = check(sample);
  {
    const std::lock_guard lock(answers_mutex_);
    ++statistics_.pushed;
    if (status < 0) ++statistics_.invalid;
  }
  if (status < 0) {
    const MessageInfo* info = message_info(sample.type);
    host_.report(0, ODO_SEVERITY_WARNING, std::string("invalid_") + (info ? info->name : "message"),
                 std::string("dropped a sample of ") + (info ? info->name : "unknown type") +
                     (status == ODO_E_STRUCT_SIZE   ? ": its struct is too small"
                      : status == ODO_E_UNSUPPORTED ? ": not an input"
                                                    : ": a number is not finite or out of its range"));
    return status;
  }
  if (sample.type == ODO_TYPE_FRAME) {
    odo_frame held;
    status = frames_.adopt(as<odo_frame>(sample), held);
    if (status < 0) {
      const std::lock_guard lock(answers_mutex_);
      ++(status == ODO_E_EXHAUSTED ? statistics_.overflow : statistics_.invalid);
      return status;
    }
    put_timing(held);
    status = enqueue(held.header);
    if (status < 0) held.release(&held);
  } else {
    if (sample.type == ODO_TYPE_CALIBRATION) {
      const odo_calibration calibration = with_own(as<odo_calibration>(sample));
      note_timing(calibration);
      status = enqueue(calibration.header);
    } else {
      status = enqueue(sample);
    }
  }
  if (live_)
    queue_changed_.notify_one();
  else
    process_ready(false);
  return status;
}

/// The config's camera stands above what is pushed; mount, time offset and row time only where the config has them.
odo_calibration Session::with_own(const odo_calibration& pushed) const {
  if (!config_.camera || config_.camera->id != pushed.id) return pushed;
  odo_calibration own = *config_.camera;
  own.header.t_ns = pushed.header.t_ns;
  own.header.source = pushed.header.source;
  if (!(own.header.flags & ODO_CALIBRATION_EXTRINSICS)) {
    std::memcpy(own.q_b_c, pushed.q_b_c, sizeof own.q_b_c);
    std::memcpy(own.p_b_c, pushed.p_b_c, sizeof own.p_b_c);
    own.header.flags |= pushed.header.flags & ODO_CALIBRATION_EXTRINSICS;
  }
  if (!(own.header.flags & ODO_CALIBRATION_TIME_OFFSET)) {
    own.time_offset_ns = pushed.time_offset_ns;
    own.header.flags |= pushed.header.flags & ODO_CALIBRATION_TIME_OFFSET;
  }
  if (!(own.header.flags & ODO_CALIBRATION_LINE_TIME)) {
    own.line_time_ns = pushed.line_time_ns;
    own.header.flags |= pushed.header.flags & ODO_CALIBRATION_LINE_TIME;
  }
  return own;
}

void Session::note_timing(const odo_calibration& calibration) {
  const std::lock_guard lock(queue_mutex_);
  const uint32_t flags = calibration.header.flags;
  const auto& own = config_.camera;
  camera_timing_[calibration.id] = {
      .offset_ns = flags & ODO_CALIBRATION_TIME_OFFSET ? calibration.time_offset_ns : 0,
      .line_time_ns = calibration.line_time_ns,
      .line_time = (flags & ODO_CALIBRATION_LINE_TIME) != 0,
      .above_frames = own && own->id == calibration.id && (own->header.flags & ODO_CALIBRATION_LINE_TIME) != 0};
}

/// From here on everything runs on the IMU's clock: a camera's frames are shifted as they come in. A frame that does
/// not tell its row time gets the calibration's.
void Session::put_timing(odo_frame& frame) {
  const std::lock_guard lock(queue_mutex_);
  const auto found = camera_timing_.find(frame.calibration);
  if (found == camera_timing_.end()) return;
  const CameraTiming& timing = found->second;
  frame.header.t_ns += timing.offset_ns;
  if (!timing.line_time || (!timing.above_frames && (frame.header.flags & ODO_FRAME_LINE_TIME))) return;
  frame.line_time_ns = timing.line_time_ns;
  frame.header.flags |= ODO_FRAME_LINE_TIME;
}

int32_t Session::enqueue(const odo_header& sample) {
  TimeOrder::Verdict verdict;
  {
    const std::lock_guard lock(queue_mutex_);
    verdict = order_.push(sample);
    if (verdict == TimeOrder::Verdict::restarted) {
      restart_clock();
      verdict = order_.push(sample);
    }
  }
  if (verdict == TimeOrder::Verdict::accepted) return ODO_OK;
  const char* name = message_info(sample.type)->name;
  const std::lock_guard lock(answers_mutex_);
  switch (verdict) {
    case TimeOrder::Verdict::late: ++statistics_.late; break;
    case TimeOrder::Verdict::duplicate: ++statistics_.duplicate; break;
    case TimeOrder::Verdict::full: ++statistics_.overflow; break;
    default: ++statistics_.invalid;
  }
  ++errors_;
  last_error_.status = verdict == TimeOrder::Verdict::full ? ODO_E_EXHAUSTED : ODO_E_DISCARD;
  const char* why = verdict == TimeOrder::Verdict::late        ? "dropped: came after its time had been processed"
                    : verdict == TimeOrder::Verdict::duplicate ? "dropped: same sensor and time as the one before"
                    : verdict == TimeOrder::Verdict::full      ? "dropped: the queue is full"
                                                               : "dropped: its time is far ahead of all others";
  std::snprintf(last_error_.message, sizeof last_error_.message, "a sample of %s was %s", name, why);
  return last_error_.status;
}

void Session::restart_clock() {
  AnyMessage message;
  while (order_.drain(message))
    if (message.header().type == ODO_TYPE_FRAME)
      as<odo_frame>(message.header()).release(&as<odo_frame>(message.header()));
  order_.restart();
  restart_pending_ = true;
}

void Session::process_ready(bool flush) {
  const std::lock_guard work(work_mutex_);
  AnyMessage message;
  for (;;) {
    {
      const std::lock_guard queue(queue_mutex_);
      if (std::exchange(restart_pending_, false)) {
        host_.report(0, ODO_SEVERITY_WARNING, "clock_restart", "the sensor clock was set back; starting anew");
        pipeline_->reset();
      }
      if (!order_.pop(message, flush)) break;
    }
    pipeline_->process(message.header());
    if (message.header().type == ODO_TYPE_FRAME)
      as<odo_frame>(message.header()).release(&as<odo_frame>(message.header()));
    const std::lock_guard answers(answers_mutex_);
    ++statistics_.processed;
  }
}

void Session::work() {
  for (;;) {
    process_ready(false);
    std::unique_lock lock(queue_mutex_);
    if (stopping_) return;
    // Woken by push; the time-out only covers a push between the two locks.
    queue_changed_.wait_for(lock, std::chrono::milliseconds(5));
  }
}

int32_t Session::flush() {
  process_ready(true);
  return ODO_OK;
}

void Session::publish(const odo_header& event) {
  if ((callback_mask_.load(std::memory_order_relaxed) >> event.type & 1) && callback_)
    callback_(callback_user_, &event);
}

int32_t Session::pose(int64_t t_ns, odo_pose& out) const { return pipeline_->pose_at(t_ns, out); }

void Session::set_callback(uint32_t mask, odo_callback callback, void* user) {
  const std::lock_guard lock(work_mutex_);
  callback_ = callback;
  callback_user_ = user;
  callback_mask_ = callback ? mask : 0;
}

void Session::statistics(odo_statistics& out) const {
  odo_statistics now;
  {
    const std::lock_guard work(work_mutex_);
    const std::lock_guard answers(answers_mutex_);
    now = statistics_;
    const auto& counters = pipeline_->counters();
    now.frames = counters.frames;
    now.steps = counters.steps;
    now.fixes_accepted = counters.fixes_accepted;
    now.fixes_rejected = counters.fixes_rejected;
    now.gaps = pipeline_->gaps();
    now.plugin_faults = pipeline_->plugin_faults();
    now.tracking_s = counters.state_s[ODO_TRACKING];
    now.degraded_s = counters.state_s[ODO_DEGRADED];
    now.lost_s = counters.state_s[ODO_LOST];
    now.distance_m = pipeline_->distance_m();
  }
  const uint32_t size = std::min<uint32_t>(out.struct_size, sizeof now);
  now.struct_size = size;
  std::memcpy(&out, &now, size);
}

void Session::reported(const Report& report) {
  HostServices::Listener listener;
  {
    const std::lock_guard lock(answers_mutex_);
    if (report.severity >= ODO_SEVERITY_WARNING) {
      ++errors_;
      last_error_.status = ODO_E_ERROR;
      std::snprintf(last_error_.message, sizeof last_error_.message, "%s: %s", report.origin.c_str(),
                    report.text.c_str());
    }
    listener = listener_;
  }
  if (listener) listener(report);
}

void Session::set_report_listener(HostServices::Listener listener) {
  const std::lock_guard lock(answers_mutex_);
  listener_ = std::move(listener);
}

int32_t Session::last_error(odo_error& out) {
  const std::lock_guard lock(answers_mutex_);
  if (errors_ == 0) return ODO_OK;
  out.status = last_error_.status;
  std::memcpy(out.message, last_error_.message, sizeof out.message);
  errors_ = 0;
  return out.status;
}

int64_t Session::save(void* data, uint64_t capacity) const {
  const std::lock_guard work(work_mutex_);
  const auto blob = pipeline_->save();
  if (data && blob.size() <= capacity) std::memcpy(data, blob.data(), blob.size());
  return static_cast<int64_t>(blob.size());
}

int32_t Session::load(const void* data, uint64_t size) {
  const std::lock_guard work(work_mutex_);
  const auto loaded = pipeline_->load({static_cast<const uint8_t*>(data), static_cast<size_t>(size)});
  if (loaded) return ODO_OK;
  host_.report(0, ODO_SEVERITY_WARNING, "load", loaded.failure().text);
  return loaded.failure().status;
}

int32_t Session::to_geodetic(const double* p_n, double* geodetic) const {
  if (!geodesy_.has_origin()) return ODO_NOT_READY;
  const auto g = geodesy_.to_geodetic({p_n[0], p_n[1], p_n[2]});
  std::copy(g.begin(), g.end(), geodetic);
  return ODO_OK;
}

int32_t Session::from_geodetic(const double* geodetic, double* p_n) const {
  if (!geodesy_.has_origin()) return ODO_NOT_READY;
  const auto p = geodesy_.from_geodetic({geodetic[0], geodetic[1], geodetic[2]});
  std::copy(p.begin(), p.end(), p_n);
  return ODO_OK;
}

}  // namespace odograph
