// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/replay/saved_files.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "sdk/host/base/output_file.hpp"

namespace odograph {

Result<std::string> read_saved_bytes(const SavedFile& saved, const std::string& path) {
  std::error_code failed;
  const auto there = std::filesystem::status(path, failed);
  if (there.type() == std::filesystem::file_type::not_found) return Failure{ODO_E_NOT_FOUND, path + ": no such file"};
  if (!std::filesystem::is_regular_file(there))
    return Failure{ODO_E_DATA, path + ": is a folder, a pipe or a device; expected a file with a saved " + saved.what};
  if (std::filesystem::file_size(path, failed) > saved.largest)
    return Failure{ODO_E_DATA, path + ": is larger than any saved " + saved.what};
  std::ifstream file(path, std::ios::binary);
  if (!file) return Failure{ODO_E_IO, path + ": cannot be opened"};
  std::stringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

Result<bool> read_saved(odo_session* session, const SavedFile& saved, const std::string& path) {
  if (path.empty()) return true;
  const auto blob = read_saved_bytes(saved, path);
  if (!blob && blob.failure().status == ODO_E_NOT_FOUND) return true;
  if (!blob) return blob.failure();
  if (saved.load(session, blob->data(), blob->size()) == ODO_OK) return true;
  odo_error error{sizeof error, ODO_OK, {}};
  odo_session_last_error(session, &error);
  return Failure{ODO_E_DATA, path + ": " + error.message};
}

Result<bool> write_saved(odo_session* session, const SavedFile& saved, const std::string& path) {
  if (path.empty()) return true;
  const int64_t size = saved.save(session, nullptr, 0);
  std::string blob(static_cast<size_t>(std::max<int64_t>(0, size)), '\0');
  if (size == 0) return Failure{ODO_E_ERROR, path + ": there is no " + saved.what + " to save"};
  if (size < 0 || saved.save(session, blob.data(), blob.size()) != size)  // a plugin may state another size each time
    return Failure{ODO_E_ERROR,
                   path + ": the " + saved.what + " could not be saved: a plugin changed its size between calls"};
  return write_whole_file(path, blob);
}

}  // namespace odograph
