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

/// The message types that a plugin receives and emits, and its flags (ODO_PLUGIN_*).
struct KindTypes {
  std::vector<uint32_t> inputs, outputs;
  uint32_t flags = 0;
};

/// The message types that a kind receives and emits; empty for an unknown interface.
KindTypes kind_types(const std::string& interface_id);
/// The same, extended by the plugin's table.
KindTypes plugin_types(const std::string& interface_id, const odo_plugin& table);

/// Maximum number of types that a plugin may declare. Ours declare three at most; there are 40 in all.
inline constexpr size_t kMaxTypes = 256;

/// One plugin instance where it runs: in this process (LibraryBackend) or in its own (ProcessBackend). Everything is
/// [control], except process, which is [process]. Statuses are the plugin's own, or ODO_E_ERROR if it threw.
class PluginBackend {
 public:
  virtual ~PluginBackend() = default;  ///< destroys the instance

  /// Creates, configures and activates the plugin.
  virtual int32_t start() = 0;
  virtual int32_t process(const odo_header& message) = 0;
  /// Calls process without messages, for a plugin that requested it (odo.wake/1).
  virtual int32_t wake() { return ODO_OK; }
  /// Returns to the state after activation, through the plugin's own function or a new instance.
  virtual int32_t reset() = 0;
  virtual std::vector<uint8_t> save() = 0;
  /// False, and nothing changed, if the plugin rejects the data.
  virtual bool load(std::span<const uint8_t> data) = 0;
  /// The plugin's map from an offset on, at most ODO_LARGEST_PIECE bytes; empty at its end, or if it makes none.
  virtual std::vector<uint8_t> map_piece(uint64_t offset) = 0;
  /// Passes a piece of a map to it; an empty one ends the map. False if the plugin rejects it or takes none.
  virtual bool take_map_piece(uint64_t offset, std::span<const uint8_t> piece) = 0;

  /// An extension's table, or null. Its functions run in this process, so a plugin in another process has none.
  virtual const void* extension(std::string_view) { return nullptr; }

  /// Types that it receives and may emit: its kind's, and those that its table declares.
  virtual const KindTypes& types() const = 0;
  /// After ODO_E_FATAL: no instance of this library is used any more.
  virtual void quarantine() = 0;
  virtual bool quarantined() const = 0;
  /// Why it ended, such as "crashed (Segmentation fault) in process"; empty while it runs.
  virtual std::string ended() const { return ""; }
  /// Id of its own process; -1 if it has none.
  virtual int process_id() const { return -1; }
};

/// Opens a backend in its own process; ODO_E_UNSUPPORTED on platforms without processes. [control]
Result<std::unique_ptr<PluginBackend>> open_process(const PluginChoice& choice, LibraryCheck check, HostServices& host,
                                                    const odo_sink& sink);

}  // namespace odograph
