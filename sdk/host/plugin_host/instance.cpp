// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/plugin_host/instance.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <system_error>

#include <odograph/odograph.h>

#include "sdk/host/platform/coarse_clock.hpp"
#include "sdk/host/base/saturating.hpp"
#include "sdk/host/messages/bounds.hpp"
#include "sdk/host/plugin_host/library_backend.hpp"
#include "sdk/math/time.hpp"

namespace odograph {
namespace {

/// The backend that the choice requests.
Result<std::unique_ptr<PluginBackend>> open_backend(const PluginChoice& choice, LibraryCheck check, HostServices& host,
                                                    const odo_sink& sink) {
  if (choice.isolation.kind == Isolation::Kind::process) return open_process(choice, check, host, sink);
  auto made = LibraryBackend::load(choice, check, host, sink);
  if (!made) return made.failure();
  return std::unique_ptr<PluginBackend>(std::move(*made));
}

}  // namespace

std::vector<odo_value> values_of(const PluginChoice& choice) {
  std::vector<odo_value> values;
  for (const auto& [spec, value] : choice.parameters) {
    odo_value out{};
    out.struct_size = sizeof out;
    out.name = {spec.name.data(), spec.name.size()};
    out.text = {value.text.data(), value.text.size()};
    switch (spec.type) {
      case SpecType::boolean:
        out.type = ODO_PARAMETER_BOOL;
        out.integer = value.boolean;
        break;
      case SpecType::integer:
        out.type = ODO_PARAMETER_INT;
        out.integer = value.integer;
        break;
      case SpecType::real:
        out.type = ODO_PARAMETER_REAL;
        out.reals = &value.real;
        out.count = 1;
        break;
      case SpecType::reals:
        out.type = ODO_PARAMETER_REALS;
        out.reals = value.reals.data();
        out.count = value.reals.size();
        break;
      case SpecType::choice: out.type = ODO_PARAMETER_CHOICE; break;
      default: out.type = ODO_PARAMETER_STRING;
    }
    values.push_back(out);
  }
  return values;
}

PluginInstance::PluginInstance(const PluginChoice& choice, LibraryCheck check, HostServices& host, uint32_t number)
    : check_(check), host_(host), number_(number) {
  sink_.struct_size = sizeof(odo_sink);
  sink_.instance = number;
  sink_.emit = emit;
  sink_.owner = this;
  choose(std::make_shared<PluginChoice>(choice));
}

PluginInstance::~PluginInstance() {
  if (starter_.joinable()) starter_.join();
}

Result<std::unique_ptr<PluginInstance>> PluginInstance::make(const PluginChoice& choice, LibraryCheck check,
                                                             uint32_t number, HostServices& host) {
  std::unique_ptr<PluginInstance> made(new PluginInstance(choice, check, host, number));
  const auto started = made->take(made->start());
  if (started) return made;
  if (choice.fallback)
    host.report(number, ODO_SEVERITY_ERROR, "given_up", started.failure().text, started.failure().status);
  if (!made->use_fallback() || !made->alive_) return started.failure();
  return made;
}

void PluginInstance::choose(std::shared_ptr<const PluginChoice> choice) {
  choice_ = std::move(choice);
  host_.name_instance(number_, id());
  use_types(kind_types(choice_->interface_id));
}

/// Starts the plugin, with its saved state; its process may have ended meanwhile. [control]
PluginInstance::Started PluginInstance::start() const {
  auto opened = open_backend(*choice_, check_, host_, sink_);
  if (!opened) return opened;
  PluginBackend& backend = **opened;
  const int32_t status = backend.start();
  if (!backend.ended().empty()) return opened;
  if (status < 0)
    return Failure{status, choice_->place + choice_->manifest.place() + ": plugin '" + id() +
                               "' could not be created, configured and activated: " + odo_status_text(status)};
  if (!saved_.empty()) backend.load(saved_);
  pass_maps(backend);
  return opened;
}

/// A plugin process that ended is not a failure: it is restarted.
Result<bool> PluginInstance::take(Started started) {
  started_ns_ = now_ns_;
  if (!started) {
    if (!isolated() || started.failure().status != ODO_E_FATAL) return started.failure();
    on_process_end(started.failure().text);
    return true;
  }
  backend_ = std::move(*started);
  use_types(backend_->types());
  if (has_ended()) on_process_end(backend_->ended());
  return true;
}

void PluginInstance::use_types(const KindTypes& types) {
  inputs_ = outputs_ = {};
  flags_ = types.flags;
  for (const uint32_t type : types.inputs) inputs_.add(type);
  for (const uint32_t type : types.outputs) outputs_.add(type);
}

namespace {

constexpr int32_t kNeedsReset = -1000, kQuarantines = -2000;  // ranges of status codes, base.h

/// Inputs come from the app and some events from the host; no table can declare them.
bool may_be_emitted(uint32_t type) {
  return ODO_IS_EVENT(type) && type != ODO_TYPE_POSE && type != ODO_TYPE_STATE && type != ODO_TYPE_CORRECTION &&
         type != ODO_TYPE_REPORT;
}

}  // namespace

int32_t validate_event(const odo_header& event, const TypeSet& outputs, AnyMessage& copy, EventFault& fault) {
  const MessageInfo* info = message_info(event.type);
  const auto name = [&] { return message_name(event.type); };
  if (ODO_IS_BORROWED(event.type)) {
    fault = {"wrong_event", "emitted type = " + name() + ", which lends memory; events do not"};
    return ODO_E_UNSUPPORTED;
  }
  if (!may_be_emitted(event.type) || !outputs.has(event.type)) {
    if (ODO_IS_EVENT(event.type) && !info) return ODO_E_UNSUPPORTED;  // from a newer plugin
    fault = {"wrong_event", "emitted type = " + name() + "; expected one that its kind emits or its table declares"};
    return ODO_E_ARGUMENT;
  }
  if (!copy.assign(event)) {
    fault = {"event_size", "emitted a " + name() + " with struct_size = " + std::to_string(event.struct_size) +
                               "; expected " + std::to_string(min_size(event.type)) + " to " +
                               std::to_string(ODO_LARGEST_MESSAGE)};
    return ODO_E_STRUCT_SIZE;
  }
  copy.header().flags &= ~ODO_FLAG_HOST_MASK;
  copy.header().reserved = 0;
  if (const std::string wrong = message_fault(copy.header()); !wrong.empty()) {
    fault = {"bad_event", "emitted a " + name() + " with " + wrong};
    return ODO_E_ARGUMENT;
  }
  return ODO_OK;
}

int32_t PluginInstance::emit(const odo_sink* sink, const odo_header* event) {
  PluginInstance& self = *static_cast<const Sink*>(sink)->owner;
  if (!event) {
    self.fault("no_event", "emitted event = null", ODO_E_ARGUMENT);
    return ODO_E_ARGUMENT;
  }
  AnyMessage* slot = self.buffer_.next();
  if (!slot && self.outputs_.has(event->type)) {
    if (!std::exchange(self.overflow_reported_, true))
      self.fault("many_events", "emitted more than " + std::to_string(EventBuffer::kCapacity) + " events in one call",
                 ODO_E_EXHAUSTED);
    return ODO_E_EXHAUSTED;
  }
  AnyMessage none;
  EventFault fault;
  int32_t status = validate_event(*event, self.outputs_, slot ? *slot : none, fault);
  if (status == ODO_OK && bounds::is_ahead(event->t_ns, self.now_ns_)) {
    fault = {"bad_event", "emitted a " + message_name(event->type) + " of a time more than a second ahead"};
    status = ODO_E_ARGUMENT;
  }
  if (status == ODO_OK) return slot->header().source = self.number_, ODO_OK;
  if (slot) self.buffer_.drop_last();
  if (status != ODO_E_UNSUPPORTED) self.fault(fault.key, fault.text, status);
  return status;
}

std::span<AnyMessage> PluginInstance::process(const odo_header& message) {
  buffer_.clear();
  overflow_reported_ = false;
  if (!alive_ || !wants(message.type) || !can_receive(message)) return {};
  now_ns_ = std::max(now_ns_, message.t_ns);
  if (!backend_) {  // its process is down; sensor descriptions are the first messages after a restart
    if (now_ns_ >= restart_at_ns_) restart();
    return {};
  }
  const int64_t start_ns = coarse_now_ns();
  const int32_t status = backend_->process(message);
  if (!isolated()) check_call_time(coarse_now_ns() - start_ns);
  return finish(status, &message);
}

std::span<AnyMessage> PluginInstance::wake() {
  buffer_.clear();
  overflow_reported_ = false;
  if (starting_.valid() && starting_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    starter_.join();
    restarted(starting_.get());
    return {};
  }
  return alive() ? finish(backend_->wake(), nullptr) : std::span<AnyMessage>();
}

/// Completes a call to process, without a message if `message` is null.
std::span<AnyMessage> PluginInstance::finish(int32_t status, const odo_header* message) {
  if (has_ended()) {
    on_process_end(backend_->ended());
    if (alive_ && !backend_ && now_ns_ >= restart_at_ns_) restart();
    return {};
  }
  if (status < 0)
    failed(status, message);
  else
    consecutive_failures_ = 0;
  if (isolated()) save_periodically();
  return buffer_.events();
}

/// Borrowed memory does not cross into another process, except a frame's pixels; frames without pixels go only to
/// plugins that declare support for them.
bool PluginInstance::can_receive(const odo_header& message) {
  if (!ODO_IS_BORROWED(message.type)) return true;
  const bool is_frame = message.type == ODO_TYPE_FRAME;
  if (is_frame && as<odo_frame>(message).planes[0].data) return true;
  if (!isolated() && (!is_frame || (flags_ & ODO_PLUGIN_NATIVE_FRAMES))) return true;
  host_.report(number_, ODO_SEVERITY_WARNING, "not_given",
               "is not given a " + message_name(message.type) +
                   (isolated() ? ": its memory cannot be shared with another process"
                               : " without pixels in memory: its table lacks ODO_PLUGIN_NATIVE_FRAMES"),
               ODO_E_UNSUPPORTED);
  return false;
}

/// A late call in the app's own thread cannot be skipped; it is reported.
void PluginInstance::check_call_time(int64_t took_ns) {
  if (took_ns <= kCoarseClock_ns) return;
  const double took_s = seconds(took_ns);
  if (took_s <= choice_->isolation.time_s + seconds(kCoarseClock_ns)) return;
  char text[96];
  std::snprintf(text, sizeof text, "took %.3g s in process; expected at most %g s (time_limit)", took_s,
                choice_->isolation.time_s);
  host_.report(number_, ODO_SEVERITY_WARNING, "late", text);
}

/// Reports the end of its process, and schedules its restart or fallback.
void PluginInstance::on_process_end(const std::string& what) {
  backend_.reset();
  ++faults_;
  if (saturating_difference(now_ns_, started_ns_) > parameters_.stable_ns) consecutive_ends_ = 0;
  ++consecutive_ends_;
  if (consecutive_ends_ >= parameters_.ends_before_fallback && choice_->fallback) {
    host_.report(number_, ODO_SEVERITY_ERROR, "isolated", what + ", for the last time", ODO_E_ERROR);
    use_fallback();
    return;
  }
  int64_t wait_ns = 0;
  if (consecutive_ends_ > 1)
    wait_ns = std::min(parameters_.longest_wait_ns, parameters_.first_wait_ns << std::min(consecutive_ends_ - 2, 16));
  restart_at_ns_ = now_ns_ == INT64_MIN ? INT64_MIN : saturating_sum(now_ns_, wait_ns);
  recovering_until_ns_ = INT64_MIN;
  host_.report(number_, ODO_SEVERITY_ERROR, "isolated",
               what + "; restarting" +
                   (wait_ns > 0 ? " after " + std::to_string(wait_ns / 1'000'000) + " ms of sensor time" : ""),
               ODO_E_ERROR);
}

/// Starts the plugin again, or its fallback: a process of a live session on another thread, so that the pipeline goes
/// on; wake() then takes it.
void PluginInstance::restart() {
  if (starting_.valid()) return;
  if (!isolated() || host_.pace() == HostServices::Pace::waits) return restarted(start());
  std::packaged_task<Started()> task([this] { return start(); });
  starting_ = task.get_future();
  try {
    starter_ = std::thread([this, task = std::move(task)]() mutable {
      task();
      host_.wake(number_);
    });
  } catch (const std::system_error&) {  // no further thread
    starting_ = {};
    restarted(start());
  }
}

void PluginInstance::restarted(Started started) {
  const std::string replaced = std::exchange(replaced_, "");
  if (const auto taken = take(std::move(started)); !taken) {
    host_.report(number_, ODO_SEVERITY_ERROR, replaced.empty() ? "isolated" : "fallback", taken.failure().text,
                 taken.failure().status);
    if (replaced.empty()) return give_up();
    alive_ = false;
    return;
  }
  if (!replaced.empty()) host_.report(number_, ODO_SEVERITY_WARNING, "fallback", "replaces " + replaced);
  if (!backend_) return;
  was_reset_ = true;
  recovering_until_ns_ = now_ns_ == INT64_MIN ? INT64_MIN : saturating_sum(now_ns_, parameters_.recovering_ns);
}

void PluginInstance::give_up() {
  host_.report(number_, ODO_SEVERITY_ERROR, "given_up", "is no longer called");
  if (!use_fallback()) alive_ = false;
}

/// False if there is none. One that does not start is disabled.
bool PluginInstance::use_fallback() {
  if (!choice_->fallback) return false;
  backend_.reset();
  replaced_ = id();
  consecutive_failures_ = consecutive_ends_ = 0;
  saved_.clear(), maps_.clear();
  choose(choice_->fallback);
  restart();
  return true;
}

void PluginInstance::save_periodically() {
  if (saved_ns_ == INT64_MIN) saved_ns_ = now_ns_;
  if (!backend_ || now_ns_ - saved_ns_ < parameters_.between_saves_ns) return;
  saved_ns_ = now_ns_;
  auto state = backend_->save();
  if (has_ended()) return on_process_end(backend_->ended());
  saved_ = std::move(state);
}

void PluginInstance::failed(int32_t status, const odo_header* message) {
  const std::string given = message ? "a sample of " + message_name(message->type) : "being woken";
  if (status > kNeedsReset) {
    const std::string why = status == ODO_E_DISCARD ? "" : std::string(": ") + odo_status_text(status);
    fault("discarded", "discarded " + given + (message ? " (t_ns = " + std::to_string(message->t_ns) + ")" : "") + why,
          status);
    return;
  }
  fault("failed", "failed at " + given + ": " + odo_status_text(status), status);
  if (status <= kQuarantines) backend_->quarantine();
  if (backend_->quarantined() || ++consecutive_failures_ >= parameters_.failures_before_giving_up) return give_up();
  reset();
}

void PluginInstance::reset() {
  was_reset_ = true;
  if (!backend_) return;
  const int32_t status = backend_->reset();
  if (has_ended()) return on_process_end(backend_->ended());
  if (status < 0) return give_up();
  pass_maps(*backend_);
}

std::vector<uint8_t> PluginInstance::save() const {
  if (!alive()) return saved_;
  auto state = backend_->save();
  return has_ended() ? saved_ : state;  // the next call reports its end
}

bool PluginInstance::load(std::span<const uint8_t> data) {
  const bool taken = alive() && backend_->load(data);
  if (taken && isolated()) saved_.assign(data.begin(), data.end());
  return taken;
}

int PluginInstance::process_id() const { return backend_ ? backend_->process_id() : -1; }

const void* PluginInstance::extension(std::string_view id) const { return alive() ? backend_->extension(id) : nullptr; }

void PluginInstance::fault(const char* key, const std::string& text, int32_t status) {
  ++faults_;
  host_.report(number_, ODO_SEVERITY_WARNING, key, text, status);
}

}  // namespace odograph
