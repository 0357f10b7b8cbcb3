// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/plugin_host/thread_backend.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <map>
#include <mutex>
#include <system_error>
#include <thread>

#include "sdk/host/base/pixels.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/host/plugin_host/library_backend.hpp"

namespace odograph {
namespace {

constexpr size_t kFrameSlots = 8;  // as many as a session holds by default

const char* name_of(int call) {
  constexpr const char* names[] = {"load", "create", "process", "reset", "save", "load", "process"};
  return names[call];
}

/// How many calls of a library have not come back.
class LeftBehind {
 public:
  static int count(const std::string& library) {
    const std::lock_guard lock(mutex());
    return all()[library];
  }
  static void add(const std::string& library, int change) {
    const std::lock_guard lock(mutex());
    all()[library] += change;
  }

 private:
  // Never destroyed: a thread that was left behind may come back while the program ends.
  static std::mutex& mutex() {
    static auto* mine = new std::mutex;
    return *mine;
  }
  static std::map<std::string, int>& all() {
    static auto* mine = new std::map<std::string, int>;
    return *mine;
  }
};

/// A frame's pixels for the plugin, and how often it holds them.
struct FrameSlot {
  std::atomic<uint32_t> holds{0};
  std::vector<uint8_t> pixels;
};

int32_t ODO_CALL retain(void* owner) {
  static_cast<FrameSlot*>(owner)->holds.fetch_add(1);
  return ODO_OK;
}

void ODO_CALL release(void* owner) { static_cast<FrameSlot*>(owner)->holds.fetch_sub(1, std::memory_order_release); }

}  // namespace

/// All that the plugin can reach. It belongs to the backend and to the thread; whichever is later ends it.
class ThreadBackend::Worker {
 public:
  Worker(const PluginChoice& choice, LibraryCheck check, HostServices& host, const odo_sink& sink)
      : choice_(choice), check_(check), services_(host, *this), host_(&host), out_(&sink) {
    sink_.struct_size = sizeof(odo_sink);
    sink_.instance = sink.instance;
    sink_.emit = emit;
    sink_.worker = this;
  }

  const PluginChoice& choice() const { return choice_; }
  const KindTypes& types() const { return backend_->types(); }
  bool loaded() const { return backend_ != nullptr; }

  // Of the current call: written by the host before it, by the thread during it.
  AnyMessage message;
  std::vector<uint8_t> bytes;
  int32_t status = ODO_OK;
  std::string failure;

  /// False when the thread has not answered within the limit, or is no more.
  bool ask(Call call, double limit_s) {
    std::unique_lock lock(mutex_);
    call_ = call;
    state_ = State::asked;
    changed_.notify_all();
    const bool answered = changed_.wait_for(lock, std::chrono::duration<double>(limit_s),
                                            [this] { return state_ == State::idle || state_ == State::gone; });
    return answered && state_ == State::idle;
  }
  bool gone() {
    const std::lock_guard lock(mutex_);
    return state_ == State::gone;
  }
  /// Ends the thread, which ends the instance first. False when that takes longer than the limit or goes wrong.
  bool stop(double limit_s) {
    std::unique_lock lock(mutex_);
    stopping_ = true;
    changed_.notify_all();
    const std::chrono::duration<double> limit(limit_s);
    return changed_.wait_for(lock, limit, [this] { return state_ == State::gone; }) && in_order_;
  }
  void tell(const std::string& what) {
    services_.report(sink_.instance, ODO_SEVERITY_WARNING, "isolated", what, ODO_E_ERROR);
  }
  /// From here on nobody hears the plugin, and nothing of the host is within its reach.
  void cut_off() {
    {
      const std::lock_guard gate(gate_);
      host_ = nullptr;
      out_ = nullptr;
    }
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    if (state_ == State::gone) return;  // no thread is left that could come back
    left_behind_ = true;
    LeftBehind::add(choice_.manifest.place(), 1);
  }

  /// Copies the pixels into a slot that the plugin does not hold.
  bool put_frame(odo_frame& frame) {
    const auto slot =
        std::find_if(std::begin(slots_), std::end(slots_), [](const FrameSlot& each) { return each.holds == 0; });
    if (slot == std::end(slots_) || pixel_bytes(frame) == 0) return false;
    slot->pixels.resize(pixel_bytes(frame));
    if (!copy_pixels(frame, slot->pixels)) return false;
    slot->holds = 1;
    frame.loan = {slot, retain, release, nullptr, 0};
    return true;
  }

  static void run(std::shared_ptr<Worker> self) {
    // The thread may end within a call (pthread_exit): its stack is unwound, and this says so.
    struct End {
      Worker& worker;
      ~End() { worker.thread_ends(); }
    } end{*self};
    self->work();
  }

 private:
  enum class State { idle, asked, busy, gone };

  struct Sink : odo_sink {
    Worker* worker;
  };

  /// The host's services, as long as it listens.
  class Services : public HostServices {
   public:
    Services(HostServices& host, Worker& worker)
        : HostServices(host.seed(), host.assets(), nullptr, host.app()), worker_(worker) {}
    void wake(uint32_t instance) override {
      const std::lock_guard gate(worker_.gate_);
      if (worker_.host_) worker_.host_->wake(instance);
    }
    void report(uint32_t instance, uint32_t severity, const std::string& key, const std::string& text,
                int32_t status) override {
      const std::lock_guard gate(worker_.gate_);
      if (worker_.host_) worker_.host_->report(instance, severity, key, text, status);
    }

   protected:
    /// The app's services end with the session.
    const void* service(std::string_view id) override {
      const std::lock_guard gate(worker_.gate_);
      return worker_.host_ ? HostServices::service(id) : nullptr;
    }

   private:
    Worker& worker_;
  };

  static int32_t emit(const odo_sink* sink, const odo_header* event) {
    Worker& self = *static_cast<const Sink*>(sink)->worker;
    const std::lock_guard gate(self.gate_);
    return self.out_ ? self.out_->emit(self.out_, event) : ODO_E_STATE;
  }

  void work() {
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait(lock, [this] { return stopping_ || state_ == State::asked; });
      if (state_ != State::asked) break;
      state_ = State::busy;
      lock.unlock();
      serve(call_);
      lock.lock();
      if (stopping_) break;
      state_ = State::idle;
      changed_.notify_all();
    }
    lock.unlock();
    if (backend_) backend_->close();
    backend_.reset();
    in_order_ = true;
  }

  void serve(Call call) {
    switch (call) {
      case Call::load: load_library(); break;
      case Call::start: status = backend_->start(); break;
      case Call::process:
        status = backend_->process(message.header());
        if (message.header().type == ODO_TYPE_FRAME) release(as<odo_frame>(message.header()).loan.owner);
        break;
      case Call::wake: status = backend_->wake(); break;
      case Call::reset: status = backend_->reset(); break;
      case Call::save: bytes = backend_->save(); break;
      case Call::restore: status = backend_->load(bytes) ? ODO_OK : ODO_E_DATA; break;
    }
  }

  void load_library() {
    auto loaded = LibraryBackend::load(choice_, check_, services_, sink_, true);
    if (loaded) {
      backend_ = std::move(*loaded);
      status = ODO_OK;
    } else {
      status = loaded.failure().status;
      failure = loaded.failure().text;
    }
  }

  void thread_ends() {
    if (!in_order_) (void)backend_.release();  // it is within a call that will never end
    const std::lock_guard lock(mutex_);
    if (left_behind_) LeftBehind::add(choice_.manifest.place(), -1);
    state_ = State::gone;
    changed_.notify_all();
  }

  const PluginChoice choice_;
  const LibraryCheck check_;
  Services services_;
  Sink sink_{};
  FrameSlot slots_[kFrameSlots];
  std::unique_ptr<LibraryBackend> backend_;
  bool in_order_ = false;  // of the thread

  std::mutex gate_;  // held while the plugin speaks
  HostServices* host_;
  const odo_sink* out_;

  std::mutex mutex_;  // for what follows
  std::condition_variable changed_;
  Call call_ = Call::load;
  State state_ = State::idle;
  bool stopping_ = false, left_behind_ = false;
};

Result<std::unique_ptr<ThreadBackend>> ThreadBackend::load(const PluginChoice& choice, LibraryCheck check,
                                                           HostServices& host, const odo_sink& sink) {
  const Parameters parameters;
  const std::string library = choice.manifest.place();
  if (const int left = LeftBehind::count(library); left >= parameters.max_left_behind)
    return Failure{ODO_E_EXHAUSTED, library + ": " + std::to_string(left) + " of its calls have not come back"};
  auto worker = std::make_shared<Worker>(choice, check, host, sink);
  std::unique_ptr<ThreadBackend> made(new ThreadBackend(worker));
  try {
    std::thread(Worker::run, worker).detach();
  } catch (const std::system_error& error) {
    made->ended_ = "has no thread";
    return Failure{ODO_E_EXHAUSTED, library + ": no thread could be started: " + error.what()};
  }
  if (!made->exchange(Call::load, choice.isolation.start_s)) return Failure{ODO_E_FATAL, library + ": " + made->ended_};
  if (worker->status < 0) return Failure{worker->status, worker->failure};
  made->types_ = worker->types();
  return made;
}

ThreadBackend::~ThreadBackend() {
  if (!ended_.empty()) return;
  const double limit_s = worker_->choice().isolation.time_s;
  if (worker_->stop(limit_s)) return;
  worker_->tell(why_none("destroy", limit_s));
  worker_->cut_off();
}

std::string ThreadBackend::why_none(const char* call, double limit_s) const {
  char limit[32];
  std::snprintf(limit, sizeof limit, "%g", limit_s);
  return (worker_->gone() ? "ended its thread" : std::string("took longer than ") + limit + " s") + " in " + call;
}

/// Asks and waits for the answer. False, with ended_ said, where there is none.
bool ThreadBackend::exchange(Call call, double limit_s) {
  if (!ended_.empty()) return false;
  if (worker_->ask(call, limit_s)) return true;
  ended_ = why_none(name_of(static_cast<int>(call)), limit_s);
  worker_->cut_off();
  return false;
}

int32_t ThreadBackend::start() {
  return exchange(Call::start, worker_->choice().isolation.start_s) ? worker_->status : ODO_E_ERROR;
}

int32_t ThreadBackend::process(const odo_header& message) {
  if (!ended_.empty()) return ODO_E_ERROR;
  worker_->message.assign(message);
  if (message.type == ODO_TYPE_FRAME && !worker_->put_frame(reinterpret_cast<odo_frame&>(worker_->message.header())))
    return ODO_E_EXHAUSTED;
  return exchange(Call::process, worker_->choice().isolation.time_s) ? worker_->status : ODO_E_ERROR;
}

int32_t ThreadBackend::wake() {
  return exchange(Call::wake, worker_->choice().isolation.time_s) ? worker_->status : ODO_E_ERROR;
}

int32_t ThreadBackend::reset() {
  return exchange(Call::reset, worker_->choice().isolation.start_s) ? worker_->status : ODO_E_ERROR;
}

std::vector<uint8_t> ThreadBackend::save() {
  if (!exchange(Call::save, worker_->choice().isolation.time_s)) return {};
  return std::move(worker_->bytes);
}

bool ThreadBackend::load(std::span<const uint8_t> data) {
  if (!ended_.empty()) return false;
  worker_->bytes.assign(data.begin(), data.end());
  return exchange(Call::restore, worker_->choice().isolation.time_s) && worker_->status >= 0;
}

}  // namespace odograph
