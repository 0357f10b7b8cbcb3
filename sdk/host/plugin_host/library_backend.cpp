// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/plugin_host/library_backend.hpp"

#include <cstddef>
#include <exception>
#include <new>

#include <odograph/messages.h>

#include "sdk/host/base/floating_point.hpp"
#include "sdk/host/base/forced_unwind.hpp"
#include "sdk/host/plugin_host/plugin_call.hpp"
#include "sdk/host/plugin_host/instance.hpp"

namespace odograph {
namespace {

/// Records which thread is within process: events may only be emitted there.
class Calling {
 public:
  explicit Calling(std::atomic<std::thread::id>& caller) : caller_(caller) {
    caller_.store(std::this_thread::get_id(), std::memory_order_relaxed);
  }
  ~Calling() { caller_.store({}, std::memory_order_relaxed); }
  Calling(const Calling&) = delete;
  Calling& operator=(const Calling&) = delete;

 private:
  std::atomic<std::thread::id>& caller_;
};

}  // namespace

LibraryBackend::LibraryBackend(std::shared_ptr<PluginLibrary> library, const PluginChoice& choice, HostServices& host,
                               const odo_sink& sink)
    : library_(std::move(library)),
      choice_(choice),
      host_(host),
      sink_(sink),
      types_(plugin_types(choice.interface_id, library_->table())) {
  given_.struct_size = sizeof(odo_sink);
  given_.instance = sink.instance;
  given_.emit = emit;
  given_.owner = this;
}

int32_t LibraryBackend::emit(const odo_sink* sink, const odo_header* event) {
  LibraryBackend& self = *static_cast<const Sink*>(sink)->owner;
  if (self.caller_.load(std::memory_order_relaxed) == std::this_thread::get_id())
    return self.sink_.emit(&self.sink_, event);
  self.host_.report(self.sink_.instance, ODO_SEVERITY_WARNING, "foreign_thread",
                    "emitted outside process: on another thread, or in another call", ODO_E_STATE);
  return ODO_E_STATE;
}

Result<std::unique_ptr<LibraryBackend>> LibraryBackend::load(const PluginChoice& choice, LibraryCheck check,
                                                             HostServices& host, const odo_sink& sink) {
  const PluginCallScope scope(choice.manifest.id, "load");
  try {
    auto library = PluginLibrary::load(choice.manifest, check, &host);
    if (!library) return library.failure();
    return std::unique_ptr<LibraryBackend>(new LibraryBackend(std::move(*library), choice, host, sink));
  } catch (const ForcedUnwind&) {
    abort_for_ended_thread();  // here, because PluginCallScope still names the plugin
  }
}

LibraryBackend::~LibraryBackend() { close(); }

/// Returns the result of the call. An exception counts as a failure of the instance. A plugin that ends the thread
/// (pthread_exit) ends the process here, where the call is still known.
template <class Work>
int32_t LibraryBackend::call(const char* name, Work&& work) {
  const PluginCallScope scope(choice_.manifest.id, name);
  std::string what;
  try {
    const int32_t status = work();
    if (!DefaultFloatingPoint::rounds_to_nearest())
      host_.report(sink_.instance, ODO_SEVERITY_WARNING, "rounding_mode",
                   std::string("left another rounding mode behind in ") + name);
    DefaultFloatingPoint::restore();
    return status;
  } catch (const ForcedUnwind&) {
    abort_for_ended_thread();
  } catch (const std::bad_alloc&) {
    return ODO_E_MEMORY;
  } catch (const std::exception& error) {
    what = std::string(": ") + error.what();
  } catch (...) {
  }
  host_.report(sink_.instance, ODO_SEVERITY_ERROR, "exception",
               std::string("an exception was thrown by ") + name + what, ODO_E_ERROR);
  return ODO_E_ERROR;
}

int32_t LibraryBackend::start() {
  const odo_plugin& table = library_->table();
  const odo_string interface_id{choice_.interface_id.data(), choice_.interface_id.size()};
  int32_t status = call("create", [&] { return table.create(&host_, sink_.instance, &interface_id, &instance_); });
  if (status >= 0 && !instance_) status = ODO_E_ERROR;
  if (status < 0) {
    instance_ = nullptr;
    return status;
  }
  const auto values = values_of(choice_);
  status = call("configure", [&] {
    return table.configure(instance_, values.data(), static_cast<uint32_t>(values.size()), sizeof(odo_value));
  });
  return status < 0 ? status : call("activate", [&] { return table.activate(instance_, &given_); });
}

int32_t LibraryBackend::process(const odo_header& message) { return process(&message, 1); }
int32_t LibraryBackend::wake() { return process(nullptr, 0); }

int32_t LibraryBackend::process(const odo_header* message, uint32_t count) {
  if (!instance_) return ODO_E_STATE;
  const odo_batch batch{sizeof(odo_batch), count, &message};
  const Calling calling(caller_);
  return call("process", [&] { return library_->table().process(instance_, &batch); });
}

int32_t LibraryBackend::reset() {
  const auto function = library_->table().reset;
  if (instance_ && function && call("reset", [&] { return function(instance_); }) >= 0) return ODO_OK;
  close();
  return start();
}

void LibraryBackend::close() {
  if (odo_instance* ended = std::exchange(instance_, nullptr))
    call("destroy", [&] { return library_->table().destroy(ended), ODO_OK; });
}

std::vector<uint8_t> LibraryBackend::save() {
  const auto function = library_->table().save;
  if (!instance_ || !function) return {};
  int64_t needed = 0, written = 0;
  std::vector<uint8_t> bytes;
  call("save", [&] { return needed = function(instance_, nullptr, 0), ODO_OK; });
  if (needed > int64_t{ODO_LARGEST_STATE})
    host_.report(sink_.instance, ODO_SEVERITY_ERROR, "state_too_large",
                 "has " + std::to_string(needed) + " bytes of state to save; expected at most " +
                     std::to_string(ODO_LARGEST_STATE) + ": nothing of it is kept",
                 ODO_E_EXHAUSTED);
  if (needed <= 0 || needed > int64_t{ODO_LARGEST_STATE}) return {};
  bytes.resize(static_cast<size_t>(needed));
  call("save", [&] { return written = function(instance_, bytes.data(), bytes.size()), ODO_OK; });
  return written == needed ? bytes : std::vector<uint8_t>();
}

std::vector<uint8_t> LibraryBackend::map_piece(uint64_t offset) {
  const odo_plugin& table = library_->table();
  if (!instance_ || !ODO_HAS(&table, save_map) || !table.save_map) return {};
  std::vector<uint8_t> piece(ODO_LARGEST_PIECE);
  int64_t written = 0;
  const auto save = [&] { return written = table.save_map(instance_, offset, piece.data(), piece.size()), ODO_OK; };
  if (call("save_map", save) < 0 || written < 0 || written > int64_t{ODO_LARGEST_PIECE}) return {};
  piece.resize(static_cast<size_t>(written));
  return piece;
}

bool LibraryBackend::take_map_piece(uint64_t offset, std::span<const uint8_t> piece) {
  const odo_plugin& table = library_->table();
  if (!instance_ || !ODO_HAS(&table, load_map) || !table.load_map) return false;
  const auto load = [&] { return table.load_map(instance_, offset, piece.data(), piece.size()); };
  return call("load_map", load) >= 0;
}

const void* LibraryBackend::extension(std::string_view id) {
  const auto function = library_->table().get_interface;
  const void* table = nullptr;
  if (instance_ && function)
    call("get_interface", [&] { return table = function(instance_, id.data(), id.size()), ODO_OK; });
  return table;
}

bool LibraryBackend::load(std::span<const uint8_t> data) {
  const auto function = library_->table().load;
  return instance_ && function && call("load", [&] { return function(instance_, data.data(), data.size()); }) >= 0;
}

}  // namespace odograph
