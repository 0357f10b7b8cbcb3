// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/platform/file_access.hpp"

namespace odograph {

bool is_world_writable(const std::filesystem::path&, bool) { return false; }

FileSizeLimit::FileSizeLimit() = default;
FileSizeLimit::~FileSizeLimit() = default;

}  // namespace odograph
