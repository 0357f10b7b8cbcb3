// SPDX-License-Identifier: Apache-2.0
//
// Cases about the file, its manifest, the entry function and the table.
#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstring>
#include <iterator>
#include <map>
#include <set>

#include <dlfcn.h>
#include <link.h>

#include "sdk/host/base/printable.hpp"
#include "sdk/host/config/signature.hpp"
#include "sdk/host/plugin_host/instance.hpp"
#include "sdk/tools/validator/case_fixture.hpp"
#include "sdk/tools/validator/child.hpp"

namespace odograph {
CASES(entry)
namespace {
namespace fs = std::filesystem;

fs::path manifest_of(const fs::path& library) {
  auto path = library;
  path.replace_extension();
  return path += ".odoplugin.json";
}

/// Throws a Verdict if there is none.
odo_plugin_entry entry_of(const CaseFixture& fixture) {
  note_phase("loading");
  void* handle = dlopen(fixture.path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle) throw Verdict(dlerror());
  const auto entry = reinterpret_cast<odo_plugin_entry>(dlsym(handle, ODO_PLUGIN_ENTRY_SYMBOL));
  if (!entry) throw Verdict("symbol missing: " ODO_PLUGIN_ENTRY_SYMBOL);
  note_phase("entry");
  return entry;
}

/// Of a call of the entry with a struct of `size` bytes in a buffer of 4096, filled with 0x5A.
struct Answer {
  alignas(8) unsigned char storage[4096];
  int32_t status = 0;
  odo_plugin& table() { return *reinterpret_cast<odo_plugin*>(storage); }
  bool untouched_from(size_t size) const {
    return std::all_of(storage + size, storage + sizeof storage, [](unsigned char c) { return c == 0x5A; });
  }
};
Answer ask(const CaseFixture& fixture, const odo_host* host, uint32_t size) {
  Answer answer;
  std::memset(answer.storage, 0x5A, sizeof answer.storage);
  std::memset(answer.storage, 0, std::min<size_t>(size, sizeof answer.storage));
  answer.table().struct_size = size;
  answer.status = entry_of(fixture)(host, &answer.table());
  return answer;
}

bool is_plain_utf8(std::string_view text) {
  while (const size_t bytes = utf8_character(text)) {
    if (static_cast<unsigned char>(text[0]) < 0x20 && text[0] != '\n') return false;
    text.remove_prefix(bytes);
  }
  return text.empty();
}

CASE(entry, "file.library", "is a shared library for this machine", 10, 0, .loaded = false) {
  const auto file = check_shared_library(fixture.path, fixture.path);
  return file ? "" : file.failure().text;
}

CASE(entry, "file.manifest", "has a manifest beside it", 10, 0, .loaded = false) {
  const auto path = manifest_of(fixture.path);
  std::error_code error;
  if (!fs::exists(path, error)) return path.filename().string() + " is missing: `odograph plugin manifest` writes it";
  const auto manifest = read_manifest(path);
  return manifest ? "" : manifest.failure().text;
}

CASE(entry, "file.hash", "is the library of its manifest", 20, 0, .loaded = false) {
  const auto manifest = read_manifest(manifest_of(fixture.path));
  if (!manifest) return not_applicable("there is no manifest to compare with");
  const auto hash = sha256_of(fixture.path);
  return hash && *hash == manifest->sha256 ? "" : "the library is not the one of the manifest: write a new manifest";
}

CASE(entry, "file.signature", "has a manifest signed by the key of --signer", 10, 0, .loaded = false) {
  if (fixture.signer.empty()) return not_applicable("no --signer is given");
  const auto manifest = read_manifest(manifest_of(fixture.path));
  if (!manifest) return manifest.failure().text;
  const auto verified = verify_signature(*manifest, {fixture.signer});
  return verified ? "" : verified.failure().text;
}

CASE(entry, "entry.loads", "loads and exports the entry", 10, 0, .loaded = false) {
  entry_of(fixture);
  return {};
}

/// The functions and variables that a loaded library defines, exports and finds by name, so that an earlier library of
/// the process with the same name replaces them. Without weak ones, as which C++ exports inline functions.
std::vector<std::string> replaceable_symbols(void* handle) {
  link_map* map = nullptr;
  if (dlinfo(handle, RTLD_DI_LINKMAP, &map) != 0) return {};
  std::map<int64_t, uintptr_t> dynamic;
  for (const ElfW(Dyn)* entry = map->l_ld; entry->d_tag != DT_NULL; ++entry)
    dynamic[static_cast<int64_t>(entry->d_tag)] = static_cast<uintptr_t>(entry->d_un.d_val);
  const auto address = [&](int64_t tag) {  // some loaders leave it relative to the library
    const uintptr_t value = dynamic[tag];
    return value != 0 && value < map->l_addr ? value + map->l_addr : value;
  };
  const auto* symbols = reinterpret_cast<const ElfW(Sym)*>(address(DT_SYMTAB));
  const auto* names = reinterpret_cast<const char*>(address(DT_STRTAB));
  std::set<std::string> found;
  const auto take = [&](int64_t table, int64_t size, bool addends) {
    const size_t stride = addends ? sizeof(ElfW(Rela)) : sizeof(ElfW(Rel));
    for (uintptr_t at = address(table), end = at + dynamic[size]; at != 0 && at < end; at += stride) {
      const auto info = reinterpret_cast<const ElfW(Rel)*>(at)->r_info;
      const auto& symbol = symbols[sizeof info == 8 ? static_cast<uint64_t>(info) >> 32 : info >> 8];
      if (symbol.st_shndx != SHN_UNDEF && ELF64_ST_BIND(symbol.st_info) == STB_GLOBAL &&
          ELF64_ST_VISIBILITY(symbol.st_other) == STV_DEFAULT)
        found.insert(names + symbol.st_name);
    }
  };
  take(DT_RELA, DT_RELASZ, true);
  take(DT_REL, DT_RELSZ, false);
  take(DT_JMPREL, DT_PLTRELSZ, dynamic[DT_PLTREL] == DT_RELA);
  return {found.begin(), found.end()};
}

CASE(entry, "entry.exports", "keeps its functions to itself", 10, 0, .loaded = false) {
  constexpr size_t kNamed = 5;
  void* handle = dlopen(fixture.path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle) throw Verdict(dlerror());
  std::vector<std::string> replaced, all = replaceable_symbols(handle);
  std::copy_if(all.begin(), all.end(), std::back_inserter(replaced), [&](const std::string& name) {
    const void* first = dlsym(RTLD_DEFAULT, name.c_str());
    return first && first != dlsym(handle, name.c_str());
  });
  if (all.empty()) return "";
  std::string names;
  const auto& named = replaced.empty() ? all : replaced;
  for (size_t i = 0; i < std::min(named.size(), kNamed); ++i) names += (i ? ", " : "") + named[i];
  if (named.size() > kNamed) names += " and " + std::to_string(named.size() - kNamed) + " more";
  const std::string remedy = "; compile with -fvisibility=hidden, which leaves the entry exported";
  if (replaced.empty())
    return {PluginCheck::Outcome::passed,
            "note: it exports " + names + ", which a library of the app replaces if it has the same name" + remedy};
  return "it exports " + names + ", and calls those of this program instead" + remedy;
}

CASE(entry, "entry.fills_table", "fills a table that the host accepts", 10, 0, .loaded = false) {
  return fixture.load();
}

CASE(entry, "entry.quick", "loads and returns in less than 2 s", 10, 0, .loaded = false) {
  const auto before = std::chrono::steady_clock::now();
  ask(fixture, &fixture.host, sizeof(odo_plugin));
  const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
  return s < 2 ? "" : "loading and the entry took " + std::to_string(s) + " s; expected less than 2 s";
}

CASE(entry, "entry.other_major", "refuses a host of another ABI major, with a reason", 10, 0, .loaded = false) {
  odo_host future = fixture.host;
  future.abi_major_min = future.abi_major_max = ODO_ABI_MAJOR + 7;
  Answer answer = ask(fixture, &future, sizeof(odo_plugin));
  if (answer.status >= 0) return "it accepted a host of ABI major " + std::to_string(ODO_ABI_MAJOR + 7);
  return answer.table().refusal.size ? "" : "it refused without a reason (odo_plugin.refusal)";
}

CASE(entry, "entry.null", "refuses null pointers", 10, 0, .loaded = false) {
  const auto entry = entry_of(fixture);
  odo_plugin table{};
  table.struct_size = sizeof table;
  if (entry(nullptr, &table) >= 0) return "it accepted a null host";
  return entry(&fixture.host, nullptr) < 0 ? "" : "it accepted a null table";
}

CASE(entry, "entry.small_table", "refuses a table that is too small, and writes nothing beyond it", 10, 0,
     .loaded = false) {
  const Answer answer = ask(fixture, &fixture.host, 32);
  if (answer.status >= 0) return "it filled a table of 32 bytes; expected ODO_E_STRUCT_SIZE";
  return answer.untouched_from(32) ? "" : "it wrote beyond a table of 32 bytes";
}

CASE(entry, "entry.table_end", "fills older and newer hosts' tables, and writes nothing beyond them", 10, 0,
     .loaded = false) {
  for (const uint32_t size : {ODO_PLUGIN_SIZE_MIN, static_cast<uint32_t>(sizeof(odo_plugin)), 1024u}) {
    Answer answer = ask(fixture, &fixture.host, size);
    if (answer.status < 0) return "it refused a table of " + std::to_string(size) + " bytes";
    if (!answer.untouched_from(size)) return "it wrote behind a table of " + std::to_string(size) + " bytes";
    if (answer.table().struct_size > size)
      return "it states that it filled more than the table's " + std::to_string(size) + " bytes";
  }
  return "";
}

CASE(entry, "entry.twice", "returns the same table again", 10, 0, .loaded = false) {
  Answer one = ask(fixture, &fixture.host, sizeof(odo_plugin)), other = ask(fixture, &fixture.host, sizeof(odo_plugin));
  if (one.status != other.status) return "the second call returned another status";
  return text(one.table().id) == text(other.table().id) && one.table().create == other.table().create
             ? ""
             : "the second call returned another table";
}

/// Only this library is checked: its dependencies may have side effects when loaded.
CASE(entry, "entry.no_side_effects", "starts no thread and leaves no file when it is loaded", 10, 0, .loaded = false) {
  entry_of(fixture);
  const size_t files = entries_of("/proc/self/fd"), threads = entries_of("/proc/self/task"), here = entries_of(".");
  ask(fixture, &fixture.host, sizeof(odo_plugin));
  if (entries_of("/proc/self/task") > threads) return "it started a thread";
  if (entries_of("/proc/self/fd") > files) return "it left a file open";
  if (entries_of(".") > here) return "it wrote a file";
  return {};
}

CASE(entry, "file.manifest_agrees", "agrees with its manifest", 10, 0) {
  const auto manifest = read_manifest(manifest_of(fixture.path));
  if (!manifest) return not_applicable("there is no manifest to compare with");
  const odo_plugin& t = fixture.table();
  if (manifest->id != text(t.id)) return "id is '" + text(t.id) + "', the manifest says '" + manifest->id + "'";
  if (manifest->version != text(t.version))
    return "version is '" + text(t.version) + "', the manifest says '" + manifest->version + "'";
  if (manifest->interfaces.size() != t.interface_count)
    return "it serves another number of kinds than the manifest states";
  if (manifest->parameters.size() != t.parameter_count)
    return "it has another number of parameters than the manifest states";
  for (uint32_t i = 0; i < t.parameter_count; ++i)
    if (manifest->parameters[i].name != fixture.choice.manifest.parameters[i].name)
      return "parameter " + std::to_string(i) + " has another name than in the manifest";
  return "";
}

CASE(entry, "table.id", "has an id group/name", 10, 0) {
  const std::string id = text(fixture.table().id);
  const auto slash = id.find('/');
  const bool good =
      slash != std::string::npos && slash > 0 && slash + 1 < id.size() && std::all_of(id.begin(), id.end(), [](char c) {
        return std::islower(static_cast<unsigned char>(c)) || std::isdigit(static_cast<unsigned char>(c)) || c == '_' ||
               c == '/' || c == '-';
      });
  return good ? "" : "id = '" + id + "'; expected group/name in lower case";
}

CASE(entry, "table.version", "has a version major.minor.patch", 10, 0) {
  const std::string version = text(fixture.table().version);
  int major, minor, patch, end = 0;
  const bool good = std::sscanf(version.c_str(), "%d.%d.%d%n", &major, &minor, &patch, &end) == 3 && end > 0;
  return good ? "" : "version = '" + version + "'; expected major.minor.patch";
}

CASE(entry, "table.texts", "has texts in UTF-8 and a summary", 10, 0) {
  const odo_plugin& t = fixture.table();
  if (text(t.summary).empty()) return "summary is empty; expected one sentence";
  std::vector<std::string> all = {text(t.id), text(t.version), text(t.summary)};
  for (const Spec& spec : fixture.choice.manifest.parameters)
    all.insert(all.end(), {spec.name, spec.help, spec.unit, spec.fallback, spec.choices});
  for (const std::string& one : all)
    if (!is_plain_utf8(one)) return "a text is not UTF-8 or has control characters: '" + one.substr(0, 40) + "'";
  return "";
}

CASE(entry, "table.kinds", "serves kinds of this ABI, each listed once", 10, 0) {
  const odo_plugin& t = fixture.table();
  std::vector<std::string> seen;
  for (uint32_t i = 0; i < t.interface_count; ++i) {
    const std::string kind = text(t.interfaces[i]);
    if (kind_types(kind).inputs.empty())
      return "interfaces[" + std::to_string(i) + "] = '" + kind + "' is not a kind of this ABI";
    if (std::count(seen.begin(), seen.end(), kind)) return "it serves '" + kind + "' twice";
    seen.push_back(kind);
  }
  return "";
}

CASE(entry, "table.types", "declares valid message types", 10, 0) {
  const odo_plugin& t = fixture.table();
  const auto judge = [&](const uint32_t* types, uint32_t count, const char* list, bool output) -> std::string {
    for (uint32_t i = 0; i < count; ++i) {
      const std::string name = std::string(list) + "[" + std::to_string(i) + "] = " + message_name(types[i]);
      if (types[i] == 0) return name + "; expected a message type";
      if (output && is_input(types[i]) && !ODO_IS_VENDOR(types[i]) && types[i] != ODO_TYPE_CALIBRATION)
        return name + " is a sensor's; a plugin emits events";
      if (std::count(types, types + count, types[i]) > 1) return name + " is listed twice";
    }
    return "";
  };
  const std::string inputs = judge(t.inputs, t.input_count, "inputs", false);
  return inputs.empty() ? judge(t.outputs, t.output_count, "outputs", true) : inputs;
}

}  // namespace

}  // namespace odograph
