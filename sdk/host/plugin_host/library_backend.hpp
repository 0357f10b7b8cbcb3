// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <thread>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/plugin_host/backend.hpp"
#include "sdk/host/plugin_host/library.hpp"
#include "sdk/host/plugin_host/services.hpp"

namespace odograph {

/// An instance in this process. Exceptions that leave the plugin are caught and reported if host and plugin share a C++
/// runtime ABI; PluginCallScope names the plugin in a crash (plugin_call.hpp). An event from one of the plugin's own
/// threads is refused and reported, because the host cannot receive it then.
class LibraryBackend : public PluginBackend {
 public:
  /// `choice` and `sink` outlive it. A plugin that ends the thread (pthread_exit) ends the process, because the thread
  /// is the app's.
  static Result<std::unique_ptr<LibraryBackend>> load(const PluginChoice& choice, LibraryCheck check,
                                                      HostServices& host, const odo_sink& sink);
  ~LibraryBackend() override;

  int32_t start() override;
  int32_t process(const odo_header& message) override;
  int32_t wake() override;
  int32_t reset() override;
  std::vector<uint8_t> save() override;
  bool load(std::span<const uint8_t> data) override;
  std::vector<uint8_t> map_piece(uint64_t offset) override;
  bool take_map_piece(uint64_t offset, std::span<const uint8_t> piece) override;
  const void* extension(std::string_view id) override;
  const KindTypes& types() const override { return types_; }
  void quarantine() override { library_->quarantine(); }
  bool quarantined() const override { return library_->quarantined(); }
  /// Destroys the instance; it is not called any more.
  void close();

 private:
  struct Sink : odo_sink {
    LibraryBackend* owner;
  };

  static int32_t emit(const odo_sink* sink, const odo_header* event);
  LibraryBackend(std::shared_ptr<PluginLibrary> library, const PluginChoice& choice, HostServices& host,
                 const odo_sink& sink);
  int32_t process(const odo_header* message, uint32_t count);
  template <class Work>
  int32_t call(const char* name, Work&& work);

  std::shared_ptr<PluginLibrary> library_;
  const PluginChoice& choice_;
  HostServices& host_;
  const odo_sink& sink_;
  Sink given_{};                             // passed to the plugin
  std::atomic<std::thread::id> caller_{{}};  // of the current call
  KindTypes types_;
  odo_instance* instance_ = nullptr;
};

}  // namespace odograph
