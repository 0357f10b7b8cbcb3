// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/config/yaml_tree.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include "sdk/host/base/printable.hpp"
#include "sdk/host/platform/utf8_path.hpp"

namespace odograph {
namespace {

struct Refused {
  Mark mark;
  std::string text;
};

Mark from_yaml(const YAML::Mark& mark) { return mark.is_null() ? Mark{} : Mark{mark.line + 1, mark.column + 1}; }

/// Builds the tree from the parser's events, so that nothing is expanded, resolved or stored beyond the limits.
class TreeBuilder : public YAML::EventHandler {
 public:
  explicit TreeBuilder(const YamlLimits& limits) : limits_(limits) {}

  YamlNode root;

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { add(mark, "", anchor, YamlNode::Kind::null); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    throw Refused{from_yaml(mark), "aliases (*name) are not allowed here; expected the value itself, written out"};
  }
  void OnAnchor(const YAML::Mark& mark, const std::string& name) override {
    throw Refused{from_yaml(mark), "anchors (&" + name + ") are not allowed here; expected only the value"};
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    if (expecting_key()) {
      begin_entry(mark, value);
      return;
    }
    YamlNode& node = add(mark, tag, anchor, YamlNode::Kind::scalar);
    node.text = value;
    node.quoted = tag == "!";
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(mark, tag, anchor, YamlNode::Kind::sequence);
  }
  void OnSequenceEnd() override { stack_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(mark, tag, anchor, YamlNode::Kind::map);
  }
  void OnMapEnd() override { stack_.pop_back(); }

 private:
  struct Level {
    YamlNode* node;
    bool key_next = true;
  };

  bool expecting_key() const {
    return !stack_.empty() && stack_.back().node->kind == YamlNode::Kind::map && stack_.back().key_next;
  }

  void begin_entry(const YAML::Mark& mark, const std::string& key) {
    Level& level = stack_.back();
    for (const auto& entry : level.node->entries)
      if (entry.key == key)
        throw Refused{from_yaml(mark), "key '" + key + "' stands here a second time (first on line " +
                                           std::to_string(entry.mark.line) + "); expected it once"};
    count(mark);
    level.node->entries.push_back({key, from_yaml(mark), {}});
    level.key_next = false;
  }

  YamlNode& add(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t, YamlNode::Kind kind) {
    if (expecting_key()) throw Refused{from_yaml(mark), "a key must be a word; expected 'name: value'"};
    if (tag != "" && tag != "?" && tag != "!")
      throw Refused{from_yaml(mark), "tags (" + tag + ") are not allowed here; expected a plain value"};
    count(mark);
    YamlNode* node = &root;
    if (!stack_.empty()) {
      Level& level = stack_.back();
      if (level.node->kind == YamlNode::Kind::map) {
        node = &level.node->entries.back().value;
        level.key_next = true;
      } else {
        node = &level.node->items.emplace_back();
      }
    }
    node->kind = kind;
    node->mark = from_yaml(mark);
    return *node;
  }

  void open(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, YamlNode::Kind kind) {
    if (static_cast<int>(stack_.size()) >= limits_.depth)
      throw Refused{from_yaml(mark), "nested more than " + std::to_string(limits_.depth) +
                                         " levels deep; expected a config, which needs 6"};
    // A parent's vector does not grow while a child is open, so the pointer stays valid.
    YamlNode* node = &add(mark, tag, anchor, kind);
    stack_.push_back({node});
  }

  void count(const YAML::Mark& mark) {
    if (++nodes_ > limits_.nodes)
      throw Refused{from_yaml(mark), "more than " + std::to_string(limits_.nodes) + " values; expected a config"};
  }

  const YamlLimits& limits_;
  std::vector<Level> stack_;
  int nodes_ = 0;
};

/// Checks what the YAML library reports poorly or not at all: tabs in the indentation, NUL, and invalid UTF-8.
void check_bytes(const std::string& text) {
  Mark mark;
  bool indentation = true;
  for (size_t i = 0; i < text.size(); ++mark.column) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const size_t bytes = utf8_character(std::string_view(text).substr(i));
    if (byte == 0) throw Refused{mark, "a NUL byte; expected a text file in UTF-8"};
    if (indentation && byte == '\t') throw Refused{mark, "a tab in the indentation; expected spaces"};
    if (bytes == 0) throw Refused{mark, "bytes that are not UTF-8; expected a text file in UTF-8"};
    if (byte == '\n')
      mark = {mark.line + 1, 0}, indentation = true;
    else if (byte != ' ')
      indentation = false;
    i += bytes;
  }
}

}  // namespace

const YamlNode* YamlNode::find(std::string_view key) const {
  for (const auto& entry : entries)
    if (entry.key == key) return &entry.value;
  return nullptr;
}

const char* YamlNode::kind_name() const {
  switch (kind) {
    case Kind::null: return "nothing";
    case Kind::scalar: return "a value";
    case Kind::sequence: return "a list";
    default: return "a map";
  }
}

std::string at(const std::string& name, Mark mark, const std::string& text) {
  return name + ":" + std::to_string(mark.line) + ":" + std::to_string(mark.column) + ": " + text;
}

Result<YamlNode> parse_yaml(const std::string& text, const std::string& name, const YamlLimits& limits) {
  try {
    if (text.size() > limits.bytes)
      throw Refused{
          {},
          "the file has " + std::to_string(text.size()) + " bytes; expected at most " + std::to_string(limits.bytes)};
    check_bytes(text);
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    TreeBuilder builder(limits);
    if (!parser.HandleNextDocument(builder)) return YamlNode{};
    TreeBuilder rest(limits);
    if (parser.HandleNextDocument(rest)) throw Refused{rest.root.mark, "a second document (---); expected one"};
    return std::move(builder.root);
  } catch (const Refused& refused) {
    return Failure{ODO_E_CONFIG, at(name, refused.mark, refused.text)};
  } catch (const YAML::Exception& error) {
    return Failure{ODO_E_CONFIG, at(name, from_yaml(error.mark), "not YAML: " + error.msg + "; expected 'key: value'")};
  } catch (const std::exception& error) {
    return Failure{ODO_E_CONFIG, at(name, {}, std::string("not YAML: ") + error.what())};
  }
}

Result<std::string> read_limited(const std::string& path, const YamlLimits& limits) {
  const std::filesystem::path name = utf8_path(path);
  std::error_code error;
  if (std::filesystem::is_directory(name, error))
    return Failure{ODO_E_NOT_FOUND, at(path, {}, "is a directory; expected a YAML file")};
  if (std::filesystem::exists(name, error) && !std::filesystem::is_regular_file(name, error))
    return Failure{ODO_E_NOT_FOUND, at(path, {}, "is a pipe or a device; expected a YAML file")};
  const auto size = std::filesystem::file_size(name, error);
  if (!error && size > limits.bytes)
    return Failure{ODO_E_CONFIG, at(path, {},
                                    "the file has " + std::to_string(size) + " bytes; expected at most " +
                                        std::to_string(limits.bytes))};
  std::ifstream file(name, std::ios::binary);
  if (!file) return Failure{ODO_E_NOT_FOUND, at(path, {}, "cannot be opened; expected a YAML file")};
  std::string text(limits.bytes + 1, '\0');  // one byte more, to detect a file that grows
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<size_t>(file.gcount()));
  return text;
}

Result<YamlNode> read_yaml(const std::string& path, const YamlLimits& limits) {
  const auto text = read_limited(path, limits);
  if (!text) return text.failure();
  return parse_yaml(*text, path, limits);
}

}  // namespace odograph
