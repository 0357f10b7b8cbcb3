// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/base/output_file.hpp"

#include <utility>

#include "sdk/host/platform/file_access.hpp"

namespace odograph {
namespace fs = std::filesystem;

namespace {

constexpr int kMaxLinks = 40;  // the limit of Linux

/// The file that a path refers to after following links, including a link whose target does not exist yet.
fs::path target_of(fs::path path) {
  std::error_code error;
  for (int i = 0; i < kMaxLinks && fs::is_symlink(fs::symlink_status(path, error)); ++i) {
    const fs::path next = fs::read_symlink(path, error);
    if (error) break;
    path = next.is_absolute() ? next : path.parent_path() / next;
  }
  return path;
}

}  // namespace

OutputFile::OutputFile(fs::path file, fs::path part_file, FileLock lock)
    : lock_(std::move(lock)),
      file_(std::move(file)),
      part_file_(std::move(part_file)),
      out_(part_file_.empty() ? file_ : part_file_, std::ios::binary | std::ios::trunc) {}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : lock_(std::move(other.lock_)),
      file_(std::move(other.file_)),
      part_file_(std::exchange(other.part_file_, {})),
      out_(std::move(other.out_)) {}

OutputFile::~OutputFile() {
  const FileSizeLimit limit;
  out_.close();
  std::error_code error;
  if (!part_file_.empty()) fs::remove(part_file_, error);
}

Result<OutputFile> OutputFile::create(const fs::path& file, PartFile part_file) {
  const fs::path target = target_of(file);
  std::error_code error;
  const auto status = fs::status(target, error);
  const bool exists = fs::exists(status);
  const bool plain = !exists || fs::is_regular_file(status);  // a device or a pipe may have several writers
  fs::path part = target;
  part += ".part";
  const bool has_part_file = exists ? plain : part_file == PartFile::always;
  FileLock lock;
  auto state = FileLock::State::impossible;
  if (plain && (FileLock::is_held(has_part_file ? target : part)))
    state = FileLock::State::busy;
  else if (plain)
    state = lock.take(has_part_file ? part : target);
  if (state == FileLock::State::busy)
    return Failure{ODO_E_STATE, file.string() + ": is being written by another recorder or run"};
  OutputFile made(target, has_part_file ? part : fs::path(), std::move(lock));
  if (!made.out_) {
    made.abandon();
    return Failure{ODO_E_IO, file.string() + ": cannot be written"};
  }
  return made;
}

Result<bool> OutputFile::commit() {
  const FileSizeLimit limit;
  out_.close();
  std::error_code error;
  if (out_ && !part_file_.empty()) fs::rename(part_file_, file_, error);
  if (!out_ || error) return Failure{ODO_E_IO, file_.string() + ": writing failed; is the disk full?"};
  part_file_.clear();
  return true;
}

Result<bool> write_whole_file(const fs::path& file, std::string_view content) {
  auto out = OutputFile::create(file);
  if (!out) return out.failure();
  const FileSizeLimit limit;
  out->stream().write(content.data(), static_cast<std::streamsize>(content.size()));
  return out->commit();
}

}  // namespace odograph
