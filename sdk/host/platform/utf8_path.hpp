// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace odograph {

/// The path of a text in UTF-8, as all texts of the contract and of configs are. A std::filesystem::path of a
/// std::string is of the machine's code page on Windows. [any]
inline std::filesystem::path utf8_path(std::string_view text) { return std::u8string(text.begin(), text.end()); }

/// The other way round, for messages and for other libraries. [any]
inline std::string utf8_text(const std::filesystem::path& path) {
  const std::u8string text = path.u8string();
  return {text.begin(), text.end()};
}

}  // namespace odograph
