// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/config/spec.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <stdexcept>

#include "sdk/host/base/nearest.hpp"
#include "sdk/math/number_text.hpp"

namespace odograph {
namespace {

std::string range(const Spec& spec) {
  if (!spec.bounded()) return "";
  return " from " + number_text(spec.min) + " to " + number_text(spec.max);
}

/// Validates the document against the table in one pass. One object per validation.
class Checker {
 public:
  Checker(const std::string& name, const PluginResolver& resolver) : name_(name), resolver_(resolver) {}

  std::vector<std::string> errors;

  Value check(const YamlNode& node, const Spec& spec, const std::string& path) {
    Value value{.name = spec.name};
    value.mark = node.mark;
    value.given = true;
    switch (spec.type) {
      case SpecType::map: check_map(node, spec.children, spec.open, path, value); break;
      case SpecType::plugins: check_plugins(node, spec, path, value); break;
      case SpecType::list: check_list(node, spec, path, value); break;
      case SpecType::reals: check_reals(node, spec, path, value); break;
      default: check_scalar(node, spec, path, value);
    }
    return value;
  }

 private:
  static constexpr size_t kMaxErrors = 20;

  void fail(Mark mark, const std::string& path, const std::string& text) {
    if (errors.size() < kMaxErrors) errors.push_back(at(name_, mark, path.empty() ? text : path + ": " + text));
  }

  void check_map(const YamlNode& node, const std::vector<Spec>& table, bool open, const std::string& path,
                 Value& value) {
    std::vector<std::string> names;
    names.reserve(table.size());
    for (const Spec& spec : table) names.push_back(spec.name);
    if (node.kind != YamlNode::Kind::map && !(node.kind == YamlNode::Kind::null && !path.empty())) {
      const std::string found =
          node.kind == YamlNode::Kind::scalar ? "'" + node.text.substr(0, 60) + "'" : node.kind_name();
      fail(node.mark, path, found + "; expected a map with the keys " + join(names) + did_you_mean(node.text, names));
      return;
    }
    const std::string prefix = path.empty() ? "" : path + ".";
    for (const auto& entry : node.entries) {
      bool known = open;
      for (const Spec& spec : table) known = known || spec.name == entry.key;
      if (known) continue;
      const std::string close = nearest(entry.key, names);
      fail(entry.mark, path,
           "unknown key '" + entry.key.substr(0, 60) + "'; expected one of " + join(names) +
               (close.empty() ? "" : " (nearest: '" + close + "')"));
    }
    for (const Spec& spec : table) {
      const YamlNode* child = node.find(spec.name);
      if (child && child->kind == YamlNode::Kind::null && spec.type != SpecType::map &&
          spec.type != SpecType::plugins && spec.type != SpecType::list) {
        fail(child->mark, prefix + spec.name, "nothing; expected " + expectation(spec));
        value.children.push_back(default_value(spec));
      } else if (child && !(child->kind == YamlNode::Kind::null && spec.type != SpecType::map)) {
        value.children.push_back(check(*child, spec, prefix + spec.name));
      } else {
        if (spec.required)
          fail(node.mark, path, "the key '" + spec.name + "' is missing; expected " + expectation(spec));
        value.children.push_back(default_value(spec));
      }
    }
  }

  void check_list(const YamlNode& node, const Spec& spec, const std::string& path, Value& value) {
    if (node.kind != YamlNode::Kind::sequence) {
      fail(node.mark, path, std::string(node.kind_name()) + "; expected " + expectation(spec));
      return;
    }
    for (size_t i = 0; i < node.items.size(); ++i)
      value.items.push_back(check(node.items[i], spec.children.front(), path + "[" + std::to_string(i) + "]"));
  }

  void check_reals(const YamlNode& node, const Spec& spec, const std::string& path, Value& value) {
    if (node.kind != YamlNode::Kind::sequence || node.items.size() != spec.count) {
      fail(node.mark, path,
           (node.kind == YamlNode::Kind::sequence ? "a list of " + std::to_string(node.items.size())
                                                  : std::string(node.kind_name())) +
               "; expected " + expectation(spec));
      value.reals.assign(spec.count, 0.0);
      return;
    }
    Spec one = spec;
    one.type = SpecType::real;
    for (size_t i = 0; i < node.items.size(); ++i)
      value.reals.push_back(check(node.items[i], one, path + "[" + std::to_string(i) + "]").real);
  }

  /// A single plugin or a list of plugins.
  void check_plugins(const YamlNode& node, const Spec& spec, const std::string& path, Value& value) {
    const bool several = node.kind == YamlNode::Kind::sequence;
    for (size_t i = 0; i < (several ? node.items.size() : 1); ++i) {
      const YamlNode& one = several ? node.items[i] : node;
      Value& item = value.items.emplace_back(Value{.name = spec.name});
      item.mark = one.mark;
      item.given = true;
      check_plugin(one, spec, several ? path + "[" + std::to_string(i) + "]" : path, item);
    }
  }

  /// {plugin: id, parameters: {...}}; the parameters are validated against the table in the plugin's manifest.
  void check_plugin(const YamlNode& node, const Spec& spec, const std::string& path, Value& value) {
    Spec id{.name = "plugin", .type = SpecType::text, .help = "", .required = true};
    Spec parameters{.name = "parameters", .type = SpecType::map};
    const YamlNode* chosen = node.kind == YamlNode::Kind::map ? node.find("plugin") : nullptr;
    if (chosen && chosen->kind == YamlNode::Kind::scalar) {
      auto table = resolver_(chosen->text, spec.interface_id);
      if (table) {
        parameters.children = **table;
      } else {
        fail(chosen->mark, path + ".plugin", table.failure().text);
        value.children.push_back(Value{.name = "plugin", .text = chosen->text});
        return;
      }
    }
    std::vector<Spec> table = {id, parameters};
    table.insert(table.end(), plugin_choice_specs().begin(), plugin_choice_specs().end());
    check_map(node, table, false, path, value);
    const Value* fallback = value.find("fallback");
    if (!fallback || !fallback->given) return;
    if (const auto other = resolver_(fallback->text, spec.interface_id); !other)
      fail(fallback->mark, path + ".fallback", other.failure().text);
  }

  void check_scalar(const YamlNode& node, const Spec& spec, const std::string& path, Value& value) {
    if (node.kind != YamlNode::Kind::scalar) {
      fail(node.mark, path, std::string(node.kind_name()) + "; expected " + expectation(spec));
      return;
    }
    const std::string shown = "'" + node.text.substr(0, 60) + "'";
    const auto wrong = [&](const std::string& more) {
      fail(node.mark, path, shown + more + "; expected " + expectation(spec));
    };
    value.text = node.text;
    switch (spec.type) {
      case SpecType::boolean:
        if (node.quoted || (node.text != "true" && node.text != "false")) return wrong("");
        value.boolean = node.text == "true";
        break;
      case SpecType::integer: {
        const char* end = node.text.data() + node.text.size();
        const auto parsed = std::from_chars(node.text.data(), end, value.integer);
        if (node.quoted || parsed.ec != std::errc() || parsed.ptr != end) return wrong("");
        check_range(static_cast<double>(value.integer), spec, wrong);
        break;
      }
      case SpecType::real: {
        const auto quantity = parse_quantity(node.text, spec.unit);
        if (!quantity) return fail(node.mark, path, quantity.failure().text + "; expected " + expectation(spec));
        value.real = *quantity;
        check_range(value.real, spec, wrong);
        break;
      }
      case SpecType::choice: {
        const auto choices = split(spec.choices, '|');
        if (std::find(choices.begin(), choices.end(), node.text) != choices.end()) break;
        for (const std::string& renamed : split(spec.renamed, '|'))
          if (renamed.starts_with(node.text + "="))
            return wrong(" was removed, its successor is '" + renamed.substr(node.text.size() + 1) + "'");
        return wrong(" (nearest: '" + nearest(node.text, choices) + "')");
      }
      default: break;
    }
  }

  template <class Wrong>
  void check_range(double x, const Spec& spec, Wrong&& wrong) {
    if (spec.bounded() && (x < spec.min || x > spec.max)) wrong(" is out of range");
  }

  const std::string& name_;
  const PluginResolver& resolver_;
};

}  // namespace

const Value* Value::find(std::string_view key) const {
  for (const Value& child : children)
    if (child.name == key) return &child;
  return nullptr;
}

const Value& Value::operator[](std::string_view key) const {
  const Value* value = find(key);
  if (!value) throw std::logic_error("no such key in the table: " + std::string(key));
  return *value;
}

Value default_value(const Spec& spec) {
  Value value{.name = spec.name};
  switch (spec.type) {
    case SpecType::map:
      for (const Spec& child : spec.children) value.children.push_back(default_value(child));
      break;
    case SpecType::boolean: value.boolean = spec.fallback == "true"; break;
    case SpecType::integer: value.integer = std::strtoll(spec.fallback.c_str(), nullptr, 10); break;
    case SpecType::real:
      if (!spec.fallback.empty()) value.real = *parse_quantity(spec.fallback, spec.unit);
      break;
    case SpecType::reals:
      for (const auto& part : split(std::string_view(spec.fallback).substr(spec.fallback.empty() ? 0 : 1), ','))
        value.reals.push_back(std::strtod(part.c_str(), nullptr));
      value.reals.resize(spec.count, 0.0);
      break;
    default: value.text = spec.fallback;
  }
  return value;
}

const std::vector<Spec>& plugin_choice_specs() {
  static const std::vector<Spec> specs = {
      {.name = "isolation",
       .type = SpecType::choice,
       .choices = "none|process",
       .renamed = "thread=process",
       .help = "process: in a process of its own, which may crash, hang or be killed; plugins.isolation unless given"},
      {.name = "fallback",
       .type = SpecType::text,
       .help = "the plugin that replaces it when it is given up, with that plugin's own defaults"},
      {.name = "time_limit",
       .type = SpecType::real,
       .unit = "s",
       .min = 0.01,
       .max = 600,
       .fallback = "2",
       .help =
           "of one call; a plugin that takes longer is reported and, in a process of its own, skipped and restarted"},
      {.name = "start_limit",
       .type = SpecType::real,
       .unit = "s",
       .min = 0.01,
       .max = 600,
       .fallback = "30",
       .help = "as time_limit, for loading, creating, configuring and activating"},
      {.name = "memory_limit",
       .type = SpecType::integer,
       .min = 64,
       .max = 1000000,
       .fallback = "2048",
       .help = "MB of address space of its own process"},
  };
  return specs;
}

std::string expectation(const Spec& spec) {
  switch (spec.type) {
    case SpecType::boolean: return "true or false";
    case SpecType::integer: return "a whole number" + range(spec);
    case SpecType::real: return "a number" + (spec.unit.empty() ? "" : " in " + spec.unit) + range(spec);
    case SpecType::reals:
      return "a list of " + std::to_string(spec.count) + " numbers" + (spec.unit.empty() ? "" : " in " + spec.unit) +
             range(spec);
    case SpecType::choice: return "one of " + join(split(spec.choices, '|'));
    case SpecType::text: return "a text" + (spec.help.empty() ? "" : " (" + spec.help + ")");
    case SpecType::list: return "a list, each item " + expectation(spec.children.front());
    case SpecType::plugins: return "a map {plugin: ID, parameters: {...}}, or a list of such";
    default: return "a map";
  }
}

Result<Value> validate(const YamlNode& node, const Spec& spec, const std::string& name,
                       const PluginResolver& resolver) {
  Checker checker(name, resolver);
  Value value = checker.check(node, spec, "");
  if (!checker.errors.empty()) return Failure{ODO_E_CONFIG, join(checker.errors, "\n")};
  return value;
}

}  // namespace odograph
