// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sdk/host/config/yaml_tree.hpp"

namespace odograph {

enum class SpecType { boolean, integer, real, reals, text, choice, map, list, plugins };

/// One entry of a schema for a file. The same tables drive validation, the JSON Schema, the help texts and the plugin
/// manifests.
struct Spec {
  std::string name;
  SpecType type = SpecType::text;
  std::string unit;      // SI; values may use another unit of the same dimension
  double min = 0.0;      // inclusive
  double max = 0.0;      // inclusive; both 0: no bound
  std::string fallback;  // as YAML text, in `unit`
  std::string choices;   // separated by '|'
  std::string renamed;   // former choices as OLD=NEW, separated by '|'
  std::string help;
  bool required = false;
  bool open = false;           // of a map: unknown keys, from a later version of the table, are skipped
  size_t count = 1;            // of reals
  std::string interface_id;    // of plugins
  std::vector<Spec> children;  // of a map; of a list, the one item

  bool bounded() const { return min != 0.0 || max != 0.0; }
};

/// A validated value with its position in the file. Defaults are filled in; `given` is false for them.
struct Value {
  std::string name;  // its key, in a table
  Mark mark;
  bool given = false;
  bool boolean = false;
  int64_t integer = 0;
  double real = 0.0;
  std::string text;
  std::vector<double> reals;
  std::vector<Value> items;
  std::vector<Value> children;

  /// The child of that name. Asking for one that is not in the table is a programming error.
  const Value& operator[](std::string_view key) const;
  const Value* find(std::string_view key) const;
};

/// Returns a plugin's parameter table by id, or a failure. The pointer is valid as long as the resolver.
using PluginResolver =
    std::function<Result<const std::vector<Spec>*>(const std::string& id, const std::string& interface_id)>;

/// Keys allowed beside `plugin` and `parameters` where a config selects a plugin.
const std::vector<Spec>& plugin_choice_specs();

/// Validates a document against a table. Reports all mistakes in one pass, each on its own line as "name:line:column:
/// ..." with the expectation and the nearest valid key.
Result<Value> validate(const YamlNode& node, const Spec& spec, const std::string& name, const PluginResolver& resolver);

/// The value of the default text.
Value default_value(const Spec& spec);

/// Parses a number with an optional unit ("1.7 m", "30 deg", "200 ms") into `unit`; a failure states what was expected.
Result<double> parse_quantity(const std::string& text, const std::string& unit);

/// Units in which a quantity with this SI unit may be written, the SI unit first.
std::vector<std::string> compatible_units(const std::string& unit);

/// "a number in m from 0.5 to 2.5", for messages and help.
std::string expectation(const Spec& spec);

}  // namespace odograph
