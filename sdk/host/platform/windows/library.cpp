// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/platform/library.hpp"

#include <windows.h>

namespace odograph {
namespace {

std::string reason_of(DWORD code) {
  wchar_t* wide = nullptr;
  const DWORD length =
      FormatMessageW(FORMAT_MESSAGE_ALLOCATE_BUFFER | FORMAT_MESSAGE_FROM_SYSTEM | FORMAT_MESSAGE_IGNORE_INSERTS,
                     nullptr, code, 0, reinterpret_cast<wchar_t*>(&wide), 0, nullptr);
  std::wstring text(wide ? wide : L"", length);
  LocalFree(wide);
  while (!text.empty() && (text.back() == L'\n' || text.back() == L'\r')) text.pop_back();
  return std::filesystem::path(text).string() + " (error " + std::to_string(code) + ")";
}

}  // namespace

// Searches dependencies beside the library and in the system's folders, never in the current directory.
void* open_library(const std::filesystem::path& path, std::string& why) {
  const DWORD where = path.is_absolute() ? LOAD_LIBRARY_SEARCH_DLL_LOAD_DIR | LOAD_LIBRARY_SEARCH_DEFAULT_DIRS
                                         : LOAD_LIBRARY_SEARCH_DEFAULT_DIRS;
  HMODULE library = LoadLibraryExW(path.c_str(), nullptr, where);
  if (!library) why = reason_of(GetLastError());
  return reinterpret_cast<void*>(library);
}

void* library_symbol(void* library, const char* name) {
  return reinterpret_cast<void*>(GetProcAddress(reinterpret_cast<HMODULE>(library), name));
}

std::filesystem::path own_file() {
  HMODULE self = nullptr;
  constexpr DWORD flags = GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT;
  if (!GetModuleHandleExW(flags, reinterpret_cast<const wchar_t*>(&own_file), &self)) return {};
  std::wstring name(MAX_PATH, L'\0');
  DWORD length = GetModuleFileNameW(self, name.data(), static_cast<DWORD>(name.size()));
  while (length == name.size() && name.size() < 65536) {  // truncated
    name.resize(2 * name.size());
    length = GetModuleFileNameW(self, name.data(), static_cast<DWORD>(name.size()));
  }
  name.resize(length);
  return name;
}

}  // namespace odograph
