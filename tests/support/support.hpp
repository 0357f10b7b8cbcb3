// SPDX-License-Identifier: Apache-2.0
//
// Included by every test: doctest, the common part of the standard library, files and folders.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "sdk/host/base/result.hpp"
#include "sdk/host/platform/temporary_folder.hpp"

using namespace odograph;
namespace fs = std::filesystem;

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

inline bool contains(std::string_view text, std::string_view part) { return text.find(part) != text.npos; }

/// What a number is compared with that lies between two others.
struct Between {
  double above, below;
  template <class Number>
  friend bool operator==(const Number& number, const Between& ends) {
    const auto value = static_cast<double>(number);
    return value > ends.above && value < ends.below;
  }
  friend std::ostream& operator<<(std::ostream& out, const Between& ends) {
    return out << "between " << ends.above << " and " << ends.below;
  }
};

/// The result or value, which must be there: otherwise the case ends.
template <class T>
T required(T result, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  if constexpr (requires { result.failure(); }) {
    if (!result.ok()) ADD_FAIL_AT(file, line, result.failure().text);
  } else if (!result) {
    ADD_FAIL_AT(file, line, "there is no result");
  }
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
