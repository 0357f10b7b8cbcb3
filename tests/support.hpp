// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "sdk/host/base/temporary_folder.hpp"

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

inline std::filesystem::path source(const std::string& name) { return std::filesystem::path(ODOGRAPH_SOURCE) / name; }
inline std::filesystem::path plugin_folder() { return std::filesystem::path(ODOGRAPH_BUILD) / "lib/odograph/plugins"; }

/// The folder of real recordings, or nothing (and a line that says so) where it is missing.
inline std::filesystem::path data_or_skip(const std::string& name) {
  const auto path = std::filesystem::path(ODOGRAPH_DATA) / name;
  if (std::filesystem::exists(path)) return path;
  std::printf("SKIPPED: no real recordings at %s\n", path.c_str());
  return {};
}
