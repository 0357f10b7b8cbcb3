// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace odograph {

/// Loads a shared library by its path, or a system library by its name: resolves all symbols at once and keeps them
/// local. Never unloaded. Null, with the reason in `why`, on failure. [any]
void* open_library(const std::filesystem::path& path, std::string& why);

/// The exported symbol, or null. [any]
void* library_symbol(void* library, const char* name);

/// The file that contains this code, a library or the program, absolute and without links; empty if unknown. [any]
std::filesystem::path own_file();

}  // namespace odograph
