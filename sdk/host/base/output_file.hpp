// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <string_view>

#include "sdk/host/platform/file_lock.hpp"
#include "sdk/host/base/result.hpp"

namespace odograph {

/// A file that is written beside its place, as NAME.part, and put there when it is whole: what was there before stays
/// until then, also where the disk is full or the file is being read meanwhile. A link is followed; a device or a pipe
/// is written directly. Two of one place exclude each other, from create to the end of their lives.
class OutputFile {
 public:
  enum class Beside { always, if_exists };

  /// `if_exists`: a new file is written in its place at once, so that after a crash it lies there as far as it came.
  /// ODO_E_STATE: another one is writing it, in this process or in another.
  static Result<OutputFile> create(const std::filesystem::path& file, Beside beside = Beside::always);
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;
  /// What was written beside and not committed is removed.
  ~OutputFile();

  std::ofstream& stream() { return out_; }
  /// Puts the file in its place. A failure leaves there what was there.
  Result<bool> commit();
  /// Leaves what has been written where it lies.
  void abandon() { beside_.clear(); }

 private:
  OutputFile(std::filesystem::path file, std::filesystem::path beside, FileLock lock);

  FileLock lock_;
  std::filesystem::path file_, beside_;  // beside_ is empty where the file itself is written
  std::ofstream out_;
};

/// A whole file by OutputFile.
Result<bool> write_whole_file(const std::filesystem::path& file, std::string_view content);

}  // namespace odograph
