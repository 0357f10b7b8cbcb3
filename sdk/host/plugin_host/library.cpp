// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/plugin_host/library.hpp"

#include <algorithm>
#include <cstring>
#include <exception>

#include <odograph/messages.h>
#include <odograph/odograph.h>

#include "sdk/host/base/forced_unwind.hpp"
#include "sdk/host/base/printable.hpp"
#include "sdk/host/config/linked_plugins.hpp"
#include "sdk/host/platform/library.hpp"
#include "sdk/host/plugin_host/backend.hpp"
#include "sdk/host/plugin_host/sealed_copy.hpp"
#include "sdk/host/plugin_host/services.hpp"

namespace odograph {
namespace {

std::string version_fault(const odo_plugin& table, const odo_host& host) {
  const std::string its = "it is for ABI " + std::to_string(table.abi_major) + "." + std::to_string(table.abi_minor);
  if (table.abi_major < host.abi_major_min || table.abi_major > host.abi_major_max)
    return its + ", this host has major " + std::to_string(host.abi_major_max);
  return "";
}

/// "group/name", see odo_plugin.id.
bool is_plugin_id(const std::string& id) {
  const auto slash = id.find('/');
  return slash != std::string::npos && slash > 0 && slash + 1 < id.size() && id.size() < 64 &&
         id.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_-") == slash &&
         id.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_-", slash + 1) == std::string::npos &&
         !id.starts_with("odo/") && !id.starts_with("host/");
}

/// The fault of a table, or nothing.
std::string table_fault(const odo_plugin& t) {
  for (const auto& [present, name] :
       {std::pair{t.create != nullptr, "create"}, std::pair{t.configure != nullptr, "configure"},
        std::pair{t.activate != nullptr, "activate"}, std::pair{t.process != nullptr, "process"},
        std::pair{t.destroy != nullptr, "destroy"}})
    if (!present) return std::string("its table lacks ") + name;
  if (const std::string id = text(t.id); !is_plugin_id(id))
    return "its id is '" + id +
           "'; expected group/name of a-z, 0-9, _ and -, at most 63 bytes, not of group odo or host";
  if (t.interface_count == 0 || !t.interfaces) return "its table has no interface";
  if ((t.input_count > 0 && !t.inputs) || (t.output_count > 0 && !t.outputs))
    return "its table counts inputs or outputs and has no list of them";
  if (t.input_count > kMaxTypes || t.output_count > kMaxTypes)
    return "its table has " + std::to_string(std::max(t.input_count, t.output_count)) +
           " inputs or outputs; expected at most " + std::to_string(kMaxTypes);
  return "";
}

/// Calls the entry function and checks its table; members missing in a smaller table are null.
Result<odo_plugin> read_table(odo_plugin_entry entry, const odo_host* host, const std::string& place) {
  const auto fail = [&](int32_t status, const std::string& why) { return Failure{status, place + ": " + why}; };
  // Extra room protects against a newer plugin that writes its larger table.
  alignas(odo_plugin) unsigned char storage[4096] = {};
  auto* filled = reinterpret_cast<odo_plugin*>(storage);
  filled->struct_size = sizeof(odo_plugin);
  int32_t status = ODO_E_ERROR;
  try {
    status = entry(host, filled);
  } catch (const ForcedUnwind&) {  // the plugin ends its thread (pthread_exit)
    throw;
  } catch (const std::exception& error) {
    return fail(ODO_E_ERROR, std::string("its entry threw an exception: ") + error.what());
  } catch (...) {
    return fail(ODO_E_ERROR, "its entry threw an exception");
  }
  if (status != ODO_OK) {
    const std::string refusal = text(filled->refusal);
    return fail(status < 0 ? status : ODO_E_ERROR,
                "it refused to start: " + (refusal.empty() ? odo_status_text(status) : refusal));
  }
  if (const auto fault = version_fault(*filled, *host); !fault.empty()) return fail(ODO_E_VERSION, fault);
  if (filled->struct_size < ODO_PLUGIN_SIZE_MIN)
    return fail(ODO_E_STRUCT_SIZE, "its table has struct_size = " + std::to_string(filled->struct_size) +
                                       "; expected at least " + std::to_string(ODO_PLUGIN_SIZE_MIN));
  odo_plugin table{};
  std::memcpy(&table, filled, std::min<size_t>(filled->struct_size, sizeof table));
  if (const auto fault = table_fault(table); !fault.empty()) return fail(ODO_E_DATA, fault);
  const auto parameters = parameter_specs(table);
  if (!parameters) return fail(parameters.failure().status, parameters.failure().text);
  return table;
}

}  // namespace

Result<std::shared_ptr<PluginLibrary>> PluginLibrary::load(const std::filesystem::path& path, const odo_host* host) {
  return open(path, path, ODO_PLUGIN_ENTRY_SYMBOL, host);
}

Result<std::shared_ptr<PluginLibrary>> PluginLibrary::open(const std::filesystem::path& path,
                                                           const std::filesystem::path& opened,
                                                           const std::string& symbol, const odo_host* host) {
  const auto fail = [&](int32_t status, const std::string& why) { return Failure{status, path.string() + ": " + why}; };
  const auto file = check_shared_library(opened, path);
  if (!file) return file.failure();
  std::string why;
  void* handle = open_library(std::filesystem::absolute(opened), why);
  if (!handle)
    return fail(ODO_E_DATA,
                "the loader refused it: " + why +
                    (opened == path ? "" : "; loaded from a sealed copy, for which $ORIGIN is not its folder"));
  const auto entry = reinterpret_cast<odo_plugin_entry>(library_symbol(handle, symbol.c_str()));
  if (!entry) return fail(ODO_E_UNSUPPORTED, "symbol missing: it does not export " + symbol);

  const auto table = read_table(entry, host, path.string());
  if (!table) return table.failure();
  auto library = std::make_shared<PluginLibrary>();
  library->path_ = path;
  library->table_ = *table;
  return library;
}

Result<std::shared_ptr<PluginLibrary>> PluginLibrary::load(const Manifest& manifest, LibraryCheck check,
                                                           const odo_host* host) {
  odo_plugin promised{};
  promised.abi_major = manifest.abi_major;
  promised.abi_minor = manifest.abi_minor;
  if (const auto fault = version_fault(promised, *host); !fault.empty())
    return Failure{ODO_E_VERSION, (manifest.entry ? manifest.place() : manifest.path.string()) + ": " + fault};
  if (manifest.entry) {
    const auto table = read_table(manifest.entry, host, manifest.place());
    if (!table) return table.failure();
    auto library = std::make_shared<PluginLibrary>();
    library->table_ = *table;
    return library;
  }
  std::filesystem::path opened = manifest.library;
  if (check == LibraryCheck::hash)
    if (const auto same = has_hash_of(manifest, opened); !same) return same.failure();
  if (check == LibraryCheck::sealed && manifest.sha256.empty())
    return Failure{ODO_E_CONFIG, manifest.path.string() +
                                     ": it has no sha256, which plugins allowed by hash or signature need; `odograph "
                                     "plugin manifest` writes it"};
  if (check == LibraryCheck::sealed) {
    const auto copy = sealed_copy(manifest);
    if (!copy) return copy.failure();
    opened = *copy;
  }
  auto library = open(manifest.library, opened, manifest.entry_symbol, host);
  if (library && text((*library)->table().id) != manifest.id)
    return Failure{ODO_E_DATA, manifest.library.string() + ": its id is '" + text((*library)->table().id) +
                                   "', the manifest says '" + manifest.id + "'"};
  return library;
}

Result<bool> register_plugin(odo_plugin_entry entry) {
  const HostServices host(0, {}, nullptr);
  const auto table = read_table(entry, &host, "the entry");
  if (!table) return table.failure();
  const auto manifest = manifest_of(*table, entry);
  if (!manifest) return manifest.failure();
  return add_linked_plugin(*manifest);
}

}  // namespace odograph
