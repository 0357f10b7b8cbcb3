// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace odograph {

/// Converts UTF-8 text, as used in the contract and in configs, to a path. A std::filesystem::path made from a
/// std::string uses the code page on Windows. [any]
inline std::filesystem::path utf8_path(std::string_view text) { return std::u8string(text.begin(), text.end()); }

/// The inverse, for messages and other libraries. [any]
inline std::string utf8_text(const std::filesystem::path& path) {
  const std::u8string text = path.u8string();
  return {text.begin(), text.end()};
}

}  // namespace odograph
