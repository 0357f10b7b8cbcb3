// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/plugin_host/assets.hpp"

#include <algorithm>
#include <fstream>
#include <memory>
#include <new>

#include "sdk/host/platform/utf8_path.hpp"

struct odo_asset {
  std::ifstream file;
  uint64_t size = 0;
};

namespace odograph {

std::optional<std::filesystem::path> find_asset(const std::vector<std::filesystem::path>& folders,
                                                const std::string& name) {
  const std::filesystem::path path = utf8_path(name);
  std::error_code error;
  if (path.is_absolute()) {
    auto found = std::filesystem::canonical(path, error);
    return error ? std::nullopt : std::optional(found);
  }
  for (const auto& folder : folders)
    if (auto found = std::filesystem::canonical(folder / path, error); !error) return found;
  return std::nullopt;
}

int32_t open_asset(const std::vector<std::filesystem::path>& folders, const std::string& name, odo_asset** asset,
                   uint64_t* size) noexcept {
  if (!asset || !size) return ODO_E_ARGUMENT;
  *asset = nullptr;
  *size = 0;
  try {
    const auto path = find_asset(folders, name);
    std::error_code error;
    if (!path || !std::filesystem::is_regular_file(*path, error)) return ODO_E_NOT_FOUND;  // a pipe would block
    auto made = std::make_unique<odo_asset>();
    made->file.open(*path, std::ios::binary);
    made->size = std::filesystem::file_size(*path, error);
    if (!made->file || error) return ODO_E_NOT_FOUND;
    *size = made->size;
    *asset = made.release();
    return ODO_OK;
  } catch (const std::bad_alloc&) {
    return ODO_E_MEMORY;
  } catch (...) {
    return ODO_E_NOT_FOUND;
  }
}

int64_t read_asset(odo_asset* asset, uint64_t offset, void* data, uint64_t size) noexcept {
  if (!asset || (!data && size > 0)) return ODO_E_ARGUMENT;
  if (offset >= asset->size) return 0;
  try {
    asset->file.clear();
    asset->file.seekg(static_cast<std::streamoff>(offset));
    asset->file.read(static_cast<char*>(data), static_cast<std::streamsize>(std::min(size, asset->size - offset)));
    return asset->file.bad() ? ODO_E_DATA : asset->file.gcount();
  } catch (...) {
    return ODO_E_DATA;
  }
}

void close_asset(odo_asset* asset) noexcept { delete asset; }

}  // namespace odograph
