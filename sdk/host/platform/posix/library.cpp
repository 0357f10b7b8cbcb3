// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/platform/library.hpp"

#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <mutex>
#include <string_view>

#include <dlfcn.h>
#include <unwind.h>

namespace odograph {
namespace {

/// An exception of a plugin may be unwound by another copy of libgcc, which then calls this copy to set registers. A
/// copy that has never unwound anything aborts there (`dwarf_reg_size_table`, libgcc's unwind-dw2.c), so this
/// initialises it by walking its own stack once.
void make_ready_for_foreign_exceptions() {
  static const auto looked = _Unwind_Backtrace([](_Unwind_Context*, void*) { return _URC_END_OF_STACK; }, nullptr);
  (void)looked;
}

/// From the list of mappings: dladdr() names the program by its argv[0], and a library by the path it was opened with,
/// either of which another folder can answer to.
std::filesystem::path file_that_holds(uintptr_t here) {
  std::ifstream mappings("/proc/self/maps");
  for (std::string line; std::getline(mappings, line);) {  // FROM-TO rights offset device inode PATH, addresses in hex
    uintptr_t from = 0, to = 0;
    if (std::sscanf(line.c_str(), "%" SCNxPTR "-%" SCNxPTR, &from, &to) != 2 || here < from || here >= to) continue;
    const size_t path = line.find('/');
    if (path == std::string::npos) break;
    constexpr std::string_view kReplaced = " (deleted)";  // by an upgrade: its folder is still the right one
    if (line.ends_with(kReplaced)) line.erase(line.size() - kReplaced.size());
    return std::filesystem::weakly_canonical(line.substr(path));
  }
  return {};
}

}  // namespace

void* open_library(const std::filesystem::path& path, std::string& why) {
  make_ready_for_foreign_exceptions();
  dlerror();
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) {
    const char* said = dlerror();
    why = said ? said : "no reason given";
  }
  return library;
}

void* library_symbol(void* library, const char* name) { return dlsym(library, name); }

std::filesystem::path own_file() {
  static std::mutex mutex;
  static std::filesystem::path found;  // kept: later there may be no free descriptor to read the list with
  const std::lock_guard lock(mutex);
  if (found.empty()) found = file_that_holds(reinterpret_cast<uintptr_t>(&own_file));
  return found;
}

}  // namespace odograph
