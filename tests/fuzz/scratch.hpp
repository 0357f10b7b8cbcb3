// SPDX-License-Identifier: Apache-2.0
//
// Files for readers that take a path: in memory where the system has such a folder, and one for each process.
#pragma once

#include <filesystem>
#include <fstream>
#include <span>
#include <string>

#include <unistd.h>

namespace fuzz {

/// A folder of this process's own, which is there for as long as the process.
inline const std::filesystem::path& folder() {
  struct Folder {
    std::filesystem::path path;
    Folder() {
      const bool in_memory = access("/dev/shm", W_OK) == 0;
      path = in_memory ? "/dev/shm" : std::filesystem::temp_directory_path();
      path /= "odograph-fuzz-" + std::to_string(getpid());
      std::filesystem::create_directories(path);
    }
    ~Folder() {
      std::error_code error;
      std::filesystem::remove_all(path, error);
    }
  };
  static const Folder mine;
  return mine.path;
}

/// Writes a file of this name, folders included, and returns its path.
inline std::filesystem::path put(const std::string& name, std::span<const uint8_t> bytes) {
  const auto path = folder() / name;
  std::ofstream file(path, std::ios::binary);
  if (!file) {
    std::filesystem::create_directories(path.parent_path());
    file.open(path, std::ios::binary);
  }
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return path;
}

}  // namespace fuzz
