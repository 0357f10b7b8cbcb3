// SPDX-License-Identifier: Apache-2.0
//
// odograph-plugin-host: the process in which a plugin runs with `isolation: process`. The host (process_backend.cpp)
// starts it with three descriptors (wire.hpp); it ends with the host.
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <mutex>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <odograph/messages.h>

#include "sdk/host/messages/messages.hpp"
#include "sdk/host/plugin_host/instance.hpp"
#include "sdk/host/plugin_host/supervisor.hpp"
#include "sdk/host/plugin_host/library_backend.hpp"
#include "sdk/host/plugin_host/sandbox.hpp"
#include "sdk/host/plugin_host/sealed_copy.hpp"
#include "sdk/host/plugin_host/shared_pixels.hpp"
#include "sdk/host/plugin_host/wire.hpp"

namespace odograph {
namespace {

wire::Control* control = nullptr;
const uint8_t* pixels = nullptr;

/// The plugin's output, in order, for the next answer. Any thread may report.
class Answer {
 public:
  void begin() {
    const std::lock_guard lock(mutex_);
    out_ = wire::Writer({control->response, wire::kAreaBytes});
    out_.put(int32_t(0));
    open_ = true;
    for (const auto& [severity, status, key, text] : early_) put_report(severity, status, key, text);
    early_.clear();
  }
  void event(const void* bytes, size_t size) {
    const std::lock_guard lock(mutex_);
    const size_t before = out_.size();
    out_.put(static_cast<uint32_t>(wire::event));
    out_.put_bytes(bytes, size);
    if (out_.full()) out_.rewind(before);
  }
  void state(std::span<const uint8_t> data) {
    const std::lock_guard lock(mutex_);
    out_.put(static_cast<uint32_t>(wire::state));
    out_.put_bytes(data.data(), data.size());
  }
  void report(uint32_t severity, int32_t status, const std::string& key, const std::string& text) {
    const std::lock_guard lock(mutex_);
    if (open_)
      put_report(severity, status, key, text);
    else if (early_.size() < kMaxEarly)
      early_.push_back({severity, status, key, text});
  }
  void finish(int32_t status) {
    const std::lock_guard lock(mutex_);
    std::memcpy(control->response, &status, sizeof status);
    control->response_size = out_.size();
    open_ = false;
  }

 private:
  struct Early {
    uint32_t severity;
    int32_t status;
    std::string key, text;
  };
  static constexpr size_t kMaxEarly = 256;

  void put_report(uint32_t severity, int32_t status, const std::string& key, const std::string& text) {
    const size_t before = out_.size();
    out_.put(static_cast<uint32_t>(wire::report));
    out_.put(severity);
    out_.put(status);
    out_.put_text(std::string_view(key).substr(0, 256));
    out_.put_text(std::string_view(text).substr(0, 4096));
    if (out_.full()) out_.rewind(before);
  }

  std::mutex mutex_;
  wire::Writer out_{{}};
  bool open_ = false;
  std::vector<Early> early_;
};

Answer answer;

/// Host services for the plugin. Reports are passed on without a rate limit, which the host applies.
class RemoteServices : public HostServices {
 public:
  RemoteServices(uint64_t seed, std::vector<std::filesystem::path> assets)
      : HostServices(seed, std::move(assets), nullptr) {}
  void report(uint32_t, uint32_t severity, const std::string& key, const std::string& text, int32_t status,
              Author) override {
    answer.report(severity, status, key, text);
  }

 protected:
  /// The host cannot be called from this process.
  const void* service(std::string_view id) override {
    return id == ODO_SERVICE_WAKE ? nullptr : HostServices::service(id);
  }
};

/// Answers the plugin like the host's own sink and passes everything on; the host checks it again.
struct RemoteSink : odo_sink {
  TypeSet outputs;
  AnyMessage copy;  // a large one uses its memory again
  size_t taken = 0;
  bool overflow_reported = false;

  static int32_t take(const odo_sink* sink, const odo_header* event) {
    auto& self = *const_cast<RemoteSink*>(static_cast<const RemoteSink*>(sink));
    if (!event) return answer.event(nullptr, 0), ODO_E_ARGUMENT;
    EventFault fault;
    int32_t status = validate_event(*event, self.outputs, self.copy, fault);
    if (status == ODO_OK && self.taken >= EventBuffer::kCapacity) status = ODO_E_EXHAUSTED;
    if (status == ODO_E_UNSUPPORTED || (status == ODO_E_EXHAUSTED && self.overflow_reported)) return status;
    self.overflow_reported = self.overflow_reported || status == ODO_E_EXHAUSTED;
    self.taken += status == ODO_OK ? 1 : 0;
    const bool whole = event->struct_size >= sizeof *event && event->struct_size <= ODO_LARGEST_MESSAGE;
    answer.event(event, whole ? event->struct_size : sizeof *event);
    return status;
  }
};

void phase(const char* name) { std::snprintf(control->phase, sizeof control->phase, "%s", name); }

std::atomic<bool> may_be_retained[wire::kFrameSlots];  // the host holds the frame as long as the plugin does

int32_t ODO_CALL retain(void* owner) {
  auto* holds = static_cast<std::atomic<uint32_t>*>(owner);
  if (!may_be_retained[holds - control->holds]) return ODO_E_EXHAUSTED;
  const auto held = std::count_if(std::begin(control->holds), std::end(control->holds),
                                  [](const auto& each) { return each.load(std::memory_order_relaxed) > 0; });
  if (holds->load() == 1 && held >= static_cast<std::ptrdiff_t>(wire::kFrameSlots)) return ODO_E_EXHAUSTED;
  holds->fetch_add(1);
  return ODO_OK;
}

void ODO_CALL release(void* owner) {
  static_cast<std::atomic<uint32_t>*>(owner)->fetch_sub(1, std::memory_order_release);
}

class Server {
 public:
  explicit Server(ChildContext context) : context_(std::move(context)) {}
  int run() {
    for (char word; read_one(word);) {
      wire::Reader request({control->request, std::min<size_t>(control->request_size, wire::kAreaBytes)});
      const uint32_t call = control->call;
      serve(call, request);
      phase("");
      if (write(wire::kSocket, &word, 1) != 1 || call == wire::end) break;
    }
    return 0;
  }

 private:
  static bool read_one(char& word) {
    ssize_t got;
    while ((got = read(wire::kSocket, &word, 1)) < 0 && errno == EINTR) {
    }
    return got == 1;
  }
  void serve(uint32_t call, wire::Reader& request) {
    if (call == wire::enter) return enter(request);
    if (call == wire::open) return open_library();
    answer.begin();
    int32_t status = ODO_OK;
    switch (call) {
      case wire::start:
        phase("create");
        status = backend_->start();
        break;
      case wire::process: status = process(request); break;
      case wire::reset:
        phase("reset");
        status = backend_->reset();
        break;
      case wire::save:
        phase("save");
        answer.state(backend_->save());
        break;
      case wire::load:
        phase("load");
        status = backend_->load(request.get_bytes()) ? ODO_OK : ODO_E_DATA;
        break;
      case wire::save_map:
        phase("save_map");
        answer.state(backend_->map_piece(request.get<uint64_t>()));
        break;
      case wire::load_map: {
        phase("load_map");
        const auto offset = request.get<uint64_t>();
        status = backend_->take_map_piece(offset, request.get_bytes()) ? ODO_OK : ODO_E_DATA;
        break;
      }
      default: phase("destroy"); backend_.reset();
    }
    answer.finish(status);
  }

  void enter(wire::Reader& request) {
    phase("load");
    const std::string manifest_path = request.get_text();
    std::string manifest_text = request.get_text();
    choice_.interface_id = request.get_text();
    sink_.struct_size = sizeof(odo_sink);
    sink_.instance = request.get<uint32_t>();
    sink_.emit = RemoteSink::take;
    check_ = static_cast<LibraryCheck>(request.get<uint32_t>());
    const auto seed = request.get<uint64_t>();
    const bool live = request.get<uint32_t>() != 0;
    const auto memory_bytes = request.get<uint64_t>();
    std::vector<std::filesystem::path> assets(std::min<uint32_t>(request.get<uint32_t>(), 1024));
    for (auto& folder : assets) folder = request.get_text();
    services_ = std::make_unique<RemoteServices>(seed, std::move(assets));
    services_->set_live(live);
    auto manifest = parse_manifest(std::move(manifest_text), manifest_path);
    if (manifest) {
      choice_.manifest = std::move(*manifest);
      take_values(request);
      // The loader's copy of it: no file can be created in there, and this one is found again.
      if (check_ == LibraryCheck::sealed)
        if (const auto copy = sealed_copy(choice_.manifest); !copy) failure_ = copy.failure();
    } else {
      failure_ = manifest.failure();
    }
    std::string missing = context_.missing;
    for (const auto& what : enter_sandbox(memory_bytes + SharedPixels::kBytes + sizeof(wire::Control), context_.gate))
      missing += (missing.empty() ? "" : "; ") + what;
    wire::Writer out({control->response, wire::kAreaBytes});
    out.put_text(missing);
    control->response_size = out.size();
  }

  void open_library() {
    phase("load");
    if (failure_.status == ODO_OK) {
      auto loaded = LibraryBackend::load(choice_, check_, *services_, sink_);
      if (loaded)
        backend_ = std::move(*loaded);
      else
        failure_ = loaded.failure();
    }
    wire::Writer out({control->response, wire::kAreaBytes});
    out.put(failure_.status);
    out.put_text(failure_.text);
    const KindTypes types = backend_ ? backend_->types() : KindTypes{};
    for (const uint32_t type : types.outputs) sink_.outputs.add(type);
    for (const auto* list : {&types.inputs, &types.outputs})
      out.put_bytes(list->data(), list->size() * sizeof(uint32_t));
    out.put(types.flags);
    control->response_size = out.size();
  }

  /// Reads the parameters, in the manifest's order.
  void take_values(wire::Reader& request) {
    const auto count = request.get<uint32_t>();
    for (uint32_t i = 0; i < count && request.good(); ++i) {
      request.get<uint32_t>();
      const std::string name = request.get_text(), text = request.get_text();
      const auto reals = request.get_bytes();
      const auto integer = request.get<int64_t>();
      for (const Spec& spec : choice_.manifest.parameters) {
        if (spec.name != name) continue;
        Value value{.name = name};
        value.text = text;
        value.integer = integer;
        value.boolean = integer != 0;
        value.reals.resize(reals.size() / sizeof(double));
        if (!reals.empty()) std::memcpy(value.reals.data(), reals.data(), value.reals.size() * sizeof(double));
        if (!value.reals.empty()) value.real = value.reals.front();
        choice_.parameters.emplace_back(spec, std::move(value));
      }
    }
  }

  int32_t process(wire::Reader& request) {
    sink_.taken = 0;
    sink_.overflow_reported = false;
    const auto bytes = request.get_bytes();
    if (bytes.size() < sizeof(odo_header) || !message_.assign(bytes)) return ODO_E_STRUCT_SIZE;
    odo_header& header = message_.header();
    if (header.type != ODO_TYPE_FRAME) {
      phase("process");
      return backend_->process(header);
    }
    auto& frame = reinterpret_cast<odo_frame&>(header);
    const auto slot = std::min<uint32_t>(request.get<uint32_t>(), wire::kFrameSlots - 1);
    may_be_retained[slot] = request.get<uint32_t>() != 0;
    for (odo_plane* plane : {&frame.planes[0], &frame.planes[1], &frame.planes[2], &frame.planes[3], &frame.mask}) {
      const auto offset = request.get<uint64_t>();
      plane->data = offset < SharedPixels::kBytes ? pixels + offset : nullptr;
      plane->row_stride = request.get<int64_t>();
      plane->pixel_stride = request.get<uint32_t>();
    }
    frame.loan = {&control->holds[slot], retain, release, nullptr, 0};
    phase("process");
    const int32_t status = backend_->process(header);
    release(frame.loan.owner);
    return status;
  }

  /// A message with room for the present struct.
  struct Message {
    AnyMessage any;
    bool assign(std::span<const uint8_t> bytes) {
      alignas(8) unsigned char copy[ODO_LARGEST_MESSAGE];
      if (bytes.size() > sizeof copy) return false;
      std::memcpy(copy, bytes.data(), bytes.size());
      return any.assign(*reinterpret_cast<const odo_header*>(copy));
    }
    odo_header& header() { return any.header(); }
  };

  ChildContext context_;
  PluginChoice choice_;
  LibraryCheck check_ = LibraryCheck::none;
  Failure failure_{ODO_OK, ""};  // if it cannot be loaded
  RemoteSink sink_{};
  std::unique_ptr<RemoteServices> services_;
  std::unique_ptr<LibraryBackend> backend_;
  Message message_;
};

int report_misuse() {
  std::fputs("odograph-plugin-host is started by a host whose config says 'isolation: process'\n", stderr);
  return 2;
}

}  // namespace
}  // namespace odograph

int main() {
  using namespace odograph;
  if (fcntl(wire::kPixels, F_GETFD) < 0) return report_misuse();
  ChildContext context = fork_supervised(wire::kPixels + 1);
  void* control_memory = mmap(nullptr, sizeof(wire::Control), PROT_READ | PROT_WRITE, MAP_SHARED, wire::kControl, 0);
  void* pixel_memory = mmap(nullptr, SharedPixels::kBytes, PROT_READ, MAP_SHARED, wire::kPixels, 0);
  if (control_memory == MAP_FAILED || pixel_memory == MAP_FAILED) return report_misuse();
  control = static_cast<wire::Control*>(control_memory);
  pixels = static_cast<const uint8_t*>(pixel_memory);
  // Released address space would count for other memory. Needs Linux 6.10; before, memory_limit is larger by that much.
  constexpr long kMseal = 462;
  syscall(kMseal, control_memory, sizeof(wire::Control), 0);
  syscall(kMseal, pixel_memory, SharedPixels::kBytes, 0);
  if (control->version != wire::kVersion) return 2;
  close(wire::kControl);
  close(wire::kPixels);
  const int status = Server(std::move(context)).run();
  _exit(status);  // skip the plugin's threads and static destructors
}
