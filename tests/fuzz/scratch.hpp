// SPDX-License-Identifier: Apache-2.0
//
// Files for readers that take a path: in memory if the system has such a folder, separate for each process.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <span>
#include <string>

#include <fcntl.h>
#include <unistd.h>

namespace fuzz {

/// A folder of this process, removed at its end.
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

/// Writes a file of this name, folders included, and returns its path. The files stay open: opening one is slower than
/// most readers.
inline const std::filesystem::path& put(const std::string& name, std::span<const uint8_t> bytes) {
  struct File {
    std::filesystem::path path;
    int descriptor = -1;
  };
  static std::map<std::string, File> files;
  File& file = files[name];
  if (file.descriptor < 0) {
    file.path = folder() / name;
    std::filesystem::create_directories(file.path.parent_path());
    file.descriptor = open(file.path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  }
  const auto size = static_cast<off_t>(bytes.size());
  if (pwrite(file.descriptor, bytes.data(), bytes.size(), 0) != size || ftruncate(file.descriptor, size) != 0)
    std::abort();
  return file.path;
}

}  // namespace fuzz
