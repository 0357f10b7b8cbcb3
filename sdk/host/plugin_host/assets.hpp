// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <odograph/plugin.h>

namespace odograph {

/// The file of that name in the first folder that contains it, absolute and without links.
std::optional<std::filesystem::path> find_asset(const std::vector<std::filesystem::path>& folders,
                                                const std::string& name);

// File-backed odo.contents/1 (plugin.h).
int32_t open_asset(const std::vector<std::filesystem::path>& folders, const std::string& name, odo_asset** asset,
                   uint64_t* size) noexcept;
int64_t read_asset(odo_asset* asset, uint64_t offset, void* data, uint64_t size) noexcept;
void close_asset(odo_asset* asset) noexcept;

}  // namespace odograph
