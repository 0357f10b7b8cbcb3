// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sdk/host/base/result.hpp"

namespace odograph {

/// A position in a file, counted from 1.
struct Mark {
  int line = 1;
  int column = 1;
};

/// A YAML document as plain values with their positions. Scalars remain text until a schema gives them a type.
struct YamlNode {
  enum class Kind { null, scalar, sequence, map };
  struct Entry;

  Kind kind = Kind::null;
  Mark mark;
  std::string text;             // of a scalar
  bool quoted = false;          // a quoted scalar is text even if it looks like a number
  std::vector<YamlNode> items;  // of a sequence
  std::vector<Entry> entries;   // of a map, in file order, keys unique

  const YamlNode* find(std::string_view key) const;
  const char* kind_name() const;
};

struct YamlNode::Entry {
  std::string key;
  Mark mark;
  YamlNode value;
};

/// Limits for a file, applied before its content is interpreted.
struct YamlLimits {
  size_t bytes = 1u << 20;
  int depth = 64;
  int nodes = 100000;
};

/// Parses one document within the limits. Anchors, aliases, tags, duplicate keys, tabs in the indentation, invalid
/// UTF-8 and second documents are refused. A failure's text is "name:line:column: what".
Result<YamlNode> parse_yaml(const std::string& text, const std::string& name, const YamlLimits& limits = {});

/// Reads a file's text unless it exceeds the limit. ODO_E_NOT_FOUND if it cannot be opened.
Result<std::string> read_limited(const std::string& path, const YamlLimits& limits = {});

/// As parse_yaml(), from a file. ODO_E_NOT_FOUND if it cannot be opened.
Result<YamlNode> read_yaml(const std::string& path, const YamlLimits& limits = {});

/// "name:line:column: text".
std::string at(const std::string& name, Mark mark, const std::string& text);

}  // namespace odograph
