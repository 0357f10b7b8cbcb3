// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/config/overrides.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>

#include "sdk/host/base/json_text.hpp"
#include "sdk/host/base/nearest.hpp"
#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/platform/utf8_path.hpp"

namespace odograph {
namespace {

YamlNode* child_of(YamlNode& map, const std::string& key) {
  for (auto& entry : map.entries)
    if (entry.key == key) return &entry.value;
  return nullptr;
}

/// Finds a list item by index or plugin id. A single plugin may be written without a list.
YamlNode* item_of(YamlNode& list, const std::string& key) {
  const auto is = [&](const YamlNode& item) {
    const YamlNode* plugin = item.find("plugin");
    return plugin && plugin->text == key;
  };
  if (list.kind == YamlNode::Kind::map) return is(list) ? &list : nullptr;
  size_t number = list.items.size();
  const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), number);
  if (error == std::errc() && end == key.data() + key.size())
    return number < list.items.size() ? &list.items[number] : nullptr;
  const auto found = std::find_if(list.items.begin(), list.items.end(), is);
  return found == list.items.end() ? nullptr : &*found;
}

std::vector<std::string> items_of(const YamlNode& list) {
  std::vector<std::string> names;
  for (size_t i = 0; i < list.items.size(); ++i) {
    const YamlNode* plugin = list.items[i].find("plugin");
    names.push_back(plugin ? plugin->text : std::to_string(i));
  }
  return names;
}

Failure no_such(const std::string& path, const std::string& key, const std::vector<std::string>& there) {
  const std::string close = nearest(key, there);
  return Failure{ODO_E_CONFIG, path + ": unknown key '" + key + "'; expected one of " + join(there) +
                                   (close.empty() ? "" : " (nearest: '" + close + "')")};
}

/// Finds `key` in a node; a map creates it if missing. `spec`: the node's schema if known; set to the key's.
Result<YamlNode*> step_into(YamlNode& node, const std::string& key, const std::string& path, const Spec*& spec) {
  if (YamlNode* item = item_of(node, key)) return spec = nullptr, item;
  if (node.kind == YamlNode::Kind::sequence) return no_such(path, key, items_of(node));
  if (node.kind == YamlNode::Kind::scalar)
    return Failure{ODO_E_CONFIG, path + ": there is no '" + key + "' in the value '" + node.text + "'"};
  const Spec* known = nullptr;
  if (spec && spec->type == SpecType::map) {
    std::vector<std::string> names;
    for (const Spec& child : spec->children) {
      names.push_back(child.name);
      if (child.name == key) known = &child;
    }
    if (!known) return no_such(path, key, names);
  }
  spec = known;
  if (YamlNode* child = child_of(node, key)) return child;
  node.kind = YamlNode::Kind::map;
  node.entries.push_back({key, node.mark, {}});
  return &node.entries.back().value;
}

std::string json_quoted(const std::string& text) { return JsonText().string(text).text(); }

/// Whether a plain scalar in flow style would end early at one of its characters; such a scalar is not a number.
bool needs_quotes(const YamlNode& scalar) {
  return scalar.quoted || scalar.text.find_first_of(",[]{}:#\"'\n") != std::string::npos;
}

void make_absolute(YamlNode* node, const std::filesystem::path& base) {
  if (!node) return;
  if (node->kind == YamlNode::Kind::scalar) node->text = utf8_text(base / utf8_path(node->text)), node->quoted = true;
  for (YamlNode& item : node->items) make_absolute(&item, base);
}

}  // namespace

Result<Override> parse_override(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == 0 || equals == std::string::npos)
    return Failure{ODO_E_ARGUMENT, "'" + text + "': expected PATH=VALUE, such as walker.height=1.8m"};
  return Override{text.substr(0, equals), text.substr(equals + 1)};
}

const YamlNode* node_at(const YamlNode& root, const std::string& path) {
  auto* node = const_cast<YamlNode*>(&root);  // the lookup creates no nodes
  for (const std::string& key : split(path, '.')) {
    YamlNode* next = item_of(*node, key);
    if (!next && !(next = child_of(*node, key))) return nullptr;
    node = next;
  }
  return node;
}

Result<YamlNode> with_overrides(YamlNode config, const std::vector<Override>& overrides) {
  for (const Override& o : overrides) {
    YamlNode* node = &config;
    const Spec* spec = &pipeline_spec();
    for (const std::string& key : split(o.path, '.')) {
      const auto next = step_into(*node, key, o.path, spec);
      if (!next) return next.failure();
      node = *next;
    }
    auto value = parse_yaml(o.value, o.path);
    if (!value) return value.failure();
    *node = std::move(*value);
  }
  return config;
}

std::string yaml_text(const YamlNode& node) {
  std::string text;
  switch (node.kind) {
    case YamlNode::Kind::null: return "null";
    case YamlNode::Kind::scalar: return needs_quotes(node) ? json_quoted(node.text) : node.text;
    case YamlNode::Kind::sequence:
      for (const YamlNode& item : node.items) text += (text.empty() ? "" : ", ") + yaml_text(item);
      return "[" + text + "]";
    case YamlNode::Kind::map:
      for (const auto& entry : node.entries)
        text += (text.empty() ? "" : ",\n ") + json_quoted(entry.key) + ": " + yaml_text(entry.value);
      return "{" + text + "}";
  }
  return text;
}

Result<std::string> effective_config(const std::string& file, const std::vector<Override>& overrides) {
  auto text = read_limited(file);
  if (!text || overrides.empty()) return text;
  auto root = parse_yaml(*text, file);
  if (!root) return root.failure();
  auto changed = with_overrides(std::move(*root), overrides);
  if (!changed) return Failure{changed.failure().status, file + ": " + changed.failure().text};
  const auto base = std::filesystem::absolute(file).parent_path();
  make_absolute(child_of(*changed, "camera"), base);
  if (YamlNode* plugins = child_of(*changed, "plugins")) {
    make_absolute(child_of(*plugins, "search"), base);
    make_absolute(child_of(*plugins, "host"), base);
    if (YamlNode* allow = child_of(*plugins, "allow"))
      for (YamlNode& item : allow->items)
        if (std::error_code error;
            std::filesystem::is_regular_file(base / utf8_path(item.text), error))  // not an id or a hash
          make_absolute(&item, base);
  }
  return yaml_text(*changed) + "\n";
}

}  // namespace odograph
