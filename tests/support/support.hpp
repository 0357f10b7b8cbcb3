// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <doctest/doctest.h>

#include "sdk/host/base/result.hpp"
#include "sdk/host/platform/temporary_folder.hpp"

using odograph::TemporaryFolder;

inline std::filesystem::path write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// The result, which must be good: a failure ends the case.
template <class T>
odograph::Result<T> required(odograph::Result<T> result, const char* file = __builtin_FILE(),
                             int line = __builtin_LINE()) {
  if (!result.ok()) ADD_FAIL_AT(file, line, result.failure().text);
  return result;
}

/// A file of the source tree, of the build folder.
std::filesystem::path source(const std::string& name);
std::filesystem::path built(const std::string& name);
inline std::filesystem::path plugin_folder() { return built("lib/odograph/plugins"); }

/// Whether the camera and terrain plugins are built (ODOGRAPH_OPENCV); cases that need one are skipped otherwise.
inline constexpr bool kCameraPlugins = ODOGRAPH_CAMERA_PLUGINS;

/// Reports what is missing; if no check fails, the program then ends with 77, which ctest shows as "Skipped".
void skip(const std::string& why);

/// Real data of that name, from the folder in the environment variable ODOGRAPH_DATA or, without it, the build's. If
/// missing, the result is empty and the case is skipped; with ODOGRAPH_REQUIRE_DATA (likewise) the case fails at once.
/// Cases that call it belong to separate suites, named ..._data, so that ctest shows what did not run.
std::filesystem::path data_or_skip(const std::string& name);
