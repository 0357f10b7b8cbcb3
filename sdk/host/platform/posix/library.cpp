// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/platform/library.hpp"

#include <cstring>

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
  Dl_info self{};
  if (!dladdr(reinterpret_cast<const void*>(&own_file), &self) || !self.dli_fname) return {};
  // For the program itself, dli_fname is argv[0], which the shell may have found in PATH.
  const bool by_name = std::strchr(self.dli_fname, '/') == nullptr;
  std::error_code error;
  auto file = std::filesystem::canonical(by_name ? "/proc/self/exe" : self.dli_fname, error);
  return error ? std::filesystem::path() : file;
}

}  // namespace odograph
