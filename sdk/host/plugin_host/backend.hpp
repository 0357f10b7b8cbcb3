// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <odograph/plugin.h>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/plugin_host/services.hpp"

namespace odograph {

/// The message types a plugin is given and emits, and how (ODO_PLUGIN_*); empty for an unknown interface.
struct KindTypes {
  std::vector<uint32_t> inputs, outputs;
  uint32_t flags = 0;
};

/// A plugin that declares more types than this is refused. Ours declare three at most; there are 40 of ours.
inline constexpr size_t kMaxTypes = 256;

/// One instance of a plugin where it runs: in this process (LibraryBackend) or in one of its own (ProcessBackend). All
/// of it is [control] but process, which is [process]. Statuses are the plugin's own, ODO_E_ERROR where it threw.
class PluginBackend {
 public:
  virtual ~PluginBackend() = default;  ///< destroys the instance

  /// Creates, configures and activates.
  virtual int32_t start() = 0;
  virtual int32_t process(const odo_header& message) = 0;
  /// A batch of no messages, for a plugin that has asked for it (odo.wake/1).
  virtual int32_t wake() { return ODO_OK; }
  /// Back to the state after activation, by the plugin's own function or by a new instance.
  virtual int32_t reset() = 0;
  virtual std::vector<uint8_t> save() = 0;
  /// False, and nothing changed, when the plugin does not take it.
  virtual bool load(std::span<const uint8_t> data) = 0;

  /// An extension's table, or null. Its functions run in this process, so that a plugin in another one has none.
  virtual const void* extension(std::string_view) { return nullptr; }

  /// What it is given and may emit, its kind's and what its table declares.
  virtual const KindTypes& types() const = 0;
  /// After ODO_E_FATAL: no instance of this library is used any more.
  virtual void quarantine() = 0;
  virtual bool quarantined() const = 0;
  /// Why it has ended, such as "crashed (Segmentation fault) in process"; empty while it runs.
  virtual std::string ended() const { return ""; }
  /// Of its own process; -1 where it has none.
  virtual int process_id() const { return -1; }
};

/// A backend in a process of its own; ODO_E_UNSUPPORTED where there are none. [control]
Result<std::unique_ptr<PluginBackend>> open_process(const PluginChoice& choice, LibraryCheck check, HostServices& host,
                                                    const odo_sink& sink);

}  // namespace odograph
