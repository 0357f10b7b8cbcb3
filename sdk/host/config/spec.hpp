// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sdk/host/config/yaml_tree.hpp"

namespace odograph {

enum class SpecType { boolean, integer, real, reals, text, choice, map, list, plugins };

/// One line of a table that says what may stand in a file. The same tables feed validation, the JSON Schema, the help
/// texts and a plugin's manifest.
struct Spec {
  std::string name;
  SpecType type = SpecType::text;
  std::string unit;      // SI; values may be written with another unit of the same dimension
  double min = 0.0;      // inclusive
  double max = 0.0;      // inclusive; both 0: no bound
  std::string fallback;  // as YAML text, in `unit`
  std::string choices;   // separated by '|'
  std::string renamed;   // choices that are no more, as OLD=NEW, separated by '|'
  std::string help;
  bool required = false;
  bool open = false;           // of a map: a later version of the table may have more keys, which are passed over
  size_t count = 1;            // of reals
  std::string interface_id;    // of plugins
  std::vector<Spec> children;  // of a map; of a list the one item

  bool bounded() const { return min != 0.0 || max != 0.0; }
};

/// A checked value with the place it came from. Defaults are filled in; `given` tells them apart.
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

  /// The child of that name; asking for one that the table does not have is a programming error.
  const Value& operator[](std::string_view key) const;
  const Value* find(std::string_view key) const;
};

/// The parameter table of a plugin by id, or why it is not to be had. The pointer lives as long as the resolver.
using PluginResolver =
    std::function<Result<const std::vector<Spec>*>(const std::string& id, const std::string& interface_id)>;

/// What may stand beside `plugin` and `parameters` where a config chooses a plugin.
const std::vector<Spec>& plugin_choice_specs();

/// Checks a document against a table. All mistakes are found in one pass, each as "name:line:column: ..." on a line of
/// its own with what was expected and the nearest valid key.
Result<Value> validate(const YamlNode& node, const Spec& spec, const std::string& name, const PluginResolver& resolver);

/// A value from its default text alone.
Value default_value(const Spec& spec);

/// A number with an optional unit ("1.7 m", "30 deg", "200 ms") in `unit`, or a sentence saying what was expected.
Result<double> parse_quantity(const std::string& text, const std::string& unit);

/// The units in which a quantity of this SI unit may be written, the SI unit first.
std::vector<std::string> compatible_units(const std::string& unit);

/// "a number in m from 0.5 to 2.5", for messages and help.
std::string expectation(const Spec& spec);

}  // namespace odograph
