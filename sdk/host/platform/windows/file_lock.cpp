// SPDX-License-Identifier: Apache-2.0
//
// Locks one byte far beyond the end of any file, because a lock prevents others from reading and writing its range.
#include "sdk/host/platform/file_lock.hpp"

#include <io.h>
#include <windows.h>

namespace odograph {
namespace {

constexpr DWORD kByteHigh = 0x40000000;  // offset 2^62

HANDLE open_file(const std::filesystem::path& file, DWORD access, DWORD how) {
  // Opens a link itself without following it; others may read, write and rename meanwhile.
  return CreateFileW(file.c_str(), access, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, nullptr, how,
                     FILE_ATTRIBUTE_NORMAL | FILE_FLAG_OPEN_REPARSE_POINT, nullptr);
}

bool lock(HANDLE file, DWORD kind) {
  OVERLAPPED where{};
  where.OffsetHigh = kByteHigh;
  return LockFileEx(file, kind | LOCKFILE_FAIL_IMMEDIATELY, 0, 1, 0, &where);
}

bool is_plain_and_alone(HANDLE file) {
  BY_HANDLE_FILE_INFORMATION about{};
  constexpr DWORD others = FILE_ATTRIBUTE_DIRECTORY | FILE_ATTRIBUTE_DEVICE | FILE_ATTRIBUTE_REPARSE_POINT;
  return GetFileInformationByHandle(file, &about) && (about.dwFileAttributes & others) == 0 &&
         about.nNumberOfLinks == 1;
}

}  // namespace

FileLock::~FileLock() {
  if (fd_ >= 0) _close(fd_);
}

FileLock::State FileLock::take(const std::filesystem::path& path) {
  for (int i = 0; i < 2; ++i) {
    HANDLE file = open_file(path, GENERIC_READ | GENERIC_WRITE, OPEN_ALWAYS);
    if (file == INVALID_HANDLE_VALUE) return State::impossible;
    if (!is_plain_and_alone(file)) {
      CloseHandle(file);
      if (!DeleteFileW(path.c_str())) return State::impossible;
      continue;
    }
    if (!lock(file, LOCKFILE_EXCLUSIVE_LOCK)) {
      CloseHandle(file);
      return State::busy;
    }
    fd_ = _open_osfhandle(reinterpret_cast<intptr_t>(file), 0);
    if (fd_ < 0) CloseHandle(file);
    return fd_ < 0 ? State::impossible : State::held;
  }
  return State::impossible;
}

bool FileLock::is_held(const std::filesystem::path& path) {
  HANDLE file = open_file(path, GENERIC_READ, OPEN_EXISTING);
  if (file == INVALID_HANDLE_VALUE) return false;
  const bool held = !lock(file, 0) && GetLastError() == ERROR_LOCK_VIOLATION;
  CloseHandle(file);
  return held;
}

}  // namespace odograph
