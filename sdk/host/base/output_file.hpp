// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <string_view>

#include "sdk/host/platform/file_lock.hpp"
#include "sdk/host/base/result.hpp"

namespace odograph {

/// Writes a file as NAME.part and renames it when complete, so that the previous file remains until then, even if the
/// disk is full or a reader has it open. Links are followed; a device or a pipe is written directly. Two writers of one
/// path exclude each other during their lifetimes.
class OutputFile {
 public:
  enum class PartFile { always, if_exists };

  /// `if_exists`: a new file is written directly to its path, so that a partial file remains after a crash. ODO_E_STATE
  /// if another writer, in this or another process, has the path.
  static Result<OutputFile> create(const std::filesystem::path& file, PartFile part_file = PartFile::always);
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;
  /// Removes an uncommitted NAME.part.
  ~OutputFile();

  std::ofstream& stream() { return out_; }
  /// Moves the file to its path. On failure the previous file remains.
  Result<bool> commit();
  /// Leaves what was written on disk.
  void abandon() { part_file_.clear(); }

 private:
  OutputFile(std::filesystem::path file, std::filesystem::path part_file, FileLock lock);

  FileLock lock_;
  std::filesystem::path file_, part_file_;  // part_file_ is empty if the file itself is written
  std::ofstream out_;
};

/// Writes a complete file through OutputFile.
Result<bool> write_whole_file(const std::filesystem::path& file, std::string_view content);

}  // namespace odograph
