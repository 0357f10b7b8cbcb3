// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace odograph {

/// Whether every user of this machine may change the file, or replace files in the folder; false if the system cannot
/// tell. With `owners_only_is_safe`, a folder to which everybody may add files but where nobody may replace another
/// user's counts as safe (POSIX sticky bit, as on /tmp; Windows' right to delete children). [any]
bool is_world_writable(const std::filesystem::path& path, bool owners_only_is_safe);

/// While it lives, a write beyond the process' limit of file size (RLIMIT_FSIZE) fails on this thread, instead of
/// ending the process by a signal. What other threads and the app do with the signal stays as it is.
class FileSizeLimit {
 public:
  FileSizeLimit();
  ~FileSizeLimit();
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  bool was_pending_ = false, was_blocked_ = false;
};

}  // namespace odograph
