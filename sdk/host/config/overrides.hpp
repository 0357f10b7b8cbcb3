// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sdk/host/config/yaml_tree.hpp"

namespace odograph {

/// A value that replaces one in a config. `path`: keys separated by dots; a list item is named by its index from 0 or
/// by its `plugin`: `absolute_fixers.fix/gnss.parameters.correlation`. `value`: as in the file.
struct Override {
  std::string path, value;
};

/// Parses "walker.height=1.8 m". ODO_E_ARGUMENT if there is no path before the equals sign.
Result<Override> parse_override(const std::string& text);

/// The node at a path, or null.
const YamlNode* node_at(const YamlNode& root, const std::string& path);

/// Returns the config with the values replaced; creates missing maps along a path. ODO_E_CONFIG for an unknown key,
/// with the nearest valid key or the items of the list.
Result<YamlNode> with_overrides(YamlNode config, const std::vector<Override>& overrides);

/// Formats the node as YAML with the same values. Comments and positions are lost.
std::string yaml_text(const YamlNode& node);

/// Text of a config file with the overrides applied and its relative paths (`camera`, `plugins.search`, `plugins.host`,
/// files of `plugins.allow`) made absolute, so that it is valid from any directory. Without overrides, the original
/// text.
Result<std::string> effective_config(const std::string& file, const std::vector<Override>& overrides);

}  // namespace odograph
