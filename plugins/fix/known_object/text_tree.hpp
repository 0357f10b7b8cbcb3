// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace odograph::known_object {

/// Parses YAML into a tree of JSON values: maps, lists, numbers (plain scalars that parse as one) and strings. No
/// aliases, at most 64 levels and 100,000 nodes, no duplicate keys. Throws std::runtime_error with line and column.
nlohmann::json parse_yaml(const std::string& text);

}  // namespace odograph::known_object
