// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sdk/host/config/yaml_tree.hpp"

namespace odograph {

/// A value that takes the place of what a config says. `path`: its keys with dots between them; of a list an item by
/// its number from 0 or by its `plugin`: `absolute_fixers.fix/gnss.parameters.correlation`. `value`: as in the file.
struct Override {
  std::string path, value;
};

/// "walker.height=1.8 m". ODO_E_ARGUMENT without a path before an equals sign.
Result<Override> parse_override(const std::string& text);

/// What stands at a path, or null.
const YamlNode* node_at(const YamlNode& root, const std::string& path);

/// The config with the values in their places; maps on the way there are made. ODO_E_CONFIG, with the nearest key where
/// a pipeline has no such key, or the items of the list.
Result<YamlNode> with_overrides(YamlNode config, const std::vector<Override>& overrides);

/// A document that parse_yaml reads as the same values. Comments and places are lost.
std::string yaml_text(const YamlNode& node);

/// The text of a config file with the values in their places, and what it names beside itself (`camera`,
/// `plugins.search`, `plugins.host`, files of `plugins.allow`) as absolute paths, so that it means the same elsewhere.
/// Without overrides the text as it is.
Result<std::string> effective_config(const std::string& file, const std::vector<Override>& overrides);

}  // namespace odograph
