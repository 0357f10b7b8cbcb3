// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace odograph {

/// Loads a shared library, by its path or, for one of the system's, by its name: all symbols at once, none of them seen
/// by others. Never unloaded. Null where it cannot be loaded, and why. [any]
void* open_library(const std::filesystem::path& path, std::string& why);

/// What the library exports by this name; null where it does not. [any]
void* library_symbol(void* library, const char* name);

/// The file that this code is in, a library or the program, absolute and without links; empty where there is none.
/// [any]
std::filesystem::path own_file();

}  // namespace odograph
