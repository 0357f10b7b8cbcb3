// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/known_object/text_tree.hpp"

#include <sstream>
#include <stdexcept>
#include <vector>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include "sdk/math/number_text.hpp"

namespace odograph::known_object {
namespace {

using nlohmann::json;

constexpr size_t kDeepest = 64, kMaxNodes = 100'000;

/// Builds the tree from parser events, so that texts nested too deeply or with aliases are rejected early.
class Builder : public YAML::EventHandler {
 public:
  json result;

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { put(mark, nullptr); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { fail(mark, "aliases are not supported"); }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t, const std::string& text) override {
    if (!stack_.empty() && stack_.back().is_object() && !has_key_) {
      if (stack_.back().contains(text)) fail(mark, "the key '" + text + "' occurs twice");
      key_ = text, has_key_ = true;
      keys_.back() = key_;
      return;
    }
    const auto number = tag == "!" ? std::nullopt : parse_number(text);
    put(mark, number ? json(*number) : json(text));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    open(mark, json::array());
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    open(mark, json::object());
  }
  void OnMapEnd() override { close(); }

 private:
  [[noreturn]] static void fail(const YAML::Mark& mark, const std::string& what) {
    throw std::runtime_error("line " + std::to_string(mark.line + 1) + ", column " + std::to_string(mark.column + 1) +
                             ": " + what);
  }
  void open(const YAML::Mark& mark, json value) {
    if (!stack_.empty() && stack_.back().is_object() && !has_key_) fail(mark, "expected a text as key");
    if (stack_.size() >= kDeepest) fail(mark, "more than 64 levels");
    if (++nodes_ > kMaxNodes) fail(mark, "more than 100000 nodes");
    stack_.push_back(std::move(value));
    keys_.emplace_back();
    has_key_ = false;
  }
  void close() {
    json value = std::move(stack_.back());
    stack_.pop_back(), keys_.pop_back();
    add(std::move(value));
  }
  void put(const YAML::Mark& mark, json value) {
    if (!stack_.empty() && stack_.back().is_object() && !has_key_) fail(mark, "expected a text as key");
    if (++nodes_ > kMaxNodes) fail(mark, "more than 100000 nodes");
    add(std::move(value));
  }
  void add(json value) {
    if (stack_.empty())
      result = std::move(value);
    else if (stack_.back().is_array())
      stack_.back().push_back(std::move(value));
    else
      stack_.back()[keys_.back()] = std::move(value);
    has_key_ = false;
  }

  std::vector<json> stack_;
  std::vector<std::string> keys_;
  std::string key_;
  bool has_key_ = false;
  size_t nodes_ = 0;
};

}  // namespace

json parse_yaml(const std::string& text) {
  std::istringstream stream(text);
  Builder builder;
  try {
    YAML::Parser(stream).HandleNextDocument(builder);
  } catch (const YAML::Exception& error) {
    throw std::runtime_error("line " + std::to_string(error.mark.line + 1) + ", column " +
                             std::to_string(error.mark.column + 1) + ": " + error.msg);
  }
  return std::move(builder.result);
}

}  // namespace odograph::known_object
